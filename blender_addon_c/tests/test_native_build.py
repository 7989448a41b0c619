# SPDX-License-Identifier: GPL-3.0-or-later
"""The module as a binary: packed arithmetic, its own libraries, sanitizers.

Skipped where NATIVE_MODULE names another build.
"""

import functools
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from native_scenes import MODULE, ROOT, native, render, scene

COST = 5.1
ALONE = {"test_all_tests_under_sanitizers": 183}

pytestmark = pytest.mark.skipif("NATIVE_MODULE" in os.environ, reason="tests the release build")

HERE = Path(__file__).parent
# all but flat, which only sets numbers, scatter, which moves them, and one by one in AVX2, and attribute, which fetches
# those of each lane's object through a pointer
KINDS = native.table()  # each has a stage of its name
STAGES = """pixel_cone width spread camera locate gather corner surface pair lit shadow reflect film""".split()
STAGES += "route_hit pixel footprint place_samples choose escape sky sky_pdf sky_draw".split()
STAGES += [kind.lower() for kind in KINDS["lights"] + KINDS["nodes"] if kind not in ("CLOTH", "RELIEF", "SCRATCHES", "ATTRIBUTE")]  # three all libshade's
STAGES += [what + kind.lower() for kind in KINDS["lights"] for what in ("hit_", "chosen_")]
BPY_LIBRARIES = next((ROOT / "build/venv-bpy").glob("lib/python3*/site-packages/bpy/lib"), ROOT / "build/venv-bpy/none")

# arithmetic on whole registers; moving them about does not count
PACKED = re.compile(
    r"^v?(add|sub|mul|div|sqrt|fn?m(add|sub)\d+|min|max|cvtt?)\w*?(ps|dq2ps|ps2dq)$"
    r"|^v?p(add|sub|mul|mull|or|and|cmp|blend)\w*$"
)
# what compilers make of loops that only move or clear
COPIES = {"memcpy", "memmove", "memset"}
MOVING = {"place_samples": re.compile("gather|^v?insert|^v?unpck"), "gather": re.compile("gather|^v?insert|^v?unpck")}


