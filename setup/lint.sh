#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Layout of C and C++ as .clang-format says, in every text file the licence of its folder, and
# the sources that the code cites, such as [Schlick1994], in REFERENCES.bib.
set -euo pipefail
cd "$(dirname "$0")/.."

find_files() {
  find . \( -path ./build -o -path ./.git -o -path ./LICENSES -o -name __pycache__ \) -prune \
    -o -type f "$@" -print
}

wrong=0
mapfile -t c_files < <(find_files -regex '.*\.\(c\|h\|cpp\)')
for file in "${c_files[@]}"; do
  clang-format "$file" | cmp -s - "$file" || {
    echo "$file: not laid out as .clang-format says; mend with: clang-format -i $file" >&2
    wrong=1
  }
done

licence_of() {
  case $1 in
  ./blender_addon_c/*) echo GPL-3.0-or-later ;;
  ./povray_patches/*) echo AGPL-3.0-or-later ;;
  *) echo Apache-2.0 ;;
  esac
}
# formats that hold no comments, and what fuzzers found
while IFS= read -r file; do
  case $file in
  *.json | *.blend | *.png | *.jpg | *.exr | *.svg | *.patch | */series | */UPSTREAM | */fuzz/corpus/*) continue ;;
  esac
  licence=$(licence_of "$file")
  if ! head -n 8 "$file" | grep -Eq "SPDX-License-Identifier: $licence( |$)|SPDX:$licence\""; then
    echo "$file: no line 'SPDX-License-Identifier: $licence' at its top" >&2
    wrong=1
  fi
done < <(find_files)

while IFS=: read -r file line citation; do
  grep -q "{${citation#[}," REFERENCES.bib || {
    echo "$file:$line: ${citation#[} is not a key of REFERENCES.bib" >&2
    wrong=1
  }
done < <(grep -noE '\[[A-Z][A-Za-z]+ ?(19|20)[0-9]{2}' "${c_files[@]}")

[ $wrong = 0 ] && echo "lint: ${#c_files[@]} C and C++ files, licences, citations: clean"
exit $wrong
