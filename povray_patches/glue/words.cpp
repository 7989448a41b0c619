// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/words.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <vector>

#include "shade/presets.h"

namespace mdf {

namespace {

struct Word {
  const char *text;
  int identity;
};
typedef std::vector<Word> Words;

void add(Words &words, const char *text, int identity) {
  const Word word = {text, identity};
  words.push_back(word);
}

void add_list(Words &words, shade_list list) {
  const char *text;
  int value;

  for (int row = 0; shade_list_row(list, row, &value, &text, NULL, NULL); row++)
    add(words, text, value);
}

// A cloth has the lists of a block but for the grooves, which are its yarns', Fresnel's, and
// what is diffuse, which is said of each yarn.
void add_cloth(std::vector<Words> &sets) {
  Words &fabric = sets[WORDS_FABRIC], &yarn = sets[WORDS_YARN];
  static const shade_list lists[] = {SHADE_LIST_BRDF, SHADE_LIST_DETAIL, SHADE_LIST_HORIZON};
  shade_fabric_params cloth;
  shade_yarn material;
  shade_param_info info;
  const char *text;

  add(fabric, "preset", FABRIC_PRESET);
  add(fabric, "weave", FABRIC_WEAVE);
  add(fabric, "draft", FABRIC_DRAFT);
  add(fabric, "crossings", FABRIC_CROSSINGS);
  add(fabric, "mm_per_unit", FABRIC_MM_PER_UNIT);
  add(fabric, "ends_per_cm", FABRIC_ENDS_PER_CM);
  add(fabric, "picks_per_cm", FABRIC_PICKS_PER_CM);
  add(fabric, "warp", FABRIC_WARP);
  add(fabric, "weft", FABRIC_WEFT);
  add(fabric, "yarns", FABRIC_YARNS);
  add(fabric, "occlusion", FABRIC_OCCLUSION);
  add(fabric, "seed", FABRIC_SEED);
  add(fabric, "draft_colors", FABRIC_DRAFT_COLORS);
  add(fabric, "shadows", FABRIC_SHADOWS);
  add(fabric, "mirrored", FABRIC_MIRRORED);
  for (int row = 0; shade_fabric_number(&cloth, row, &info) != NULL; row++)
    if (std::strstr(info.word, "transmit") == NULL) // said of each yarn
      add(fabric, info.word, BLOCK_ROW + row);
  add_list(fabric, SHADE_LIST_MDF);
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
    add(fabric, shade_list_name(lists[i]), (int)BLOCK_LIST + (int)lists[i]);

  for (int row = 0; shade_yarn_param_row(row, &info); row++)
    add(yarn, info.word, BLOCK_ROW + row);
  for (int row = 0; shade_fabric_yarn_number(&material, row, &info) != NULL; row++)
    if (std::strcmp(info.word, "kd") != 0) // said after `diffuse`
      add(yarn, word_of_yarn(row), YARN_MATERIAL + row);
  add(yarn, shade_list_name(SHADE_LIST_DIFFUSE), (int)BLOCK_LIST + (int)SHADE_LIST_DIFFUSE);
  add(yarn, "transmit", YARN_TRANSMIT);
  for (int row = 0, value; shade_occlusion_row(row, &value, &text, NULL, NULL); row++)
    add(sets[WORDS_OCCLUSION], text, value);
}

std::vector<Words> make_sets() {
  std::vector<Words> sets((size_t)words_of_list(SHADE_LIST_COUNT));

  add_list(sets[WORDS_BLOCK], SHADE_LIST_MDF);
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    if (list != SHADE_LIST_MDF) // a distribution is named without the word `mdf`
      add(sets[WORDS_BLOCK], shade_list_name((shade_list)list), BLOCK_LIST + list);
    add_list(sets[(size_t)words_of_list((shade_list)list)], (shade_list)list);
  }
  add(sets[WORDS_BLOCK], "tangent", BLOCK_TANGENT);
  shade_param_info info;
  for (int row = 0; shade_param_row(row, &info); row++)
    if (info.list == SHADE_LIST_COUNT)
      add(sets[WORDS_BLOCK], word_of_row(row), BLOCK_ROW + row);
  add(sets[WORDS_BLOCK], "roughness", BLOCK_ROUGHNESS);
  add(sets[WORDS_BLOCK], "bump_image", BLOCK_BUMP_IMAGE);
  add(sets[WORDS_BLOCK], "reflection", BLOCK_REFLECTION);
  add(sets[WORDS_BLOCK], "preset", BLOCK_PRESET);
  add(sets[WORDS_BLOCK], "fabric", BLOCK_FABRIC);
  add(sets[WORDS_BLOCK], "scratches", BLOCK_SCRATCHES);
  add(sets[WORDS_BLOCK], "notes", BLOCK_NOTES);
  add(sets[WORDS_BLOCK], "slopes", BLOCK_SLOPES);
  sets[WORDS_RADIAL] = sets[WORDS_BLOCK];
  add(sets[WORDS_RADIAL], "at", BLOCK_AT);
  add(sets[WORDS_TANGENT], "uv", TANGENT_UV);
  add(sets[WORDS_TANGENT], "radial", TANGENT_AROUND);
  add(sets[WORDS_IMAGE], "png", IMAGE_PNG);
  add(sets[WORDS_IMAGE], "exr", IMAGE_EXR);
  add(sets[WORDS_IMAGE], "strength", IMAGE_STRENGTH);
  add(sets[WORDS_IMAGE], "scale", IMAGE_SCALE);
  add(sets[WORDS_IMAGE], "translate", IMAGE_TRANSLATE);
  add(sets[WORDS_IMAGE], "filter", IMAGE_FILTER);
  add(sets[WORDS_IMAGE], "once", IMAGE_ONCE);
  add(sets[WORDS_REFLECTION], "samples", REFLECTION_SAMPLES);
  add(sets[WORDS_REFLECTION], "clamp", REFLECTION_CLAMP);
  add_cloth(sets);
  add(sets[WORDS_SCRATCHES], "preset", SCRATCH_PRESET);
  add(sets[WORDS_SCRATCHES], "tile_mm", SCRATCH_TILE_MM);
  add(sets[WORDS_SCRATCHES], "mm_per_unit", SCRATCH_MM_PER_UNIT);
  add(sets[WORDS_SCRATCHES], "seed", SCRATCH_SEED);
  add(sets[WORDS_SCRATCHES], "layer", SCRATCH_LAYER);
  add(sets[WORDS_LAYER], "pits", LAYER_PITS);
  add(sets[WORDS_LAYER], "radius", LAYER_RADIUS);
  add(sets[WORDS_LAYER], "stretch", LAYER_STRETCH);
  add(sets[WORDS_LAYER], "depth", LAYER_DEPTH);
  add(sets[WORDS_LAYER], "direction", LAYER_DIRECTION);
  add(sets[WORDS_LAYER], "spread", LAYER_SPREAD);
  return sets;
}

const Words &words_of(WordSet set) {
  static const std::vector<Words> sets(make_sets());
  return sets[set];
}

} // namespace

