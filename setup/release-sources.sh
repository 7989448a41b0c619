#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# What `make release` compiles beside our own, from Debian's archive and checked by apt, into FOLDER: the source of
# OpenEXR and the headers of Embree 4.
#   setup/release-sources.sh FOLDER
set -eu
[ $# -eq 1 ] || { sed -n '3,5s/^# \?//p' "$0" >&2; exit 2; }
openexr=3.1.5-5 embree=4.3.3+dfsg-1 # of Debian 12 and of 13
setup=$(cd "$(dirname "$0")" && pwd)

echo "setup: OpenEXR's source and Embree 4's headers into $1"
rm -rf "$1"
mkdir -p "$1"
cd "$1"
. "$setup/own_apt.sh"
own_sources "deb-src MIRROR bookworm main" "deb MIRROR trixie main"
own_apt source --only-source "openexr=$openexr" >/dev/null
own_apt download "libembree-dev:amd64=$embree"
dpkg-deb --extract libembree-dev_*.deb embree
own_clean
