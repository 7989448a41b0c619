// SPDX-License-Identifier: AGPL-3.0-or-later
// Parser's part of `finish { mdf { … } }`.

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <set>

#include "base/fileinputoutput.h"
#include "base/image/image.h"
#include "base/stringutilities.h"
#include "backend/lighting/point.h"
#include "backend/math/matrices.h"
#include "backend/mdf/notes.h"
#include "backend/mdf/relief.h"
#include "backend/mdf/surface.h"
#include "backend/mdf/tangents.h"
#include "backend/mdf/words.h"
#include "backend/parser/parse.h"
#include "backend/scene/scene.h"
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

// What messages call a token that no number, vector or colour begins with; "" for others. text: as
// it is written, name: as POV-Ray calls it.
std::string no_number(TOKEN id, const char *text, const char *name) {
  switch (id) {
  case MDF_WORD_TOKEN:
  case IDENTIFIER_TOKEN:
    return std::string("'") + text + "'";
  case RIGHT_CURLY_TOKEN:
  case LEFT_CURLY_TOKEN:
  case STRING_LITERAL_TOKEN:
  case COMMA_TOKEN:
  case EQUALS_TOKEN:
  case END_OF_FILE_TOKEN:
    return mdf::plain_token(name);
  default:
    return "";
  }
}

// Whether a colour begins with this token. POV-Ray takes what begins with any other for black.
bool begins_colour(TOKEN id) {
  static const TOKEN begin[] = {
      COLOUR_KEY_TOKEN, COLOUR_ID_TOKEN,   VECTFUNCT_ID_TOKEN, VECTOR_FUNCT_TOKEN, LEFT_ANGLE_TOKEN,
      U_TOKEN,          V_TOKEN,           UV_ID_TOKEN,        VECTOR_4D_ID_TOKEN, SPLINE_ID_TOKEN,
      LEFT_PAREN_TOKEN, FLOAT_FUNCT_TOKEN, PLUS_TOKEN,         DASH_TOKEN,         FUNCT_ID_TOKEN,
      EXCLAMATION_TOKEN};

  return std::find(begin, begin + sizeof begin / sizeof *begin, id) !=
         begin + sizeof begin / sizeof *begin;
}

// What the name of a token is that of: where a file ends, its function is that of the one before.
TOKEN named_by(TOKEN id, TOKEN function) {
  return id == END_OF_FILE_TOKEN ? id : function;
}

// Do numbers of colours add up as light does? As far as the scene has said yet.
bool is_light_linear(const SceneData &scene) {
  if (scene.gammaMode == kPOVList_GammaMode_None)
    return scene.EffectiveLanguageVersion() >= 370;
  return GammaCurve::IsNeutral(scene.workingGamma);
}

} // namespace

// Scenes ask `#ifdef (mdf_Version)` whether this is a POV-Ray that knows the block. It counts up
// whenever a word comes, goes or changes its meaning; 1 was that of libshade 0.1.
void Parser::Declare_Mdf_Version() {
  SYM_ENTRY *entry = Add_Symbol(1, "mdf_Version", FLOAT_ID_TOKEN);

  entry->Data = Create_Float();
  *reinterpret_cast<DBL *>(entry->Data) = 8.0;
}

// Loops and macros parse the same block many times: once is enough. of_operand: about what was read
// last, whose line is told; the parser is a token further, perhaps in another file.
void Parser::Warn_Mdf(const std::string &text, bool of_operand) {
  if (!sceneData->mdfScene->first_warning(text))
    return;
  const Token_Struct ahead(Token);
  if (of_operand && Mdf_Operand.FileHandle == Token.FileHandle) {
    Token.Token_File_Pos = Mdf_Operand.Token_File_Pos;
    Token.Token_Col_No = Mdf_Operand.Token_Col_No;
  }
  Warning(0, "mdf: %s", text.c_str());
  Token = ahead;
}

// A number, or a colour, that was out of range.
void Parser::Warn_Mdf_Numbers(const std::string &what, int count, const double *written,
                              const double *taken) {
  char text[160];

  if (std::equal(written, written + count, taken))
    return;
  if (count == 3)
    snprintf(text, sizeof text, " is <%g, %g, %g>; it is taken as <%g, %g, %g>.", written[0],
             written[1], written[2], taken[0], taken[1], taken[2]);
  else
    snprintf(text, sizeof text, " is %g; it is taken as %g.", written[0], taken[0]);
  Warn_Mdf(what + text, true);
}

void Parser::Warn_Mdf_Number(const std::string &what, double written, double taken) {
  Warn_Mdf_Numbers(what, 1, &written, &taken);
}

