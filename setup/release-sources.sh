#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make release` compiles beside our own, from Debian's archive and checked by apt, into FOLDER: the source of
# OpenEXR and the headers of Embree 4. Needs no root: apt's lists and files are FOLDER's own.
#   setup/release-sources.sh FOLDER
set -eu
[ $# -eq 1 ] || { sed -n '3,5s/^# \?//p' "$0" >&2; exit 2; }
openexr=3.1.5-5 embree=4.3.3+dfsg-1 # of Debian 12 and of 13

# the mirror that this system uses itself
mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
  awk '$2 ~ /^(bookworm|trixie)$/ && $3 == "main" { print $1; exit }')
: "${mirror:=http://deb.debian.org/debian}"
rm -rf "$1"
mkdir -p "$1/lists/partial" "$1/archives/partial"
cd "$1"
printf '%s\n' "deb-src $mirror bookworm main" "deb $mirror trixie main" >sources.list
apt() {
  apt-get -qq -o Acquire::Retries=3 -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null \
    -o Dir::State::Lists="$PWD/lists" -o Dir::Cache="$PWD" -o APT::Sandbox::User="$(id -un)" "$@"
}
echo "setup: OpenEXR's source and Embree 4's headers into $1"
apt update
apt source --only-source "openexr=$openexr" >/dev/null
apt download "libembree-dev:amd64=$embree"
dpkg-deb --extract libembree-dev_*.deb embree
rm -rf lists archives ./*.bin
