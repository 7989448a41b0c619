#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Installs the package in a minimal Debian of this release (debootstrap), alone and beside Debian's own povray,
# renders, removes it, and asks whether anything is left.
#   check-install.sh PACKAGE.deb FOLDER    FOLDER is made, and removed
set -euo pipefail
[ $# -eq 2 ] || { sed -n 's/^#   /usage: /p' "$0" >&2; exit 2; }
[ "$(id -u)" -eq 0 ] || { echo "check-install: left out: it needs root (chroot)"; exit 0; }
command -v debootstrap >/dev/null || { echo "check-install: left out: it needs debootstrap"; exit 0; }
package=$(readlink -f "$1")
[ ! -e "$2" ] || { echo "check-install: $2 is there already" >&2; exit 1; }
mkdir -p "$2"
root=$(readlink -f "$2")
trap 'rm -rf --one-file-system "$root"' EXIT

codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
mirror=$(apt-get indextargets --format '$(SITE) $(RELEASE)' 'Created-By: Packages' | awk -v codename="$codename" '$2 == codename { print $1; exit }')
debootstrap --variant=minbase "$codename" "$root" "${mirror:-http://deb.debian.org/debian}" >"$root.log" 2>&1 || { tail -n 20 "$root.log" >&2; exit 1; }
rm "$root.log"
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
apt-config dump | grep -Ei '^Acquire::([a-z]+::Proxy|Check-(Valid-Until|Date))' >"$root/etc/apt/apt.conf.d/90host" || true
cp "$package" "$root/tmp/package.deb"

cat >"$root/tmp/inside" <<'INSIDE'
set -eu
apt() { apt-get -qq --yes --no-install-recommends "$@" >/tmp/log 2>&1 || { tail -n 20 /tmp/log; exit 1; }; }
there() { # what packages, apt and logs write about themselves left out
  find / -xdev \( -path /proc -o -path /tmp -o -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg -o -path /var/log \) -prune -o -print | sort
  dpkg-query -W -f '${Package} ${Version} ${Status}\n' | sort
}
round() {
  there >/tmp/before
  apt install /tmp/package.deb
  dpkg -V povray-libshade
  mkdir /tmp/pictures
  cd /tmp/pictures
  for scene in metals reflection cloth; do
    povray-libshade "+I/usr/share/doc/povray-libshade/examples/$scene.pov" "+O$scene.png" +W80 +H40 -D >/tmp/log 2>&1 && [ -s $scene.png ] || { tail -n 20 /tmp/log; exit 1; }
  done
  cd /
  rm -r /tmp/pictures
  apt purge povray-libshade
  apt autoremove --purge
  there >/tmp/after
  diff /tmp/before /tmp/after || { echo "check-install: the above is left, or gone"; exit 1; }
  echo "check-install: installed, rendered and removed $1; nothing is left"
}
apt update
# shared by all that installs a library
ldconfig
round "alone"
apt install povray povray-includes
round "beside Debian's povray"
povray --version >/dev/null 2>&1
INSIDE
unshare --mount --pid --fork sh -c 'mount -t proc proc "$0/proc" && mount -t tmpfs shm "$0/dev/shm" &&
  exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive sh /tmp/inside' "$root" </dev/null