// The error for a token that is none of these words (`last` as in expected_words); of no words, for
// one that is not `last`. after: the word of the set before it, with all that it takes.
void Parser::Expect_Mdf_Word(mdf::WordSet words, const std::string &last,
                             const std::string &after) {
  const std::string expected = mdf::expected_words(words, last);
  std::string found;

  if (Token.Token_Id == IDENTIFIER_TOKEN)
    found = Token.Token_String;
  else if (Token.Token_Id != RIGHT_CURLY_TOKEN)
    found = Get_Token_String(named_by(Token.Token_Id, Token.Function_Id));
  if (words == mdf::WORDS_NONE)
    Error("mdf: expected %s, but found %s.", last.c_str(),
          Token.Token_Id == IDENTIFIER_TOKEN || Token.Token_Id == MDF_WORD_TOKEN
              ? ("'" + std::string(Token.Token_String) + "'").c_str()
              : mdf::plain_token(Get_Token_String(named_by(Token.Token_Id, Token.Function_Id)))
                    .c_str());
  const std::string hint = mdf::hint_for(words, found, after);
  const std::string nearest = mdf::nearest_word(words, found);
  if (!hint.empty() && (nearest.empty() || words < mdf::WORDS_LIST))
    Error("Expected '%s', %s found instead; %s.", expected.c_str(),
          Token.Token_Id == IDENTIFIER_TOKEN
              ? ("undeclared identifier '" + found + "'").c_str()
              : mdf::plain_token(Get_Token_String(named_by(Token.Token_Id, Token.Function_Id)))
                    .c_str(),
          hint.c_str());
  const std::string misspelt = mdf::hint_for_misspelt(words, found);
  if (nearest.empty() && Token.Token_Id == IDENTIFIER_TOKEN && !misspelt.empty())
    Error("Expected '%s', undeclared identifier '%s' found instead; %s", expected.c_str(),
          found.c_str(), misspelt.c_str());
  if (nearest.empty() && Token.Token_Id == IDENTIFIER_TOKEN)
    Error("Expected '%s', undeclared identifier '%s' found instead.", expected.c_str(),
          found.c_str());
  if (nearest.empty())
    Error("Expected '%s', %s found instead.", expected.c_str(),
          mdf::plain_token(Get_Token_String(named_by(Token.Token_Id, Token.Function_Id))).c_str());
  Error("Expected '%s', '%s' found instead; did you mean '%s'?", expected.c_str(), found.c_str(),
        nearest.c_str());
}

// The error for a word of a block, or one misspelt, where something else was to end.
void Parser::Misplace_Mdf_Word(const char *within) {
  if (Token.Token_Id != IDENTIFIER_TOKEN && Token.Token_Id != MDF_TOKEN)
    return;
  const std::string found = Token.Token_Id == MDF_TOKEN ? "mdf" : Token.Token_String;
  const std::string hint = mdf::hint_outside(found);
  if (!hint.empty())
    Error("No matching } in '%s', '%s' found instead; %s", within, found.c_str(), hint.c_str());
}

// The error that says all there is to say.
void Parser::Refuse_Mdf(const std::string &text) {
  Mdf_Due.clear();
  Error("mdf: %s", text.c_str());
}

// Whether the scene has given the symbol just read a meaning of its own.
bool Parser::Is_Mdf_Word_Declared() {
  for (int table = Table_Index; table > 0; table--)
    if (Find_Symbol(table, String) != NULL)
      return true;
  return false;
}

// Where a number or a text is due, a word of the block that the scene has declared is the scene's.
void Parser::Get_Mdf_Operand() {
  Get_Token();
  Mdf_Operand = Token;
  if (Token.Token_Id != MDF_WORD_TOKEN || !Is_Mdf_Word_Declared())
    return;
  Token.Token_Id = END_OF_FILE_TOKEN;
  Read_Declared_Symbol();
  if (Token.Token_Id == END_OF_FILE_TOKEN) // a macro: what it begins with
    Get_Token();
}

// That what comes next may be an operand: no brace, word or name. `what` says what was expected.
void Parser::Need_Mdf_Operand(const std::string &what) {
  Get_Mdf_Operand();
  if (Token.Token_Id == RIGHT_CURLY_TOKEN || Token.Token_Id == MDF_WORD_TOKEN ||
      Token.Token_Id == IDENTIFIER_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, what);
  Unget_Token();
}

// The brace after the word that a part of a block begins with.
void Parser::Begin_Mdf(const std::string &word) {
  Get_Token();
  if (Token.Token_Id != LEFT_CURLY_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, "'{' after '" + word + "'");
  Unget_Token();
  Parse_Begin();
}

