# SPDX-License-Identifier: Apache-2.0
"""What the library's objects may not hold: names of other programs, state, or in the evaluation calls to anything but
copies and comparisons of memory and libm."""
import os
import pathlib
import subprocess

COST = 0.7

ROOT = pathlib.Path(__file__).resolve().parents[2]
ARCHIVE = ROOT / "build" / "libshade.a"
EVALUATION = ("isa_", "dispatch")
# __cpu_model: the processor's features, filled before main; the last one is the linker's
HARMLESS = {"memcpy", "memset", "memmove", "memcmp", "__cpu_model", "_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"}
LIBM = {f + s for f in ("sqrt", "sin", "cos", "tan", "exp", "log", "log2", "pow", "atan2", "sincos", "fmin", "fmax")
        for s in ("", "f")}


def members(*command):
    """Lines of binutils' output, by member of the archive."""
    text = subprocess.run([*command, ARCHIVE], check=True, capture_output=True, text=True).stdout
    found, name = {}, None
    for line in text.splitlines():
        if line.split(":")[0].endswith(".o"):
            name = line.split(":")[0]
            found[name] = []
        elif name and line.strip():
            found[name].append(line.split())
    return found


def test_no_mutable_globals():
    sections = 0
    for member, lines in members("objdump", "-h").items():
        for fields in lines:
            if not fields[0].isdigit():
                continue
            sections += 1
            name, size = fields[1], int(fields[2], 16)
            writable = name.startswith((".data", ".bss", ".tdata", ".tbss")) and not name.startswith(
                ".data.rel.ro")
            assert not (writable and size), f"{member}: {size} bytes of {name}"
    assert sections > 20
    for member, lines in members("nm").items():
        common = [fields[-1] for fields in lines if fields[-2] == "C"]
        assert not common, f"{member}: {common}"


def test_names():
    """All that a program linked with the archive may meet: ours by their beginning, and no other."""
    names = [fields[-1] for lines in members("nm", "--extern-only", "--defined-only").values() for fields in lines]
    assert not [name for name in names if not name.startswith("shade_")]
    assert len(names) == len(set(names)) > 100


def test_evaluation_calls_nothing_that_allocates():
    seen = 0
    for member, lines in members("nm", "--undefined-only").items():
        if not member.startswith(EVALUATION):
            continue
        seen += 1
        wanted = {fields[-1] for fields in lines}
        strange = {s for s in wanted - HARMLESS - LIBM if not s.startswith("shade_")}
        assert not strange, f"{member} calls {sorted(strange)}"
    assert seen >= 2


def test_instruction_sets_are_the_targets():
    """A compiler for another machine is asked for none of this one's."""
    environment = {key: value for key, value in os.environ.items() if key not in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "WERROR")}
    text = subprocess.run(["make", "-nB", "NEEDS=", "V=1", "CC=clang --target=aarch64-linux-gnu", "build/libshade.a"], cwd=ROOT,
                          env=environment, check=True, capture_output=True, text=True).stdout
    assert "-DISA=scalar" in text and "-DISA=neon" in text and "-DISA=avx2" not in text
    assert "-Werror" not in text, "that is for `make check`"
    here = subprocess.run(["cc", "-dumpmachine"], check=True, capture_output=True, text=True).stdout
    assert ("isa_avx2_float.o" in members("nm")) == here.startswith("x86_64")
