// SPDX-License-Identifier: AGPL-3.0-or-later
// The words of an `mdf { }` block, made from libshade's table of names.
#ifndef POVRAY_BACKEND_MDF_WORDS_H
#define POVRAY_BACKEND_MDF_WORDS_H

#include <string>
#include <vector>

#include "shade/fabric.h"
#include "shade/presets.h"

namespace mdf {

// Which words the tokenizer takes for itself. Every place has its own small
// set, so that `x` after `groove` is a choice and after `tangent` a vector.
enum WordSet {
  WORDS_NONE,       // outside mdf { }, and inside # directives
  WORDS_BLOCK,      // where a statement may begin
  WORDS_TANGENT,    // after `tangent`
  WORDS_RADIAL,     // after `tangent radial`: those of the block, and `at`
  WORDS_IMAGE,      // inside bump_image { }
  WORDS_REFLECTION, // inside reflection { }
  WORDS_FABRIC,     // inside fabric { }
  WORDS_YARN,       // inside warp { } and weft { }
  WORDS_OCCLUSION,  // after `occlusion`
  WORDS_SCRATCHES,  // inside scratches { }
  WORDS_LAYER,      // inside scratches { layer { } }
  WORDS_LIST        // and on, words_of_list(): after the name of a list of the table
};

// Identities of the words of WORDS_BLOCK beyond the distributions, whose
// identity is their shade_mdf value.
enum BlockWord {
  BLOCK_LIST = 1000, // BLOCK_LIST + a shade_list: `detail`, `groove`, …
  BLOCK_ROW = 2000,  // BLOCK_ROW + a row of the table that every choice reads: `specular`
  BLOCK_TANGENT = 3000,
  BLOCK_ROUGHNESS,
  BLOCK_BUMP_IMAGE,
  BLOCK_REFLECTION,
  BLOCK_PRESET,
  BLOCK_FABRIC,
  BLOCK_SCRATCHES,
  BLOCK_NOTES,
  BLOCK_SLOPES,
  BLOCK_AT // of WORDS_RADIAL
};

// Of WORDS_FABRIC and WORDS_YARN beyond the distributions and lists, which are numbered as in a
// block: BLOCK_ROW + a row of shade_fabric_number or shade_yarn_param_row.
enum FabricWord {
  FABRIC_PRESET = BLOCK_TANGENT,
  FABRIC_WEAVE,
  FABRIC_DRAFT,
  FABRIC_CROSSINGS,
  FABRIC_MM_PER_UNIT,
  FABRIC_ENDS_PER_CM,
  FABRIC_PICKS_PER_CM,
  FABRIC_WARP,
  FABRIC_WEFT,
  FABRIC_YARNS,
  FABRIC_OCCLUSION,
  FABRIC_SEED,
  FABRIC_DRAFT_COLORS,
  FABRIC_SHADOWS,
  FABRIC_MIRRORED,
  YARN_TRANSMIT,
  YARN_MATERIAL = BLOCK_TANGENT + 1000 // + a row of shade_fabric_yarn_number
};

enum TangentWord { TANGENT_UV, TANGENT_AROUND };
enum ImageWord {
  IMAGE_PNG,
  IMAGE_EXR,
  IMAGE_STRENGTH,
  IMAGE_SCALE,
  IMAGE_TRANSLATE,
  IMAGE_FILTER,
  IMAGE_ONCE
};
enum ReflectionWord { REFLECTION_SAMPLES, REFLECTION_CLAMP };

enum ScratchWord {
  SCRATCH_PRESET,
  SCRATCH_TILE_MM,
  SCRATCH_MM_PER_UNIT,
  SCRATCH_SEED,
  SCRATCH_LAYER
};
enum LayerWord {
  LAYER_PITS,
  LAYER_RADIUS,
  LAYER_STRETCH,
  LAYER_DEPTH,
  LAYER_DIRECTION,
  LAYER_SPREAD
};

inline WordSet words_of_list(shade_list list) {
  return (WordSet)((int)WORDS_LIST + (int)list);
}

// The rows of the table's numbers that this choice of a list reads.
std::vector<int> rows_of_choice(shade_list list, int value);

// Whether a word of WORDS_BLOCK has no part in a cloth.
bool is_of_metal(int word);

// What messages call a row that follows a choice: "alpha along", "fresnel conductor's k".
std::string name_of_row(int row, shade_list list, int value);

// What a block calls a row that every choice reads.
const char *word_of_row(int row);

// What warp { } calls a row of shade_fabric_yarn_number.
const char *word_of_yarn(int row);

// The words of a set, in the order that messages have.
std::vector<std::string> words_in(WordSet set);

// The identity of `text` in `set`, or -1. Exact spelling: a scene may have a
// `Detail` of its own.
int find_word(WordSet set, const char *text);

// "detail, fresnel or }": what a parse error says was expected. `last` may be empty.
std::string expected_words(WordSet set, const std::string &last);

// The word of `set`, or of these, that `text` was probably meant to be, or "".
std::string nearest_word(WordSet set, const std::string &text);
std::string nearest_of(const std::vector<std::string> &words, const std::string &text);
// " Did you mean \"word\"?" of a name in quotes, or "".
std::string nearest_name(const std::vector<std::string> &names, const std::string &text);

// POV-Ray's own name of a token, as an author has it: a comma, a number, a text in quotes.
std::string plain_token(const std::string &name);

// What to do about something found in place of a word of `set`: where it belongs, if it is a word
// of another place or of POV-Ray's, or how a list is said. after: the word of the set before it, or
// "". "" where there is nothing to tell.
std::string hint_for(WordSet set, const std::string &text, const std::string &after);
// The same for a word that only one of another place is like: "did you mean …, which …", or "".
std::string hint_for_misspelt(WordSet set, const std::string &text);
// The same for something found outside of a block.
std::string hint_outside(const std::string &text);

// "'ggx', 'specular' and 'tangent'".
std::string quoted(const std::vector<std::string> &words);

// A number as messages have it.
std::string text_of(double number);

// Sets a word set and puts the old one back at the end of the scope.
class WordScope {
public:
  WordScope(WordSet &current, WordSet inside) : outside(current), set(current) { set = inside; }
  ~WordScope() { set = outside; }

  const WordSet outside;

private:
  WordSet &set;

  WordScope(const WordScope &);
  WordScope &operator=(const WordScope &);
};

// Says what a word of the block is due while POV-Ray's own parser reads it, for that one's errors.
class NoteScope {
public:
  NoteScope(std::string &current, const std::string &inside) : outside(current), note(current) {
    note = inside;
  }
  ~NoteScope() { note = outside; }

private:
  const std::string outside;
  std::string &note;

  NoteScope(const NoteScope &);
  NoteScope &operator=(const NoteScope &);
};

} // namespace mdf

#endif
