// SPDX-License-Identifier: AGPL-3.0-or-later
// Prints the words of an mdf block for editors: from the tables that the parser reads.
#include <cstdio>
#include <cstring>
#include <set>
#include <string>
#include <vector>

#include "backend/mdf/words.h"

namespace {

struct Place {
  std::string name;
  mdf::WordSet set;
};

std::vector<Place> places() {
  std::vector<Place> all = {{"mdf", mdf::WORDS_BLOCK},
                            {"tangent", mdf::WORDS_TANGENT},
                            {"tangent", mdf::WORDS_RADIAL},
                            {"bump_image", mdf::WORDS_IMAGE},
                            {"reflection", mdf::WORDS_REFLECTION},
                            {"fabric", mdf::WORDS_FABRIC},
                            {"warp", mdf::WORDS_YARN},
                            {"occlusion", mdf::WORDS_OCCLUSION},
                            {"scratches", mdf::WORDS_SCRATCHES},
                            {"layer", mdf::WORDS_LAYER}};

  for (int list = 0; list < SHADE_LIST_COUNT; list++)
    if (list != SHADE_LIST_MDF) // its words are the block's own
      all.push_back({shade_list_name((shade_list)list), mdf::words_of_list((shade_list)list)});
  return all;
}

} // namespace

int main(int argc, char **argv) {
  const bool vim = argc == 2 && std::strcmp(argv[1], "vim") == 0;

  if (!vim && !(argc == 2 && std::strcmp(argv[1], "text") == 0)) {
    std::fprintf(stderr, "usage: words text | vim\n\n"
                         "text  lines of `place word`: where a word stands, and the word\n"
                         "vim   after/syntax/pov.vim, which adds the words to vim's own\n");
    return 2;
  }
  std::set<std::string> words;
  const std::vector<Place> all = places();
  if (!vim)
    std::printf("finish mdf\n");
  for (size_t i = 0; i < all.size(); i++) {
    const std::vector<std::string> here = mdf::words_in(all[i].set);
    const bool radial = all[i].set == mdf::WORDS_RADIAL; // the block's, and `at`
    for (size_t w = radial ? here.size() - 1 : 0; w < here.size(); w++) {
      words.insert(here[w]);
      if (!vim)
        std::printf("%s %s\n", all[i].name.c_str(), here[w].c_str());
    }
  }
  if (vim) {
    std::printf("\" The words of POV-Ray's mdf blocks. Copy to ~/.vim/after/syntax/pov.vim.\n"
                "syn keyword povMdf mdf\n");
    for (std::set<std::string>::const_iterator w = words.begin(); w != words.end(); ++w)
      std::printf("syn keyword povMdf %s\n", w->c_str());
    std::printf("hi def link povMdf Statement\n");
  }
  return 0;
}
