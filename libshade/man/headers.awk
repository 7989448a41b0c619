# SPDX-License-Identifier: Apache-2.0
# The comments of the public headers as sections of a manual page: awk -f headers.awk table.h HEADER...
function plain(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  sub(/^[.']/, "\\\\\\&&", text)
  return text
}
function said(text) {
  gsub(/`/, "", text)
  if (text != "")
    print plain(text)
}
# what the comment is of, and choices that come from the table
function code(i, line, list) {
  print ".PP\n.EX"
  for (i = 1; i <= declarations; i++) {
    line = declaration[i]
    if (!sub(/^SHADE_API /, "", line) && whole ~ /^SHADE_API/)
      sub(/^          /, "", line)
    print plain(line)
  }
  print ".EE"
  if (match(whole, /SHADE_TABLE_[A-Z_]+[(]SHADE_[A-Z]+_ROW_/)) {
    list = substr(whole, RSTART + 12, RLENGTH - 12)
    sub(/[(].*/, "", list)
    print ".PP\nChoices: " plain(substr(choices[list], 3)) "."
  }
}
function text(i, line, fields, words) {
  for (i = 1; i <= comments; i++) {
    line = comment[i]
    if (line ~ /^@code/) {
      print ".PP\n.EX"
      while (comment[++i] !~ /^@endcode/)
        print plain(comment[i])
      print ".EE"
    } else if (match(line, /^@param [a-zA-Z0-9_]+(, [a-zA-Z0-9_]+)* +/)) {
      words = substr(line, 8, RLENGTH - 7)
      sub(/ +$/, "", words)
      print ".TP\n.I " words
      said(substr(line, RLENGTH + 1))
    } else if (line ~ /^@return /) {
      print ".TP\n.B returns"
      said(substr(line, 9))
    } else if (line ~ /^- /) {
      print ".IP \\(bu 2"
      said(substr(line, 3))
    } else if (line == "")
      print ".PP"
    else {
      sub(/^ +/, "", line)
      said(line)
    }
  }
}
function entry(first) {
  first = declaration[1]
  if (first ~ /^#ifndef/) {
    print ".PP"
    text()
  } else if (comment[1] ~ /^In float: .*[.]$/) {
    print ".PP\nIn float:"
    code()
  } else {
    match(whole, /shade_[a-z0-9_]+\(|#define [A-Z_]+|[a-z_0-9]+;$/)
    first = substr(whole, RSTART, RLENGTH)
    gsub(/#define |[(;]/, "", first)
    print ".SS " (whole ~ /^enum/ ? "Constants" : first)
    code()
    print ".PP"
    text()
  }
}
/^#define SHADE_TABLE_[A-Z_]+[(]ROW[)]/ {
  list = substr($2, 13)
  sub(/[(].*/, "", list)
  prefix = list
  sub(/_FORMS$/, "", prefix)
}
list != "" && $1 ~ /^ROW[(][A-Z]/ {
  choices[list] = choices[list] ", SHADE_" prefix "_" substr($1, 5, length($1) - 5)
}
list != "" && $1 ~ /^SHADE_TABLE_[A-Z_]+[(]ROW[)]/ {
  choices[list] = choices[list] choices[substr($1, 13, length($1) - 17)]
}
FILENAME ~ /table[.]h$/ {
  next
}
FNR == 1 {
  name = FILENAME
  sub(/.*\/shade\//, "shade/", name)
  print ".SH \"" name "\""
  state = list = ""
}
/^\/\*\*/ {
  comments = declarations = 0
  whole = ""
  state = "comment"
  if ($0 !~ /^\/\*\* /)
    next
}
state == "comment" {
  line = $0
  last = line ~ /\*\/$/
  sub(/^\/\*\* | \*\/$/, "", line)
  sub(/ *\*\/$/, "", line)
  sub(/^ \* ?/, "", line)
  if (!last || line != "")
    comment[++comments] = line
  if (last)
    state = "declaration"
  next
}
state == "declaration" {
  declaration[++declarations] = $0
  whole = whole $0
  opened = gsub(/[{]/, "{", whole)
  closed = gsub(/[}]/, "}", whole)
  if ($0 ~ /^#/ || (opened == closed && $0 ~ /;$/)) {
    entry()
    state = ""
  }
}
