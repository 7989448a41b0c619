#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Proves that the patches change no existing scene: renders the sample scenes
# with a patched and an unpatched POV-Ray and compares the pixels.
usage="usage: check.sh PATCHED UNPATCHED DISTRIBUTION [SCENE-FOLDER …]

PATCHED, UNPATCHED  POV-Ray programs (UNPATCHED may be Debian's own: built with
                    the same options, it gives the same pixels)
DISTRIBUTION        the folder 'distribution' of POV-Ray's source (scenes/, include/)
SCENE-FOLDER        below scenes/; by default textures lights objects

Every .pov is rendered at 64x48, 16 bits a component, one thread, JOBS (16) at a
time: POV-Ray spends most of so small a render waiting for its own messages.
Exit status: 0 all equal, 1 a difference, 2 wrong usage."

set -euo pipefail
case ${1-} in -h|--help) echo "$usage"; exit 0;; esac
[ $# -ge 3 ] || { echo "$usage" >&2; exit 2; }

patched=$(command -v "$1") || { echo "check.sh: $1: no such program" >&2; exit 2; }
unpatched=$(command -v "$2") || { echo "check.sh: $2: no such program" >&2; exit 2; }
patched=$(realpath "$patched") unpatched=$(realpath "$unpatched")
distribution=$(realpath "$3")
shift 3
[ $# -gt 0 ] || set -- textures lights objects
[ -d "$distribution/scenes/$1" ] || { echo "check.sh: $distribution/scenes/$1: no such folder" >&2; exit 2; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for side in patched unpatched; do # scenes may write files beside themselves
  mkdir "$work/$side" "$work/$side.out"
  cp -r "$distribution/scenes/." "$work/$side/"
done

# Prints "verdict scene". The header of the PPM holds the date, so only the pixels are compared.
compare_scene() {
  local scene=$1 name status_p=0 status_u=0
  name=${scene//\//_}
  render() { # program side
    cd "$work/$2/$(dirname "$scene")"
    timeout 300 "$1" "+I$(basename "$scene")" "+O$work/$2.out/$name.ppm" +FP16 +W64 +H48 -D -P +WT1 -GA \
      "+L$distribution/include" "+L$work/$2/$(dirname "$scene")" >"$work/$2.out/$name.log" 2>&1 </dev/null
  }
  pixels() { tail -c $((64 * 48 * 3 * 2)) "$work/$1.out/$name.ppm"; }
  (render "$patched" patched) || status_p=$?
  (render "$unpatched" unpatched) || status_u=$?
  if [ $status_p != $status_u ]; then echo "DIFFERS $scene (exit status $status_p, unpatched $status_u)"
  elif [ $status_u != 0 ]; then echo "fails   $scene (both, exit status $status_u)"
  elif cmp -s <(pixels patched) <(pixels unpatched); then echo "equal   $scene"
  else echo "DIFFERS $scene"; fi
}
export -f compare_scene
export work patched unpatched distribution

start=$SECONDS
(cd "$work/unpatched" && find "$@" -name '*.pov' | sort) |
  xargs -P "${JOBS:-16}" -I{} bash -c 'compare_scene "$1"' _ {} | tee "$work/verdicts" |
  { [ -t 2 ] && awk '{ printf "\r%d scenes ", NR > "/dev/stderr" } END { print "" > "/dev/stderr" }' || cat >/dev/null; }

grep -v '^equal' "$work/verdicts" | sort || true
equal=$(grep -c '^equal' "$work/verdicts" || true)
total=$(wc -l <"$work/verdicts")
echo "$equal of $total scenes pixel-identical, $((SECONDS - start)) s"
[ "$total" -gt 0 ] && ! grep -q '^DIFFERS' "$work/verdicts"