std::vector<int> rows_of_choice(shade_list list, int value) {
  std::vector<int> rows;
  shade_param_info info;

  for (int row = 0; shade_param_row(row, &info); row++)
    if (info.list == list && (info.choices >> value & 1))
      rows.push_back(row);
  return rows;
}

bool is_of_metal(int word) {
  return word != BLOCK_PRESET && word != BLOCK_FABRIC && word != BLOCK_BUMP_IMAGE &&
         word != BLOCK_REFLECTION && word != BLOCK_NOTES;
}

std::string name_of_row(int row, shade_list list, int value) {
  shade_param_info info;
  const std::string name = shade_list_name(list), choice = shade_list_word(list, value);

  shade_param_row(row, &info);
  if (list == SHADE_LIST_MDF)
    return std::string(info.word[0] == 'e' ? "exponent " : "alpha ") +
           (info.word[1] == 'x' ? "along" : "across");
  if (rows_of_choice(list, value).size() > 1)
    return name + " " + choice + "'s " + info.word;
  return choice == info.word ? name + " " + choice : name;
}

const char *word_of_row(int row) {
  shade_param_info info;

  shade_param_row(row, &info);
  return std::strcmp(info.word, "f0") == 0 ? "specular" : info.word; // as elsewhere in a finish
}

const char *word_of_yarn(int row) {
  shade_yarn yarn;
  shade_param_info info;

  shade_fabric_yarn_number(&yarn, row, &info);
  return std::strcmp(info.word, "f0") == 0 ? "specular" : info.word;
}

std::vector<std::string> words_in(WordSet set) {
  const Words &words = words_of(set);
  std::vector<std::string> texts;

  for (size_t i = 0; i < words.size(); i++)
    texts.push_back(words[i].text);
  return texts;
}

int find_word(WordSet set, const char *text) {
  const Words &words = words_of(set);

  for (Words::const_iterator i = words.begin(); i != words.end(); ++i)
    if (std::strcmp(i->text, text) == 0)
      return i->identity;
  return -1;
}