// The next word of a block; false at the brace that ends it. last: the word before, for errors.
bool Parser::Next_Mdf_Word(mdf::WordSet words, std::string &last) {
  Get_Token();
  if (Token.Token_Id == RIGHT_CURLY_TOKEN) {
    Unget_Token();
    return false;
  }
  if (Token.Token_Id != MDF_WORD_TOKEN)
    Expect_Mdf_Word(words, "}", last);
  last = Token.Token_String;
  return true;
}

// Numbers (three: of a colour) that have to be there, and to be numbers. `what` is their name in
// messages; of: the word that they follow, where that is another one.
void Parser::Parse_Mdf_Numbers(const std::string &what, int count, double *v,
                               const std::string &of) {
  const std::string needed =
      (of.empty() ? "" : of + ": ") + what + " needs " + (count == 3 ? "a colour" : "a number");

  Get_Mdf_Operand();
  if (count == 3 && Token.Token_Id == COLOUR_TOKEN) // alone POV-Ray takes it for black
    Get_Mdf_Operand();
  std::string found =
      no_number(Token.Token_Id, Token.Token_String, Get_Token_String(Token.Token_Id));
  const bool wrong = count == 3
                         ? !begins_colour(Token.Token_Id)
                         : Token.Token_Id == COLOUR_TOKEN || Token.Token_Id == COLOUR_KEY_TOKEN;
  if (found.empty() && wrong)
    found = Get_Token_String(named_by(Token.Token_Id, Token.Function_Id));
  if (!found.empty())
    Error("mdf: %s, %s found instead.", needed.c_str(), found.c_str());
  Unget_Token();

  const mdf::NoteScope due(Mdf_Due, needed);
  if (count == 3) {
    RGBColour colour;
    Parse_Colour(colour);
    v[0] = colour.red();
    v[1] = colour.green();
    v[2] = colour.blue();
  } else {
    EXPRESS value;
    if (Parse_Unknown_Vector(value) > 1)
      Refuse_Mdf(what + " needs a number, a vector or colour found instead.");
    v[0] = value[0];
  }
  for (int c = 0; c < count; c++)
    if (!std::isfinite(v[c]))
      Refuse_Mdf(what + " is not a finite number.");
}

// `pigment` in place of a colour: that of the texture's layer.
bool Parser::Parse_Mdf_Pigment() {
  Get_Token();
  if (Token.Token_Id == PIGMENT_TOKEN)
    return true;
  Unget_Token();
  return false;
}

// What stands after `word`.
bool Parser::Parse_Mdf_Switch(const std::string &word) {
  Get_Token();
  if (Token.Function_Id != ON_TOKEN && Token.Function_Id != OFF_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, "'on' or 'off' after '" + word + "'");
  return Token.Function_Id == ON_TOKEN;
}

// One number for both, or <of u, of v>.
void Parser::Parse_Mdf_UV(const std::string &what, UV_VECT both) {
  const std::string needed = what + " needs a number or <of u, of v>";

  Get_Mdf_Operand();
  const std::string found =
      no_number(Token.Token_Id, Token.Token_String, Get_Token_String(Token.Token_Id));
  if (!found.empty())
    Error("mdf: %s, %s found instead.", needed.c_str(), found.c_str());
  Unget_Token();
  const mdf::NoteScope due(Mdf_Due, needed);
  EXPRESS value;
  const int terms = Parse_Unknown_Vector(value);
  if (terms > 2)
    Refuse_Mdf(needed + ", a vector of " + std::to_string(terms) + " numbers found instead.");
  both[U] = value[0];
  both[V] = value[terms - 1];
}

// Numbers of one row of the table; `word` is what the block calls it. A number out of range is
// taken as the nearest within, and the author is told.
void Parser::Parse_Mdf_Row(mdf::Material &material, int row, const std::string &word,
                           const std::string &of) {
  shade_param_info info;
  double v[3], set[3];

  shade_param_row(row, &info);
  if (info.components == 3) {
    bool *const pigment = material.pigment_for(row);
    if (pigment == &material.specular_pigment && Mdf_Defaults() >= 1) // older scenes keep the metal
      material.colour_metal();
    if (pigment != NULL && (*pigment = Parse_Mdf_Pigment()))
      return;
  }
  Parse_Mdf_Numbers(word, info.components, v, of);
  shade_params_set(&material.params, row, v);
  shade_params_get(&material.params, row, set);
  Warn_Mdf_Numbers(word, info.components, v, set);
}

