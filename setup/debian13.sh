#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A Debian 13 to change root into, for PyPI's bpy of the given versions, which are for its Python 3.13:
#   setup/debian13.sh 5.2 [5.3]
# It is no more than they need: packages of Debian's archive, unpacked (packages-debian13.txt), and an environment
# /opt/bpy-VERSION for each (requirements-bpy-VERSION.txt). It is kept from one build folder to the next, in
# ${LIBSHADE_CACHE:-${XDG_CACHE_HOME:-~/.cache}/libshade}/debian13; build/debian13 leads there.
# Where it can't be had it says so, with status 0: tests that need it are skipped. Needs build/venv, for its pip.
set -eu
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || { sed -n '3,9s/^# \?//p' "$0" >&2; exit 2; }
setup=$PWD/setup pip="$PWD/build/venv/bin/python -m pip"
cache=${LIBSHADE_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/libshade}
root=$cache/debian13 log=$cache/debian13.log

doing="no apt here"
ended() {
  status=$?
  trap - EXIT
  rm -rf "$root.part" "$root"/opt/*.part
  case $status in
  0 | 130 | 143) exit $status ;;
  esac
  echo "setup: no Debian 13 for bpy $*, tests in it are skipped: $doing: $(tail -n 1 "$log" 2>/dev/null)" >&2
  exit 0
}
trap 'ended "$@"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
mkdir -p "$cache"
: >"$log"
command -v apt-get >/dev/null
command -v dpkg-deb >/dev/null
doing="bpy is made for x86-64 alone"
[ "$(uname -m)" = x86_64 ]
# one at a time, also of several build folders
exec 9>"$cache/debian13.lock"
flock -n 9 || { echo "setup: waiting for another's $root" && flock 9; }

if ! cmp -s setup/packages-debian13.txt "$root/packages"; then
  echo "setup: Debian 13 into $root"
  doing="its packages"
  rm -rf "$root.part"
  mkdir -p "$root.part/apt"
  cd "$root.part"
  mkdir -p usr/bin usr/lib usr/lib64 usr/sbin dev proc opt tmp etc
  for folder in bin lib lib64 sbin; do ln -s "usr/$folder" $folder; done
  ln -s /proc/self/mounts etc/mtab
  cd apt
  {
    . "$setup/own_apt.sh"
    own_sources "deb MIRROR trixie main"
    # shellcheck disable=SC2046  # names, a word each
    own_apt download $(sed 's/#.*//; s/$/:amd64/; /^:/d' "$setup/packages-debian13.txt")
    for package in *.deb; do dpkg-deb --extract "$package" ..; done
  } >"$log" 2>&1
  cd ..
  rm -rf apt
  cp "$setup/packages-debian13.txt" packages
  rm -rf "$root"
  mv "$root.part" "$root"
fi

for version; do
  pins=$setup/requirements-bpy-$version.txt
  environment=$root/opt/bpy-$version
  cmp -s "$pins" "$environment/pins" && continue
  echo "setup: bpy $version into $root"
  doing="PyPI's bpy $version"
  rm -rf "$environment.part"
  mkdir -p "$environment.part/bin"
  cd "$environment.part"
  echo "home = /usr/bin" >pyvenv.cfg
  ln -s /usr/bin/python3.13 bin/python
  # not its dependencies: all are among the pins. Into a Python that this one isn't
  $pip --disable-pip-version-check install --quiet --no-deps --no-compile --ignore-requires-python --retries 3 --only-binary :all: \
    --implementation cp --python-version 3.13 --abi cp313 --abi abi3 --abi none --platform manylinux_2_28_x86_64 \
    --platform manylinux_2_27_x86_64 --platform manylinux_2_17_x86_64 --platform manylinux2014_x86_64 --platform any \
    --target lib/python3.13/site-packages -r "$pins" >"$log" 2>&1
  cp "$pins" pins
  rm -rf "$environment"
  mv "$environment.part" "$environment"
  cd "$setup"
done
ln -sfn "$root" "$setup/../build/debian13"
