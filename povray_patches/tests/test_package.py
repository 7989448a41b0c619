# SPDX-License-Identifier: AGPL-3.0-or-later
"""What `make povray-package` leaves: the package for Debian, and the archive that runs from any folder. Where it has not been
made, the same of a stand-in for POV-Ray, which is not rendered with."""
import os
import re
import shutil
import subprocess
import tarfile

import OpenImageIO as oiio
import pytest

from conftest import ROOT

COST = 2.9  # in make check, which makes no package; 27 where there is one

FOLDER = ROOT / "build/povray-package"
NAME = "povray-libshade"
PACK = ROOT / "povray_patches/package/package.sh"
MADE = len(list(FOLDER.glob("*.deb")) + list(FOLDER.glob("*.tar.xz"))) == 2
pytestmark = pytest.mark.skipif(not MADE and not shutil.which("dpkg-shlibdeps"), reason="dpkg-dev is not installed")
renders = pytest.mark.skipif(not MADE, reason="not built: make povray-package")

SCENE = """#version 3.7;
#include "colors.inc"
#include "libshade_metals.inc"
global_settings { assumed_gamma 1 }
camera { location <0, 0, -3> look_at 0 angle 40 right x up y }
light_source { <3, 4, -6>, White }
sphere { 0, 1 pigment { rgb 0 } finish { ambient 0 diffuse 0 mdf { ggx .2, .5 specular rgb <.2, .9, .1> } } }
"""


def run(*command, status=0, **more):
    done = subprocess.run(command, text=True, errors="replace", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=300, **more)
    assert done.returncode == status, done.stdout
    return done.stdout


@pytest.fixture(scope="module")
def povray(tmp_path_factory):
    """What build.sh leaves, or any program in its place with POV-Ray's own files."""
    if MADE:
        return ROOT / "build/povray"
    folder = tmp_path_factory.mktemp("stand-in")
    for path, text in (("src/distribution/ini/slow.ini", "Quality=9\n"), ("src/debian/copyright", "POV-Ray is of many.\n"),
                       *((f"include/{path.name}", path.read_text(encoding="utf-8")) for path in (ROOT / "povray_patches/include").iterdir()),
                       *((f"include/{name}", "// POV-Ray's\n") for name in ("colors.inc", "textures.inc"))):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    (folder / "src/unix").mkdir()
    shutil.copy(shutil.which("true"), folder / "src/unix/povray")
    return folder


@pytest.fixture(scope="module")
def packed(povray, tmp_path_factory):
    if MADE:
        return FOLDER
    folder = tmp_path_factory.mktemp("packed")
    run("sh", "-c", 'umask 077 && TZ=Asia/Tokyo exec "$@"', "sh", PACK, povray, folder, env={**os.environ, "SOURCE_DATE_EPOCH": "86400", "DEBFULLNAME": "Someone Else"})
    return folder


@pytest.fixture(scope="module")
def deb(packed, tmp_path_factory):
    """The package, its files unpacked."""
    folder = tmp_path_factory.mktemp("deb")
    run("dpkg-deb", "--raw-extract", next(packed.glob("*.deb")), folder)
    return folder


@pytest.fixture(scope="module")
def unpacked(packed, tmp_path_factory):
    """The archive in a folder with a space and other letters."""
    folder = tmp_path_factory.mktemp("a folder, ткань")
    run("tar", "-xf", next(packed.glob("*.tar.xz")), "-C", folder)
    top, = folder.iterdir()
    return top


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def test_package_has_what_it_needs_in_folders_of_its_own(deb):
    there = files(deb) - {"DEBIAN/control", "DEBIAN/md5sums"}  # no script runs when it is installed
    own = rf"usr/(bin/{NAME}$|lib/{NAME}/|share/{NAME}/|share/doc/{NAME}/|share/man/man1/{NAME}\.1\.gz$)"
    assert [name for name in there if not re.match(own, name)] == []
    includes = {path.name for path in (ROOT / "povray_patches/include").iterdir()} | {"colors.inc", "textures.inc"}
    assert {f"usr/share/{NAME}/include/{name}" for name in includes} <= there
    documents = f"usr/share/doc/{NAME}"
    assert {f"usr/bin/{NAME}", f"usr/lib/{NAME}/povray", f"usr/share/{NAME}/povray.ini", f"usr/share/man/man1/{NAME}.1.gz",
            f"{documents}/copyright", f"{documents}/changelog.gz", f"{documents}/manual/povray/reference.md"} <= there


def test_what_the_manual_page_and_the_readme_name_is_there(unpacked):
    page = (ROOT / f"povray_patches/package/{NAME}.1").read_text(encoding="utf-8").replace("\\-", "-")
    readme = (ROOT / "povray_patches/package/README").read_text(encoding="utf-8")
    there = {f"share/doc/{NAME}/{name}" for name in re.findall(r"^\.IR? ((?:manual|examples)[\w/.]*)", page, re.M)}
    there |= {f"share/{NAME}/include/{name}" for name in re.findall(r"(\w+\.inc)", page)} | set(re.findall(r"^\.I (share/[\w/.-]+)$", page, re.M))
    there |= set(re.findall(r"\b((?:bin|share)/[\w/.-]+\w)", readme))
    assert len(there) > 9 and [name for name in there if not (unpacked / name).exists()] == []
    assert "LIBSHADE_DUMP" in page and "POVINI" in page


