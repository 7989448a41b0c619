#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Fetches Debian's source of POV-Ray, applies the series and builds it with
# libshade. Safe to repeat: each step is skipped when nothing it needs changed.
usage="usage: build.sh OUT LIBSHADE ARCHIVE …

OUT       folder for everything that is made; the program is OUT/povray
LIBSHADE  the folder libshade/ with include/ and dump/
ARCHIVE   libshade's static libraries, in the order of linking

CXX, CXXFLAGS, EXR_LIBS and JOBS (processors) are honoured. UNPATCHED=1 builds the source
as Debian has it, for check.sh; LIBSHADE and ARCHIVE are then left out. PREPARE=1
ends when the source is configured, for which no ARCHIVE has to be there yet."

set -euo pipefail
# variables of the make above (SHELL=setup/timed.sh) are not for POV-Ray's
unset MAKEFLAGS MAKEOVERRIDES
here=$(dirname "$(readlink -f "$0")")
unpatched=${UNPATCHED:-}
case ${1-} in -h|--help) echo "$usage"; exit 0;; esac
prepare=${PREPARE:-}
[ $# -ge 3 ] || { [ $# = 1 ] && [ -n "$unpatched" ]; } || { [ $# = 2 ] && [ -n "$prepare" ]; } || { echo "$usage" >&2; exit 2; }

mkdir -p "$1"
out=$(readlink -f "$1")
download=$out/download src=$out/src
shift
if [ -z "$unpatched" ]; then
  libshade=$(readlink -f "$1")
  shift
  archives=
  [ -n "$prepare" ] || archives=$(readlink -f "$@")
fi

say() { echo "povray: $*"; }
die() { echo "povray: $*" >&2; exit 1; }

exec 9>"$out/lock"
flock --nonblock 9 || { say "waiting for another build in $out"; flock 9; }
run() { # description command … : quiet unless it fails
  local what=$1
  shift
  "$@" >"$out/step.log" 2>&1 || { tail -n 30 "$out/step.log" >&2; die "$what failed; all of it is in $out/step.log"; }
}

# ---- the source, checked against UPSTREAM

version=$(sed -n 's/^version //p' "$here/UPSTREAM")
pool=$(sed -n 's/^pool //p' "$here/UPSTREAM")
verified() { (cd "$download" 2>/dev/null && sed -n '/^[0-9a-f]\{64\}  /p' "$here/UPSTREAM" | sha256sum --quiet -c - >/dev/null 2>&1); }

# deb-src entries for UPSTREAM's release, made from the system's deb entries for its own
# (both forms); the system's own lists stay as they are.
source_entries() {
  local codename suite file
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  suite=$(sed -n 's/^suite //p' "$here/UPSTREAM")
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    [ -f "$file" ] && sed -nE "s/^[[:space:]]*deb[[:space:]]+((\[[^]]*\][[:space:]]+)?[^[:space:]]+[[:space:]]+${codename}[[:space:]].*)/deb-src \1/p" "$file" | sed -E "s/([[:space:]])$codename([[:space:]])/\1$suite\2/"
  done >"$out/apt/debian.list" || true
  for file in /etc/apt/sources.list.d/*.sources; do
    [ -f "$file" ] && awk -v codename="$codename" -v suite="$suite" 'BEGIN { RS = ""; ORS = "\n\n" }
      ("\n" $0 "\n") ~ "\nSuites:([^\n]*[ \t])?" codename "[ \t\n]" && ("\n" $0) ~ /\nTypes:[^\n]*deb/ && !(("\n" $0) ~ /\nEnabled:[ \t]*no/) {
        $0 = "\n" $0; sub(/\nTypes:[^\n]*/, "\nTypes: deb-src")
        sub(/\nSuites:[^\n]*/, "\nSuites: " suite); print substr($0, 2) }' "$file"
  done >"$out/apt/debian.sources" || true
  cat "$out"/apt/debian.list "$out"/apt/debian.sources | grep -q . ||
    die "no entry for Debian $codename in /etc/apt/sources.list or /etc/apt/sources.list.d: where is the source to come from?"
}

