// SPDX-License-Identifier: AGPL-3.0-or-later
// Parser's part of `finish { mdf { … } }`.

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"

#include <cmath>
#include <memory>
#include <set>

#include "base/fileinputoutput.h"
#include "base/image/image.h"
#include "base/stringutilities.h"
#include "backend/mdf/surface.h"
#include "backend/mdf/words.h"
#include "backend/parser/parse.h"
#include "backend/shape/mesh.h"
#include "backend/support/fileutil.h"
#include "backend/texture/pigment.h"
#include "backend/texture/texture.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

namespace {

mdf::BumpImage *read_png(IStream *file) {
  Image::ReadOptions options; // by default no gamma correction: a normal map holds no colours
  const std::unique_ptr<Image> image(Image::Read(Image::PNG, file, options));
  std::unique_ptr<mdf::BumpImage> bump(new mdf::BumpImage(image->GetWidth(), image->GetHeight()));

  for (unsigned int y = 0; y < image->GetHeight(); y++)
    for (unsigned int x = 0; x < image->GetWidth(); x++) {
      float red, green, blue;
      image->GetRGBValue(x, y, red, green, blue);
      bump->set(x, y, red, green, blue);
    }
  return bump.release();
}

// All mdf blocks of a texture.
void collect_blocks(const TEXTURE *texture, std::set<const mdf::Material *> &blocks) {
  for (; texture != NULL; texture = reinterpret_cast<const TEXTURE *>(texture->Next)) {
    if (texture->Type == PLAIN_PATTERN && texture->Finish != NULL && texture->Finish->Mdf != NULL)
      blocks.insert(texture->Finish->Mdf);
    if (texture->Type == BITMAP_PATTERN)
      for (const TEXTURE *m = texture->Materials; m != NULL; m = m->Next_Material)
        collect_blocks(m, blocks);
    if (texture->Blend_Map != NULL)
      for (int i = 0; i < texture->Blend_Map->Number_Of_Entries; i++)
        collect_blocks(texture->Blend_Map->Blend_Map_Entries[i].Vals.Texture, blocks);
  }
}

} // namespace

// Numbers of one row of the table; `word` is what the block calls it.
void Parser::Parse_Mdf_Row(mdf::Material &material, int row, const std::string &word) {
  shade_param_info info;
  double v[3];

  shade_param_row(row, &info);
  if (info.components == 3) {
    RGBColour colour;
    Parse_Colour(colour);
    v[0] = colour.red();
    v[1] = colour.green();
    v[2] = colour.blue();
  } else
    v[0] = Parse_Float();

  // a lobe's number too small is a mistake, a colour a little out of range is not
  if (info.components == 1 && !(v[0] >= info.minimum))
    Error("mdf: %s is %g, expected a number from %g to %g.", word.c_str(), v[0], info.minimum,
          info.maximum);
  shade_params_set(&material.params, row, v);
  double set[3];
  shade_params_get(&material.params, row, set);
  for (int c = 0; c < info.components; c++)
    if (set[c] != v[c]) {
      if (info.components == 1)
        Warning(0, "mdf: %s is %g; it is taken as %g, the largest possible.", word.c_str(), v[c],
                set[c]);
      else
        Warning(0, "mdf: a component of %s is %g; it is taken as %g.", word.c_str(), v[c], set[c]);
    }
}

// The numbers that a choice reads, in the order of the table.
void Parser::Parse_Mdf_Rows(mdf::Material &material, shade_list list, int value) {
  const std::vector<int> rows = mdf::rows_of_choice(list, value);

  for (size_t i = 0; i < rows.size(); i++) {
    if (i > 0)
      Parse_Comma();
    Parse_Mdf_Row(material, rows[i], mdf::name_of_row(rows[i], list, value));
  }
}

void Parser::Parse_Mdf_Bump_Image(mdf::Material &material) {
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_IMAGE);
  std::string name;
  int type = mdf::IMAGE_PNG;

  Parse_Begin();
  material.strength = 1.0;

  // clang-format off
  EXPECT
    CASE (MDF_WORD_TOKEN)
      if (Token.Function_Id == mdf::IMAGE_STRENGTH)
        material.strength = Parse_Float();
      else {
        type = Token.Function_Id;
        char *text = Parse_C_String(true);
        name = text;
        POV_FREE(text);
      }
    END_CASE

    CASE (RIGHT_CURLY_TOKEN)
      UNGET
      EXIT
    END_CASE

    OTHERWISE
      Expectation_Error(mdf::expected_words(mdf::WORDS_IMAGE, "}").c_str());
    END_CASE
  END_EXPECT
  // clang-format on

  if (name.empty())
    Expectation_Error("png \"file\" or exr \"file\"");
  if (!(material.strength >= 0.0))
    Error("mdf: bump_image strength is %g, expected 0 or more.", material.strength);

  UCS2String found;
  const std::unique_ptr<IStream> file(
      Locate_File(this, sceneData, ASCIItoUCS2String(name.c_str()),
                  type == mdf::IMAGE_PNG ? POV_File_Image_PNG : POV_File_Image_EXR, found, true));
  if (file.get() == NULL)
    Error("mdf: cannot open the bump_image file '%s'.", name.c_str());

  const std::string path = UCS2toASCIIString(found);
  std::shared_ptr<const mdf::BumpImage> &image = sceneData->mdfScene.images[path];
  try {
    if (!image)
      image.reset(type == mdf::IMAGE_PNG ? read_png(file.get()) : mdf::read_exr(path));
  } catch (const std::exception &e) {
    Error("mdf: cannot read the bump_image file '%s': %s", path.c_str(), e.what());
  }
  material.bump = image;

  Parse_End();
}