@pytest.mark.parametrize("name", ["plain", "a folder, ткань"])
def test_the_program_starts_with_its_own_files(tmp_path, name):
    """Wherever the folder lies, by a link too; a reader's own settings come first. Names that POV-Ray would not read are a number."""
    folder = tmp_path / name
    for path in ("bin", f"lib/{NAME}", f"share/{NAME}/include"):
        (folder / path).mkdir(parents=True)
    shutil.copy(ROOT / f"povray_patches/package/{NAME}", folder / "bin")
    (folder / f"share/{NAME}/include/own.inc").write_text("// own")
    stand_in = folder / f"lib/{NAME}/povray"
    stand_in.write_text('#!/bin/sh\necho "$POVINI"\necho "$*"\ncat "${1#+L}/own.inc"\nexit 3\n')
    stand_in.chmod(0o755)
    (tmp_path / "link").symlink_to(folder / f"bin/{NAME}")
    clean = {key: value for key, value in os.environ.items() if key != "POVINI"}
    for program in (folder / f"bin/{NAME}", tmp_path / "link"):
        for settings, ini in (({}, folder / f"share/{NAME}/povray.ini"), ({"POVINI": "mine.ini"}, "mine.ini")):
            said = run(program, "+Ia scene.pov", "-D", status=3, env=clean | settings, cwd=tmp_path).split("\n")
            include = f"{folder}/share/{NAME}/include" if name == "plain" else "/proc/self/fd/9"
            assert said == [str(ini), f"+L{include} +Ia scene.pov -D", "// own"]


def test_package_says_what_it_depends_on(deb):
    """Each library that the program asks for itself is of a package in Depends."""
    depends = re.search("^Depends: (.*)", (deb / "DEBIAN/control").read_text(), re.M).group(1)
    needed = re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-d", deb / f"usr/lib/{NAME}/povray"))
    assert len(needed) > (5 if MADE else 0)
    for library in needed:
        owners = run("dpkg-query", "-S", f"*/{library}").split("\n")
        assert any(re.search(rf"(^|, ){re.escape(line.split(':')[0])}( |,|$)", depends) for line in owners if line), library


