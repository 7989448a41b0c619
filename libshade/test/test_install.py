# SPDX-License-Identifier: Apache-2.0
"""`make install`: what it puts where, that Python finds what is for it, that the programs of the manual compile against it by its commands, the interface, manual pages."""
import itertools
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

COST = 5.6

ROOT = pathlib.Path(__file__).resolve().parents[2]
HEADERS = sorted((ROOT / "libshade/include/shade").glob("*.h"))
MODULE = sorted(path for path in (ROOT / "libshade/python/shade").iterdir() if path.is_file())
PAGES = ("libshade.3", "shade.1")
# a make of its own, not a part of the one that may have started this
ENVIRONMENT = {key: value for key, value in os.environ.items()
               if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "PREFIX", "DESTDIR")}


def run(*command, **more):
    out = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                         env=ENVIRONMENT | more, cwd=ROOT, timeout=600)
    assert out.returncode == 0, f"{command}\n{out.stdout}{out.stderr}"
    return out.stdout


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()}


def version():
    return re.search(r'SHADE_VERSION "(.*)"', (HEADERS[0].parent / "shade.h").read_text())[1]


def expected(lib, man="share/man"):
    short = version().rsplit(".", 1)[0]
    return ({"bin/shade", "libexec/shade/shade_image_oiio.so", f"{lib}/pkgconfig/libshade.pc"}
            | {f"{lib}/cmake/libshade/libshadeConfig{end}.cmake" for end in ("", "Version")}
            | {f"bin/{name}" for name in ("shade-render", "libshade-farm") if (ROOT / "build" / name).exists()}
            | {f"{lib}/libshade.{end}" for end in ("a", "so", f"so.{short}", f"so.{version()}")}
            | {f"include/shade/{header.name}" for header in HEADERS}
            | {f"lib/python3/dist-packages/shade/{name}"
               for name in ("library.txt", *(path.name for path in MODULE))}
            | {f"{man}/man{page[-1]}/{page}" for page in PAGES})


@pytest.fixture(scope="module")
def prefix(tmp_path_factory):
    folder = tmp_path_factory.mktemp("installed")
    run("make", "install", f"PREFIX={folder}")
    return folder


def test_files(prefix):
    assert files(prefix) == expected("lib")
    for path in prefix.rglob("*"):
        if not path.is_symlink():
            mode = 0o755 if path.is_dir() or path.parent.name == "bin" else 0o644
            assert path.stat().st_mode & 0o777 == mode, path
    for end in ("", f".{version().rsplit('.', 1)[0]}"):  # both names lead to the library
        assert os.path.realpath(prefix / f"lib/libshade.so{end}") == os.path.realpath(prefix / f"lib/libshade.so.{version()}") and \
            (prefix / f"lib/libshade.so{end}").exists(), end
    # what was installed needs nothing of the place where it was built
    for path in ("pkgconfig/libshade.pc", "cmake/libshade/libshadeConfig.cmake"):
        assert str(ROOT) not in (prefix / "lib" / path).read_text()
    assert run(prefix / "bin/shade", "--version").startswith(f"shade {version()} (")


def shades(folder, library, elsewhere):
    """Whether the module in that folder calls that library, and gets the peak that it should."""
    script = ("import shade; print(shade.library, shade.D(shade.Material(ex=200, ey=10), None, [0, 0, 1.])"
              " * 2 * 3.141592653589793)")
    found, peak = subprocess.run([sys.executable, "-B", "-c", script], capture_output=True, text=True, check=True,
                                 cwd=elsewhere, env=ENVIRONMENT | {"PYTHONPATH": str(folder)}).stdout.split()
    return os.path.realpath(found) == os.path.realpath(library) and float(peak) == pytest.approx(math.sqrt(201 * 11))


def test_python_module(prefix, tmp_path):
    """It finds the library that was installed with it, from anywhere, and when both were moved."""
    moved = tmp_path / "moved"
    shutil.copytree(prefix, moved, symlinks=True)
    for place in (prefix, moved):
        assert shades(place / "lib/python3/dist-packages", place / f"lib/libshade.so.{version()}", tmp_path)
    found = list((prefix / "lib/python3/dist-packages/shade").iterdir())
    assert {path.name for path in found} == {"library.txt", *(path.name for path in MODULE)}


