#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make windows` and `make macos` compile beside our own, from the archive of Debian 12 and checked by apt, into
# FOLDER: the sources of OpenEXR, libpng, zlib, and cmocka for the tests.
#   setup/windows-sources.sh FOLDER
set -eu
[ $# -eq 1 ] || { sed -n '3,5s/^# \?//p' "$0" >&2; exit 2; }
setup=$(cd "$(dirname "$0")" && pwd)

echo "setup: the sources of OpenEXR, libpng, zlib and cmocka into $1"
rm -rf "$1"
mkdir -p "$1"
cd "$1"
. "$setup/own_apt.sh"
own_sources "deb-src MIRROR bookworm main"
own_apt source --only-source openexr libpng1.6 zlib cmocka >/dev/null
own_clean