@functools.cache  # asked for each stage
def disassembly(isa):
    """{function: [(mnemonic, operands)]} of the stages' translation units."""
    listing = subprocess.run(
        ["objdump", "-dr", "--no-show-raw-insn", *map(str, (MODULE.parent / f"obj/isa/{isa}").glob("*.o"))],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    functions, current = {}, None
    for line in listing.splitlines():
        head = re.match(r"^[0-9a-f]+ <([\w.]+)>:$", line)
        if head:
            current = functions.setdefault(head.group(1).split(".")[0], [])
        elif current and "R_X86_64_" in line and current[-1][0].startswith("call"):  # whom
            current[-1] = (current[-1][0], re.split(r"[-+]0x", line.split()[-1])[0])
        elif current is not None and "\t" in line and "R_X86_64_" not in line:
            words = line.split("\t")[1].split(None, 1)
            current.append((words[0], words[1] if len(words) > 1 else ""))
    return functions


@pytest.mark.parametrize("isa, register", [("avx512", "%zmm"), ("avx2", "%ymm")])
@pytest.mark.parametrize("stage", STAGES)
def test_stage_computes_in_whole_registers(isa, register, stage):
    body = disassembly(isa)["stage_" + stage]
    if stage == "corner":  # a row of 8 floats is a ymm in both
        register = "%ymm"
    wanted = MOVING.get(stage, PACKED)
    found = [name for name, operands in body if wanted.search(name) and register in operands]
    assert len(found) >= 1, f"{stage}: no packed arithmetic among {len(body)} instructions"
    calls = [operands for name, operands in body if name.startswith("call")]
    assert set(calls) <= COPIES, f"{stage} calls {calls}"


@pytest.mark.parametrize("isa, register", [("avx512", "%zmm"), ("avx2", "%ymm")])
def test_no_variant_of_a_stage_is_left_scalar(isa, register):
    """In each of three wrappings, of normal maps two roots and a third for what a point covers; of images three
    channels' of sRGB, from bytes and floats, bilinear and cubic (there in two loops), and for what a point covers
    four: from both, placed or not. Cubic and wide images' texels; a ramp's places; two sample numbers in each of four
    cameras; three roots for the point of a light that has an extent and one for its middle; of the formulas six that
    have roots."""
    for stage, word, count in (("normal_map", "sqrtps", 3 * 5), ("image", "gather", 24), ("image", "sqrtps", 3 * 27),
                               ("ramp", "cvttps2dq", 1), ("math", "sqrtps", 6), ("camera", "cvtdq2ps", 8),
                               ("point", "sqrtps", 4)):
        body = disassembly(isa)["stage_" + stage]
        assert sum(word in name and register in operands for name, operands in body) >= count


def test_only_the_module_itself_is_exported():
    names = subprocess.run(
        ["nm", "-D", "--defined-only", str(MODULE)], capture_output=True, text=True, check=True
    ).stdout.split()
    assert names[2::3] == ["PyInit__native"]


def test_stable_abi_only():
    """One binary for all Pythons: no private symbol, and no library of a certain version."""
    undefined = subprocess.run(
        ["nm", "-D", "--undefined-only", str(MODULE)], capture_output=True, text=True, check=True
    ).stdout.split()
    used = {name for name in undefined if name.startswith(("Py", "_Py"))}
    assert "PyObject_GetBuffer" in used
    # the underscored ones that its macros stand for
    stable = {"_Py_NoneStruct", "_Py_TrueStruct", "_Py_FalseStruct", "_Py_Dealloc", "_PyArg_ParseTuple_SizeT", "_Py_BuildValue_SizeT"}
    assert {name for name in used if name.startswith("_Py")} <= stable
    needed = subprocess.run(
        ["readelf", "-d", str(MODULE)], capture_output=True, text=True, check=True
    ).stdout
    assert not re.search("embree|OpenEXR|tbb|libpython", needed)


def run(code, **environment):
    """A new Python that can import native_scenes."""
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=HERE,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=120,
    )


PICTURE = """
import sys, numpy as np
from native_scenes import render, scene, dump
picture, _ = render(scene())
planes, _ = dump(scene(), sys.argv[1] if len(sys.argv) > 1 else "{dump}")
assert (planes["material.ID"] == 0).all()
np.save("{picture}", picture)
maps = open("/proc/self/maps").read()
print("\\n".join(sorted(set(line.split(None, 5)[5] for line in maps.splitlines() if "/" in line))))
"""


def picture_elsewhere(tmp_path, **environment):
    file = tmp_path / "picture.npy"
    done = run(PICTURE.format(dump=tmp_path / "d.exr", picture=file), **environment)
    assert done.returncode == 0, done.stderr
    return np.load(file), done.stdout.splitlines()


def test_own_libraries_are_used(tmp_path):
    """Not the system's: they may be absent or other versions."""
    _, maps = picture_elsewhere(tmp_path)
    own = MODULE.parent / "lib"
    for name in ("libshade_embree.so", "libshade_tbb.so", "libshade_openexrcore.so"):
        assert str(own / name) in maps
    names = [Path(path).name for path in maps]
    assert not [n for n in names if re.match("libembree|libtbb.so|libOpenEXR", n)]
    # and what they need is each other and what every system has
    for library in own.iterdir():
        needed = subprocess.run(
            ["readelf", "-d", str(library)], capture_output=True, text=True, check=True
        ).stdout
        for name in re.findall(r"NEEDED.*\[(.*)\]", needed):
            assert name.startswith(
                ("libc.", "libm.", "libgcc_s", "libstdc++", "libz.", "ld-linux", "libshade_tbb")
            ), name


