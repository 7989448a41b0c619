# SPDX-License-Identifier: Apache-2.0
# What a DLL exports: the functions that headers declare with SHADE_API.
#   awk -f exports.awk HEADER...
BEGIN { print "EXPORTS" }
/^SHADE_API/ {
  line = $0
  while (line !~ /[(]/ && (getline more) > 0)
    line = line " " more
  sub(/[(].*/, "", line)
  sub(/.*[ *]/, "", line)
  print "  " line
}
