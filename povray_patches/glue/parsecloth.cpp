// SPDX-License-Identifier: AGPL-3.0-or-later
// Parser's part of `mdf { preset … }` and `mdf { fabric { … } }`.

// frame.h must always be the first POV file included (pulls in platform config)
#include "backend/frame.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/fileinputoutput.h"
#include "base/stringutilities.h"
#include "backend/mdf/material.h"
#include "backend/mdf/words.h"
#include "backend/parser/parse.h"
#include "backend/scene/scene.h"
#include "backend/support/fileutil.h"

// this must be the last file included
#include "base/povdebug.h"

namespace pov {

// `off` in place of what is in braces after `word`. of_preset: what may stand there, for messages.
bool Parser::Parse_Mdf_Off(const std::string &word, const std::string &of_preset) {
  Get_Token();
  if (Token.Function_Id == OFF_TOKEN)
    return true;
  if (Token.Token_Id != LEFT_CURLY_TOKEN)
    Expect_Mdf_Word(mdf::WORDS_NONE, "'{' or 'off' after '" + word + "', as in " + word +
                                         " { preset \"" + of_preset + "\" }");
  Unget_Token();
  return false;
}

// A name in quotes.
std::string Parser::Parse_Mdf_String(const std::string &what) {
  Get_Mdf_Operand();
  if (Token.Token_Id == MDF_WORD_TOKEN || Token.Token_Id == IDENTIFIER_TOKEN)
    Error("mdf: %s needs a text in quotes, '%s' found instead.", what.c_str(), Token.Token_String);
  if (Token.Token_Id == RIGHT_CURLY_TOKEN || Token.Token_Id == LEFT_CURLY_TOKEN ||
      Token.Token_Id == COMMA_TOKEN || Token.Function_Id == FLOAT_TOKEN)
    Error("mdf: %s needs a text in quotes, %s found instead.", what.c_str(),
          mdf::plain_token(Get_Token_String(Token.Function_Id)).c_str());
  Unget_Token();
  const mdf::NoteScope due(Mdf_Due, what + " needs a text in quotes");
  char *text = Parse_C_String(false);
  const std::string name(text);
  POV_FREE(text);
  return name;
}

namespace {

// "a, b, c" of the presets of a kind.
std::string presets_of(shade_preset_kind kind) {
  std::string all;
  shade_preset preset;

  for (int row = 0; shade_preset_row(row, &preset); row++)
    if (preset.kind == kind)
      all += (all.empty() ? "" : ", ") + std::string(preset.word);
  return all;
}

} // namespace

// A preset by its name in quotes; of any kind, or of one.
void Parser::Parse_Mdf_Preset_Named(bool cloths, bool metals, shade_preset &preset) {
  const std::string name = Parse_Mdf_String("preset");

  if (shade_preset_find(name.c_str(), &preset) &&
      (preset.kind == SHADE_PRESET_FABRIC ? cloths : metals))
    return;
  std::string there;
  std::vector<std::string> names;
  shade_preset of;
  for (int row = 0; shade_preset_row(row, &of); row++)
    if (of.kind == SHADE_PRESET_FABRIC ? cloths : metals)
      names.push_back(of.word);
  there += mdf::nearest_name(names, name);
  if (cloths)
    there += " Cloths: " + presets_of(SHADE_PRESET_FABRIC) + ".";
  if (metals)
    there += " Metals: " + presets_of(SHADE_PRESET_METAL) + ".";
  if (shade_preset_find(name.c_str(), &preset))
    there += " \"" + name + "\" is a " + (preset.kind == SHADE_PRESET_FABRIC ? "cloth" : "metal") +
             ": mdf { preset \"" + name + "\" }.";
  Error("mdf: there is no %s \"%s\".%s",
        cloths && metals ? "preset"
        : cloths         ? "cloth"
                         : "metal",
        name.c_str(), there.c_str());
}

void Parser::Parse_Mdf_Preset(mdf::Material &material) {
  shade_preset preset;

  Parse_Mdf_Preset_Named(true, true, preset);
  material.preset = true;
  if (preset.kind == SHADE_PRESET_FABRIC) {
    const std::shared_ptr<mdf::Cloth> cloth(new mdf::Cloth);
    cloth->take(preset);
    material.cloth = cloth;
    material.scratches.reset(); // of a metal that it was
    return;
  }
  material.cloth.reset();
  material.params = preset.metal;
  material.stated = 0;
  const std::shared_ptr<mdf::Scratches> grain(new mdf::Scratches);
  grain->take(preset);
  if (material.scratches)
    grain->mm_per_unit = material.scratches->mm_per_unit;
  material.scratches = grain;
  material.specular_pigment = material.kd_pigment = false;
}

// A number, or a colour, that is kept at `place`.
void Parser::Parse_Mdf_Number_Of(const std::string &what, const shade_param_info &info,
                                 double *place) {
  double v[3];

  Parse_Mdf_Numbers(what, info.components, v);
  for (int c = 0; c < info.components; c++)
    place[c] = std::min(std::max(v[c], info.minimum), info.maximum);
  Warn_Mdf_Numbers(what, info.components, v, place);
}

// How much, or how many: above 0.
double Parser::Parse_Mdf_Size(const std::string &what) {
  double number;

  Parse_Mdf_Numbers(what, 1, &number);
  const double taken = std::min(std::max(number, 1e-6), 1e6);
  if (taken != number)
    Warn_Mdf_Number(what, number, taken);
  return taken;
}

// `warp { }`, `weft { }` or, both alike, `yarns { }`.
void Parser::Parse_Mdf_Yarns(mdf::Cloth &cloth, bool of_warp, bool of_weft) {
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_YARN);
  shade_yarn_params *const shapes[2] = {&cloth.yarns.warp, &cloth.yarns.weft};
  shade_yarn *const materials[2] = {&cloth.material.warp, &cloth.material.weft};
  double *const transmits[2] = {cloth.material.warp_transmit, cloth.material.weft_transmit};
  const bool wanted[2] = {of_warp, of_weft};
  const int first = of_warp ? 0 : 1;
  const std::string of = of_warp ? (of_weft ? "yarns: " : "warp: ") : "weft: ";
  shade_param_info info;
  std::string last;
  double *place, number[3];
  int word, row;

