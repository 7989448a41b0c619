# SPDX-License-Identifier: Apache-2.0
"""Set-up where there is no apt: what is missing is named as that system names it. And of the whole house: one version, and what is new
in it."""
import importlib.util
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from PIL import Image

COST = 1.5

ROOT = Path(__file__).resolve().parents[2]
SETUP = ROOT / "setup"
WORDS = "sh sed awk tr cat dirname printf env cc c++ gcc g++ as ld make pkg-config python3".split()
SYSTEMS = {"fedora": 'ID=fedora\n', "rocky": 'ID="rocky"\nID_LIKE="rhel centos fedora"\n', "arch": "ID=arch\n", "other": "ID=void\n"}


@pytest.fixture
def run(tmp_path):
    """apt.sh with programs WORDS and `more` alone, on one of SYSTEMS."""
    def run(system, *packages, more=()):
        folder = tmp_path / "bin"
        folder.mkdir()
        for word in (*WORDS, *more):
            found = shutil.which(word, path="/usr/bin:/bin")
            if found:
                (folder / word).symlink_to(found)
        (tmp_path / "os-release").write_text(SYSTEMS[system])
        listed = tmp_path / "packages.txt"
        listed.write_text("# a list\n" + "\n".join(packages) + "\n")
        return subprocess.run(["/bin/sh", SETUP / "apt.sh", listed], capture_output=True, text=True, cwd=tmp_path, check=False,
                              env={"PATH": str(folder), "OS_RELEASE": str(tmp_path / "os-release"), "LC_ALL": "C", **{
                                  name: os.environ[name] for name in ("USR",) if name in os.environ}})
    return run


def test_what_is_there_is_taken(run):
    done = run("fedora", "gcc", "libc6-dev", "make", "python3-venv", "patchelf", more=["patchelf"])
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("system, command", [("fedora", "sudo dnf install patchelf xorg-x11-server-Xvfb"),
                                             ("rocky", "sudo dnf install patchelf xorg-x11-server-Xvfb"),
                                             ("arch", "sudo pacman -S --needed patchelf xorg-server-xvfb")])
def test_what_is_missing_is_named(run, system, command):
    done = run(system, "gcc", "patchelf", "xvfb")
    names = command.removeprefix("sudo dnf install ").removeprefix("sudo pacman -S --needed ")
    assert (done.returncode, done.stdout) == (1, "") and done.stderr.splitlines() == [
        f"setup: this system has no apt, and these are missing: {names}", f"setup: install them and run make again: {command}"]


