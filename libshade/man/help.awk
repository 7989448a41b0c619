# SPDX-License-Identifier: Apache-2.0
# What --help of each command prints, as sections of a manual page: awk -f help.awk COMMAND.txt...
FNR == 1 {
  name = FILENAME
  sub(/.*\//, "", name)
  sub(/[.]txt$/, "", name)
  print (NR == 1 ? "" : ".EE\n") ".SS shade " name "\n.EX"
}
{
  gsub(/\\/, "\\e")
  gsub(/-/, "\\-")
  gsub(/…/, "...")
  sub(/^[.']/, "\\\\\\&&")
  print
}
END {
  print ".EE"
}
