# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=sh
# Sourced: `own_apt` is apt-get with lists and files of its own, in the folder where this is sourced. It asks Debian's
# archive and checks what it gets; it needs no root, and what this system is made of stays as it is.
#   own_sources "deb MIRROR trixie main"...   first: what it knows; MIRROR is that of this system

own_sources() {
  mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    awk '$2 ~ /^(bookworm|trixie)$/ && $3 == "main" { print $1; exit }')
  mkdir -p lists/partial archives/partial
  printf '%s\n' "$@" | sed "s|MIRROR|${mirror:-http://deb.debian.org/debian}|" >sources.list
  own_apt update
}
own_apt() {
  apt-get -qq -o Acquire::Retries=3 -o Acquire::Languages=none -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null \
    -o Dir::State::Lists="$PWD/lists" -o Dir::Cache="$PWD" -o APT::Sandbox::User="$(id -un)" "$@"
}
own_clean() {
  rm -rf lists archives sources.list ./*.bin
}