// Widths that are allowed and of no use: exponents in place of alphas, or alphas in place of
// exponents.
void Parser::Warn_Mdf_Width(const mdf::Material &material, int row, int mdf,
                            const std::string &what) {
  const bool exponents = mdf == SHADE_MDF_ASHIKHMIN_SHIRLEY;
  double v[3];

  shade_params_get(&material.params, row, v);
  if (exponents ? v[0] > 0.0 && v[0] < 1.0 : v[0] > 1.0)
    Warn_Mdf(what + " (" + material.name + ") is " + mdf::text_of(v[0]) +
                 (exponents
                      ? ": below 1 there is no highlight left; alphas are read by ggx, beckmann "
                        "and ward."
                      : ": above 1 there is no highlight left; exponents are read by "
                        "ashikhmin_shirley."),
             true);
}

// The numbers that a choice reads, in the order of the table.
void Parser::Parse_Mdf_Rows(mdf::Material &material, shade_list list, int value) {
  const std::vector<int> rows = mdf::rows_of_choice(list, value);
  const std::string of = list == SHADE_LIST_MDF ? Token.Token_String : ""; // others are in names

  for (size_t i = 0; i < rows.size(); i++) {
    if (i > 0)
      Parse_Comma();
    Parse_Mdf_Row(material, rows[i], mdf::name_of_row(rows[i], list, value), of);
    if (list == SHADE_LIST_MDF)
      Warn_Mdf_Width(material, rows[i], value, mdf::name_of_row(rows[i], list, value));
  }
}

// As in `specular 1 roughness r`: the reciprocal of an exponent. One, or one along and one across.
void Parser::Parse_Mdf_Roughness(mdf::Material &material) {
  const std::vector<int> rows = mdf::rows_of_choice(SHADE_LIST_MDF, SHADE_MDF_ASHIKHMIN_SHIRLEY);
  double r = 0.0;

  for (size_t i = 0; i < rows.size(); i++) {
    bool another = (i == 0);
    if (i > 0) {
      Get_Token();
      another = Token.Token_Id == COMMA_TOKEN || Token.Token_Id == FLOAT_FUNCT_TOKEN;
      if (Token.Token_Id != COMMA_TOKEN) // which may be left out, as between other numbers
        Unget_Token();
    }
    if (another) {
      shade_param_info info;
      shade_param_row(rows[i], &info);
      Parse_Mdf_Numbers("roughness", 1, &r);
      if (!(r * info.maximum >= 1.0)) {
        Warn_Mdf_Number("roughness", r, 1.0 / info.maximum);
        r = 1.0 / info.maximum;
      } else if (r > 1.0)
        Warn_Mdf("roughness (" + material.name + ") is " + mdf::text_of(r) +
                     ": above 1 there is no highlight left.",
                 true);
    }
    const double exponent = 1.0 / r;
    shade_params_set(&material.params, rows[i], &exponent);
  }
}

// `slopes x, y, xx, xy, yy`: of the bumps, in place of what is found.
void Parser::Parse_Mdf_Slopes(mdf::Material &material) {
  static const char *const names[] = {"slopes x", "slopes y", "slopes xx", "slopes xy",
                                      "slopes yy"};
  double written[5], taken[5];

  for (int i = 0; i < 5; i++) {
    if (i > 0)
      Parse_Comma();
    Parse_Mdf_Numbers(names[i], 1, &written[i]);
  }
  shade_params_set_slopes(&material.params, written);
  shade_params_get_slopes(&material.params, taken);
  for (int i = 0; i < 5; i++)
    Warn_Mdf_Number(names[i], written[i], taken[i]);
  material.told_slopes = true;
}

