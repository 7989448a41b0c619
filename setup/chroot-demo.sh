#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Run make targets as on a machine that has nothing yet: a minimal Debian 12 or 13 (debootstrap, variant minbase) with
# only `make` added, and a fresh clone of HEAD in it. Needs root and debootstrap.
#   setup/chroot-demo.sh bookworm                   make demo
#   setup/chroot-demo.sh trixie blender povray      these targets instead
#   KEEP=1 setup/chroot-demo.sh ...                 leave the system in build/chroot-trixie to look at
set -euo pipefail
cd "$(dirname "$0")/.."
case ${1:-} in
bookworm | trixie) suite=$1 && shift ;;
*) sed -n '3,7s/^# \?//p' "$0"; [[ ${1:-} =~ ^(-h|--help)$ ]] && exit 0 || exit 2 ;;
esac
[ $# -gt 0 ] || set -- demo
[ "$(id -u)" -eq 0 ] || { echo "$0: needs root (chroot, mount)" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "$0: needs debootstrap: apt-get install debootstrap" >&2; exit 1; }

root=$PWD/build/chroot-$suite
# mounts live in a namespace of their own and go with it: there is nothing to unmount afterwards
remove() { rm -rf --one-file-system "$root"; }
[ "${KEEP:-}" ] || trap remove EXIT
remove
mkdir -p "$root"

# the mirrors that this system uses itself: lines "URI release component...", of either Debian
sources=$(apt-get indextargets --format '$(SITE) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
  awk '$2 ~ /^(bookworm|trixie)/ && $3 == "main"' | sed -E "s/ (bookworm|trixie)/ $suite/" | sort -u)
[ "$sources" ] || sources="http://deb.debian.org/debian $suite main"
mirror=$(awk -v suite="$suite" '$2 == suite { print $1; exit }' <<<"$sources")

echo "chroot: debootstrap of Debian's $suite (minbase)"
debootstrap --variant=minbase "$suite" "$root" "$mirror" >"$root.log" 2>&1 ||
  { tail -n 20 "$root.log" >&2; exit 1; }
sed 's/^/deb /' <<<"$sources" >"$root/etc/apt/sources.list"

# the way to the network: resolver, certificates, proxies and mirrors of apt and pip
cp -L /etc/resolv.conf "$root/etc/resolv.conf"
# (the package ca-certificates, when it comes, makes its bundle anew from the second folder)
for certificates in /etc/ssl/certs/ca-certificates.crt /usr/local/share/ca-certificates; do
  [ ! -e "$certificates" ] || { mkdir -p "$root${certificates%/*}" && cp -rL "$certificates" "$root$certificates"; }
done
apt-config dump | grep -Ei '^Acquire::([a-z]+::Proxy|Check-(Valid-Until|Date))' >"$root/etc/apt/apt.conf.d/90host" || true
[ ! -e /etc/pip.conf ] || cp /etc/pip.conf "$root/etc/pip.conf"
keep=(http_proxy https_proxy no_proxy PIP_INDEX_URL PIP_EXTRA_INDEX_URL PIP_CERT SSL_CERT_FILE)
environment=(HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 TERM="${TERM:-dumb}")
for name in "${keep[@]}"; do
  [ -z "${!name:-}" ] || environment+=("$name=${!name}")
done

git clone --quiet --no-hardlinks . "$root/clone"

inside() {
  unshare --mount --pid --fork sh -c '
    mount -t proc proc "$0/proc" && mount -t tmpfs shm "$0/dev/shm" &&
    exec chroot "$0" env -i "$@"' "$root" "${environment[@]}" "$@" </dev/null
}
echo "chroot: installing make"
inside sh -c 'apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --yes --no-install-recommends make' >>"$root.log" 2>&1 ||
  { tail -n 20 "$root.log" >&2; exit 1; }

echo "chroot: make $*"
start=$SECONDS
status=0
inside make -C /clone "$@" || status=$?
echo "chroot: make $* ended with $status after $((SECONDS - start)) s; $(du -sh "$root" | cut -f1) on disk"
exit $status