def test_wheel(tmp_path):
    """Its library lies beside its module; for any Python of this kind of machine."""
    python = "/usr/bin/python3"
    if subprocess.run([python, "-c", "import setuptools, wheel, pip"], capture_output=True, check=False).returncode:
        pytest.skip("no pip, setuptools or wheel for /usr/bin/python3 (in setup/packages-test.txt)")
    run(python, "-m", "pip", "install", "--no-index", "--no-deps", "--no-build-isolation", "--no-compile", "--target", tmp_path,
        ROOT / "libshade/python")
    library = f"libshade.so.{version()}"
    assert files(tmp_path / "shade") == {"Apache-2.0.txt", "library.txt", library, *(path.name for path in MODULE)}
    about = (tmp_path / f"libshade-{version()}.dist-info/WHEEL").read_text(encoding="utf-8")
    assert re.search(r"^Tag: cp310-abi3-linux_", about, re.M), about
    assert shades(tmp_path, tmp_path / "shade" / library, tmp_path)


@pytest.mark.parametrize("where", ["/usr/local", "/usr"])
def test_python_looks_there(tmp_path, where):
    """Below the usual prefixes the system's Python finds the module without being told."""
    run("make", "install", f"DESTDIR={tmp_path}", f"PREFIX={where}")
    found, = tmp_path.glob("usr/**/shade/__init__.py")
    folder = "/" + str(found.parents[1].relative_to(tmp_path))
    assert folder in run("/usr/bin/python3", "-c", "import site; print(*site.getsitepackages())").split()


def test_destdir_and_uninstall(tmp_path):
    where = [f"DESTDIR={tmp_path}", "PREFIX=/opt/shade", "LIBDIR=/usr/lib/some-triplet",
             "MANDIR=/usr/man", "PYTHONDIR=/opt/shade/lib/python3/dist-packages"]
    run("make", "install", *where)
    strange = tmp_path / "opt/shade/include/shade/mine.h"
    strange.write_text("/* not libshade's */\n")
    want = {os.path.normpath(f"opt/shade/{name}")
            for name in expected("../../usr/lib/some-triplet", "../../usr/man")}
    assert files(tmp_path) == want | {"opt/shade/include/shade/mine.h"}
    pc = (tmp_path / "usr/lib/some-triplet/pkgconfig/libshade.pc").read_text()
    assert "libdir=/usr/lib/some-triplet\n" in pc and "includedir=${prefix}/include\n" in pc
    assert str(tmp_path) not in pc
    place = (tmp_path / "opt/shade/lib/python3/dist-packages/shade/library.txt").read_text()
    assert place == f"../../../../../../usr/lib/some-triplet/libshade.so.{version()}\n"
    cache = tmp_path / "opt/shade/lib/python3/dist-packages/shade/__pycache__"
    cache.mkdir()
    (cache / "__init__.cpython-311.pyc").touch()
    run("make", "uninstall", *where)
    assert files(tmp_path) == {"opt/shade/include/shade/mine.h"}
    strange.unlink()
    run("make", "uninstall", *where)  # once more does no harm
    assert not (tmp_path / "opt/shade/include/shade").exists()


def declared():
    text = "".join(header.read_text() for header in HEADERS)
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return set(re.findall(r"SHADE_API[^;(]*?\b(shade_\w+)\(", text))


def test_exports(prefix):
    """The shared library offers the functions of the headers and not one symbol more."""
    library = prefix / "lib" / f"libshade.so.{version()}"
    lines = run("nm", "-D", "--defined-only", library).splitlines()
    short = version().rsplit(".", 1)[0]
    node, *names = sorted(line.split()[-1] for line in lines)
    assert node == f"LIBSHADE_{short}" and names == sorted(f"{name}@@{node}" for name in declared())
    assert len(declared()) > 20
    dynamic = run("readelf", "-d", library)
    assert f"[libshade.so.{short}]" in dynamic and "TEXTREL" not in dynamic
    needed = set(re.findall(r"NEEDED.*\[(.*)\]", dynamic))
    assert all(name.startswith(("libm.", "libc.")) for name in needed), needed


def programs(*pages):
    """Of C, of pages of the manual."""
    text = "\n".join((ROOT / f"docs/{page}.md").read_text() for page in pages)
    return re.findall(r"^```c\n(.*?)^```$", text, flags=re.S | re.M)


FIRST = programs("start/c", "library/guide")
COOKBOOK = programs("library/cookbook")


def blocks(kind):
    """What the page prints of that kind about building."""
    text = (ROOT / "docs/library/guide.md").read_text().split("\n## Build against it")[1].split("\n## ")[0]
    return re.findall(rf"^```{kind}\n(.*?)^```$", text, flags=re.S | re.M)


LINKINGS = ("shared", "static", "c++", "cmake", "go")