  Begin_Mdf(of.substr(0, of.size() - 2));
  while (Next_Mdf_Word(mdf::WORDS_YARN, last)) {
    word = Token.Function_Id;
    if (word == mdf::YARN_TRANSMIT) {
      shade_fabric_params other;
      for (row = 0; shade_fabric_number(&other, row, &info) != other.warp_transmit; row++)
        ;
      Parse_Mdf_Number_Of(of + "transmit", info, number);
      for (int i = 0; i < 2; i++)
        if (wanted[i])
          std::copy(number, number + 3, transmits[i]);
    } else if (word >= mdf::YARN_MATERIAL) {
      row = word - mdf::YARN_MATERIAL;
      shade_fabric_yarn_number(materials[first], row, &info);
      Parse_Mdf_Number_Of(of + mdf::word_of_yarn(row), info, number);
      for (int i = 0; i < 2; i++)
        if (wanted[i]) {
          place = shade_fabric_yarn_number(materials[i], row, NULL);
          std::copy(number, number + info.components, place);
        }
    } else if (word >= mdf::BLOCK_ROW) {
      row = word - mdf::BLOCK_ROW;
      shade_yarn_param_row(row, &info);
      Parse_Mdf_Number_Of(of + info.word, info, number);
      for (int i = 0; i < 2; i++)
        if (wanted[i])
          *shade_yarn_param(shapes[i], info.word) = number[0];
    } else
      Parse_Mdf_Yarn_Colour(cloth, of + "diffuse", wanted);
  }
  Parse_End();
}

// `diffuse rgb …`, `diffuse fibre rgb …`, and `pigment` in place of a colour.
void Parser::Parse_Mdf_Yarn_Colour(mdf::Cloth &cloth, const std::string &what,
                                   const bool wanted[2]) {
  shade_yarn *const materials[2] = {&cloth.material.warp, &cloth.material.weft};
  shade_param_info info;
  double colour[3], *place = NULL;
  int model = -1;

  {
    const mdf::WordScope models(Mdf_Words, mdf::words_of_list(SHADE_LIST_DIFFUSE));
    Get_Token();
  }
  if (Token.Token_Id == MDF_WORD_TOKEN)
    model = Token.Function_Id;
  else
    Unget_Token();
  for (int row = 0; place != materials[0]->kd; row++)
    place = shade_fabric_yarn_number(materials[0], row, &info);
  const bool pigment = Parse_Mdf_Pigment();
  if (!pigment)
    Parse_Mdf_Number_Of(what, info, colour);
  for (int i = 0; i < 2; i++) {
    if (!wanted[i])
      continue;
    if (model >= 0)
      materials[i]->diffuse = (shade_diffuse)model;
    cloth.pigment[i] = pigment;
    if (!pigment)
      std::copy(colour, colour + 3, materials[i]->kd);
  }
}