void Parser::Parse_Mdf_Bump_Image(mdf::Material &material) {
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_IMAGE);
  std::string name, last;
  int type = mdf::IMAGE_PNG;

  Begin_Mdf("bump_image");
  material.bump_once = false;
  material.strength = 1.0;
  material.filtered = true;
  for (int axis = 0; axis < 2; axis++) {
    material.bump_scale[axis] = 1.0;
    material.bump_move[axis] = 0.0;
  }

  while (Next_Mdf_Word(mdf::WORDS_IMAGE, last)) {
    if (Token.Function_Id == mdf::IMAGE_STRENGTH)
      Parse_Mdf_Numbers("bump_image strength", 1, &material.strength);
    else if (Token.Function_Id == mdf::IMAGE_FILTER)
      material.filtered = Parse_Mdf_Switch("filter");
    else if (Token.Function_Id == mdf::IMAGE_ONCE)
      material.bump_once = true;
    else if (Token.Function_Id == mdf::IMAGE_SCALE || Token.Function_Id == mdf::IMAGE_TRANSLATE) {
      const bool is_scale = Token.Function_Id == mdf::IMAGE_SCALE;
      UV_VECT both;
      Parse_Mdf_UV(is_scale ? "bump_image scale" : "bump_image translate", both);
      for (int axis = 0; axis < 2; axis++) {
        if (!std::isfinite(both[axis]) || (is_scale && both[axis] == 0.0))
          Error("mdf: bump_image %s is <%g, %g>; it needs finite numbers%s.",
                is_scale ? "scale" : "translate", both[U], both[V],
                is_scale ? " that are not 0" : "");
        // in the order they are written, as elsewhere
        if (is_scale) {
          material.bump_scale[axis] *= both[axis];
          material.bump_move[axis] *= both[axis];
        } else
          material.bump_move[axis] += both[axis];
      }
    } else {
      type = Token.Function_Id;
      const std::string file = Token.Token_String;
      Need_Mdf_Operand("the name of a file, in quotes, after '" + file + "'");
      const mdf::NoteScope due(Mdf_Due, file + " needs the name of a file, in quotes");
      char *text = Parse_C_String(true);
      name = text;
      POV_FREE(text);
    }
  }

  if (name.empty())
    Error("mdf: bump_image needs a file: png \"file\" or exr \"file\".");
  if (material.strength < 0.0) {
    Warn_Mdf_Number("bump_image strength", material.strength, 0.0);
    material.strength = 0.0;
  }

  UCS2String found;
  const std::unique_ptr<IStream> file(
      Locate_File(this, sceneData, ASCIItoUCS2String(name.c_str()),
                  type == mdf::IMAGE_PNG ? POV_File_Image_PNG : POV_File_Image_EXR, found, false));
  if (file.get() == NULL)
    Error("mdf: cannot open the bump_image file '%s'.", name.c_str());

  const std::string path = UCS2toASCIIString(found);
  std::shared_ptr<const mdf::BumpImage> &image = sceneData->mdfScene->images[path];
  try {
    if (!image)
      image.reset(type == mdf::IMAGE_PNG ? read_png(file.get()) : mdf::read_exr(path));
  } catch (const std::exception &e) {
    Error("mdf: cannot read the bump_image file '%s': %s", path.c_str(), e.what());
  }
  material.bump = image;
  if (material.bump_once) {
    std::shared_ptr<const mdf::BumpImage> &alone = sceneData->mdfScene->images[path + "\nonce"];
    if (!alone)
      alone.reset(image->once());
    material.bump = alone;
  }

  Parse_End();
}

// `reflection { samples n clamp c }`, either of which may be left out; `reflection off` where a
// finish that this one began with has it.
void Parser::Parse_Mdf_Reflection(mdf::Material &material) {
  Get_Token();
  if (Token.Function_Id == OFF_TOKEN || Token.Function_Id == ON_TOKEN) {
    material.reflects = Token.Function_Id == ON_TOKEN;
    return;
  }
  if (Token.Token_Id != LEFT_CURLY_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, "'{', 'on' or 'off' after 'reflection'");
  Unget_Token();

  const mdf::WordScope words(Mdf_Words, mdf::WORDS_REFLECTION);
  std::string last;
  double number;

  Parse_Begin();
  material.reflects = true;
  material.samples = 0;
  material.clamp = 0.0;
  while (Next_Mdf_Word(mdf::WORDS_REFLECTION, last)) {
    if (Token.Function_Id == mdf::REFLECTION_SAMPLES) {
      Parse_Mdf_Numbers("reflection samples", 1, &number);
      const double taken = floor(std::min(std::max(number, 1.0), 4096.0));
      if (taken != number)
        Warn_Mdf_Number("reflection samples", number, taken);
      material.samples = (int)taken;
    } else {
      Parse_Mdf_Numbers("reflection clamp", 1, &material.clamp);
      if (material.clamp < 0.0) {
        Warn_Mdf_Number("reflection clamp", material.clamp, 0.0);
        material.clamp = 0.0;
      }
    }
  }
  Parse_End();
}

namespace {

// A direction of unit length. False if the vector has none.
bool direction_of(double v[3]) {
  double largest = 0.0;

  for (int c = 0; c < 3; c++) {
    if (!std::isfinite(v[c]))
      return false;
    largest = std::max(largest, fabs(v[c]));
  }
  if (!(largest > EPSILON))
    return false;
  for (int c = 0; c < 3; c++)
    v[c] /= largest; // its square is then no number too large
  const double length = Vector3d(v).length();
  for (int c = 0; c < 3; c++)
    v[c] /= length;
  return true;
}

} // namespace