def run_program(source, prefix, folder, linking):
    """Compiles a program of the manual against what is installed, by its own command, without a warning; what it prints."""
    (folder / "program.c").write_text(source)
    environment = dict(PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"), LD_LIBRARY_PATH=str(prefix / "lib"),
                       CFLAGS="-std=c11 -Wall -Wextra -Wconversion -Werror")
    assert run("pkg-config", "--modversion", "libshade", **environment).strip() == version()
    command = blocks("sh")[LINKINGS.index(linking)]
    if linking == "cmake":  # which names the folder of start/c
        (folder / "libshade").unlink(missing_ok=True)
        (folder / "libshade").symlink_to(prefix)
        environment["HOME"] = str(folder)
    else:
        # C++17, so without C's designated initialisers and enumerations as integers
        warnings = environment["CFLAGS"].replace("c11", "c++17" if linking == "c++" else "c11")
        command = re.sub(r"^(cc|c\+\+) ", rf"\1 {warnings} ", command)
    run("sh", "-ec", f"cd {folder}\n{command}", **environment)
    return run(folder / ("made/program" if linking == "cmake" else "program"), **environment).split()


def brdf_at(half):
    """f of the programs of the manual at a half vector that lies `half` radians along x from n, by hand.

    The default horizon has nothing to bend here (the mirror image of wo is 57 degrees from z),
    and fades light along n, of slope 3/4, by Smith's shadow for alpha^2 = (3/4)^2/8."""
    peak = math.sqrt(201 * 11) / (2 * math.pi)
    shadow = 2 / (1 + math.sqrt(1 + .75 ** 4 / 8))
    return shadow * peak * math.cos(half) ** 200 / (4 * math.cos(half) * 1)


def indented(page, first):
    """The lines of code of a page that begin with that word, as they are typed."""
    text = (ROOT / f"docs/{page}.md").read_text()
    return "".join(f"{line.strip()}\n" for line in re.search(rf"(?:^ +\S.*\n)*^ +{first}\b.*\n(?:^ +\S.*\n)*", text, re.M)[0].splitlines())


def test_first_program_by_the_page(prefix, tmp_path):
    """C in five minutes, word for word: the file of that name, the commands, what it prints."""
    (tmp_path / "libshade").symlink_to(prefix)  # where the page installs it
    page = (ROOT / "docs/start/c.md").read_text()
    assert "make install PREFIX=$HOME/libshade" in page
    (tmp_path / re.search(r"Write this into `([\w.]+)`", page)[1]).write_text(FIRST[0])
    out = run("sh", "-ec", f"cd\n{indented('start/c', 'cc')}", HOME=str(tmp_path)).split()
    assert float(out[0]) == pytest.approx(brdf_at((math.asin(.6) - math.asin(.28)) / 2), rel=1e-8) and out[2] == "0"


def test_printed_answers():
    """What pages print below a command of the tool, it prints."""
    asked = 0
    for page in ("library/tool", "povray/reference", "library/guide"):
        for command, said in re.findall(r"^    \$ (.*build/shade .*)\n((?:    [^$\n].*\n)+)", (ROOT / f"docs/{page}.md").read_text(), re.M):
            assert run("sh", "-ec", command).split() == said.split(), command
            asked += 1
    assert asked
    assert run("sh", "-ec", indented("start/checking", "echo")).split() == ["7.4836678345783225"]


@pytest.mark.parametrize("which, linking", [(0, "static"), (0, "c++"), (1, "shared"), (1, "c++")])
def test_library_page_programs(prefix, tmp_path, which, linking):
    assert len(FIRST) == 2
    source = FIRST[which]
    body = source.split("int main(void) {\n")[1].split("\n}")[0].splitlines()
    assert len(body) <= 15, "the page promises a few lines"
    out = run_program(source, prefix, tmp_path, linking)
    # wi is n itself, wo lies 20.6 degrees from it in the plane of x and z, h in the middle
    half = (math.asin(.6) - math.asin(.28)) / 2
    close = 1e-8 if which == 0 else 2e-5
    assert float(out[0]) == pytest.approx(brdf_at(half), rel=close)
    assert float(out[1]) == pytest.approx(1, abs=1e-6) and out[2] == "0"


