#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Where there is no apt: is what Debian's packages bring there, whatever brought it? What is missing is named as the system
# names it (elsewhere.txt), with status 1; nothing is installed.
#   setup/elsewhere.sh setup/packages-build.txt ...
# OS_RELEASE, USR: instead of /etc/os-release and /usr.
set -eu
[ $# -gt 0 ] || { sed -n '3,6s/^# \?//p' "$0" >&2; exit 2; }
table=$(dirname "$0")/elsewhere.txt
ID='' ID_LIKE=''
release=${OS_RELEASE:-/etc/os-release}
# shellcheck disable=SC1090
[ ! -r "$release" ] || . "$release"
case " $ID $ID_LIKE " in
*" fedora "* | *" rhel "*) column=3 install="dnf install" ;;
*" arch "*) column=4 install="pacman -S --needed" ;;
*) column=1 install= ;;
esac

includes() { printf '#include <%s>\n' "$1" | ${CC:-cc} -xc "$2" -fsyntax-only - 2>/dev/null || printf '#include <%s>\n' "$1" | ${CXX:-c++} -xc++ "$2" -fsyntax-only - 2>/dev/null; }
is_there() { # kind, name
  case $1 in
  command) command -v "$2" >/dev/null ;;
  module) pkg-config --exists "$2" 2>/dev/null ;;
  header) includes "$2" -I. ;;
  library) [ -e "$(${CC:-cc} -print-file-name="$2" 2>/dev/null)" ] ;;
  file) [ -e "${USR:-/usr}/$2" ] || [ -e "${USR:-/usr}/local/$2" ] ;;
  python) /usr/bin/python3 -c "import $2" 2>/dev/null ;;
  python-header) includes "$2" "-I$(/usr/bin/python3 -c 'import sysconfig; print(sysconfig.get_path("include"))' 2>/dev/null)" ;;
  esac
}
is_any_there() { # kind, names with commas between
  for name in $(echo "$2" | tr , ' '); do
    ! is_there "$1" "$name" || return 0
  done
  return 1
}

missing='' more=''
for package in $(sed 's/#.*//' "$@"); do
  row=$(awk -v package="$package" '$1 == package' "$table")
  if [ -z "$row" ]; then
    more="$more $package"
    continue
  fi
  sign=$(echo "$row" | awk '{ print $2 }')
  is_any_there "${sign%%:*}" "${sign#*:}" && continue
  name=$(echo "$row" | awk -v column=$column '{ print $column }')
  case " $missing $more " in
  *" $name "*) ;;
  *) if [ "$name" = - ]; then more="$more $package"; else missing="$missing $name"; fi ;;
  esac
done
[ "$missing$more" ] || exit 0
echo "setup: this system has no apt, and these are missing:$missing$more" >&2
if [ -n "$install" ] && [ -n "$missing" ]; then
  echo "setup: install them and run make again: sudo $install$missing" >&2
elif [ -z "$install" ]; then
  echo "setup: (Debian's names); install what brings them here and run make again" >&2
fi
exit 1
