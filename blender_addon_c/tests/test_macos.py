# SPDX-License-Identifier: GPL-3.0-or-later
"""The archives of `make macos`, which nothing here can run: what their programs and libraries are made for, what they need and show,
their signatures; that a program links with them; that Blender takes the add-on. Skipped where these are not built: `make check-macos` and
`make soak-machines` build them."""

import hashlib
import os
import re
import shlex
import shutil
import struct
import subprocess
import zipfile

import pytest

from blender_runs import BPY, BUILD, ROOT
from blender_runs import ZIP as LINUX

COST = 0.1  # where nothing was built; else 4

ALL = "BOTH" in os.environ  # in make check-macos
VERSION = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text())[1]
MINOR = VERSION.rsplit(".", 1)[0]
RELEASE = BUILD / "release"
ZIG = next(BUILD.glob("venv-release/lib/python3*/site-packages/ziglang"), None)
BUILT = [machine for machine in ("arm64", "x64") if (RELEASE / f"libshade-blender-{VERSION}-macos-{machine}.zip").exists()]
pytestmark = pytest.mark.skipif(not (len(BUILT) == 2 and ZIG and shutil.which("llvm-config")), reason="needs what make macos builds: make check-macos")

CPU = {"arm64": 0x0100000C, "x64": 0x01000007}
PROGRAM, DYLIB = 2, 6
ID_DYLIB, LOAD_DYLIB, SIGNATURE, RPATH, OLD_LEAST, LEAST = 0xD, 0xC, 0x1D, 0x8000001C, 0x24, 0x32
SYSTEM, CXX = "/usr/lib/libSystem.B.dylib", "/usr/lib/libc++.1.dylib"
# by name: what kind it is, how others name it, what it loads
FILES = {
    "shade": (PROGRAM, None, {SYSTEM}),
    "shade-render": (PROGRAM, None, {SYSTEM}),
    f"libshade.{MINOR}.dylib": (DYLIB, f"@rpath/libshade.{MINOR}.dylib", {SYSTEM}),
    "_native.abi3.so": (DYLIB, "@rpath/_native.abi3.so", {SYSTEM}),
    "libshade_openexrcore.dylib": (DYLIB, "@loader_path/libshade_openexrcore.dylib", {SYSTEM}),
    "libshade_embree.dylib": (DYLIB, "@loader_path/libshade_embree.dylib", {SYSTEM, CXX, "@loader_path/libshade_tbb.dylib"}),
    "libshade_tbb.dylib": (DYLIB, "@loader_path/libshade_tbb.dylib", {SYSTEM, CXX}),
}
# of zig's linker, in each that it makes
OWN_HEADER = {"__mh_dylib_header", "___dso_handle"}


def tool(name, *words):
    folder = subprocess.run(["llvm-config", "--bindir"], capture_output=True, text=True, check=True).stdout.strip()
    return subprocess.run([f"{folder}/llvm-{name}", *words], capture_output=True, text=True, check=True).stdout


@pytest.fixture(scope="module", params=["arm64", "x64"])
def unpacked(request, tmp_path_factory):
    """The machine, and the folder of all three archives."""
    folder = tmp_path_factory.mktemp(request.param)
    for name in ("libshade", "shade-render"):
        subprocess.run(["tar", "-xzf", RELEASE / f"{name}-{VERSION}-macos-{request.param}.tar.gz", "-C", folder], check=True)
    with zipfile.ZipFile(RELEASE / f"libshade-blender-{VERSION}-macos-{request.param}.zip") as archive:
        archive.extractall(folder)
    return request.param, folder


def loaded(folder):
    return [path for path in folder.rglob("*") if path.is_file() and path.read_bytes()[:4] == b"\xcf\xfa\xed\xfe"]


def only(folder, name):
    return [path for path in loaded(folder) if path.name == name][0]


def commands(data):
    count, = struct.unpack_from("<I", data, 16)
    at = 32
    for _ in range(count):
        kind, size = struct.unpack_from("<2I", data, at)
        yield kind, data[at:at + size]
        at += size


def text(command, at=8):
    """A command's string, which it says the place of."""
    begin, = struct.unpack_from("<I", command, at)
    return command[begin:].split(b"\0")[0].decode()