def test_cmake_package(prefix, tmp_path):
    """What the page prints, of a tree that was moved; a minor release beside is refused."""
    if not shutil.which("cmake"):
        pytest.skip("no cmake here (in setup/packages-test.txt)")
    moved = tmp_path / "moved"
    shutil.copytree(prefix, moved, symlinks=True)
    text, = blocks("cmake")
    (tmp_path / "CMakeLists.txt").write_text(text)
    out = run_program(FIRST[0], moved, tmp_path, "cmake")
    assert out == run_program(FIRST[0], prefix, tmp_path, "shared")
    assert str(moved / "lib") in run("readelf", "-d", tmp_path / "made/program")
    # the other library, and what the page's versions are good for
    (tmp_path / "CMakeLists.txt").write_text(text.replace("libshade::libshade m", "libshade::static"))
    assert run_program(FIRST[0], moved, tmp_path, "cmake") == out
    assert "libshade" not in run("readelf", "-d", tmp_path / "made/program")
    major, minor, _ = version().split(".")
    for asked, fits in ((f"{major}.{minor}", 1), (version(), 1), (f"{major}.{int(minor) + 1}", 0), (f"{major}.{minor}.99", 0)):
        (tmp_path / "asked.cmake").write_text(f"set(PACKAGE_FIND_VERSION {asked})\n" + "".join(
            f"set(PACKAGE_FIND_VERSION_{part} {n})\n" for part, n in zip(("MAJOR", "MINOR"), asked.split("."))) + (
            f"include({moved}/lib/cmake/libshade/libshadeConfigVersion.cmake)\n"
            "if(PACKAGE_VERSION_COMPATIBLE)\nmessage(FATAL_ERROR fits)\nendif()\n"))
        words = ["cmake", "-P", str(tmp_path / "asked.cmake")]
        assert ("fits" in subprocess.run(words, capture_output=True, text=True).stderr) == fits, asked