void Parser::Parse_Mdf_Tangent(mdf::Material &material) {
  {
    const mdf::WordScope words(Mdf_Words, mdf::WORDS_TANGENT);
    Get_Token();
  }
  const bool radial = Token.Token_Id == MDF_WORD_TOKEN && Token.Function_Id == mdf::TANGENT_AROUND;
  if (Token.Token_Id == MDF_WORD_TOKEN && !radial) {
    material.tangent = mdf::Material::TANGENT_FROM_UV;
    return;
  }
  if (!radial) {
    if (Token.Token_Id == IDENTIFIER_TOKEN || Token.Token_Id == RIGHT_CURLY_TOKEN ||
        Token.Token_Id == STRING_LITERAL_TOKEN)
      Expect_Mdf_Word(mdf::WORDS_TANGENT, "a vector");
    Unget_Token();
  }

  bool at = false;
  {
    // an expression reads one token ahead, which may be `at`
    const mdf::WordScope words(Mdf_Words, radial ? mdf::WORDS_RADIAL : mdf::WORDS_BLOCK);
    if (radial)
      Need_Mdf_Operand("an axis after 'tangent radial', as in tangent radial y");
    const mdf::NoteScope due(Mdf_Due, radial ? "tangent radial needs a vector, as y or <0, 1, 0>"
                                             : "tangent needs uv, radial or a vector, as x");
    Parse_Vector(material.axis);
    if (radial) {
      Get_Token();
      at = Token.Token_Id == MDF_WORD_TOKEN && Token.Function_Id == mdf::BLOCK_AT;
      if (!at)
        Unget_Token();
    }
  }
  const Vector3d written(material.axis);
  if (!direction_of(material.axis))
    Error("mdf: tangent <%g, %g, %g> has no direction.", written[X], written[Y], written[Z]);
  material.tangent = radial ? mdf::Material::TANGENT_RADIAL : mdf::Material::TANGENT_AXIS;

  Assign_Vector(material.centre, *Vector3d(0.0));
  if (at) {
    Need_Mdf_Operand("a point after 'at'");
    const mdf::NoteScope due(Mdf_Due, "at needs a point, as <0, 1, 0>");
    Parse_Vector(material.centre);
  }
  for (int c = 0; c < 3; c++)
    if (!std::isfinite(material.centre[c]))
      Error("mdf: tangent radial's point is not finite.");
}

void Parser::Parse_Mdf_Choice(mdf::Material &material, shade_list list) {
  const mdf::WordSet choices = mdf::words_of_list(list);
  {
    const mdf::WordScope words(Mdf_Words, choices);
    Get_Token();
  }
  if (Token.Token_Id != MDF_WORD_TOKEN)
    Expect_Mdf_Word(choices, "");

  const int value = Token.Function_Id;
  shade_params_set_choice(&material.params, list, value);
  material.stated |= 1u << list;
  Parse_Mdf_Rows(material, list, value);
}

// The version of the defaults that the scene asks for; 0 if it does not. An include file's or a
// macro's own (#local) holds for what stands there.
int Parser::Mdf_Defaults() {
  const SYM_ENTRY *said = NULL;

  for (int table = Table_Index; said == NULL && table > 0; table--)
    said = Find_Symbol(table, "mdf_Defaults");
  if (said == NULL)
    return 0;
  const double version =
      said->Token_Number == FLOAT_ID_TOKEN ? *reinterpret_cast<const DBL *>(said->Data) : -1.0;
  if (!(version >= 0.0 && version <= SHADE_DEFAULTS && version == std::floor(version)))
    Error("mdf: mdf_Defaults is the version of a block's defaults, 0 to %d.", SHADE_DEFAULTS);
  return (int)version;
}

namespace {

// The choice that shades: what brdf auto stands for, and others as they are.
int shaded_with(const shade_params &p, shade_list list) {
  return list == SHADE_LIST_BRDF ? (int)shade_params_brdf(&p) : shade_params_get_choice(&p, list);
}

} // namespace

// Choices that no block has made (stated: of Material), and whose default has changed, become the
// default of the scene's version. The first block that newer ones would change is told of.
void Parser::Fill_Mdf_Defaults(shade_params &params, unsigned int stated, const std::string &name) {
  const int version = Mdf_Defaults();
  std::string differ;

  for (int i = 0; i < SHADE_LIST_COUNT; i++) {
    const shade_list list = (shade_list)i;
    const int newest = shade_list_default(list, SHADE_DEFAULTS);
    bool changed = false;
    for (int v = 0; v < SHADE_DEFAULTS; v++)
      changed = changed || shade_list_default(list, v) != newest;
    if (!changed || (stated >> i & 1))
      continue;
    shade_params newer = params;
    shade_params_set_choice(&newer, list, newest);
    shade_params_set_choice(&params, list, shade_list_default(list, version));
    const int here = shaded_with(params, list), there = shaded_with(newer, list);
    if (here != there)
      differ += std::string(differ.empty() ? "" : ", ") + shade_list_name(list) + " is " +
                shade_list_word(list, here) + ", not " + shade_list_word(list, there);
  }
  if (!differ.empty() && sceneData->mdfScene->first_warning("mdf_Defaults"))
    Warning(0,
            "mdf: the defaults of version %d hold (%s: %s); newer scenes say #declare "
            "mdf_Defaults = %d;",
            version, name.c_str(), differ.c_str(), SHADE_DEFAULTS);
}

