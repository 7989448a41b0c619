# SPDX-License-Identifier: Apache-2.0
"""The archive of `make windows`, run by Wine: names, long paths, numbers, lines, damaged files as on Linux; programs that use
the library; what its files need. Skipped where it is not built: `make check-windows` and `make soak-machines` build it."""
import os
import random
import re
import shutil
import struct
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

COST = 0.1  # where nothing was built; else 15

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
SHADE = BUILD / "shade"
WINE = Path("/usr/lib/wine/wine64")
VERSION = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text())[1]
ZIP = BUILD / f"release/libshade-{VERSION}-windows-x64.zip"
CC = "x86_64-w64-mingw32-gcc-posix"
ENVIRONMENT = os.environ | {"WINEPREFIX": str(BUILD / "windows/wine"), "WINEDEBUG": "-all", "LC_ALL": "C.UTF-8",
                            "WINEDLLOVERRIDES": "mscoree,mshtml,winemenubuilder.exe="}
pytestmark = pytest.mark.skipif(not (ZIP.exists() and WINE.exists()), reason="needs Wine and what make windows builds: make check-windows")


@pytest.fixture(scope="module", autouse=True)
def wine():
    """One program of Windows that stays: else each of the others would start Wine's services, and wait for their end."""
    with subprocess.Popen([WINE, "cmd"], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=ENVIRONMENT) as stays:
        yield
        stays.stdin.close()


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    """In a folder whose name is no ASCII."""
    folder = tmp_path_factory.mktemp("установлено здесь")
    with zipfile.ZipFile(ZIP) as archive:
        archive.extractall(folder)
    return folder / f"libshade-{VERSION}-windows-x64"


@pytest.fixture(scope="module")
def shade(unpacked):
    def run(*words, **options):
        return subprocess.run([WINE, unpacked / "bin/shade.exe", *map(str, words)], capture_output=True, timeout=120, check=False,
                              env=ENVIRONMENT, **options)

    return run


def linux(*words, **options):
    return subprocess.run([SHADE, *map(str, words)], capture_output=True, timeout=120, check=False, **options)


def pixels(path):
    file = oiio.ImageInput.open(str(path))
    assert file, oiio.geterror()
    read = file.read_image(oiio.FLOAT)
    file.close()
    return read


def test_what_it_says(shade):
    said = shade("--version")
    assert said.returncode == 0 and said.stdout == linux("--version").stdout
    assert b"\r" not in shade("--help").stdout
    unknown = shade("sheen")
    assert unknown.returncode == 2 and b"unknown command 'sheen'" in unknown.stderr


@pytest.mark.parametrize("name", ["сатин пять.exr", "布の 織物.exr", "𠀋 é ü.png", "a" * 200 + ".exr"])
def test_names(shade, tmp_path, name):
    """Written, replaced, read again; nothing left beside it; as pictures, the same as Linux's."""
    folder = tmp_path / "папка" / "フォルダ ä"
    folder.mkdir(parents=True)
    own, other = folder / name, tmp_path / ("linux" + Path(name).suffix)
    for _ in range(2):
        done = shade("weave", "--name", "satin_5", "--size", 64, "-o", own)
        assert done.returncode == 0, done.stderr.decode()
    assert [path.name for path in folder.iterdir()] == [name]
    assert linux("weave", "--name", "satin_5", "--size", 64, "-o", other).returncode == 0
    assert np.abs(pixels(own) - pixels(other)).max() <= (1 / 255 if name.endswith("png") else 1e-6)


def test_long_paths(shade, tmp_path):
    """Far beyond 260 characters, absolute and from where it was started."""
    deep = tmp_path
    for k in range(9):
        deep = deep / f"{k}-длинное имя папки, of which there are many"
    deep.mkdir(parents=True)
    assert len(str(deep)) > 400
    draft = deep / "cloth.wif"
    shutil.copy(ROOT / "examples/weaves/denim.wif", draft)
    for path, options in ((deep, {}), (deep.relative_to(tmp_path), {"cwd": tmp_path})):
        done = shade("weave", "--draft", path / "cloth.wif", "--wif", path / "out.wif", **options)
        assert done.returncode == 0, done.stderr.decode()
        linux("weave", "--draft", draft, "--wif", tmp_path / "out.wif")
        assert (deep / "out.wif").read_bytes() == (tmp_path / "out.wif").read_bytes()
        (deep / "out.wif").unlink()
        done = shade("scratch", "--size", 32, "-o", path / "map.exr", **options)
        assert done.returncode == 0, done.stderr.decode()
        (deep / "map.exr").unlink()