def signature_holds(data, begin):
    """Without a name, and for the bytes that are there: macOS on arm64 ends a program whose pages are others."""
    count, = struct.unpack_from(">I", data, begin + 8)
    at, = (at for kind, at in struct.iter_unpack(">2I", data[begin + 12:begin + 12 + 8 * count]) if kind == 0)
    directory = data[begin + at:]
    magic, _, _, flags, hashes, _, _, pages, limit = struct.unpack_from(">9I", directory)
    size, kind, _, page = directory[36:40]
    assert (magic, flags & 2, size, kind, limit) == (0xFADE0C02, 2, 32, 2, begin)
    assert pages == -(-limit // (1 << page))
    for k in range(pages):
        of = data[k << page:min((k + 1) << page, limit)]
        assert hashlib.sha256(of).digest() == directory[hashes + size * k:hashes + size * (k + 1)], f"page {k}"


def test_what_they_are(unpacked):
    machine, folder = unpacked
    assert {path.name for path in loaded(folder)} == set(FILES)
    for path in loaded(folder):
        data = path.read_bytes()
        wanted = FILES[path.name]
        assert struct.unpack_from("<I", data, 4) == (CPU[machine],) and struct.unpack_from("<I", data, 12) == (wanted[0],), path
        found = list(commands(data))
        assert {text(command) for kind, command in found if kind == LOAD_DYLIB} == wanted[2], path
        assert [text(command) for kind, command in found if kind == ID_DYLIB] == [wanted[1]] * (wanted[0] == DYLIB), path
        assert RPATH not in [kind for kind, _ in found], path
        least = [struct.unpack_from("<2I", command, 8) for kind, command in found if kind == LEAST]
        least = [version for platform, version in least if platform == 1] + [struct.unpack_from("<I", command, 8)[0] for kind, command in found if kind == OLD_LEAST]
        assert len(least) == 1 and least[0] <= 13 << 16, path
        signed = [struct.unpack_from("<I", command, 8)[0] for kind, command in found if kind == SIGNATURE]
        assert signed or machine == "x64", path
        for begin in signed:
            signature_holds(data, begin)
        assert str(ROOT).encode() not in data, path
        assert path.suffix in (".so", ".dylib") or path.stat().st_mode & 0o111


def names(path, *flags):
    return {line.split()[-1] for line in tool("nm", "--extern-only", *flags, path).splitlines() if line}


def test_what_they_show(unpacked):
    _, folder = unpacked
    headers = "".join(re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S) for path in (ROOT / "libshade/include/shade").glob("*.h"))
    declared = {"_" + name for name in re.findall(r"SHADE_API[^;(]*?\b(shade_\w+)\(", headers)}
    shown = {name: names(only(folder, name), "--defined-only") - OWN_HEADER for name in FILES}
    assert shown[f"libshade.{MINOR}.dylib"] == declared
    assert shown["_native.abi3.so"] == {"_PyInit__native"}
    # of what the renderer looks up by name, where it looks for it
    for source, name, function in (("blender_addon_c/native/scene/accel.c", "embree", r"\brtc[A-Z]\w+(?=\))"),
                                   ("libshade/dump/dump_exr.h", "openexrcore", r"\bexr_\w+(?=\))")):
        called = {"_" + word for word in re.findall(function, (ROOT / source).read_text())}
        called -= {"_rtcIntersectNp", "_rtcOccludedNp"}  # of Embree 3
        assert len(called) > 10 and called <= shown[f"libshade_{name}.dylib"], called - shown[f"libshade_{name}.dylib"]


def system(machine):
    """What it shows, as the SDK's stubs say, which zig has."""
    found, own = set(), {"arm64": {"arm64-macos", "arm64e-macos"}, "x64": {"x86_64-macos"}}[machine]
    for targets, symbols in re.findall(r"- targets: +\[(.*?)\]\s+(?:weak-)?(?:symbols|thread-local-symbols): +\[(.*?)\]",
                                       (ZIG / "lib/libc/darwin/libSystem.tbd").read_text(), flags=re.S):
        if own & set(re.split(r"[\s,]+", targets)):
            found.update(name.strip(" '") for name in re.split(r"[\n,]+", symbols))
    return found