void Parser::Parse_Mdf(FINISH *finish) {
  mdf::Material material;
  std::vector<std::string> of_metal; // the words of this block that only metals read
  bool coloured = false;             // by `specular`

  Get_Token();
  if (Token.Function_Id == OFF_TOKEN) {
    finish->Mdf = NULL;
    return;
  }
  if (Token.Token_Id != LEFT_CURLY_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, "'{' or 'off' after 'mdf'");
  Unget_Token();

  if (finish->Mdf != NULL) // of the finish that this one began with
    material = *finish->Mdf;
  material.name = UCS2toASCIIString(Token.FileHandle->name()) + ":" +
                  std::to_string(Token.Token_File_Pos.lineno);

  Parse_Begin();
  {
    const mdf::WordScope words(Mdf_Words, mdf::WORDS_BLOCK);
    std::string last;
    int word;

    while (Next_Mdf_Word(mdf::WORDS_BLOCK, last)) {
      word = Token.Function_Id;
      if (mdf::is_of_metal(word) &&
          std::find(of_metal.begin(), of_metal.end(), last) == of_metal.end())
        of_metal.push_back(last);
      coloured = coloured || last == "specular";
      if (word == mdf::BLOCK_TANGENT) {
        Parse_Mdf_Tangent(material);
        MIdentity(finish->Mdf_Space); // it counts from here
        MIdentity(finish->Mdf_Plane);
      } else if (word == mdf::BLOCK_ROUGHNESS)
        Parse_Mdf_Roughness(material);
      else if (word == mdf::BLOCK_BUMP_IMAGE)
        Parse_Mdf_Bump_Image(material);
      else if (word == mdf::BLOCK_REFLECTION)
        Parse_Mdf_Reflection(material);
      else if (word == mdf::BLOCK_PRESET)
        Parse_Mdf_Preset(material);
      else if (word == mdf::BLOCK_FABRIC)
        Parse_Mdf_Fabric(material);
      else if (word == mdf::BLOCK_SCRATCHES)
        Parse_Mdf_Scratches(material);
      else if (word == mdf::BLOCK_SLOPES)
        Parse_Mdf_Slopes(material);
      else if (word == mdf::BLOCK_NOTES)
        material.notes = Parse_Mdf_Switch("notes");
      else if (word >= mdf::BLOCK_ROW)
        Parse_Mdf_Row(material, word - mdf::BLOCK_ROW, mdf::word_of_row(word - mdf::BLOCK_ROW));
      else if (word >= mdf::BLOCK_LIST)
        Parse_Mdf_Choice(material, (shade_list)(word - mdf::BLOCK_LIST));
      else { // a distribution
        shade_params_set_choice(&material.params, SHADE_LIST_MDF, word);
        Parse_Mdf_Rows(material, SHADE_LIST_MDF, word);
      }
    }
  }
  Parse_End();
  Fill_Mdf_Defaults(material.params, material.cloth ? ~0u : material.stated, material.name);
  if (material.cloth && !of_metal.empty())
    Warn_Mdf(mdf::quoted(of_metal) + " (" + material.name + ") " +
             (of_metal.size() > 1 ? "have" : "has") +
             " no part in a cloth; what its yarns are is said inside fabric { }.");

  if (coloured && !material.cloth && material.params.fresnel == SHADE_FRESNEL_CONDUCTOR)
    Warn_Mdf("'specular' (" + material.name +
             ") has no part in a conductor, which has a colour of its own; 'specular' after that, "
             "in a scene with #declare mdf_Defaults = 1;, gives it another.");
  const shade_params &p = material.params;
  if (p.multiscatter == SHADE_MULTISCATTER_ON && !material.cloth &&
      (shade_params_brdf(&p) != SHADE_BRDF_MICROFACET ||
       (p.mdf != SHADE_MDF_GGX && p.mdf != SHADE_MDF_BECKMANN)))
    Warn_Mdf("'multiscatter on' (" + material.name +
             ") changes nothing: only ggx and beckmann with brdf microfacet have it.");
  if (material.told_slopes && p.horizon != SHADE_HORIZON_MUTUAL && !material.cloth)
    Warn_Mdf("'slopes' (" + material.name + ") changes nothing: 'horizon mutual' alone reads it.");

  char wrong[160];
  if (sceneData->mdfScene->empty() && shade_isa_check(wrong, sizeof wrong) != 0) // once
    Warning(0, "mdf: %s.", wrong);
  finish->Mdf = sceneData->mdfScene->add(material);
}