@pytest.mark.skipif(
    not BPY_LIBRARIES.exists(), reason="build/venv-bpy is not there: make setup-test"
)
def test_other_libraries_in_the_global_scope(tmp_path):
    """bpy's Embree 4, TBB and OpenEXRCore first and global, as official Blenders have them."""
    expected, _ = render(scene())
    foreign = [
        next(BPY_LIBRARIES.glob(pattern))
        for pattern in ("libembree4.so*", "libOpenEXRCore.so*", "libtbb.so*")
    ]
    picture, maps = picture_elsewhere(
        tmp_path, LD_PRELOAD=":".join(map(str, foreign)), LD_LIBRARY_PATH=str(BPY_LIBRARIES)
    )
    for path in foreign:
        assert str(path) in maps or str(path.resolve()) in maps
    assert (picture == expected).all()


@pytest.mark.parametrize("isa", ["scalar", "sse2", "avx2"])
def test_narrower_instruction_sets_render_the_same(tmp_path, isa):
    expected, _ = render(scene())
    picture, _ = picture_elsewhere(tmp_path, LIBSHADE_ISA=isa)
    np.testing.assert_allclose(picture, expected, rtol=1e-5)


def started_on(isa):
    """The instruction set that a job says it runs on, and its warnings."""
    done = run("""
from native_scenes import native, scene
job = native.start(scene())
native.wait(job, 60)
print(native.isa(), *native.poll(job)["warnings"], sep="|")
""", LIBSHADE_ISA=isa)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip().split("|")


def test_one_choice_of_the_instruction_set():
    """The engine runs on what the library runs on; what the CPU lacks is told once a job."""
    tool = ROOT / "build" / "shade"

    def version(isa):
        return subprocess.run([tool, "--version"], env=os.environ | {"LIBSHADE_ISA": isa},
                              capture_output=True, text=True, check=True)

    for isa in ("scalar", "sse2", "avx2", "avx512", ""):
        said = version(isa)
        used, *warnings = started_on(isa)
        assert f"({used})" in said.stdout
        if "warning" not in said.stderr:
            assert isa in ("", used) and not warnings
    used, *warnings = started_on("avx3")
    said = version("avx3")
    assert warnings == [said.stderr.strip().removeprefix("shade: warning: ")]
    assert "LIBSHADE_ISA 'avx3': this CPU has scalar" in warnings[0]
    assert warnings[0].endswith(f"{used} is used") and f"({used})" in said.stdout


def test_process_may_end_while_jobs_run():
    code = """
from native_scenes import native, scene
jobs = [native.start(scene(width=4000, height=4000, samples=4096)) for _ in range(3)]
kept = __builtins__.__dict__.setdefault("kept", jobs)
native.wait(jobs[0], 0.1)
"""
    done = run(code)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("part", range(3))
def test_all_tests_under_sanitizers(part):
    """One of three parts of them, each with one of the longest. Clang's build runs them in `make soak`."""
    module = ROOT / "build/sanitized/blender/native/_native.abi3.so"
    assert module.exists(), f"{module} is missing: run `make native-sanitized`"
    # with that of C++, or an exception of Embree's, which ends a build that is cancelled, finds no way
    runtime = ":".join(subprocess.run(["gcc", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
                       for name in ("libasan.so", "libstdc++.so.6"))
    long = ["test_native_adaptive.py", "test_native_light_paths.py", "test_native_cloth.py"]
    assert all((HERE / name).exists() for name in long)
    loading = {p.name for p in HERE.glob("test_native_*.py") if "native_scenes" in p.read_text(encoding="utf-8")}
    files = long + sorted(loading - {*long, Path(__file__).name})
    files = [str(HERE / name) for name in files[part::3]]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *files],
        cwd=ROOT,
        env=os.environ | {
            "NATIVE_MODULE": str(module),
            "LD_PRELOAD": runtime,
            "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",  # Python keeps memory to the end
            "UBSAN_OPTIONS": "halt_on_error=1:print_stacktrace=1",
        },
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