def test_go_by_cgo(prefix, tmp_path):
    """The page's program of Go prints what that of C does."""
    go = shutil.which("go") or next(map(str, sorted(pathlib.Path("/usr/bin").glob("go-[0-9]*"))), None)
    if not go:
        pytest.skip("no Go here (gccgo has one)")
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/go").symlink_to(go)
    (tmp_path / "program.go").write_text(blocks("go")[0])
    source = FIRST[0]
    folder = tmp_path / "c"
    folder.mkdir()
    want = run_program(source, prefix, folder, "shared")
    run("sh", "-ec", f"cd {tmp_path}\n{blocks('sh')[LINKINGS.index('go')]}", HOME=str(tmp_path), GOCACHE=str(tmp_path / "cache"),
        GO111MODULE="off", PATH=f"{tmp_path}/bin:{os.environ['PATH']}", PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"))
    assert run(tmp_path / "program", LD_LIBRARY_PATH=str(prefix / "lib")).split() == want


def test_interface(tmp_path):
    """The text of the interface is that of the library: what was meant to change is written by `make abi`."""
    if not shutil.which("abidiff"):
        pytest.skip("no abidiff here (abigail-tools, in setup/packages-test.txt)")
    kept, now = ROOT / "libshade/abi/libshade.abi", tmp_path / "now.abi"
    run("make", "abi", f"ABI={now}", "NEEDS=")
    run("abidiff", kept, now)
    # it would be seen
    swapped = re.sub(r"'SHADE_BRDF_WARD_(1992|DUR)'", lambda name: "'SHADE_BRDF_WARD_%s'" % {"1992": "DUR", "DUR": "1992"}[name[1]],
                     now.read_text())
    now.write_text(swapped)
    assert subprocess.run(["abidiff", kept, now], capture_output=True).returncode


def answers(command, queries):
    """Of the tool, a row of numbers for each query."""
    text = "".join(" ".join(f"{x!r}" for x in query) + "\n" for query in queries)
    words = [str(ROOT / "build/shade"), *command]
    out = subprocess.run(words, input=text, capture_output=True, text=True, check=True, timeout=600)
    return [[float(x) for x in line.split()] for line in out.stdout.splitlines()]


@pytest.mark.parametrize("linking", ["shared", "c++"])
def test_library_page_path_tracer(prefix, tmp_path, linking):
    """Light of its lamp, by the reference over a lattice in it."""
    source = COOKBOOK[0]
    out = run_program(source, prefix, tmp_path, linking)
    rings, spokes, queries = 60, 90, []
    for i in range(rings * spokes):
        z = 1 - (i // spokes + .5) / rings * .02
        r, phi = math.sqrt(1 - z * z), (i % spokes + .5) * 2 * math.pi / spokes
        wi = (.8 * r * math.cos(phi) + .6 * z, r * math.sin(phi), -.6 * r * math.cos(phi) + .8 * z)
        queries.append((.28, 0., .96, *wi, 0., 0., 1.))
    found = answers(["eval", "--what", "f", "--precision", "reference", "--ax", "0.05", "--ay", "0.4"], queries)
    cosines = [.28 * q[3] + .96 * q[5] for q in queries]
    truth = sum(f * c for (f,), c in zip(found, cosines)) / len(queries) * 2 * math.pi * .02
    assert float(out[0]) == pytest.approx(truth, rel=.01)


def test_library_page_cloth(prefix, tmp_path):
    """As one call for each light says, and as much of a white sky as a lattice over it."""
    source = COOKBOOK[1]
    out = [float(x) for x in run_program(source, prefix, tmp_path, "shared")]
    ends, picks = (float(re.search(rf"([\d.]+) {what}", run(ROOT / "build/shade", "presets", "denim"))[1])
                   for what in ("ends", "picks"))
    at = (1.25 * ends, 2.5 * picks, 5.)
    assert out[:6] == pytest.approx(sum(answers(["fabric", "denim"], [
        (*at, .6, 0., .8, 0., 0., 1.), (*at, 0., -.6, .8, 0., 0., 1.)]), []), rel=1e-8)
    rings, spokes, queries = 60, 60, []
    for i in range(rings * spokes):
        z, phi = (i // spokes + .5) / rings, (i % spokes + .5) * 2 * math.pi / spokes
        r = math.sqrt(1 - z * z)
        queries.append((*at, r * math.cos(phi), r * math.sin(phi), z, 0., 0., 1.))
    white = sum(s[2] for s in answers(["fabric", "denim"], queries)) / len(queries) * 2 * math.pi
    assert out[6] == pytest.approx(white, rel=.02)


def test_library_page_albedo(prefix, tmp_path):
    """As a lattice of half vectors about n says, by the reference and the numbers of the preset."""
    out = run_program(COOKBOOK[2], prefix, tmp_path, "shared")
    metal = json.loads(run(ROOT / "build/shade", "presets", "brushed_steel", "--json"))["material"]
    options = [word for name in ("mdf", "detail", "horizon", "ex", "ey") for word in (f"--{name}", str(metal[name]))]
    n, across, step, queries, weights = (.28, 0., .96), (.96, 0., -.28), .01, [], []
    for i, j in itertools.product(range(-36, 37), range(-84, 85)):
        h = [n[k] + i * step * across[k] + j * step * (k == 1) for k in range(3)]
        length = math.hypot(*h)
        h = [x / length for x in h]
        wi = [2 * h[2] * x for x in h[:2]] + [2 * h[2] * h[2] - 1]
        cosine = sum(a * b for a, b in zip(n, wi))
        if h[2] > 0 and wi[2] > 0 and cosine > 0:
            queries.append((*n, *wi, 0., 0., 1.))
            weights.append(cosine * 4 * h[2] * step**2 / length**3)
    for k in range(3):  # red, green, blue
        found = answers(["eval", "--what", "f", "--precision", "reference", *options, "--eta", str(metal["eta"][k]), "--k", str(metal["k"][k])], queries)
        assert float(out[k]) == pytest.approx(sum(f * w for (f, *_), w in zip(found, weights)), rel=.005)


@pytest.mark.parametrize("page", PAGES)
def test_manual_pages(prefix, page):
    """They are well formed, and say of every function and of every option what the headers and the tool say."""
    assert shutil.which("groff"), "groff-base is in setup/packages-test.txt"
    path = prefix / f"share/man/man{page[-1]}/{page}"
    out = subprocess.run(["groff", "-ww", "-man", "-Tutf8", "-z", str(path)], capture_output=True, text=True)
    assert out.returncode == 0 and not out.stderr, out.stderr
    text = path.read_text()
    assert f'"libshade {version()}"' in text and "@" not in re.sub(r"@endcode|@code", "@", text)
    plain = text.replace("\\-", "-").replace("\\e", "\\").replace("\n\\&", "\n")
    if page == "libshade.3":
        assert {name for name in declared() if re.search(rf"\b{name}\(", plain)} == declared()
        described = set(re.findall(r"^\.SS (shade_\w+)", plain, flags=re.M))
        assert {name for name in declared() if name not in described and name[:-1] not in described} == set()
        assert set(re.findall(r"<shade/(\w+\.h)>", plain)) == {header.name for header in HEADERS} - {"table.h"}
        assert "SHADE_BRDF_WARD_BOUNDED, SHADE_BRDF_MICROFACET, SHADE_BRDF_AUTO." in plain
    else:
        help_text = run(ROOT / "build/shade", "--help")
        commands = re.findall(r"^  (\w+)  ", help_text, flags=re.M)
        assert set(re.findall(r"^\.SS shade (\w+)", plain, flags=re.M)) == set(commands)
        for command in commands:
            assert run(ROOT / "build/shade", command, "--help").replace("…", "...") in plain, command
