#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Install the Debian packages that the given lists name (one a line; # starts a comment):
#   setup/apt.sh setup/packages-build.txt ...
# Where all of them are installed already it does nothing, and needs neither root nor network. Where there is no apt it looks
# whether what they bring is there, and names what is not (elsewhere.sh).
set -eu

[ $# -gt 0 ] || { echo "usage: $0 LIST..." >&2; exit 2; }
wanted=$(sed -e 's/#.*//' "$@")

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  exec "$(dirname "$0")/elsewhere.sh" "$@"
fi

missing() {
  for package in $wanted; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) || state=none
    [ "$state" = installed ] || printf '%s ' "$package"
  done
}
[ -n "$(missing)" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
  as_root="env"
elif command -v sudo >/dev/null; then
  as_root='sudo env'
else
  echo "setup: these Debian packages are missing, and there is neither root nor sudo to install them:" >&2
  echo "  $(missing)" >&2
  echo "setup: ask an administrator for: apt-get install --no-install-recommends $(missing)" >&2
  exit 1
fi

# one installation at a time, also under make -j
state_dir=build/setup
mkdir -p "$state_dir"
exec 9>"$state_dir/apt.lock"
flock 9

apt() {
  $as_root DEBIAN_FRONTEND=noninteractive apt-get -qq -o Acquire::Retries=3 \
    -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" </dev/null
}
refresh() {
  echo "setup: refreshing the package lists"
  apt update && touch "$state_dir/apt-updated"
}
fresh=$(find "$state_dir/apt-updated" -mmin -60 2>/dev/null) || fresh=
packages=$(missing)
[ -n "$packages" ] || exit 0
[ -n "$fresh" ] || refresh
echo "setup: installing Debian packages: $packages"
install() {
  # shellcheck disable=SC2086 # a list of words
  apt install --yes --no-install-recommends $packages
}
# a failure may come from lists that are out of date: once more with new ones
install || { refresh && install; } || {
  echo "setup: could not install: $packages" >&2
  exit 1
}
