// SPDX-License-Identifier: AGPL-3.0-or-later
#include "backend/mdf/words.h"

#include <cstring>
#include <vector>

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

std::vector<Words> make_sets() {
  std::vector<Words> sets((size_t)words_of_list(SHADE_LIST_COUNT));

  add_list(sets[WORDS_BLOCK], SHADE_LIST_MDF);
  for (int list = 0; list < SHADE_LIST_COUNT; list++) {
    if (list != SHADE_LIST_MDF) // a distribution is named without the word `mdf`
      add(sets[WORDS_BLOCK], shade_list_name((shade_list)list), BLOCK_LIST + list);
    add_list(sets[(size_t)words_of_list((shade_list)list)], (shade_list)list);
  }
  add(sets[WORDS_BLOCK], "tangent", BLOCK_TANGENT);
  add(sets[WORDS_BLOCK], "specular", BLOCK_SPECULAR);
  add(sets[WORDS_BLOCK], "bump_image", BLOCK_BUMP_IMAGE);
  add(sets[WORDS_TANGENT], "uv", TANGENT_UV);
  add(sets[WORDS_IMAGE], "png", IMAGE_PNG);
  add(sets[WORDS_IMAGE], "exr", IMAGE_EXR);
  add(sets[WORDS_IMAGE], "strength", IMAGE_STRENGTH);
  return sets;
}

const Words &words_of(WordSet set) {
  static const std::vector<Words> sets(make_sets());
  return sets[set];
}

} // namespace

int find_word(WordSet set, const char *text) {
  const Words &words = words_of(set);

  for (Words::const_iterator i = words.begin(); i != words.end(); ++i)
    if (std::strcmp(i->text, text) == 0)
      return i->identity;
  return -1;
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