namespace {

char lower(char c) {
  return (c >= 'A' && c <= 'Z') ? (char)(c - 'A' + 'a') : c;
}

// How many letters to insert, leave out, replace, or swap with the next (case does not count).
size_t distance(const std::string &a, const std::string &b) {
  std::vector<std::vector<size_t>> d(a.size() + 1, std::vector<size_t>(b.size() + 1));

  for (size_t i = 0; i <= a.size(); i++)
    for (size_t j = 0; j <= b.size(); j++) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min(std::min(d[i - 1][j], d[i][j - 1]) + 1, d[i - 1][j - 1] + (same ? 0 : 1));
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

} // namespace

std::string nearest_word(WordSet set, const std::string &text) {
  return nearest_of(words_in(set), text);
}

std::string nearest_of(const std::vector<std::string> &words, const std::string &text) {
  // two slips in a word of six letters; the beginning of a word counts as one slip
  size_t least = std::min((text.size() + 1) / 3, (size_t)3) + 1;
  std::string nearest;

  if (text.size() > 40)
    return nearest;
  for (size_t i = 0; i < words.size(); i++) {
    const std::string &word = words[i];
    size_t slips = distance(word, text);
    if (text.size() > 2 && word.compare(0, text.size(), text) == 0)
      slips = 1;
    if (slips < least) {
      least = slips;
      nearest = word;
    }
  }
  return nearest;
}

std::string nearest_name(const std::vector<std::string> &names, const std::string &text) {
  const std::string nearest = nearest_of(names, text);

  return nearest.empty() ? "" : " Did you mean \"" + nearest + "\"?";
}

std::string plain_token(const std::string &name) {
  return name == ", " || name == "," ? "a comma"
         : name == "string literal"  ? "a text in quotes"
         : name == "float constant"  ? "a number"
         : name == "End of File"     ? "the end of the file"
                                     : name;
}

namespace {

// Where the words of a set belong; those of lists follow its name.
std::string place_of(WordSet set) {
  switch (set) {
  case WORDS_BLOCK:
    return "belongs in mdf { } itself";
  case WORDS_FABRIC:
    return "belongs in fabric { }";
  case WORDS_YARN:
    return "belongs in warp { }, weft { } or yarns { } of fabric { }";
  case WORDS_SCRATCHES:
    return "belongs in scratches { }";
  case WORDS_LAYER:
    return "belongs in layer { } of scratches { }";
  case WORDS_IMAGE:
    return "belongs in bump_image { }";
  case WORDS_REFLECTION:
    return "belongs in reflection { }";
  case WORDS_RADIAL:
    return "follows tangent radial <axis>";
  case WORDS_TANGENT:
    return "follows tangent";
  default:
    return set >= WORDS_LIST
               ? std::string("follows ") + shade_list_name((shade_list)(set - (int)WORDS_LIST))
               : "";
  }
}

// POV-Ray's own words that are looked for in a block.
const char *place_of_reserved(const std::string &text) {
  static const char *const places[][2] = {
      {" normal bump_map slope_map ", "stands in the texture, beside finish { }, and moves the "
                                      "block's highlight too"},
      {" pigment texture finish rotate translate scale matrix transform warp turbulence ",
       "stands in the texture, beside finish { }"},
      {" metallic ", "is what a block is without it: the metal's colour follows specular"},
      {" ambient emission phong phong_size brilliance irid conserve_energy crand subsurface ",
       "stands in finish { }, beside mdf { }"},
      {" rgb rgbf rgbt rgbft srgb color colour red green blue ",
       "begins a colour, which follows the word that it is of: specular rgb <.9, .7, .4>"},
      {" exponent exponents nu nv ", "is none of the block's words: two exponents follow "
                                     "ashikhmin_shirley, as in ashikhmin_shirley 200, 10"},
      {" alpha alphas type distribution anisotropy anisotropic mdf ",
       "is none of the block's words: a distribution's name with its numbers stands for itself, as "
       "in ggx .1, .3"},
      {" ior interior ", "stands in the object's interior { }; a metal's index follows fresnel "
                         "conductor"},
  };

  for (size_t i = 0; i < sizeof places / sizeof *places; i++)
    if (std::strstr(places[i][0], (" " + text + " ").c_str()) != NULL)
      return places[i][1];
  return NULL;
}

// All other places, those nearest to `set` first.
std::vector<WordSet> others_than(WordSet set) {
  static const WordSet near[][2] = {{WORDS_FABRIC, WORDS_YARN},
                                    {WORDS_YARN, WORDS_FABRIC},
                                    {WORDS_SCRATCHES, WORDS_LAYER},
                                    {WORDS_LAYER, WORDS_SCRATCHES}};
  static const WordSet far[] = {WORDS_BLOCK,     WORDS_FABRIC, WORDS_YARN,
                                WORDS_SCRATCHES, WORDS_LAYER,  WORDS_REFLECTION,
                                WORDS_IMAGE,     WORDS_RADIAL, WORDS_TANGENT};
  std::vector<WordSet> others, all(far, far + sizeof far / sizeof *far);

  for (size_t i = 0; i < sizeof near / sizeof *near; i++)
    if (near[i][0] == set)
      others.push_back(near[i][1]);
  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    all.push_back(words_of_list((shade_list)list));
  for (size_t i = 0; i < all.size(); i++)
    if (all[i] != set)
      others.push_back(all[i]);
  return others;
}

// Where a word belongs that was found in place of one of `set`: in this other one, and in another
// if both are as near.
std::string place_from(WordSet set, WordSet other, const std::string &word) {
  const bool also =
      other == WORDS_FABRIC && set != WORDS_YARN && find_word(WORDS_SCRATCHES, word.c_str()) >= 0;

  return place_of(other) + (also ? " or scratches { }" : "");
}

// "'crimp' belongs in warp { } …", of a word of another place, or "".
std::string belongs(WordSet set, const std::string &text) {
  const std::vector<WordSet> others = others_than(set);

  for (size_t i = 0; i < others.size(); i++)
    if (find_word(others[i], text.c_str()) >= 0)
      return "'" + text + "' " + place_from(set, others[i], text);
  return "";
}

} // namespace

std::string hint_for(WordSet set, const std::string &text, const std::string &after) {
  if (set == words_of_list(SHADE_LIST_DIFFUSE))
    return "a block's diffuse part is a model and a colour, as in diffuse lambert rgb .3; "
           "POV-Ray's "
           "own diffuse stands in finish { }, beside mdf { }";
  if (set == words_of_list(SHADE_LIST_FRESNEL))
    return "as in fresnel schlick";
  if (set >= WORDS_LIST || text.empty())
    return belongs(set, text);
  shade_preset preset;
  if ((set == WORDS_BLOCK || set == WORDS_FABRIC || set == WORDS_SCRATCHES) &&
      shade_preset_find(text.c_str(), &preset))
    return "a preset's name stands in quotes after preset: preset \"" + text + "\"";
  if (text == "string literal")
    return set == WORDS_IMAGE ? "a file's name follows png or exr"
           : set == WORDS_BLOCK || set == WORDS_FABRIC || set == WORDS_SCRATCHES
               ? "a preset's name follows preset"
               : "";
  if (text == "finish identifier" || text == "texture identifier")
    return "what a finish begins with stands before its block: finish { NAME mdf { } }";
  if (set == WORDS_IMAGE &&
      std::strstr(" jpeg tiff gif tga iff ppm pgm sys hdr ", (" " + text + " ").c_str()) != NULL)
    return "a picture of another format is to be converted first";
  // numbers, vectors, colours, commas and braces
  static const char *const more[] = {"float ", "vector ", "color identifier", "<", "{", ","};
  for (size_t i = 0; !after.empty() && i < sizeof more / sizeof *more; i++)
    if (text.compare(0, std::strlen(more[i]), more[i]) == 0)
      return "'" + after + "' takes " +
             (text == "{" ? "no braces" : "no more than what stands before that");
  const char *const reserved = place_of_reserved(text);
  if (reserved != NULL && !(set == WORDS_BLOCK && text == "warp"))
    return "'" + text + "' " + reserved;
  return belongs(set, text);
}

std::string hint_for_misspelt(WordSet set, const std::string &text) {
  const std::vector<WordSet> others = others_than(set);
  size_t least = text.size();
  std::string hint;

  for (size_t i = 0; i < others.size(); i++) {
    const std::string nearest = nearest_word(others[i], text);
    const size_t slips = distance(nearest, text);
    if (!nearest.empty() && slips < least) {
      least = slips;
      hint = "did you mean '" + nearest + "', which " + place_from(set, others[i], nearest) + "?";
    }
  }
  return hint;
}

std::string hint_outside(const std::string &text) {
  if (text == "mdf")
    return "'mdf' stands in finish { }.";
  if (!nearest_of(std::vector<std::string>(1, "mdf"), text).empty())
    return "did you mean 'mdf'?";
  for (int set = WORDS_BLOCK; set < WORDS_LIST; set++)
    if (set != WORDS_RADIAL && find_word((WordSet)set, text.c_str()) >= 0)
      return "a word of that name stands in mdf { } of a finish.";
  return "";
}

std::string quoted(const std::vector<std::string> &words) {
  std::string text;

  for (size_t i = 0; i < words.size(); i++)
    text += (i == 0 ? "'" : i + 1 < words.size() ? ", '" : " and '") + words[i] + "'";
  return text;
}

std::string text_of(double number) {
  char text[40];

  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

std::string expected_words(WordSet set, const std::string &last) {
  const Words &words = words_of(set);
  const size_t count = words.size() + (last.empty() ? 0 : 1);
  std::string text;

  for (size_t i = 0; i < count; i++) {
    if (i > 0)
      text += (i + 1 == count) ? " or " : ", ";
    text += (i < words.size()) ? words[i].text : last;
  }
  return text;
}

} // namespace mdf
