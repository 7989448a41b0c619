#!/bin/bash
# SPDX-License-Identifier: AGPL-3.0-or-later
# Packs what build.sh made: a package for Debian, beside its own povray, and the same files as a tar archive that
# runs from any folder. The same program gives the same bytes (SOURCE_DATE_EPOCH, or the time of the commit).
#   package.sh POVRAY OUT    POVRAY is the OUT of build.sh
# DEBFULLNAME and DEBEMAIL say who makes the package.
set -euo pipefail
[ $# -eq 2 ] || { sed -n 's/^#   /usage: /p' "$0" >&2; exit 2; }
umask 022
export LC_ALL=C TZ=UTC
here=$(dirname "$(readlink -f "$0")")
top=$(readlink -f "$here/../..")
povray=$(readlink -f "$1")
mkdir -p "$2"
out=$(readlink -f "$2")

name="povray-libshade"
version=$(sed -n 's/^version .*:\(.*\)-.*/\1/p' "$here/../UPSTREAM")+libshade$(sed -n 's/^#define SHADE_VERSION "\(.*\)"/\1/p' "$top/libshade/include/shade/shade.h")
architecture=$(dpkg --print-architecture)
maintainer="${DEBFULLNAME:-libshade} <${DEBEMAIL:-libshade@libshade.invalid}>"
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$top" log -1 --format=%ct 2>/dev/null || stat -c %Y "$top/NEWS.md")}

# ---- the files, under usr/ as in a folder of one's own

rm -rf "$out"
build=$out/build
stage=$build/debian/$name # where dpkg-shlibdeps expects it
usr=$stage/usr share=$stage/usr/share/$name doc=$stage/usr/share/doc/$name man=$stage/usr/share/man/man1
put() { install -D -m "$1" "${@:2}"; } # mode from to
put 755 "$here/$name" "$usr/bin/$name"
# its build-id and its debug information tell folders apart
put 755 "$povray/src/unix/povray" "$usr/lib/$name/povray"
strip --remove-section=.comment --remove-section=.note.gnu.build-id "$usr/lib/$name/povray"
put 644 "$here/povray.ini" "$share/povray.ini"
put 644 -t "$share/ini" "$povray"/src/distribution/ini/*.ini
put 644 -t "$share/include" "$povray"/include/*
put 644 "$here/$name.1" "$man/$name.1"
for page in "$top"/docs/start/povray.md "$top"/docs/povray/*.md; do # links to the glossary are plain text here
  file=${page#"$top"/docs/}
  put 644 "$page" "$doc/manual/$file"
  sed -i -E 's/\{term\}`([^`<]*[^`< ]) *(<[^`>]*>)?`/\1/g' "$doc/manual/$file"
done
for scene in "$top"/examples/povray/*/*.pov; do
  file=${scene##*/}
  case $file in suzanne.pov | embossed.pov) continue ;; esac # need what the demo and the tool `shade` make
  put 644 "$scene" "$doc/examples/$file"
  sed -i 's,build/povray/povray +Iexamples/povray/[a-z]*/,povray-libshade +I,; s,+Lbuild ,,; s,+Obuild/,+O,' "$doc/examples/$file"
done
cat "$povray/src/debian/copyright" "$here/copyright" >"$doc/copyright"
cat >"$doc/changelog" <<END
$name ($version) unstable; urgency=medium

  * POV-Ray of Debian with libshade. NEWS.md of its source has what is new.

 -- $maintainer  $(date -Rd "@$SOURCE_DATE_EPOCH")
END
gzip -9n "$doc/changelog" "$man/$name.1"

# ---- the package

mkdir "$stage/DEBIAN"
echo "Source: $name" >"$build/debian/control"
depends=$(cd "$build" && dpkg-shlibdeps -O "$usr/lib/$name/povray" | sed -n 's/^shlibs:Depends=//p')
[ "$depends" ] || { echo "$0: what does it depend on?" >&2; exit 1; }
cat >"$stage/DEBIAN/control" <<END
Package: $name
Version: $version
Section: graphics
Priority: optional
Architecture: $architecture
Maintainer: $maintainer
Installed-Size: $(du -sk --apparent-size "$usr" | cut -f1)
Depends: $depends
Suggests: povray-doc
Homepage: https://www.povray.org
Description: Persistence of vision raytracer with brushed metal and woven cloth
 POV-Ray is a ray tracer that renders scenes written in a language of its
 own. This one has a new block in a finish, mdf { }: highlights and reflections
 of brushed, turned and scratched metal, and woven cloth, from the library
 libshade. Scenes without the block look as they do in POV-Ray.
 .
 It has its own include files and installs beside the package povray.
END
(cd "$stage" && find usr -type f | sort | xargs -d '\n' md5sum) >"$stage/DEBIAN/md5sums"
chmod 644 "$stage"/DEBIAN/*
find "$stage" -exec touch -hd "@$SOURCE_DATE_EPOCH" {} +
# one thread: what several make depends on their number
dpkg-deb --root-owner-group -Zxz --threads-max=1 --build "$stage" "$out/${name}_${version}_$architecture.deb" >/dev/null

# ---- the archive

folder=$name-$version-$architecture
rm -r "$stage/DEBIAN"
mv "$usr" "$out/$folder"
put 644 -t "$out/$folder/share/doc/$name" "$top/LICENSES/Apache-2.0.txt"
sed "s/@VERSION@/$version/; s/@DEPENDS@/$depends/" "$here/README" | fold -sw 100 >"$out/$folder/README"
find "$out/$folder" -exec touch -hd "@$SOURCE_DATE_EPOCH" {} +
tar --sort=name --owner=0 --group=0 --numeric-owner --mode=go-w -C "$out" -c "$folder" | xz -T1 >"$out/$folder.tar.xz"
rm -r "${out:?}/$folder" "$build"
echo "package: $out/${name}_${version}_$architecture.deb"
echo "package: $out/$folder.tar.xz"