@pytest.mark.parametrize("script", ["apt.sh", "elsewhere.sh"])
def test_lists_are_wanted(script):
    done = subprocess.run([SETUP / script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "") and f"{script} " in done.stderr


def test_elsewhere_by_the_names_of_debian(run):
    done = run("other", "xvfb", "patchelf", "no-such-package")
    assert (done.returncode, done.stdout) == (1, "") and done.stderr.splitlines() == [
        "setup: this system has no apt, and these are missing: xvfb patchelf no-such-package", "setup: (Debian's names); install what brings them here and run make again"]


@pytest.mark.parametrize("system, package", [("fedora", "no-such-package"), ("arch", "no-such-package"), ("other", "no-such-package"), ("fedora", "libc6-dev-arm64-cross"), ("arch", "lintian")])
def test_one_that_nothing_is_known_of_is_missing(run, system, package):
    """Or that has no name there."""
    done = run(system, "gcc", package)
    assert done.returncode == 1 and f"missing: {package}\n" in done.stderr and "sudo" not in done.stderr


# by goal, what a machine that has nothing is given before make starts: lists of packages, setup/packages-NAME.txt, and environments of Python
NEEDED = {"demo": "blender build demo povray", "compare": "blender build demo povray", "compare-peers": "blender build demo peers povray",
          "pictures": "blender build demo povray", "manual-pictures": "blender build demo povray test", "bench": "build", "bench-pairs": "build",
          "bench-frames": "blender build demo povray", "blender": "blender build", "native": "blender build test", "render": "blender build",
          "povray": "build povray", "povray-package": "build package povray", "check-libshade": "build test", "check": "blender build", "lint": "lint",
          "release": "arm64 blender build macos release windows", "release-addon": "blender build release", "windows": "blender build windows",
          "macos": "blender build macos release", "check-windows": "blender build test windows", "check-arm64": "arm64 blender build test windows",
          "check-macos": "blender build macos release test", "povray lint": "build lint povray",
          "native-sanitized": "blender build test", "check-sanitized": "blender build test", "compare-quick": "blender build demo povray",
          "soak": "blender build package povray release test", "check-povray-package": "build package povray test", "check-povray-scenes": "build povray test",
          "soak-machines": "arm64 blender build macos release test windows", "fuzz": "blender build test", "clean": "", "all": ""}


def test_what_a_goal_needs():
    lines = re.findall(r"^NEEDS.*$", (SETUP / "setup.mk").read_text(encoding="utf-8"), re.M)
    goals = "\n".join(f"MAKECMDGOALS := {goals}\n{lines[-1]}\n$(info $(NEEDS))" for goals in NEEDED)
    own = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS"))}  # not those of `make check`
    said = subprocess.run(["make", "-f", "-", "end"], input="\n".join([*lines[:-1], goals, "end:;@:"]), env=own, capture_output=True, text=True, check=True).stdout
    assert dict(zip(NEEDED, said.splitlines())) == NEEDED


def test_help_lists_the_commands_and_clean_takes_what_they_made():
    """Of lines that a person types as they are; each is a goal."""
    def said(*words):
        return subprocess.run(["make", "--no-print-directory", "NEEDS=", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    rows = said("help").splitlines()
    assert all(row.startswith("make ") for row in rows) and len(rows) > 25
    goals = {re.match(r"make ([\w.-]*)", row)[1] for row in rows} - {""}
    text = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "Makefile", *ROOT.glob("*/*.mk")))
    assert {"demo", "check", "blender", "povray", "compare", "install", "clean"} <= goals
    assert all(re.search(rf"^[^\t#]*\b{re.escape(goal)}\b[^:=]*:", text, re.M) for goal in goals)
    assert said("-n", "B=some/where", "clean").split() == ["rm", "-rf", "some/where", "compile_commands.json"]


@pytest.mark.parametrize("size, cut", [((10, 40), (0, 30, 10, 40)), ((40, 10), (15, 0, 25, 10)), ((10, 10), (0, 0, 10, 10))])
def test_pictures_are_cut_at_their_sides_or_on_top(size, cut):
    spec = importlib.util.spec_from_file_location("pictures_of_readme", SETUP / "pictures.py")
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    whole = Image.new("L", size)
    whole.putdata([(7 * x + 3 * y) % 256 for y in range(size[1]) for x in range(size[0])])
    assert list(pictures.fitted(whole, 10, 10).getdata()) == list(whole.crop(cut).getdata())


def test_every_package_has_a_row():
    rows = [line.split() for line in (SETUP / "elsewhere.txt").read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    assert all(len(row) == 4 and ":" in row[1] for row in rows)
    known = [row[0] for row in rows]
    assert known == sorted(known, key=lambda name: name.replace("++", "")) and len(known) == len(set(known))
    for listed in SETUP.glob("packages-*.txt"):
        if listed.name != "packages-debian13.txt":  # of that system alone
            named = {word for line in listed.read_text(encoding="utf-8").splitlines() for word in line.split("#")[0].split()}
            assert named <= set(known), listed.name


# What stands for Debian's programs: packages in `installed` are; apt-get logs what it is asked and, `fails` times, fails; id says who
# it is.
DEBIAN = {"dpkg-query": 'for name; do :; done; if grep -qx "$name" installed; then printf installed; elif grep -qx "$name" removed; then printf config-files; '
                        'else exit 1; fi',
          "apt-get": 'echo "$*" >>log; case " $* " in *" install "*) if [ -s fails ]; then sed -i 1d fails; exit 1; fi; for w; do case $w in -*|install|A*|D*) ;; '
                     '*) echo "$w" >>installed ;; esac; done ;; esac',
          "id": "cat user", "sudo": 'echo sudo >>log; exec "$@"'}


@pytest.fixture
def debian(tmp_path):
    """apt.sh where the packages of `there` are installed, as root or not, with sudo or not: it, and what apt-get was asked."""
    def debian(*wanted, there=(), removed=(), root=True, sudo=False, fails=0):
        folder = tmp_path / "bin"
        if not folder.exists():
            folder.mkdir()
            for word in ("sh", "sed", "dirname", "printf", "env", "cat", "grep", "mkdir", "flock", "find", "touch"):
                (folder / word).symlink_to(shutil.which(word))
        for word, text in DEBIAN.items():
            (folder / word).unlink(missing_ok=True)
            if word != "sudo" or sudo:
                (folder / word).write_text(f"#!/bin/sh\n{text}\n")
                (folder / word).chmod(0o755)
        for name, text in (("installed", "".join(f"{name}\n" for name in there)), ("removed", "".join(f"{name}\n" for name in removed)), ("user", "0" if root else "1000"), ("fails", "x\n" * fails),
                           ("log", ""), ("packages.txt", "# a list\n" + "".join(f"{name} # why\n" for name in wanted))):
            (tmp_path / name).write_text(text)
        done = subprocess.run(["/bin/sh", SETUP / "apt.sh", "packages.txt"], capture_output=True, text=True, cwd=tmp_path, check=False,
                              env={"PATH": str(folder)})
        asked = [line.split() for line in (tmp_path / "log").read_text().splitlines()]
        return done, [words[-1] if "update" in words else " ".join(w for w in words if w in ("sudo", *wanted)) for words in asked]
    return debian


def test_debians_packages_are_installed(debian):
    """Those that are missing alone, by root or by sudo; lists are refreshed once an hour, and where an installation fails; nobody
    is asked for anything where all are there."""
    done, asked = debian("gcc", "make", there=("gcc", "make"), root=False)
    assert (done.returncode, done.stdout, done.stderr, asked) == (0, "", "", [])
    done, asked = debian("gcc", "make", there=["gcc"], root=False)
    assert done.returncode == 1 and asked == [] and "neither root nor sudo" in done.stderr
    assert "apt-get install --no-install-recommends make \n" in done.stderr
    done, asked = debian("gcc", "make", there=["gcc"])
    assert done.returncode == 0 and asked == ["update", "make"] and "installing Debian packages: make" in done.stdout
    assert debian("gcc", "make", "sed", root=False, sudo=True)[1] == ["sudo", "gcc make sed"]
    assert debian("gcc", "make", there=["gcc"], removed=["make"])[1] == ["make"]  # its settings are left there
    done, asked = debian("gcc", fails=1)
    assert done.returncode == 0 and asked == ["gcc", "update", "gcc"]
    done, asked = debian("gcc", fails=2)
    assert done.returncode == 1 and asked == ["gcc", "update", "gcc"] and "could not install: gcc" in done.stderr


@pytest.mark.parametrize("place", ["share", "local/share", "elsewhere"])
def test_files_of_packages(run, tmp_path, monkeypatch, place):
    """In /usr or, what a person installed, in /usr/local."""
    found = tmp_path / "usr" / place / "aclocal/ax_boost_base.m4"
    found.parent.mkdir(parents=True)
    found.touch()
    monkeypatch.setenv("USR", str(tmp_path / "usr"))
    assert run("fedora", "autoconf-archive").returncode == (place == "elsewhere")


@pytest.mark.skipif(not shutil.which("dpkg-query"), reason="no dpkg")
def test_signs_are_those_of_packages():
    """Here, where Debian's packages say which are installed: an installed one is found by its sign."""
    wanted = "gcc libc6-dev make pkg-config libopenexr-dev libpng-dev g++ libopenimageio-dev libembree-dev libtbb-dev python3-dev patchelf zlib1g-dev"
    state = {name: subprocess.run(["dpkg-query", "-W", "-f", "${db:Status-Status}", name], capture_output=True, text=True, check=False).stdout
             for name in wanted.split()}
    installed = [name for name, said in state.items() if said == "installed"]
    assert installed
    done = subprocess.run(["/bin/sh", SETUP / "elsewhere.sh", "/dev/stdin"], input="\n".join(installed), capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_one_version_everywhere():
    """That of shade.h, which the library, its pkg-config file, manual pages and POV-Ray's package are made by."""
    def found(file, pattern):
        return re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.M)[1]
    version = found("libshade/include/shade/shade.h", r'^#define SHADE_VERSION "(.*)"')
    assert found("blender_addon_c/blender_manifest.toml", r'^version = "(.*)"') == version
    assert found("blender_addon_c/__init__.py", r'^ *"version": \((.*)\),').replace(", ", ".") == version
    assert found("NEWS.md", r"^## (\S+)") == version
    for tool in ("shade", "shade-render"):
        if (ROOT / "build" / tool).exists():
            said = subprocess.run([ROOT / "build" / tool, "--version"], capture_output=True, text=True, check=True).stdout
            assert said.split()[:2] == [tool, version]


def test_news_are_short():
    releases = re.split(r"^## ", (ROOT / "NEWS.md").read_text(encoding="utf-8"), flags=re.M)[1:]
    assert releases and all(len(release.strip().splitlines()) <= 22 for release in releases)  # its name, an empty line, twenty