def test_numbers_beyond_31_bits(shade, tmp_path):
    for command in (("scratch",), ("weave", "--name", "plain", "--vary-brightness", ".4")):
        seen = []
        for run, name in ((shade, "w.exr"), (linux, "l.exr")):
            for seed in (4294967295, 2147483647):
                done = run(*command, "--size", 48, "--seed", seed, "-o", tmp_path / name)
                assert done.returncode == 0, done.stderr.decode()
                seen.append(pixels(tmp_path / name))
        assert np.abs(seen[0] - seen[2]).max() <= 1e-6 and np.abs(seen[1] - seen[3]).max() <= 1e-6
        assert np.abs(seen[0] - seen[1]).max() > 1e-3
    done = shade("weave", "--name", "plain", "--seed", 4294967296, "-o", tmp_path / "w.exr")
    assert done.returncode == 2 and b"4294967296" in done.stderr


def test_lines(shade):
    """Of either ending, with the mark that editors of Windows begin files with."""
    lines = b"\xef\xbb\xbf0 0 1 .1 .2 .97\r\n# a comment\r\n\r\n.1 0 .99 0 0 1\n"
    got, want = (run("eval", input=lines) for run in (shade, linux))
    assert got.returncode == want.returncode == 0 and b"\r" not in got.stdout
    assert np.allclose(np.array(got.stdout.split(), float), np.array(want.stdout.split(), float), rtol=1e-12)
    got = shade("eval", input=b"0 0 1 0 0 1\r\n0 0 one\r\n")
    assert got.returncode == 1 and b"line 2: not a number" in got.stderr


def test_what_stands_in_the_way(shade, tmp_path):
    for path, said in ((tmp_path, b"Is a directory"), (tmp_path / "none" / "a.wif", b"No such file"), ("NUL", b"")):
        done = shade("weave", "--name", "plain", "--wif", path)
        assert done.returncode == (1 if said else 0) and said in done.stderr, done.stderr
    assert not list(tmp_path.iterdir())
    kept = tmp_path / "kept.wif"
    kept.write_bytes(b"kept")
    kept.chmod(0o444)  # Windows' own protection of a file, which Linux's folder would not respect
    done = shade("weave", "--name", "plain", "--wif", kept)
    assert (done.returncode == 1 and b"Permission denied" in done.stderr and kept.read_bytes() == b"kept") or kept.read_bytes()[:5] == b"[WIF]"
    assert [path.name for path in tmp_path.iterdir()] == ["kept.wif"]


def damaged(seed, data):
    generator = random.Random(seed)
    if seed % 3 == 0:
        return data[: generator.randrange(len(data))]
    data = bytearray(data)
    for _ in range(1 + seed % 7):
        at = generator.randrange(min(len(data), 3000))
        data[at] = generator.randrange(256)
    return bytes(data)


