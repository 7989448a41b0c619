#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Puts POV-Ray's own code where it lies without the patches, as far as a processor's cache lines see it.
usage="usage: layout.sh table MAP                        the phases of an unpatched build
       layout.sh script TABLE COMPILER FLAGS …   a linker script that keeps them
       layout.sh check TABLE MAP                 whether a build has them

A phase is where code begins within 64 bytes. The same instructions take up to a fifth more or less time by it:
isosurfaces take 1.00, 1.00, 1.18 and 1.18 where what interprets functions begins at 32 (as unpatched), 16, 0
and 48 (Zen 5). Without a script every object behind ours begins where ours happen to end, so that any
change of ours moves all of POV-Ray.

MAP    the linker's map; build.sh leaves it in OUT/povray.map
TABLE  povray_patches/layout; made anew where UPSTREAM or the compiler changes:
       UNPATCHED=1 build.sh OUT && layout.sh table OUT/povray.map >layout

Exit status: 0, 1 (check: not all are in place; script: the linker has no script that can be changed), 2 wrong usage."

set -euo pipefail
case ${1-} in
  -h|--help) echo "$usage"; exit 0;;
  table) [ $# = 2 ];;
  check) [ $# = 3 ];;
  script) [ $# -ge 3 ];;
  *) false;;
esac || { echo "$usage" >&2; exit 2; }

# Lines "ARCHIVE:OBJECT PHASE" of the first code of each object, and those of functions that are known to mind.
# (mawk reads no hexadecimal numbers, and only the last two digits count.)
begins='
  function phase(hex) { hex = substr(hex, length(hex) - 1)
    return ((index(digits, substr(hex, 1, 1)) - 1) * 16 + index(digits, substr(hex, 2, 1)) - 1) % 64 }
  function place(section, address, size, file) {
    if (section !~ /^\.text/ || section ~ /^\.text\.(unlikely|exit|startup|hot|sorted)/ || size ~ /^0x0+$/) return
    if (!match(file, /lib(vfe|povray)\.a\(.*\)$/)) return
    name = substr(file, RSTART, RLENGTH - 1); sub(/\(/, ":", name)
    if (!(name in seen)) print name, phase(address)
    seen[name] = 1 }
  BEGIN { digits = "0123456789abcdef" }
  /^Linker script and memory map/ { on = 1 }
  !on { next }
  /^ \.text[^ ]*$/ { section = $1; next }
  /^ \.text[^ ]* +0x/ { place($1, $2, $3, $4) }
  section && /^ +0x/ { place(section, $1, $2, $3) }
  { section = "" }
  / pov::POVFPU_RunDefault\(/ { print "pov::POVFPU_RunDefault", phase($1) }'

case $1 in
  table)
    echo "# SPDX-License-Identifier: AGPL-3.0-or-later"
    echo "# Made by layout.sh from Debian's source and compiler: where stock's code begins, modulo 64, in the order of linking."
    awk "$begins" "$2";;
  script)
    table=$2
    shift 2
    # A whole script, the linker's own with a line for each object: no smaller thing can align single ones. What an
    # unpatched build links first comes first: the compiler's start of programs and POV-Ray's displays.
    # (Nothing can be linked from nothing, but the script is told before that.)
    { "$@" -Wl,--verbose -x c++ /dev/null -o /dev/null 2>/dev/null || true; } | awk '
      FNR == NR { if (/^lib/) rows = rows sprintf("    . = ALIGN(64) + %d; *%s(.text .stub .text.* .gnu.linkonce.t.*)\n", $2, $1); next }
      /^=======/ { on = !on; next }
      !on { next }
      /^ *\*\(\.text \.stub \.text\.\*/ { printf "    *crt*.o(.text)\n    *disp_*.o(.text .stub .text.*)\n%s", rows; found = 1 }
      { print }
      END { exit !found }' "$table" -;;
  check)
    awk "$begins" "$3" | awk '
      /^#/ { next }
      FNR == NR { want[$1] = $2; next }
      $1 in want { if ($2 != want[$1]) { print $1 " begins at " $2 " modulo 64 and not at " want[$1]; bad = 1 } delete want[$1] }
      END { for (name in want) { print name " is not there"; bad = 1 } exit bad }' "$2" -;;
esac
