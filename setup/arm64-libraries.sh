#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make check-arm64` links and opens, and shade-render of `make linux-arm64` brings, from the archive of Debian 12 and checked
# by apt, unpacked into FOLDER: Embree, TBB, OpenEXR, libpng and zlib for arm64.
#   setup/arm64-libraries.sh FOLDER
set -eu
[ $# -eq 1 ] || { sed -n '3,5s/^# \?//p' "$0" >&2; exit 2; }
setup=$(cd "$(dirname "$0")" && pwd)

echo "setup: Embree, OpenEXR and libpng for arm64 into $1"
rm -rf "$1"
mkdir -p "$1"
cd "$1"
. "$setup/own_apt.sh"
own_sources "deb [arch=arm64] MIRROR bookworm main"
own_apt download libembree3-3:arm64 libtbb12:arm64 libopenexr-3-1-30:arm64 libopenexr-dev:arm64 libimath-3-1-29:arm64 \
  libpng16-16:arm64 libpng-dev:arm64 zlib1g:arm64 zlib1g-dev:arm64 libstdc++6:arm64 libgcc-s1:arm64
for package in *.deb; do
  dpkg-deb -x "$package" .
done
rm -f ./*.deb
own_clean