void Parser::Parse_Mdf_Tangent(mdf::Material &material) {
  {
    const mdf::WordScope words(Mdf_Words, mdf::WORDS_TANGENT);
    Get_Token();
  }
  if (Token.Token_Id == MDF_WORD_TOKEN) {
    material.tangent = mdf::Material::TANGENT_FROM_UV;
    return;
  }
  Unget_Token();
  Parse_Vector(material.axis);
  material.tangent = mdf::Material::TANGENT_AXIS;
  if (!(Vector3d(material.axis).length() > EPSILON))
    Error("mdf: tangent <0, 0, 0> has no direction.");
}

void Parser::Parse_Mdf_Choice(mdf::Material &material, shade_list list) {
  const mdf::WordSet choices = mdf::words_of_list(list);
  {
    const mdf::WordScope words(Mdf_Words, choices);
    Get_Token();
  }
  if (Token.Token_Id != MDF_WORD_TOKEN)
    Expectation_Error(mdf::expected_words(choices, "").c_str());

  const int value = Token.Function_Id;
  shade_params_set_choice(&material.params, list, value);
  Parse_Mdf_Rows(material, list, value);
}

void Parser::Parse_Mdf(FINISH *finish) {
  mdf::Material material;

  if (finish->Mdf != NULL) // of the finish that this one began with
    material = *finish->Mdf;
  material.name = UCS2toASCIIString(Token.FileHandle->name()) + ":" +
                  std::to_string(Token.Token_File_Pos.lineno);

  Parse_Begin();
  {
    const mdf::WordScope words(Mdf_Words, mdf::WORDS_BLOCK);
    int word;

    // clang-format off
    EXPECT
      CASE (MDF_WORD_TOKEN)
        word = Token.Function_Id;
        if (word == mdf::BLOCK_TANGENT)
          Parse_Mdf_Tangent(material);
        else if (word == mdf::BLOCK_BUMP_IMAGE)
          Parse_Mdf_Bump_Image(material);
        else if (word >= mdf::BLOCK_ROW)
          Parse_Mdf_Row(material, word - mdf::BLOCK_ROW, mdf::word_of_row(word - mdf::BLOCK_ROW));
        else if (word >= mdf::BLOCK_LIST)
          Parse_Mdf_Choice(material, (shade_list)(word - mdf::BLOCK_LIST));
        else { // a distribution
          shade_params_set_choice(&material.params, SHADE_LIST_MDF, word);
          Parse_Mdf_Rows(material, SHADE_LIST_MDF, word);
        }
      END_CASE

      CASE (RIGHT_CURLY_TOKEN)
        UNGET
        EXIT
      END_CASE

      OTHERWISE
        Expectation_Error(mdf::expected_words(mdf::WORDS_BLOCK, "}").c_str());
      END_CASE
    END_EXPECT
    // clang-format on
  }
  Parse_End();

  char wrong[160];
  if (sceneData->mdfScene.empty() && shade_isa_check(wrong, sizeof wrong) != 0) // once
    Warning(0, "mdf: %s.", wrong);
  finish->Mdf = sceneData->mdfScene.add(material);
}

void Parser::Post_Process_Mdf(ConstObjectPtr object) {
  std::set<const mdf::Material *> blocks;
  mdf::Scene &scene = sceneData->mdfScene;
  const Mesh *mesh = dynamic_cast<const Mesh *>(object);

  if (scene.empty())
    return;
  collect_blocks(object->Texture, blocks);
  collect_blocks(object->Interior_Texture, blocks);
  for (long i = 0; mesh != NULL && i < mesh->Number_Of_Textures; i++)
    collect_blocks(mesh->Textures[i], blocks);
  if (blocks.empty() || (object->Type & IS_COMPOUND_OBJECT)) // its children come on their own
    return;

  if (mesh != NULL && scene.meshes.find(mesh->Data) == scene.meshes.end()) {
    const long without = mdf_add_mesh(mesh, scene);
    if (without > 0 && without < 3 * mesh->Data->Number_Of_Triangles)
      Warning(0,
              "mdf: %ld of the %ld corners of a mesh have no UV area around them; their tangents "
              "are arbitrary.",
              without, 3 * mesh->Data->Number_Of_Triangles);
  }

  const MdfUv uv = mdf_uv(object, scene);
  const char *kind =
      (mesh != NULL) ? "a mesh without UV coordinates" : "an object without UV coordinates";
  for (std::set<const mdf::Material *>::const_iterator i = blocks.begin(); i != blocks.end(); ++i) {
    const mdf::Material *block = *i;
    if (uv == MDF_UV_NONE && block->tangent == mdf::Material::TANGENT_FROM_UV &&
        scene.first_warning(block, "tangent"))
      Warning(0, "mdf: 'tangent uv' (%s) on %s: the object's x axis is used.", block->name.c_str(),
              kind);
    if (uv != MDF_UV_FULL && block->bump && scene.first_warning(block, "bump_image"))
      Warning(0, "mdf: 'bump_image' (%s) on %s: it has no effect there.", block->name.c_str(),
              kind);
  }
}

} // namespace pov