# where there is no apt: as UPSTREAM's sums say
fetch_files() {
  local name
  mkdir -p "$download"
  while read -r _ name; do
    run "fetching $name" curl --fail --silent --show-error --location --retry 3 -o "$download/$name" "$pool/$name"
  done < <(sed -n '/^[0-9a-f]\{64\}  /p' "$here/UPSTREAM")
}

fetch() {
  say "fetching Debian's source of povray $version (53 MB)"
  if ! command -v apt-get >/dev/null; then
    fetch_files
    verified || die "the files in $download are not those of povray_patches/UPSTREAM"
    return
  fi
  mkdir -p "$download" "$out/apt/lists/partial" "$out/apt/cache/archives/partial"
  source_entries
  # our own lists and cache: no root needed, nothing of the system touched
  local apt=(apt-get -q -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$out/apt"
    -o "Dir::State::Lists=$out/apt/lists" -o "Dir::Cache=$out/apt/cache"
    -o APT::Sandbox::User=root -o Acquire::Retries=3)
  run "apt-get update" "${apt[@]}" update
  cd "$download"
  run "apt-get source" "${apt[@]}" source --download-only "povray=$version"
  cd - >/dev/null
  verified || die "the files in $download are not those of povray_patches/UPSTREAM"
}
verified || fetch

# ---- unpack and patch

patches=()
[ -n "$unpatched" ] || mapfile -t patches < <(grep -v '^#' "$here/series")

recipe=$(cat "$here/UPSTREAM" "${patches[@]/#/$here/}" | sha256sum)
if [ "$(cat "$out/recipe" 2>/dev/null)" != "$recipe" ]; then
  say "unpacking the source and applying ${#patches[@]} patches"
  rm -rf "$src" "$out/recipe" "$out/configured"
  run "unpacking" dpkg-source --no-copy --no-check -x "$download"/*.dsc "$src"
  if [ ${#patches[@]} -gt 0 ]; then
    cd "$src"
    QUILT_PATCHES=$here QUILT_SERIES=$here/series QUILT_PC=.pc-libshade run "applying the patches" quilt --quiltrc=- push -a --fuzz=0
    cd - >/dev/null
  fi
  echo "$recipe" >"$out/recipe"
fi

if [ -z "$unpatched" ]; then
  mkdir -p "$src/source/backend/mdf"
  for file in "$here"/glue/*.{h,cpp}; do
    cmp -s "$file" "$src/source/backend/mdf/${file##*/}" || cp "$file" "$src/source/backend/mdf/"
  done
  for file in "$src"/source/backend/mdf/*.{h,cpp}; do
    [ -e "$here/glue/${file##*/}" ] || rm "$file"
  done
fi

# ---- configure

configure=(./configure COMPILED_BY="libshade" --without-x --without-libsdl --disable-optimiz --disable-strip
  --with-boost-thread=boost_thread "CXX=${CXX:-g++}" "CXXFLAGS=${CXXFLAGS:--O3}")
[ -n "$unpatched" ] || configure+=("CPPFLAGS=-I$libshade/include -I$libshade" "LIBS=${EXR_LIBS:--lOpenEXRCore-3_1}")

# prebuild lists the source files, so a new one means a new configuration
settings=$(printf '%s\n' "${configure[@]}" && cd "$src/source/backend/mdf" 2>/dev/null && ls -- *.h *.cpp || true)
if [ "$(cat "$out/configured" 2>/dev/null)" != "$settings" ]; then
  say "configuring"
  cd "$src/unix"
  run "prebuild" ./prebuild.sh
  cd "$src"
  run "configure" "${configure[@]}"
  echo "$settings" >"$out/configured"
fi
[ -z "$prepare" ] || exit 0

# ---- compile

