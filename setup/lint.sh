#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Layout of C and C++ as .clang-format says, in every text file the licence of its folder, and
# the sources that the code cites, such as [Schlick1994], in REFERENCES.bib.
set -euo pipefail
cd "$(dirname "$0")/.."

find_files() {
  find . \( -path ./build -o -path ./.git -o -path ./LICENSES -o -name __pycache__ -o -name ".*_cache" \) -prune \
    -o -type f "$@" -print
}

wrong=0 layout=
mapfile -t c_files < <(find_files -regex '.*\.\(c\|h\|cpp\)')
# layouts of other versions differ. One program over all: it takes longer to start than to read a file
if [[ $(clang-format --version) != *' version 14.'* ]]; then
  layout=", layout not asked: clang-format is not 14"
elif ! clang-format --dry-run --Werror --ferror-limit=1 "${c_files[@]}" 2>/dev/null; then
  for file in "${c_files[@]}"; do
    clang-format "$file" | cmp -s - "$file" || {
      echo "$file: not laid out as .clang-format says; mend with: clang-format -i $file" >&2
      wrong=1
    }
  done
fi

# each header of a model and of a batch compiles alone, in either precision; what footprints hold is in double
for single in 0 1; do
  alone=()
  for header in libshade/{model,batch}/*.h; do
    [[ $header == */column_streak.h || ($single = 1 && $header == */column_@(yarns|near).h) ]] || alone+=("$header")
  done
  gcc -std=c11 -Wall -Wextra -Werror -Wno-unknown-pragmas -Wno-unused-function -DSHADE_FLOAT=$single \
    -Ilibshade/include -xc -fsyntax-only "${alone[@]}" || wrong=1
done

# formats that hold no comments, and what fuzzers found
# REUSE-IgnoreStart
mapfile -t texts < <(find_files | grep -Ev '\.(json|blend|png|jpg|exr|svg|patch)$|/series$|/UPSTREAM$|/fuzz/corpus/')
while IFS= read -r unlicensed; do
  echo "$unlicensed at its top" >&2
  wrong=1
done < <(awk '
  function licence(file) {
    return file ~ /^\.\/blender_addon_c\// ? "GPL-3.0-or-later" : file ~ /^\.\/povray_patches\// ? "AGPL-3.0-or-later" : "Apache-2.0"
  }
  FNR <= 8 {
    wanted = licence(FILENAME)
    if (index($0 " ", "SPDX-License-Identifier: " wanted " ") || index($0, "SPDX:" wanted "\""))
      found[FILENAME] = 1
  }
  END {
    for (i = 1; i < ARGC; i++)
      if (!(ARGV[i] in found))
        print ARGV[i] ": no line \047SPDX-License-Identifier: " licence(ARGV[i]) "\047"
  }' "${texts[@]}")
# REUSE-IgnoreEnd

while IFS=: read -r file line citation; do
  grep -q "{${citation#[}," REFERENCES.bib || {
    echo "$file:$line: ${citation#[} is not a key of REFERENCES.bib" >&2
    wrong=1
  }
done < <(grep -noE '\[[A-Z][A-Za-z]+ ?(19|20)[0-9]{2}' "${c_files[@]}")

[ $wrong = 0 ] && echo "lint: ${#c_files[@]} C and C++ files, licences, citations: clean$layout"
exit $wrong