void Parser::Post_Process_Mdf(ObjectPtr object) {
  MdfBlocks blocks;
  mdf::Scene &scene = *sceneData->mdfScene;
  const Mesh *mesh = dynamic_cast<const Mesh *>(object);

  if (object->Type & LIGHT_SOURCE_OBJECT) {
    const LightSource *lamp = static_cast<const LightSource *>(object);
    if (!lamp->children.empty() && lamp->Light_Type != FILL_LIGHT_SOURCE)
      Mark_Mdf_Lamp(lamp->children[0]);
  }
  if (scene.empty() || (object->Type & IS_COMPOUND_OBJECT)) // its children come on their own
    return;
  if (mesh == NULL) { // whatever its textures: it may show those of others (cutaway_textures)
    const mdf::Shape::Kind kind = mdf_kind(object);
    std::shared_ptr<const mdf::Shape> &shape = scene.shapes[kind];
    if (!shape)
      shape.reset(new mdf::Shape(kind));
    object->Mdf_Shape = shape.get();
  }

  Collect_Mdf_Blocks(object, false, blocks);
  if (blocks.empty())
    return;
  for (MdfBlocks::const_iterator i = blocks.begin(); i != blocks.end(); ++i) {
    scene.use((*i)->Mdf);
    if ((*i)->UseSubsurface && sceneData->useSubsurface && (*i)->RawDiffuse <= 0.0)
      Error(
          "mdf: the finish of the block at %s has 'subsurface' and 'diffuse 0': what is scattered "
          "below the surface is the finish's diffuse light. Let it have some, as in 'diffuse .6', "
          "or leave 'subsurface' out.",
          (*i)->Mdf->name.c_str());
    if ((*i)->Mdf->preset && !is_light_linear(*sceneData))
      Warn_Mdf(
          "colours of presets are made for assumed_gamma 1.0; by this scene's gamma they come out "
          "darker.");
    if (!(*i)->Mdf->notes)
      continue;
    const std::string notes = Mdf_Notes(*i);
    if (scene.first_warning(notes)) // once, as warnings
      Debug_Info("%s", notes.c_str());
  }
  static const char *const laid =
      " on an object without UV coordinates: it lies along two of the object's axes.";

  if (mesh != NULL) {
    if (scene.meshes.find(mesh->Data) == scene.meshes.end()) {
      const long without = mdf_add_mesh(mesh, scene);
      if (without > 0 && without < 3 * mesh->Data->Number_Of_Triangles)
        Warning(0,
                "mdf: %ld of the %ld corners of a mesh have no UV area around them; their "
                "tangents are arbitrary.",
                without, 3 * mesh->Data->Number_Of_Triangles);
    }
    object->Mdf_Shape = scene.meshes[mesh->Data].get();
  }
  if (object->Mdf_Shape->has_uv())
    return;

  std::string kind = " on an object without UV coordinates: ", direction = "along its x axis";
  if (mesh != NULL)
    kind = " on a mesh without UV coordinates: ";
  if (object->Mdf_Shape->kind == mdf::Shape::CONE) {
    kind = " on a cone or cylinder, which has no UV coordinates: ";
    direction = "around its axis";
  } else if (object->Mdf_Shape->kind == mdf::Shape::PLANE) {
    kind = " on a plane or disc, which has no UV coordinates: ";
    direction = "along its x axis, or z where it faces x";
  }
  for (MdfBlocks::const_iterator i = blocks.begin(); i != blocks.end(); ++i) {
    const mdf::Material *block = (*i)->Mdf;
    if (block->tangent == mdf::Material::TANGENT_FROM_UV)
      Warn_Mdf("'tangent uv' (" + block->name + ")" + kind + "strokes run " + direction + ".");
    const bool turned = !block->cloth && block->tangent == mdf::Material::TANGENT_RADIAL;
    if ((block->cloth || block->scratches) && !turned &&
        object->Mdf_Shape->kind == mdf::Shape::OTHER)
      Warn_Mdf((block->cloth ? "'fabric' (" : "'scratches' (") + block->name + ")" + laid);
    if (block->bump)
      Warn_Mdf("'bump_image' (" + block->name + ")" + kind + "it has no effect there.");
  }
}

} // namespace pov