cd "$src"
flags=$(sed -n 's/^CXXFLAGS = //p' Makefile)
if [ -z "$unpatched" ]; then
  for file in $archives; do # make does not know them
    [ "$file" -nt unix/povray ] && rm -f unix/povray
  done
fi
# Two fifths of the time of 161 files went into reading the same headers of the standard library
# and boost: they are compiled once and read ahead of all. No result depends on it, and a compiler
# that cannot use what was compiled reads them as text. As much again went into the exceptions of boost's
# futures, which a file that reads boost/thread.hpp compiles whether or not it has futures: POV-Ray has none,
# so that their header is said to have been read. (Who used them would not compile.)
# Each file also compiled what makes boost's error codes those of the standard library, a sixth of a second:
# nothing of POV-Ray's asks for that, and no class is laid out otherwise without it.
headers=$out/headers.h
if [ ! -e "$headers.gch" ] || [ "$headers.gch" -ot "$out/configured" ] || [ "$headers.gch" -ot "$here/build.sh" ]; then
  printf '#define %s\n' BOOST_THREAD_FUTURE_HPP BOOST_NO_CXX11_HDR_SYSTEM_ERROR >"$headers.new"
  printf '#include <%s>\n' algorithm cctype cmath cstdio cstring list map queue set stack stdexcept string vector \
    boost/bind.hpp boost/function.hpp boost/functional/hash/hash.hpp boost/scoped_array.hpp boost/scoped_ptr.hpp \
    boost/shared_ptr.hpp boost/thread.hpp boost/unordered_map.hpp >>"$headers.new"
  cmp -s "$headers.new" "$headers" || cp "$headers.new" "$headers"
  run "compiling the headers" ${CXX:-g++} -pthread $flags -DHAVE_CONFIG_H -x c++-header "$headers" -o "$headers.gch"
fi
total=$(make -n 2>/dev/null | grep -c -- ' -c -o ' || true)
# make -n always lists the two files of unix/: it takes config.h for remade
if [ "$total" -gt 2 ]; then say "compiling $total files (about $((total * 3 / 2 / $(nproc) + 5)) s)"; fi
progress() {
  awk -v total="$total" -v tty="$1" '{ print > file } / -c -o / { if (tty && total) printf "\rpovray: compiled %d of %d ", ++n, total; fflush() }
    END { if (tty && n) print "" }' file="$out/build.log"
}
# what configure found links after our archives, which need some of it
libs=()
[ -n "$unpatched" ] || libs=("LIBS=${archives//$'\n'/ } $(sed -n 's/^LIBS = //p' Makefile)")
nice make -j"${JOBS:-$(nproc)}" CXXFLAGS="$flags -include $headers" "${libs[@]}" 2>&1 | progress "$([ -t 1 ] && echo 1 || true)" ||
  { grep -aE 'error|Error' "$out/build.log" | head -n 20 >&2; die "compiling failed; all of it is in $out/build.log"; }

# ---- a program that runs from here; its time stamp changes only when something did

includes=("$src/distribution/include")
[ -n "$unpatched" ] || includes+=("$here/include")
stale=$(find "${includes[@]}" unix/povray "$here/build.sh" -newer "$out/povray" 2>/dev/null || echo all)
if [ -n "$stale" ]; then
  mkdir -p "$out/include"
  for folder in "${includes[@]}"; do cp -r "$folder/." "$out/include/"; done
  echo "; used by the script povray beside it when POVINI is not set" >"$out/povray.ini"
  cat >"$out/povray.new" <<'WRAPPER'
#!/bin/sh
# Runs this POV-Ray where it was built, with its include files.
here=$(dirname "$(readlink -f "$0")")
export POVINI="${POVINI:-$here/povray.ini}"
exec "$here/src/unix/povray" "+L$here/include" "$@"
WRAPPER
  chmod +x "$out/povray.new"
  mv "$out/povray.new" "$out/povray"
fi
say "ready: $out/povray; its manual: docs/start/povray.md"