@pytest.fixture(scope="module")
def dump(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dump")
    flags = subprocess.run(["pkg-config", "--cflags", "OpenEXR"], capture_output=True, text=True, check=True).stdout.split()
    subprocess.run(["cc", "-O1", "-Ilibshade/include", "-Ilibshade", *flags, "libshade/test/makedump.c", "build/libshade_dump.a", "build/libshade.a",
                    "-lOpenEXRCore-3_1", "-lm", "-o", folder / "makedump"], cwd=ROOT, check=True)
    subprocess.run([folder / "makedump", folder / "dump.exr", "40", "30", "1"], check=True)
    return folder / "dump.exr"


def test_dumps(shade, dump):
    """The reference is as exact as on Linux: it judges the dump alike."""
    got, want = (run("check", dump, "--json") for run in (shade, linux))
    assert got.returncode == want.returncode == 0 and got.stdout.count(b"\n") == want.stdout.count(b"\n"), got.stderr.decode()


def test_damaged_files(shade, dump, tmp_path):
    """A message each, or an answer: no crash."""
    refused = 0
    for seed in range(60):
        of = (dump, ROOT / "examples/weaves/denim.wif")[seed % 2]
        path = tmp_path / f"повреждён{of.suffix}"
        path.write_bytes(damaged(seed, of.read_bytes()))
        done = shade(*(("check", path) if seed % 2 == 0 else ("weave", "--draft", path, "--print")))
        assert done.returncode in (0, 1), (seed, done.returncode, done.stderr)
        if done.returncode and not done.stdout:
            assert "повреждён" in done.stderr.decode(), (seed, done.stderr)
            refused += 1
    assert refused > 15


def program():
    return re.findall(r"^```c\n(.*?)^```$", (ROOT / "docs/start/c.md").read_text(), flags=re.S | re.M)[0]


@pytest.mark.parametrize("how", ["shared", "static", "cmake"])
def test_programs(unpacked, tmp_path, how):
    """That of the manual, compiled against the archive where it lies."""
    (tmp_path / "one.c").write_text(program())
    if how == "cmake":
        (tmp_path / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.16)\nproject(one C)\nfind_package(libshade 0.3 REQUIRED)\n"
                                                 "add_executable(one one.c)\ntarget_link_libraries(one libshade::libshade)\n")
        commands = [["cmake", "-S", ".", "-B", ".", "-DCMAKE_SYSTEM_NAME=Windows", f"-DCMAKE_C_COMPILER={CC}", f"-DCMAKE_PREFIX_PATH={unpacked}",
                     "-DCMAKE_FIND_ROOT_PATH_MODE_PACKAGE=BOTH"], ["cmake", "--build", "."]]
    else:
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "libshade"], capture_output=True, check=True,
                               env=os.environ | {"PKG_CONFIG_PATH": str(unpacked / "lib/pkgconfig")}).stdout
        words = [re.sub(rb"\\(.)", rb"\1", word) for word in re.split(rb"(?<!\\) ", flags.strip())]  # it escapes what is no ASCII
        commands = [[CC, "-D__USE_MINGW_ANSI_STDIO=1", "one.c", *(["-static"] if how == "static" else []), *words, "-lm", "-o", "one.exe"]]
    for command in commands:
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    if how != "static":
        shutil.copy(next((unpacked / "bin").glob("*.dll")), tmp_path)
    got = subprocess.run([WINE, tmp_path / "one.exe"], capture_output=True, text=True, env=ENVIRONMENT, check=True).stdout
    subprocess.run(["cc", "-I", ROOT / "libshade/include", "one.c", BUILD / "libshade.a", "-lm", "-o", "one"], cwd=tmp_path, check=True)
    want = subprocess.run([tmp_path / "one"], capture_output=True, text=True, check=True).stdout
    assert np.allclose([float(word) for word in got.split()], [float(word) for word in want.split()], rtol=1e-8)


def test_what_its_files_need(unpacked):
    """Nothing but Windows; the functions of the headers and no more; no moment at which they were made."""
    library, = (unpacked / "bin").glob("libshade-*.dll")
    for path in (library, unpacked / "bin/shade.exe"):
        data = path.read_bytes()
        header, = struct.unpack_from("<I", data, 0x3C)
        assert data[header:header + 6] == b"PE\0\0\x64\x86" and struct.unpack_from("<I", data, header + 8) == (0,)
        said = subprocess.run(["x86_64-w64-mingw32-objdump", "-p", path], capture_output=True, text=True, check=True).stdout
        assert {name.lower() for name in re.findall(r"DLL Name: (\S+)", said)} <= {"kernel32.dll", "msvcrt.dll", "shell32.dll"}
        assert str(ROOT).encode() not in data
    said = subprocess.run(["x86_64-w64-mingw32-objdump", "-p", library], capture_output=True, text=True, check=True).stdout
    text = "".join(re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S) for header in (ROOT / "libshade/include/shade").glob("*.h"))
    declared = set(re.findall(r"SHADE_API[^;(]*?\b(shade_\w+)\(", text))
    assert set(re.findall(r"^\s+\[\s*\d+\].*?\b(shade_\w+)$", said.split("[Ordinal/Name Pointer] Table")[1], re.M)) == declared