void Parser::Parse_Mdf_Weave(mdf::Cloth &cloth) {
  Get_Mdf_Operand();
  if (Token.Token_Id == STRING_LITERAL_TOKEN || Token.Function_Id == STRING_ID_TOKEN) {
    Unget_Token();
    const std::string name = Parse_Mdf_String("weave");
    const std::shared_ptr<shade_draft> found(shade_draft_named(name.c_str()), shade_draft_free);
    if (!found) {
      std::string all;
      std::vector<std::string> names;
      const char *word;
      for (int row = 0; shade_weave_row(row, &word, NULL, NULL); row++) {
        all += (row > 0 ? ", " : "") + std::string(word);
        names.push_back(word);
      }
      Error("mdf: there is no weave \"%s\"; there are: %s.%s", name.c_str(), all.c_str(),
            mdf::nearest_name(names, name).c_str());
    }
    cloth.weave = name;
    cloth.draft.reset();
    return;
  }
  if (Token.Token_Id == IDENTIFIER_TOKEN || Token.Token_Id == MDF_WORD_TOKEN)
    Error("mdf: weave needs a text in quotes, weave \"%s\", or three numbers.", Token.Token_String);
  Unget_Token();

  int numbers[3];
  for (int i = 0; i < 3; i++) {
    double number;
    if (i > 0)
      Parse_Comma();
    Parse_Mdf_Numbers(i == 0   ? "weave: ends under"
                      : i == 1 ? "weave: ends over"
                               : "weave: shift",
                      1, &number);
    if (number != std::floor(number) || std::fabs(number) > 1e9)
      Error("mdf: weave needs three whole numbers: ends under, ends over, shift; %g is none.",
            number);
    numbers[i] = (int)number;
  }
  const std::shared_ptr<const shade_draft> draft(
      shade_draft_from_pattern(numbers[0], numbers[1], numbers[2]),
      [](const shade_draft *d) { shade_draft_free(const_cast<shade_draft *>(d)); });
  if (!draft)
    Error("mdf: there is no weave %d, %d, %d: ends under (1 at least) and over (0 at least) are %d "
          "together at most.",
          numbers[0], numbers[1], numbers[2], (int)SHADE_PATTERN_MAX);
  cloth.weave.clear();
  cloth.draft = draft;
}

void Parser::Parse_Mdf_Draft(mdf::Cloth &cloth) {
  const size_t MOST_BYTES = (size_t)64 << 20; // far beyond any draft; some files never end
  const std::string name = Parse_Mdf_String("draft");
  UCS2String found;
  const std::unique_ptr<IStream> file(Locate_File(this, sceneData, ASCIItoUCS2String(name.c_str()),
                                                  POV_File_Unknown, found, false));

  if (file.get() == NULL)
    Error("mdf: cannot open the draft '%s'.", name.c_str());
  std::string text; // byte by byte: read() is all or nothing
  char message[512];
  for (int byte = file->Read_Byte(); byte != EOF; byte = file->Read_Byte()) {
    if (text.size() == MOST_BYTES)
      Error("mdf: cannot read the draft '%s': it is longer than %d MiB.", name.c_str(),
            (int)(MOST_BYTES >> 20));
    text += (char)byte;
  }
  const std::shared_ptr<const shade_draft> draft(
      shade_wif_parse(text.data(), text.size(), name.c_str(), message, sizeof message),
      [](const shade_draft *d) { shade_draft_free(const_cast<shade_draft *>(d)); });
  if (!draft)
    Error("mdf: cannot read the draft %s.", message);
  if (message[0] != '\0')
    Warn_Mdf(std::string("draft ") + message + ".");
  cloth.take(draft);
}

void Parser::Parse_Mdf_Crossings(mdf::Cloth &cloth) {
  UV_VECT both;

  Parse_Mdf_UV("crossings", both);
  for (int axis = 0; axis < 2; axis++) {
    if (!std::isfinite(both[axis]))
      Error("mdf: crossings is not a finite number.");
    cloth.crossings[axis] = std::min(std::max(both[axis], 1e-6), 1e6);
    if (cloth.crossings[axis] != both[axis])
      Warn_Mdf_Number("crossings", both[axis], cloth.crossings[axis]);
  }
}