def test_both_say_what_they_are(packed, deb, unpacked):
    """Version, machine and who made it in the control file; the time in the changelog and of each file; nobody needs rights of their own."""
    control = dict(re.findall("^(\\w[\\w-]*): (.*)", (deb / "DEBIAN/control").read_text(encoding="utf-8"), re.M))
    upstream = re.search("^version .*:(.*)-", (ROOT / "povray_patches/UPSTREAM").read_text(), re.M)[1]
    version = upstream + "+libshade" + re.search('SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text())[1]
    architecture = run("dpkg", "--print-architecture").strip()
    assert (control["Package"], control["Version"], control["Architecture"], control["Section"]) == (NAME, version, architecture, "graphics")
    assert {path.name for path in packed.iterdir()} == {f"{NAME}_{version}_{architecture}.deb", f"{NAME}-{version}-{architecture}.tar.xz"}
    kibibytes = sum(os.path.getsize(deb / name) for name in files(deb) if name.startswith("usr/")) / 1024
    assert abs(int(control["Installed-Size"]) - kibibytes) < 0.05 * kibibytes + 4 * sum(path.is_dir() for path in deb.rglob("*"))
    news = run("zcat", deb / f"usr/share/doc/{NAME}/changelog.gz")
    assert news.startswith(f"{NAME} ({version}) unstable; urgency=medium\n") and f" -- {control['Maintainer']}  " in news
    assert MADE or (control["Maintainer"] == "Someone Else <libshade@libshade.invalid>" and news.endswith("Fri, 02 Jan 1970 00:00:00 +0000\n"))
    readme = (unpacked / "README").read_text(encoding="utf-8")
    assert version in readme and "@" not in readme and max(map(len, readme.splitlines())) <= 100
    programs = {f"bin/{NAME}", f"lib/{NAME}/povray"}
    with tarfile.open(next(packed.glob("*.tar.xz"))) as archive:
        for item in archive:
            executable = item.isdir() or item.name.partition("/")[2] in programs
            assert (item.uid, item.gid, item.mode & 0o777) == (0, 0, 0o755 if executable else 0o644), item.name
            assert MADE or item.mtime == 86400, item.name
    listed = run("dpkg-deb", "--contents", next(packed.glob("*.deb"))).splitlines()
    assert {line.split()[0] for line in listed} == {"drwxr-xr-x", "-rwxr-xr-x", "-rw-r--r--"} and {line.split()[1] for line in listed} == {"root/root"}
    assert {line.split()[-1].removeprefix("./usr/") for line in listed if line.startswith("-rwx")} == programs


def test_manual_and_examples_are_of_the_package(unpacked):
    """Links to the glossary are words there, and commands on top of examples start the package's program."""
    folder = unpacked / f"share/doc/{NAME}"
    sources, terms = [ROOT / "docs/start/povray.md", *(ROOT / "docs/povray").glob("*.md")], 0
    assert files(folder / "manual") == {str(path.relative_to(ROOT / "docs")) for path in sources}
    for path in sources:
        text, page = (of.read_text(encoding="utf-8") for of in (path, folder / "manual" / path.relative_to(ROOT / "docs")))
        words = re.findall(r"{term}`([^`<]*?) *(?:<[^`>]*>)?`", text)
        terms += len(words)
        assert re.sub(r"{term}`([^`<]*?) *(?:<[^`>]*>)?`", r"\1", text) == page and all(word and word in page for word in words), path
    assert terms > 5
    examples = {path.name: path.read_text(encoding="utf-8") for path in (folder / "examples").iterdir()}
    assert set(examples) == {path.name for path in (ROOT / "examples/povray").glob("*/*.pov")} - {"suzanne.pov", "embossed.pov"}
    assert not any("build/" in text or "+L" in text for text in examples.values()) and "povray-libshade +Icloth.pov" in examples["cloth.pov"]


def test_sums_are_those_of_the_files(deb):
    run("md5sum", "--quiet", "-c", "DEBIAN/md5sums", cwd=deb)
    listed = {line.split(maxsplit=1)[1] for line in (deb / "DEBIAN/md5sums").read_text().splitlines()}
    assert listed == {name for name in files(deb) if not name.startswith("DEBIAN/")}


def test_archive_has_the_files_of_the_package(deb, unpacked):
    ours = {name.removeprefix("usr/") for name in files(deb) if name.startswith("usr/")}
    assert files(unpacked) == ours | {"README", f"share/doc/{NAME}/Apache-2.0.txt"}
    for name in ours:
        assert (unpacked / name).read_bytes() == (deb / "usr" / name).read_bytes(), name


def test_nothing_names_the_machine_it_was_made_on(unpacked):
    """Neither the folder of the tree nor that of the user."""
    places = {str(ROOT), os.path.expanduser("~"), str(ROOT.parent)} - {"/"}
    for name in files(unpacked):
        data = (unpacked / name).read_bytes()
        assert [place for place in places if f"{place}/".encode() in data] == [], name
    assert "RPATH" not in (dynamic := run("readelf", "-d", unpacked / f"lib/{NAME}/povray")) and "RUNPATH" not in dynamic


@renders
def test_archive_renders_from_where_it_lies(unpacked, tmp_path):
    """With its include files alone, though an old folder of settings is there."""
    home = tmp_path / "home of one"
    (home / ".povray/3.7").mkdir(parents=True)
    (home / ".povray/3.7/povray.ini").write_text("Width=3\nHeight=3\nOutput_File_Name=other.png\n")
    (tmp_path / "scene.pov").write_text(SCENE)
    environment = {"PATH": "/usr/bin:/bin", "HOME": str(home)}
    log = run(unpacked / f"bin/{NAME}", "+Iscene.pov", "+Oimage.exr", "+FE", "-D", "-V", cwd=tmp_path, env=environment)
    pixels = oiio.ImageBuf(str(tmp_path / "image.exr")).get_pixels(oiio.FLOAT)
    assert pixels.shape[:2] != (3, 3), log
    red, green, blue = pixels[..., :3].reshape(-1, 3).sum(0)
    assert green > 10 and (red / green, blue / green) == pytest.approx((2 / 9, 1 / 9), rel=1e-3)  # half floats


@renders
def test_a_link_to_the_program_finds_its_files(unpacked, tmp_path):
    (tmp_path / "pov").symlink_to(unpacked / f"bin/{NAME}")
    (tmp_path / "scene.pov").write_text(SCENE)
    run(tmp_path / "pov", "+Iscene.pov", "+Oimage.png", "+W8", "+H8", "-D", "-V", cwd=tmp_path)
    assert (tmp_path / "image.png").exists()


def test_same_bytes_twice(povray, tmp_path):
    """With another number of processors, other rights of new files, another place on Earth."""
    pack = PACK, povray
    run(*pack, tmp_path / "one")
    run("sh", "-c", 'umask 077 && TZ=Asia/Tokyo exec taskset -c 0 "$@"', "sh", *pack, tmp_path / "two")
    one, two = ({path.name: path.read_bytes() for path in (tmp_path / name).iterdir()} for name in ("one", "two"))
    assert len(one) == 2 and one == two


@renders
@pytest.mark.skipif(not shutil.which("lintian"), reason="lintian is not installed")
def test_lintian_finds_no_error():
    run("lintian", "--allow-root", "--fail-on", "error", "--tag-display-limit", "0", next(FOLDER.glob("*.deb")))