def test_what_they_miss(unpacked):
    """Symbols of others: of macOS, each in its stubs; of Python, as any Python has them; of our own TBB."""
    machine, folder = unpacked
    stubs = system(machine)
    assert {"_malloc", "_pthread_create", "dyld_stub_binder"} <= stubs and "_malloc_usable_size" not in stubs
    python = os.path.realpath("/usr/bin/python3")
    of_python = {"_" + line.split()[-1] for line in subprocess.run(["nm", "-D", "--defined-only", python], capture_output=True, text=True,
                                                                      check=True).stdout.splitlines()}
    tbb = names(only(folder, "libshade_tbb.dylib"), "--defined-only")
    for path in loaded(folder):
        for line in tool("nm", "-m", "--undefined-only", path).splitlines():
            if not (of := re.search(r"external (\S+)(?: \(from ([\w+]+)\))?", line)):
                assert not line.strip(), line
                continue
            where = {"libSystem": stubs, "libshade_tbb": tbb, None: of_python}.get(of[2])
            assert of[2] == "libc++" or of[1] in where, f"{path}: {line}"
            assert of[2] or (path.name == "_native.abi3.so" and of[1].startswith(("_Py", "__Py"))), f"{path}: {line}"


def test_memory_is_counted(unpacked):
    """All that the renderer allocates passes memory.c: but for it nothing has the C library's functions by their names."""
    machine, _ = unpacked
    folder = BUILD / "macos" / machine / "module/wrapped/blender/native/obj"
    if not folder.exists():
        pytest.skip("built elsewhere")
    asked = {path: names(path, "--undefined-only") for path in folder.rglob("*.o")}
    own = {"_malloc", "_calloc", "_realloc", "_free"}
    assert [path.name for path, missed in asked.items() if missed & own] == ["memory.o"]
    assert sum("___wrap_free" in missed for missed in asked.values()) > 10


@pytest.mark.parametrize("how", ["shared", "static"])
def test_programs_link(unpacked, tmp_path, how):
    """That of the manual, as pkg-config says."""
    machine, folder = unpacked
    source, = re.findall(r"^```c\n(.*?)^```$", (ROOT / "docs/start/c.md").read_text(), flags=re.S | re.M)[:1]
    (tmp_path / "one.c").write_text(source)
    at = folder / f"libshade-{VERSION}-macos-{machine}"
    flags = shlex.split(subprocess.run(["pkg-config", "--cflags", "--libs", "libshade"], capture_output=True, text=True, check=True,
                                       env=os.environ | {"PKG_CONFIG_PATH": str(at / "lib/pkgconfig")}).stdout)
    if how == "shared":
        flags = [flag for flag in flags if flag != "-lshade"] + [str(at / f"lib/libshade.{MINOR}.dylib"), "-Wl,-rpath,@executable_path"]
    done = subprocess.run([ZIG / "zig", "cc", "-target", {"arm64": "aarch64", "x64": "x86_64"}[machine] + "-macos.13.0", "one.c", *flags, "-o", "one"],
                          cwd=tmp_path, capture_output=True, text=True, check=False,
                          env=os.environ | {f"ZIG_{which}_CACHE_DIR": str(RELEASE / "zig") for which in ("GLOBAL", "LOCAL")})
    assert done.returncode == 0, done.stderr
    needs = {text(command) for kind, command in commands((tmp_path / "one").read_bytes()) if kind == LOAD_DYLIB}
    assert needs == {SYSTEM} | ({f"@rpath/libshade.{MINOR}.dylib"} if how == "shared" else set())


def test_blender_finds_the_addon_valid(unpacked):
    machine, folder = unpacked
    assert f'platforms = ["macos-{machine}"]' in (folder / "libshade/blender_manifest.toml").read_text()
    checker, = BPY.parents[1].glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    subprocess.run([BPY, checker, "validate", RELEASE / f"libshade-blender-{VERSION}-macos-{machine}.zip"], check=True)


@pytest.mark.skipif(not ALL, reason="the add-on for Linux may be newer: make check-macos makes both")
def test_the_addon_is_linuxs_but_for_what_is_compiled(unpacked):
    machine, _ = unpacked
    compiled = re.compile(r".*\.(so|dylib)")
    with zipfile.ZipFile(RELEASE / f"libshade-blender-{VERSION}-macos-{machine}.zip") as ours, zipfile.ZipFile(LINUX) as linux:
        shared = [{name for name in archive.namelist() if not compiled.fullmatch(name)} for archive in (ours, linux)]
        assert shared[0] == shared[1]
        assert [name for name in shared[0] if ours.read(name) != linux.read(name)] == ["libshade/blender_manifest.toml"]