// `fabric { … }`; `fabric off` where a finish that this one began with is cloth.
void Parser::Parse_Mdf_Fabric(mdf::Material &material) {
  if (Parse_Mdf_Off("fabric", "denim")) {
    material.cloth.reset();
    return;
  }
  // of the finish that this one began with
  const std::shared_ptr<mdf::Cloth> cloth(material.cloth ? new mdf::Cloth(*material.cloth)
                                                         : new mdf::Cloth);
  const mdf::WordScope words(Mdf_Words, mdf::WORDS_FABRIC);
  shade_fabric_params &p = cloth->material;
  shade_param_info info;
  shade_preset preset;
  std::string last;
  double number;
  bool draft = false;
  int word;

  Parse_Begin();
  while (Next_Mdf_Word(mdf::WORDS_FABRIC, last)) {
    word = Token.Function_Id;
    switch (word) {
    case mdf::FABRIC_PRESET:
      Parse_Mdf_Preset_Named(true, false, preset);
      cloth->take(preset);
      material.preset = true;
      break;
    case mdf::FABRIC_WEAVE:
      Parse_Mdf_Weave(*cloth);
      break;
    case mdf::FABRIC_DRAFT:
      Parse_Mdf_Draft(*cloth);
      cloth->counted[0] = cloth->counted[1] = false;
      draft = true;
      break;
    case mdf::FABRIC_CROSSINGS:
      Parse_Mdf_Crossings(*cloth);
      break;
    case mdf::FABRIC_MM_PER_UNIT:
      cloth->mm_per_unit = Parse_Mdf_Size("mm_per_unit");
      cloth->crossings[0] = cloth->crossings[1] = 0.0;
      break;
    case mdf::FABRIC_ENDS_PER_CM:
      cloth->per_cm[0] = Parse_Mdf_Size("ends_per_cm");
      cloth->counted[0] = true;
      break;
    case mdf::FABRIC_PICKS_PER_CM:
      cloth->per_cm[1] = Parse_Mdf_Size("picks_per_cm");
      cloth->counted[1] = true;
      break;
    case mdf::FABRIC_WARP:
      Parse_Mdf_Yarns(*cloth, true, false);
      break;
    case mdf::FABRIC_WEFT:
      Parse_Mdf_Yarns(*cloth, false, true);
      break;
    case mdf::FABRIC_YARNS:
      Parse_Mdf_Yarns(*cloth, true, true);
      break;
    case mdf::FABRIC_OCCLUSION: {
      const mdf::WordScope kinds(Mdf_Words, mdf::WORDS_OCCLUSION);
      Get_Token();
      if (Token.Token_Id != MDF_WORD_TOKEN)
        Expect_Mdf_Word(mdf::WORDS_OCCLUSION, "");
      cloth->yarns.occlusion = (shade_occlusion)Token.Function_Id;
      break;
    }
    case mdf::FABRIC_SEED:
      Parse_Mdf_Numbers("seed", 1, &number);
      cloth->yarns.seed = (uint32_t)(int64_t)std::min(std::max(number, -1e15), 1e15);
      break;
    case mdf::FABRIC_DRAFT_COLORS:
      p.draft_colors = Parse_Mdf_Switch("draft_colors");
      break;
    case mdf::FABRIC_MIRRORED:
      cloth->mirrored = Parse_Mdf_Switch("mirrored");
      break;
    case mdf::FABRIC_SHADOWS:
      p.shadows = Parse_Mdf_Switch("shadows");
      break;
    default:
      if (word >= mdf::BLOCK_ROW) {
        double *const place = shade_fabric_number(&p, word - mdf::BLOCK_ROW, &info);
        Parse_Mdf_Number_Of(info.word, info, place);
      } else if (word >= mdf::BLOCK_LIST)
        Parse_Mdf_Cloth_Choice(*cloth, (shade_list)(word - mdf::BLOCK_LIST));
      else
        p.mdf = (shade_mdf)word;
    }
  }
  Parse_End();
  const std::string note = draft && cloth->draft ? cloth->settle() : "";
  if (!note.empty())
    Warn_Mdf(note);
  shade_params choices;
  shade_params_init(&choices);
  choices.mdf = p.mdf;
  choices.brdf = p.brdf;
  choices.detail = p.detail;
  choices.horizon = p.horizon;
  Fill_Mdf_Defaults(choices, cloth->stated, material.name);
  p.brdf = choices.brdf;
  p.detail = choices.detail;
  p.horizon = choices.horizon;
  material.cloth = cloth;
  material.scratches.reset();
}

void Parser::Parse_Mdf_Cloth_Choice(mdf::Cloth &cloth, shade_list list) {
  shade_fabric_params &p = cloth.material;
  const mdf::WordSet choices = mdf::words_of_list(list);
  {
    const mdf::WordScope words(Mdf_Words, choices);
    Get_Token();
  }
  if (Token.Token_Id != MDF_WORD_TOKEN)
    Expect_Mdf_Word(choices, "");
  cloth.stated |= 1u << list;
  if (list == SHADE_LIST_BRDF)
    p.brdf = (shade_brdf)Token.Function_Id;
  else if (list == SHADE_LIST_DETAIL)
    p.detail = (shade_detail)Token.Function_Id;
  else
    p.horizon = (shade_horizon)Token.Function_Id;
}

} // namespace pov
