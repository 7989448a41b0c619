# SPDX-License-Identifier: Apache-2.0
"""Scripts of setup/, each in a small house of its own with stand-ins for what it starts: what they do, say and end with."""
import ast
import contextlib
import importlib.util
import json
import os
import re
import runpy
import shlex
import shutil
import struct
import subprocess
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

COST = 5.2

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def house(tmp_path):
    """house(scripts, files={path: text}) -> its folder: copies in setup/ there."""
    def made(*scripts, files=()):
        root = tmp_path / "house"
        for name in scripts:
            (root / "setup").mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / "setup" / name, root / "setup")
        for name, text in dict(files).items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            if text.startswith("#!"):
                path.chmod(0o755)
        return root
    return made


@pytest.fixture
def programs(tmp_path):
    """programs({name: shell text}, kept names) -> PATH of these alone; each logs its words in `log` first."""
    def made(stand_ins, *kept, without=()):
        folder = tmp_path / "bin"
        folder.mkdir(exist_ok=True)
        for name in ("sh", "bash", "env", "sed", "awk", "dirname", "cat", "mkdir", "rm", "mv", "cp", "ln", "cmp", "flock", "tail", "grep", "touch", *kept):
            if not (folder / name).exists():
                (folder / name).symlink_to(shutil.which(name, path="/usr/bin:/bin:/usr/sbin:/sbin"))
        for name, text in stand_ins.items():
            (folder / name).unlink(missing_ok=True)
            (folder / name).write_text(f'#!/bin/sh\necho "{name} $*" >>"{tmp_path}/log"\n{text}\n')
            (folder / name).chmod(0o755)
        (tmp_path / "log").write_text("")
        for name in without:
            (folder / name).unlink(missing_ok=True)
        return {"PATH": str(folder), "HOME": str(tmp_path), "LC_ALL": "C"}
    return made


def run(*words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, timeout=60, **options)


def git(root):
    for words in (["init", "-q"], ["add", "-A"]):
        subprocess.run(["git", "-C", root, *words], check=True, capture_output=True)


def test_how_each_file_is_compiled(tmp_path):
    said = "  compile  a.o\nmkdir -p o\ncc -O2 '-DX=a b' -MMD -c src/a.c -o o/a.o\ncc a.o -o a\ncc -c b.c -o o/b.o\ncc -fsyntax-only -c d.c\ncc x.o y.o\n"
    done = run(sys.executable, ROOT / "setup/compile_commands.py", input=said, cwd=tmp_path)
    assert done.returncode == 0 and json.loads(done.stdout) == [
        {"directory": str(tmp_path), "file": "src/a.c", "output": "o/a.o", "arguments": ["cc", "-O2", "-DX=a b", "-MMD", "-c", "src/a.c", "-o", "o/a.o"]},
        {"directory": str(tmp_path), "file": "b.c", "output": "o/b.o", "arguments": ["cc", "-c", "b.c", "-o", "o/b.o"]}]
    done = run(sys.executable, ROOT / "setup/compile_commands.py", input="cc a.o -o a\n")
    assert done.returncode == 1 and "make named no file that it compiles" in done.stderr


def test_what_a_header_makes_again():
    """Each rule of make that compiles an object of C notes which headers it has read, and those notes are read."""
    for name in ("libshade/libshade.mk", "blender_addon_c/native.mk"):
        text = (ROOT / name).read_text()
        rules = re.findall(r"^\t.*\$\(CC\) (?:.*\\\n)*.* -c \$<.*$", text, re.M)
        assert rules and all("-MMD" in rule for rule in rules), (name, rules)
        assert re.search(r"^-include .*\.d\b", text, re.M), name


def test_what_steps_cost(tmp_path):
    """Also of what fails, whose status and messages stay as they are."""
    timed = ROOT / "setup/timed.sh"
    assert [run(timed, "-c", words, cwd=tmp_path).returncode for words in ("exit 3", "sleep .3;\techo done")] == [3, 0]
    done = run(timed, "-c", "echo out; echo wrong >&2", cwd=tmp_path)
    assert (done.stdout, done.stderr) == ("out\n", "wrong\n")
    rows = [line.split(" ", 3) for line in (tmp_path / "build/times.txt").read_text().splitlines()]
    assert [row[3].strip() for row in rows] == ["exit 3", "sleep .3; echo done", "echo out; echo wrong >&2"]
    user, system, wall = map(float, rows[1][:3])
    assert .25 < wall < 20 and user + system < .2


IDENTIFIER = "SPDX-License" + "-Identifier: "  # in two, or reuse takes it for this file's
APACHE, GPL, AGPL = (IDENTIFIER + name for name in ("Apache-2.0", "GPL-3.0-or-later", "AGPL-3.0-or-later"))
HEADER = f"/* {APACHE} */\nstatic const int number = 1; /* [Known1994] */\n"


def test_lint_names_what_is_wrong(house):
    """Licences by folder, citations, layout, and headers that do not compile alone."""
    files = {"REFERENCES.bib": f"% {APACHE}\n@article{{Known1994,\n}}\n", ".clang-format": (ROOT / ".clang-format").read_text(),
             "libshade/model/good.h": HEADER, "libshade/batch/good.h": HEADER, "blender_addon_c/a.py": f"# {GPL}\n", "povray_patches/a.cpp": f"// {AGPL}\n",
             "libshade/model/column_streak.h": f"/* {APACHE} */\n#error of two halves\n", "build/a.c": "int  x;\n", "a/picture.png": "none\n",
             "libshade/batch/column_near.h": f"/* {APACHE} */\n#if SHADE_FLOAT\n#error in double alone\n#endif\n"}
    root = house("lint.sh", files=files)
    done = run(root / "setup/lint.sh")
    assert done.returncode == 0 and "lint: 5 C and C++ files, licences, citations: clean" in done.stdout, done.stderr + done.stdout
    for name, text in {"a.py": f"# {GPL}\n", "blender_addon_c/b.py": f"# {APACHE}\n", "povray_patches/b.cpp": f"// {GPL}\n", "late.txt": 9 * "\n" + f"# {APACHE}\n",
                       "libshade/a.c": f"/* {APACHE} */\nint  x; /* [Unknown 2001] */\n", "libshade/model/bad.h": f"/* {APACHE} */\n#error alone\n"}.items():
        (root / name).write_text(text)
    done = run(root / "setup/lint.sh")
    assert done.returncode == 1 and "clean" not in done.stdout
    for name, licence in (("a.py", APACHE), ("blender_addon_c/b.py", GPL), ("povray_patches/b.cpp", AGPL), ("late.txt", APACHE)):
        assert f"./{name}: no line '{licence}' at its top" in done.stderr
    assert "./libshade/a.c:2: Unknown 2001 is not a key of REFERENCES.bib" in done.stderr and done.stderr.count("error: #error alone") == 2
    assert done.stderr.count("at its top") == 4 and done.stderr.count("is not a key") == 1
    if "version 14." in run("clang-format", "--version").stdout:
        assert done.stderr.count("not laid out") == 1 and "clang-format -i ./libshade/a.c" in done.stderr


# ---- what tests notice

PYTEST = """#!/bin/sh
[ -f hangs ] || case $* in *none.py*) exit 5 ;; esac
grep -q slow part.txt && exec sleep 30
if grep -q bad part.txt; then echo "FAILED compare/tests/test_x.py::test_that - why"; exit 1; fi
"""
MAKEFILE = """all build/horizon build/displaced build/bumps build/plain.so:
	@echo "$(CFLAGS) $(NEEDS) $(WERROR) $(PLAIN_ISAS)" >>build/made.txt
	@! grep -q wrong part.txt
build/test/%:
	@mkdir -p build/test; printf '#!/bin/sh\\n! grep -q unsound part.txt' >$@; chmod +x $@
"""
LIST = """# of a test
part.txt
- one good
+ one bad
$ py compare/tests/test_x.py

part.txt
- two good
+ two harmless
$ py compare/tests/test_x.py
$ c other

part.txt
- three good
+ three wrong
$ py compare/tests/test_x.py

part.txt
- four good
- and more
$ c a other

part.txt
- no such line
+ x
$ py compare/tests/test_x.py

part.txt
- five good
+ five slow
$ py compare/tests/test_x.py

part.txt
- six good
+ six unsound
$ c a
"""


NOT_COPIED = ("sanitized", "threads", "clang", "fuzz", "demo", "compare", "pytest-cache")


def test_mistakes_are_planted_and_judged(house):
    """In a copy, one at a time; the tree stays as it is."""
    part = "one good\ntwo good\nthree good\nfour good\nand more\nfive good\nsix good\n"
    root = house("mutants.py", "reach.py", "costs.py", files={
        "setup/mutants.txt": LIST, "setup/mutants-once-missed.txt": "# none\n", "setup/mutants-noticed.txt": "# old\ngone -> gone\tx::y\n", "Makefile": MAKEFILE, "part.txt": part,
        ".gitignore": "build/\n", "build/venv/bin/python": PYTEST, "build/shade": "#!/bin/sh\necho 'shade 1 (avx2)'\n", **{f"build/{name}/large": "" for name in NOT_COPIED},
        **{f"build/obj/src/isa_{name}_float": "" for name in ("scalar", "sse2", "avx2", "avx512")}})
    script = root / "setup/mutants.py"
    script.write_text(script.read_text().replace("SECONDS = 300", "SECONDS = 1"))
    (root / "build/povray").mkdir()
    (root / "build/povray/configured").write_text(f"in {root}/build\n")
    git(root)

    def mutants(*words):
        return run(sys.executable, script, *words)
    done = mutants("--stale")
    assert (done.returncode, done.stdout.strip()) == (1, f"{root}/setup/mutants.txt:23: stale: part.txt: no such line -> x")
    assert mutants("--stale", "--only", "good").returncode == 0
    done = mutants()
    rows = [line.split(None, 3) for line in done.stdout.splitlines() if "part.txt" in line]
    assert [(row[0], row[3]) for row in rows] == [
        ("caught", "part.txt: one good -> one bad  [test_that]"), ("SURVIVED", "part.txt: two good -> two harmless"), ("compiler", "part.txt: three good -> three wrong"),
        ("SURVIVED", "part.txt: four good -> (left out)"), ("stale", "part.txt: no such line -> x"), ("slow", "part.txt: five good -> five slow"),
        ("caught", "part.txt: six good -> six unsound  [main]")], done.stdout + done.stderr
    assert done.returncode == 1 and re.search(r"^4 of 6 noticed \(1 stale\), \d+ s$", done.stdout, re.M)
    copy = root / "build/mutants"
    assert (copy / "part.txt").read_text() == (root / "part.txt").read_text() == part
    assert (copy / "build/venv").resolve() == (root / "build/venv").resolve() and not any((copy / "build" / name).exists() for name in (*NOT_COPIED, "mutants"))
    assert (copy / "build/povray/configured").read_text() == f"in {copy}/build\n"
    assert set((copy / "build/made.txt").read_text().splitlines()) == {"-O1  -Werror avx512 sse2"}
    done = mutants("--only", "one", "--table", "--work", root / "build/other", "--no-baseline")
    assert done.returncode == 0 and (root / "build/other/part.txt").exists(), done.stderr
    told = (root / "setup/mutants-noticed.txt").read_text().splitlines()
    assert told[2:] == ["part.txt: one good -> one bad\tcompare/tests/test_x.py::test_that"] and told[0].endswith("Apache-2.0")
    (root / "part.txt").write_text(part + "bad\n")
    done = mutants("--only", "one")
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr == f"error: without any mistake `py compare/tests/test_x.py` fails; see {copy}/build/mutant.log\n"


@pytest.mark.parametrize("text, said", [("a.txt\nx\n", ":2: a line begins with '- ', '+ ' or '$ ', this one does not"), ("# of\n\na.txt\n+ x\n", ":3: needs lines that begin with '- '"),
                                        ("a.txt\n- x\n$ rust it\n", "'rust it': tests are c, py, blender, zip or povray"), (None, "No such file")])
def test_lists_that_cannot_be_read(house, text, said):
    root = house("mutants.py", "reach.py", "costs.py", files={} if text is None else {"list.txt": text})
    done = run(sys.executable, root / "setup/mutants.py", "--list", root / "list.txt", "--stale")
    assert done.returncode == 2 and said in done.stderr and "Traceback" not in done.stderr


def test_what_a_line_of_tests_runs(monkeypatch):
    """Goals of make, then a command, which stops at the first that fails unless all are wanted; what a log names."""
    monkeypatch.syspath_prepend(ROOT / "setup")
    spec = importlib.util.spec_from_file_location("mutants_of_setup", ROOT / "setup/mutants.py")
    mutants = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "mutants_of_setup", mutants)
    spec.loader.exec_module(mutants)
    old = "-o build/blender/addons/libshade/assets/blender_assets.cats.txt -o build/blender/addons/libshade/manual/index.html"
    for kind, goals in {"py": "all build/horizon build/displaced build/bumps build/plain.so", "blender": f"all {old} native blender", "zip": "all blender",
                        "povray": "all povray"}.items():
        made, words = mutants.command(f"{kind} a/test_b.py -k 'one or two'")
        assert made == goals.split() and words == ["sh", "-c", "build/venv/bin/python -m pytest -q -x -p no:cacheprovider a/test_b.py -k 'one or two'"]
    assert " -x " not in mutants.command("py a.py", True)[1][2]
    for whole, end in ((False, "exit 1"), (True, "failed=1")):
        made, words = mutants.command("c bsdf isa", whole)
        assert made == ["build/test/bsdf", "build/test/isa"] and words[2].splitlines() == [
            "failed=0", *(f"build/test/{name} || {{ echo FAILED libshade/test/test_{name}.c::main; {end}; }}" for name in ("bsdf", "isa")), "exit $failed"]
    log = "[  FAILED  ] tests: of_c\nFAILED b/test_b.py::test_two[a-1] - x\nERROR b/test_b.py::test_one\nFAILED a/test_a.py::test_z - y\nFAILED b/test_b.py::test_two[b]\n"
    assert mutants.failed(log) == "of_c" and mutants.failed(log.split("\n", 1)[1]) == "test_two[a-1]" and mutants.failed("[  FAILED  ] alone") == "alone" and mutants.failed("") == ""
    assert mutants.all_failed(log) == ["a/test_a.py::test_z", "b/test_b.py::test_one", "b/test_b.py::test_two"]
    assert (mutants.SECONDS, mutants.ENOUGH) == (300, .9) and mutants.Mutant(1, "a.c", "  x\ny", "", []).title() == "a.c: x -> (left out)"


def test_which_tests_reach_a_file(house):
    """By what they include, import and start, the cheapest first."""
    root = house("reach.py", "costs.py", files={
        "libshade/include/shade/a.h": "", "libshade/src/a.c": '#include "inner.h"\n', "libshade/src/inner.h": "", "libshade/src/inner.c": "", "libshade/tool/eval.c": "", "setup/some.sh": "",
        "libshade/test/test_a.c": "/* COST = 3 */\n#include <shade/a.h>\n", "libshade/test/test_tool.py": 'COST = 1\nrun(SHADE, "some.sh")\n',
        "compare/judge.py": "from deep import thing\n", "compare/deep.py": "", "compare/tests/test_judge.py": "import judge\nCOST = 2\n", "compare/tests/test_none.py": "COST = 1\n",
        "blender_addon_c/export/e.py": "from . import f\n", "blender_addon_c/export/f.py": "", "blender_addon_c/native/node/n.h": "", "blender_addon_c/native/isa/n.c": '#include "node/n.h"\n',
        "blender_addon_c/tests/test_blender_e.py": 'COST = 9\nALONE = {"test_b": 5}\ndef test_b(blender): pass\n', "blender_addon_c/tests/test_native_n.py": "from native_scenes import native\nCOST = 4\n",
        "povray_patches/series": "", "povray_patches/glue/g.cpp": "", "povray_patches/tests/test_p.py": "COST = .5\ndef test_p(povray): pass\n", "Makefile": "",
        "compare/tests/test_make.py": 'COST = 8\nrun(["make"])\nimport judge\nfrom conftest import thing\n', "compare/tests/conftest.py": "import deep\n",
        "blender_addon_c/tests/inside/scenes.py": "import parts\n", "blender_addon_c/tests/parts.py": "", "libshade/python/mod/__init__.py": "from ._inner import thing\n",
        "libshade/python/mod/_inner.py": "from .deeper import (one, two)\n", "libshade/python/mod/deeper/__init__.py": "", "libshade/python/mod/deeper/two.py": "from .. import up\n",
        "libshade/python/mod/up.py": "", "libshade/test/test_mod.py": "COST = 6\nimport mod\n", "blender_addon_c/tests/test_blender_s.py": "COST = 5\nbpy = run.scene('pan')\n",
        "notes/series.txt": "", "setup/a.mk": "", "compare/displaced/d.c": "", "farm/tests/odd.py": "", "compare/tests/test_disp.py": "COST = 4\nimport displacement\n",
        "farm/tests/conftest.py": "", "farm/tests/test_farm.py": 'COST = 7\nfrom conftest import thing\nrun("started.py")\n', "farm/started.py": ""})
    git(root)
    reached = {
            "libshade/include/shade/a.h": ["c a"], "libshade/src/a.c": ["c a"], "libshade/src/inner.c": ["c a"], "libshade/tool/eval.c": ["py libshade/test/test_tool.py"],
            "setup/some.sh": ["py libshade/test/test_tool.py"], "compare/deep.py": ["py compare/tests/test_judge.py", "py compare/tests/test_make.py"],
            "blender_addon_c/export/f.py": ["blender blender_addon_c/tests/test_blender_e.py"], "blender_addon_c/native/node/n.h": [f"blender blender_addon_c/tests/test_{name}.py" for name in ("native_n", "blender_e")],
            "povray_patches/0001-x.patch": ["povray povray_patches/tests/test_p.py"], "build/povray/src/x.cpp": ["povray povray_patches/tests/test_p.py"],
            "povray_patches/glue/g.cpp": ["povray povray_patches/tests/test_p.py"], "Makefile": ["py compare/tests/test_make.py"],
            "blender_addon_c/tests/parts.py": ["blender blender_addon_c/tests/test_blender_s.py"], "setup/a.mk": ["py compare/tests/test_make.py"], "notes/series.txt": [],
            "compare/displaced/d.c": ["py compare/tests/test_disp.py"], "farm/tests/odd.py": [],
            **{f"libshade/python/mod/{name}.py": ["py libshade/test/test_mod.py"] for name in ("__init__", "_inner", "deeper/__init__", "deeper/two", "up")},
            "farm/tests/conftest.py": ["py farm/tests/test_farm.py"], "farm/started.py": ["py farm/tests/test_farm.py"]}
    done = run(sys.executable, root / "setup/reach.py", *reached)
    assert done.stdout.splitlines() == [line for file, wanted in reached.items() for line in (file, *(f"$ {test}" for test in wanted))]
    (root / "setup/mutants-noticed.txt").write_text("# head\na -> b\tlibshade/test/test_a.c::main compare/tests/test_judge.py::test_x\nc -> d\tlibshade/test/test_a.c::main\n")
    said = [line.split() for line in run(sys.executable, root / "setup/costs.py").stdout.splitlines()]
    assert said[0] == ["seconds", "noticed", "file"] and said[-1] == ["56"] and len(said) == 14
    assert said[1] == ["14.0", "0", "blender_addon_c/tests/test_blender_e.py"] and ["3.0", "2", "libshade/test/test_a.c"] in said and ["2.0", "1", "compare/tests/test_judge.py"] in said


# ---- what --help says


def _said(node):
    """A help text as far as it is written there; what is worked out is a question mark."""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else "?" for part in node.values)
    if isinstance(node, ast.BinOp):
        return _said(node.left) + _said(node.right)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else "?"


def test_help_tells_the_defaults():
    """Of every script's options: the number or word in "(default …)" is the option's."""
    seen = 0
    for path in (*(ROOT / "setup").glob("*.py"), *(ROOT / "compare").glob("*.py")):
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(call, ast.Call) and getattr(call.func, "attr", "") == "add_argument":
                given = {word.arg: word.value for word in call.keywords}
                told = re.search(r"\((?:by )?default:? ([^,;)?]+)", _said(given.get("help", ast.Constant(0))))
                default = given.get("default")
                if told and isinstance(default, ast.Constant) and default.value is not None:
                    seen += 1
                    word = told[1].split()[0].rstrip(":")
                    numbers = isinstance(default.value, (int, float)) and re.fullmatch(r"[\d.e-]+", word)  # 0 may be "all"
                    same = abs(float(word) - default.value) < 1e-12 if numbers else word == str(default.value) or default.value == 0
                    assert same, (path.name, ast.unparse(call)[:80], told[1])
            if isinstance(call, ast.Call) and getattr(call.func, "attr", "") == "ArgumentParser" and any(
                    word.arg == "description" and isinstance(word.value, ast.Name) for word in call.keywords):  # the whole of __doc__, with its lines
                assert "RawDescriptionHelpFormatter" in ast.unparse(call), path.name
    assert seen > 5


def test_every_command_has_a_manual_page():
    made = re.search(r"^SHADE_COMMANDS := (.*)$", (ROOT / "libshade/install.mk").read_text(), re.M)[1].split()
    listed = re.findall(r"^  (\w+) ", run(ROOT / "build/shade", "--help").stdout.split("ommands", 1)[-1], re.M)
    assert set(made) == set(listed) - {"shade"} and len(made) == len(set(made)) > 5, listed


def test_supported_txt_claims_no_more_than_is_read():
    """Nor less than there is; a page without its marks is said."""
    module = types.ModuleType("supported")
    exec(compile((ROOT / "setup/supported.py").read_text(), "supported.py", "exec"), {**vars(module), "__file__": str(ROOT / "setup/supported.py")}, vars(module))
    module.Page.__init__.__globals__.update(vars(module))
    with pytest.raises(KeyError, match="known.py has no _NOTHING"):
        module._assigned("known.py", "_NOTHING")
    page = module.Page()
    page.said["light", "SUN"], page.read = ("much the same", ""), lambda *_what: False
    with pytest.raises(SystemExit, match="light SUN is much the same, but the exporter does not read it"):
        page._said("light", "SUN", "")
    assert page._said("node", "ShaderNodeNothing", "NOTHING") == ("not", "passed on") and page._said("camera", "NOTHING", "")[1] == "It is named."
    page = module.Page()
    made = [part for part, lines in page.parts() if len(list(lines)) > 3]
    assert made == re.findall(r"<!-- made: (\w+) -->", (ROOT / "docs/blender/supported.md").read_text(encoding="utf-8"))
    page.unused.add(("node", "NoSuch"))
    with pytest.raises(SystemExit, match=r"no Blender has \[\('node', 'NoSuch'\)\]"):
        page.text()
    page.parts = lambda: [("none", ["| a |"])]
    with pytest.raises(SystemExit, match="supported.md has no marks of none"):
        page.text()
    every = ["3.4", "4.2", "5.0"]
    for versions, said in ((every, "all"), (["3.4"], "in `3.4`"), (["3.4", "4.2"], "until `4.2`"), (["4.2", "5.0"], "from `4.2`"), (["4.2"], "`4.2` to `4.2`")):
        assert module.since(versions, every) == said


def test_versions_of_bpy_are_those_that_are_asked():
    """Of each Debian's Python one, whose pins are there; tests know which."""
    listed = dict(re.findall(r"^BPY_OF_(3\.\d+) := (\S+)$", (ROOT / "setup/setup.mk").read_text(), re.M))
    told = re.search(r"3\.4 and (\S+) on Debian 12, 4\.3 and (\S+) on Debian 13", (ROOT / "blender_addon_c/tests/blender_runs.py").read_text())
    assert listed == {"3.11": told[1], "3.13": told[2].rstrip(".")}
    for version in (*listed.values(), "4.2", "4.5", "5.3"):
        assert f"bpy=={version}." in (ROOT / f"setup/requirements-bpy-{version}.txt").read_text(), version


# ---- what Blender has


def test_what_cycles_has_in_each_version(tmp_path, monkeypatch):
    """Beside what older Blenders had; what a version is asked again replaces what it said."""
    listed = tmp_path / "cycles-has.txt"
    text = (ROOT / "setup/cycles_has.py").read_text()
    part = lambda name: types.SimpleNamespace(identifier=name)

    class Node:
        pass

    def blender(version, **nodes):
        kinds = {name: type(name, (Node,), {}) for name in nodes}

        def new(name):
            if name not in nodes:
                raise RuntimeError(name)
            return types.SimpleNamespace(type=name[10:].upper(), bl_label=name[10:], inputs=[part(s) for s in nodes[name][0]], outputs=[part(s) for s in nodes[name][1]])
        enum = lambda *items: types.SimpleNamespace(enum_items=[types.SimpleNamespace(identifier=item, name=item.title()) for item in items])
        flag = lambda name, kind="BOOLEAN": types.SimpleNamespace(identifier=name, type=kind, name=name[9:])
        layer = types.SimpleNamespace(bl_rna=types.SimpleNamespace(properties=[flag("use_pass_mist"), flag("use_pass_depth_z", "INT"), flag("use_pass_grease_pencil"), flag("use_pass_cryptomatte_accurate"), flag("use_sky")]))
        layer.cycles = types.SimpleNamespace(bl_rna=types.SimpleNamespace(properties=[flag("pass_debug_sample_count"), flag("denoising_store_passes")]))
        camera = types.SimpleNamespace(bl_rna=types.SimpleNamespace(properties={"type": enum("PERSP")}), panorama_type=1)
        camera.bl_rna.properties["panorama_type"] = enum("FISHEYE")
        fake = types.SimpleNamespace(
            types=types.SimpleNamespace(Node=Node, Light=types.SimpleNamespace(bl_rna=types.SimpleNamespace(properties={"type": enum("SUN")})), **kinds),
            data=types.SimpleNamespace(node_groups=types.SimpleNamespace(new=lambda _name, kind: kind == "ShaderNodeTree" and types.SimpleNamespace(nodes=types.SimpleNamespace(new=new))),
                                       cameras=types.SimpleNamespace(new=lambda _: camera)),
            context=types.SimpleNamespace(view_layer=layer), app=types.SimpleNamespace(version=version))
        monkeypatch.setitem(sys.modules, "bpy", fake)
        exec(compile(text, "cycles_has.py", "exec"), {"__file__": str(tmp_path / "cycles_has.py"), "__name__": "cycles_has"})
        return [line for line in listed.read_text().splitlines() if not line.startswith("#")]
    of_others = ("EeveeSpecular ShaderToRGB OutputLineStyle UVAlongStroke LightAccumulation LightEvaluation LightInfo LightIterInternalInput LightIterInternalOutput "
                 "ShadowRaycast Squeeze Group CustomGroup").split()
    mix = {"ShaderNodeMix": (["A", "B", "__extend__", "LightIndex"], ["Out"]),
           **{name: ([], []) for name in ("NodeReroute", "NodeFrame", "NodeGroupInput", "NodeGroupOutput", *(f"ShaderNode{name}" for name in of_others))}}
    others = ["camera | FISHEYE |  | Fisheye | {0} |  |", "camera | PERSP |  | Persp | {0} |  |", "light | SUN |  | Sun | {0} |  |"]
    passes = ["pass | denoising_store_passes |  | _store_passes | {0} |  |", "pass | pass_debug_sample_count |  | g_sample_count | {0} |  |", "pass | use_pass_mist |  | mist | {0} |  |"]
    rows = lambda versions, *nodes: [row.format(versions) for row in (*others, *nodes, *passes)]
    found = blender((3, 4), **mix)
    assert found == rows("3.4", "node | ShaderNodeMix | MIX | Mix | 3.4 | A, B | Out")
    newer = {"ShaderNodeMix": (["A", "C"], ["Out"]), "ShaderNodeNew": ([], ["Out"])}
    for _ in range(2):
        found = blender((5, 10), **newer)
        assert found == rows("3.4 5.10", "node | ShaderNodeMix | MIX | Mix | 3.4 5.10 | A, B (3.4), C (5.10) | Out", "node | ShaderNodeNew | NEW | New | 5.10 |  | Out")
    found = blender((5, 2), **newer)
    assert "node | ShaderNodeMix | MIX | Mix | 3.4 5.2 5.10 | A, B (3.4), C (5.2 5.10) | Out" in found
    assert listed.read_text().startswith(f"# {IDENTIFIER}Apache-2.0\n")


# ---- other systems

APT = {"apt-get": 'case "$*" in "indextargets --format "\\$"(SITE) "\\$"(RELEASE) "\\$"(COMPONENT) Created-By: Packages") printf "http://x/security trixie-security main\\nhttp://mirror/debian trixie main\\n" ;; *" download "*) touch a.deb b.deb ;; esac\n'
                  '[ ! -f "$HOME/no-net" ] || case "$*" in *download*) echo "no route"; exit 1 ;; esac',
       "dpkg-deb": 'mkdir -p "$3/usr/lib"; touch "$3/usr/lib/$(basename "$2")"', "id": "echo someone", "uname": 'cat "$HOME/machine"'}


def test_a_debian_13_for_another_python(house, programs, tmp_path):
    """Made once, and again when what it holds is listed otherwise; where it can't be had that is said, with status 0."""
    root = house("debian13.sh", "own_apt.sh", files={
        "setup/packages-debian13.txt": "# a list\npython3.13\nlibc6\n", "setup/requirements-bpy-5.2.txt": "bpy==5.2\n", "build/.keep": "",
        "build/venv/bin/python": f'#!/bin/sh\necho "pip $*" >>{tmp_path}/log\nfor w; do [ "$last" = --target ] && mkdir -p "$w" && touch "$w/bpy"; last=$w; done\n'})
    (tmp_path / "machine").write_text("x86_64\n")
    cache = tmp_path / "cache/debian13"

    def made(*versions, env=None, without=()):
        environment = programs(APT, "basename", without=without)
        done = run(root / "setup/debian13.sh", *versions, env={**environment, "LIBSHADE_CACHE": str(tmp_path / "cache"), **(env or {})})
        return done, (tmp_path / "log").read_text().splitlines()
    done, log = made()
    assert done.returncode == 2 and "setup/debian13.sh 5.2 [5.3]" in done.stderr and done.stderr.startswith("A Debian 13 to change root into") and len(done.stderr.splitlines()) == 6 and not log
    done, _log = made("5.2", without=["apt-get"])
    assert done.returncode == 0 and "setup: no Debian 13 for bpy 5.2, tests in it are skipped: no apt here" in done.stderr
    (tmp_path / "machine").write_text("aarch64\n")
    done, _log = made("5.2")
    assert done.returncode == 0 and "bpy is made for x86-64 alone" in done.stderr and not (root / "build/debian13").exists()
    (tmp_path / "machine").write_text("x86_64\n")
    (tmp_path / "no-net").touch()
    done, _log = made("5.2")
    assert done.returncode == 0 and "its packages: no route" in done.stderr and not cache.exists() and not (tmp_path / "cache/debian13.part").exists()
    (tmp_path / "no-net").unlink()
    done, log = made("5.2")
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    assert (root / "build/debian13").resolve() == cache.resolve() and sorted(path.name for path in (cache / "usr/lib").iterdir()) == ["a.deb", "b.deb"]
    assert os.readlink(cache / "bin") == "usr/bin" and not (cache / "apt").exists()
    assert all((cache / name).is_dir() for name in ("dev", "proc", "opt", "tmp", "etc", "usr/sbin", "usr/lib64"))  # some to mount on
    assert any(line.endswith("download python3.13:amd64 libc6:amd64") for line in log) and sum("update" in line for line in log) == 1
    environment = cache / "opt/bpy-5.2"
    assert (environment / "lib/python3.13/site-packages/bpy").exists() and os.readlink(environment / "bin/python") == "/usr/bin/python3.13"
    pip, = (line for line in log if line.startswith("pip"))
    platforms = [f"--platform {name}" for name in ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux_2_17_x86_64", "manylinux2014_x86_64", "any")]
    assert pip == " ".join(["pip -m pip --disable-pip-version-check install --quiet --no-deps --no-compile --ignore-requires-python --retries 3 --only-binary :all: --implementation cp",
                            "--python-version 3.13 --abi cp313 --abi abi3 --abi none", *platforms, "--target lib/python3.13/site-packages -r", f"{root}/setup/requirements-bpy-5.2.txt"])
    assert (environment / "pyvenv.cfg").read_text() == "home = /usr/bin\n" and os.readlink(cache / "etc/mtab") == "/proc/self/mounts"
    assert done.stdout.splitlines() == [f"setup: Debian 13 into {cache}", f"setup: bpy 5.2 into {cache}"]
    assert made("5.2")[1] == ["uname -m"]
    (root / "setup/requirements-bpy-5.2.txt").write_text("bpy==5.2.1\n")
    assert [line.split()[0] for line in made("5.2")[1]] == ["uname", "pip"]
    (root / "setup/packages-debian13.txt").write_text("libc6\n")
    log = made("5.2")[1]
    assert any(line.endswith("download libc6:amd64") for line in log) and log[-1].startswith("pip")


def test_sources_of_a_release(house, programs, tmp_path):
    """From this system's mirror, of both Debians; what apt needed besides goes."""
    root, environment = house("release-sources.sh", "own_apt.sh"), programs(APT, "basename")
    assert run(root / "setup/release-sources.sh", env=environment).returncode == 2
    target = tmp_path / "sources"
    target.mkdir()
    (target / "old").touch()
    stays = {**environment, "KEPT": str(tmp_path / "kept")}
    programs({**APT, "apt-get": APT["apt-get"].replace("a.deb b.deb", "libembree-dev_4.deb") + '\n[ ! -f sources.list ] || cp sources.list "$KEPT"'}, "basename")
    done = run(root / "setup/release-sources.sh", target, env=stays)
    assert done.returncode == 0 and sorted(path.name for path in target.iterdir()) == ["embree", "libembree-dev_4.deb"], done.stderr
    assert (tmp_path / "kept").read_text() == "deb-src http://mirror/debian bookworm main\ndeb http://mirror/debian trixie main\n"
    log = (tmp_path / "log").read_text()
    assert re.search(r"source --only-source openexr=3\.1\.5", log) and re.search(r"download libembree-dev:amd64=4\.3\.3", log)
    assert f"Dir::State::Lists={target}/lists" in log and "Dir::Etc::SourceParts=/dev/null" in log and "User=someone" in log
    assert log.count("dpkg-deb --extract libembree-dev_4.deb embree") == 1


@pytest.mark.parametrize("script, said", [("windows-sources.sh", "the sources of OpenEXR, libpng, zlib and cmocka"), ("release-sources.sh", "OpenEXR's source and Embree 4's headers"),
                                          ("arm64-libraries.sh", "Embree, OpenEXR and libpng for arm64")])
def test_what_is_fetched_from_debians_archive(house, programs, tmp_path, script, said):
    """Into the folder that is named; it says which, and a source that cannot be had ends it."""
    root, environment = house(script, "own_apt.sh"), programs(APT, "basename")
    for words in ((), ("a", "b")):
        done = run(root / "setup" / script, *words, env=environment)
        assert done.returncode == 2 and done.stdout == "" and done.stderr.startswith("What `make ") and done.stderr.endswith(f"  setup/{script} FOLDER\n") and len(done.stderr.splitlines()) == 3
    target = tmp_path / "sources"
    for broken in ("source", "download", "update"):
        fails = {**APT, "apt-get": f'case "$*" in *" {broken}"*) exit 3 ;; esac; ' + APT["apt-get"].replace("a.deb b.deb", "libembree-dev_4.deb")}
        done = run(root / "setup" / script, target, env=programs(fails, "basename"))
        asked = re.search(rf" {broken}\b", (tmp_path / "log").read_text())
        assert (done.returncode != 0) == bool(asked) and done.stdout == f"setup: {said} into {target}\n", (broken, done.stderr)
        assert asked or not any((target / name).exists() for name in ("lists", "archives", "sources.list"))


def test_sources_of_windows(house, programs, tmp_path):
    root, environment = house("windows-sources.sh", "own_apt.sh"), programs({**APT, "apt-get": APT["apt-get"] + '\n[ ! -f sources.list ] || cp sources.list "$HOME/kept"'}, "basename")
    (tmp_path / "sources").mkdir()
    (tmp_path / "sources/old").touch()
    done = run(root / "setup/windows-sources.sh", tmp_path / "sources", env=environment)
    assert done.returncode == 0 and not list((tmp_path / "sources").iterdir()), done.stderr
    assert (tmp_path / "kept").read_text() == "deb-src http://mirror/debian bookworm main\n"
    assert re.search(r"source --only-source openexr libpng1.6 zlib cmocka", (tmp_path / "log").read_text())


def test_libraries_for_arm64(house, programs, tmp_path):
    """Unpacked where they are asked for, of that machine and no other; the packages go."""
    root, environment = house("arm64-libraries.sh", "own_apt.sh"), programs(APT, "basename")
    done = run(root / "setup/arm64-libraries.sh", env=environment)
    assert done.returncode == 2 and "setup/arm64-libraries.sh FOLDER" in done.stderr
    target = tmp_path / "arm64"
    target.mkdir()
    (target / "old").touch()
    stand_ins = {**APT, "apt-get": APT["apt-get"] + '\n[ ! -f sources.list ] || cp sources.list "$HOME/kept"', "dpkg-deb": 'mkdir -p "$3/usr/lib"; touch "$3/usr/lib/${2#./}.so"'}
    done = run(root / "setup/arm64-libraries.sh", target, env=programs(stand_ins, "basename"))
    assert done.returncode == 0 and done.stdout == f"setup: Embree, OpenEXR and libpng for arm64 into {target}\n", done.stderr
    assert sorted(str(path.relative_to(target)) for path in target.rglob("*") if path.is_file()) == ["usr/lib/a.deb.so", "usr/lib/b.deb.so"]
    assert (tmp_path / "kept").read_text() == "deb [arch=arm64] http://mirror/debian bookworm main\n"
    asked = re.search(r" download (.*)", (tmp_path / "log").read_text())[1].split()
    assert all(name.endswith(":arm64") for name in asked)
    assert {"libembree3-3", "libtbb12", "libopenexr-dev", "libpng-dev", "zlib1g-dev", "libstdc++6", "libgcc-s1"} <= {name.partition(":")[0] for name in asked}


SLURM = "slurmctld slurmd slurm-client munge"


@pytest.mark.parametrize("release, user, apt, brings, said", [
    ("12", "0", True, True, ""), ("13", "0", True, True, ""), ("", "0", True, True, ""), ("12", "0", True, False, "Slurm was installed in vain"),
    ("12", "0", False, False, "Slurm cannot be installed"), ("12", "1000", True, True, "only root installs a scheduler here"),
    ("12", "0", None, True, "there is no apt")])
def test_slurm_for_the_farms_tests(house, programs, tmp_path, release, user, apt, brings, said):
    """Its packages alone, no service of which starts; where it cannot be had that is said, with status 0."""
    sbin = tmp_path / "sbin"
    sbin.mkdir()
    root = house("slurm.sh", files={"setup/apt.sh": f'#!/bin/sh\n"{sbin}/policy-rc.d"; echo "$? $(cat $1)" >>"{tmp_path}/asked"\n{apt or "exit 1"}\n' + (
        f'for name in munged slurmctld slurmd sbatch; do printf "#!/bin/sh\\n" >"{sbin}/$name"; chmod 755 "{sbin}/$name"; done\n' if brings else "")})
    (tmp_path / "os-release").write_text(f'NAME="Debian"\nVERSION_ID="{release}"\n' if release else "NAME=sid\n")
    script = root / "setup/slurm.sh"
    script.write_text(script.read_text().replace(":/usr/sbin:/sbin", f":{sbin}").replace("/usr/sbin", str(sbin)).replace("/etc/os-release", str(tmp_path / "os-release")))
    environment = programs({"id": f"echo {user}", "true": "exit 0", "True": "exit 0", **({} if apt is None else {"apt-get": ""})}, "chmod")
    done = run(script, env=environment)
    assert (done.returncode, done.stdout) == (0, "") and not (sbin / "policy-rc.d").exists()
    packages = SLURM + (" systemd-standalone-sysusers" if release == "13" else "")
    assert done.stderr == (f"setup: {said}: tests of Slurm are skipped. They need: {packages}\n" if said else "")
    asked = (tmp_path / "asked").read_text() if (tmp_path / "asked").exists() else ""
    assert asked == (f"101 {packages}\n" if user == "0" and apt is not None else "")
    if not said:
        assert run(script, env=environment).returncode == 0 and (tmp_path / "asked").read_text() == asked  # it is there
        (sbin / "sbatch").unlink()
        (sbin / "policy-rc.d").write_text("#!/bin/sh\nexit 7\n")
        (sbin / "policy-rc.d").chmod(0o755)
        run(script, env=environment)
        assert (tmp_path / "asked").read_text() == asked + f"7 {packages}\n" and (sbin / "policy-rc.d").exists()  # somebody's own stays


# ---- make


def made_by(root, *words, **more):
    own = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS")) and name not in ("NEEDS", "B")}  # not those of `make check`
    return run("make", "--no-print-directory", *words, cwd=root, env={**own, **more})


def test_environments_of_python(house, tmp_path):
    """Of the pins that each has, once, and again when pins change; bpy by the version of the system's Python."""
    names = ("", "-peers", "-release", "-lint", "-manual", *(f"-bpy-{version}" for version in ("4.2", "5.0", "5.2")))
    log = tmp_path / "log"
    root = house("setup.mk", files={**{f"setup/requirements{name}.txt": "" for name in names}, **{f"setup/packages-{name}.txt": "" for name in ("demo", "test", "peers", "lint", "release")},
                                    "Makefile": "B := build\nall:\n\t@echo all\ninclude setup/setup.mk\nsoak-it: debian13\nfetched:\n\t@echo fetched\n", "setup/debian13.sh": f'#!/bin/sh\necho "debian13 $*" >>{log}\n', "setup/apt.sh": f'#!/bin/sh\necho "apt $*" >>{log}\n',
                                    "setup/release-sources.sh": f'#!/bin/sh\nmkdir -p $1; echo "sources $1" >>{log}\n', "version": "3.11",
                                    "python": f'#!/bin/sh\n[ "$1" != -c ] || exec /usr/bin/python3 -c "import sys; sys.version_info = ($(tr . , <version), 9); $2"\necho "venv $3" >>{log}; mkdir -p $3/bin; printf \'#!/bin/sh\\necho "pip $*" >>{log}\\n\' >$3/bin/pip\nchmod 755 $3/bin/pip\n'})

    def made(*goals):
        log.write_text("")
        done = made_by(root, "-j1", "PYTHON3=./python", *goals)
        return done, sorted(line.split() for line in log.read_text().splitlines())
    of = lambda name, pins, *flags: [["pip", "--disable-pip-version-check", "install", "--quiet", "--retries", "5", *flags, "-r", f"setup/requirements{pins}.txt"], ["venv", f"build/venv{name}"]]
    apt = lambda *lists: [["apt", f"setup/packages-{name}.txt"] for name in lists]
    done, log_of = made("setup-demo")
    assert log_of == sorted([*apt("demo"), *of("", "")]) and done.stdout == "setup: Python packages of setup/requirements.txt into build/venv\n", done.stderr
    assert made("setup-demo")[1] == []
    (root / "setup/requirements.txt").write_text("# other\n")
    os.utime(root / "setup/requirements.txt", (2e9, 2e9))
    assert made("setup-demo")[1] == sorted(of("", ""))
    os.utime(root / "setup/requirements.txt", (1e9, 1e9))
    made("setup-demo")
    assert made("setup-peers")[1] == sorted([*apt("peers"), *of("-bpy", "-bpy-5.0"), *of("-peers", "-peers")])
    assert made("setup-lint")[1] == sorted([*apt("lint"), *of("-lint", "-lint")])
    assert made("setup-release")[1] == sorted([*apt("release"), *of("-release", "-release", "--no-deps", "--no-compile"), ["sources", "build/release/debian"]])
    for name in ("manual", "bpy-4.2"):
        assert made(f"build/venv-{name}/done")[1] == sorted(of(f"-{name}", f"-{name}"))
    for version, pins in (("3.13", "5.2"), ("3.12", None)):
        (root / "version").write_text(version)
        shutil.rmtree(root / "build/venv-bpy")
        done, log_of = made("setup-test")
        if pins:
            assert log_of == sorted([*apt("test"), *of("-bpy", f"-bpy-{pins}")])
        else:
            assert done.returncode == 2 and "PyPI has no bpy for Python 3.12" in done.stderr and log_of == []
    for version, goal, asked in (("3.11", "debian13", ["debian13", "5.2"]), ("3.13", "debian13", None), ("3.13", "soak-it", ["debian13", "5.3"]), ("3.11", "soak-it", ["debian13", "5.2", "5.3"])):
        (root / "version").write_text(version)  # of other versions than are here
        assert made(goal)[1] == ([asked] if asked else []), (version, goal)
    for needs, said in (("fetched", ""), ("none-such", "setup: what make release-addon needs can't be had: tests of its zip are skipped\n")):
        done, _log_of = made("release-fetched", f"RELEASE_NEEDS={needs}")
        assert done.returncode == 0 and done.stdout == ("" if said else "fetched\n") and done.stderr.endswith(said) and bool(said) == bool(done.stderr), done.stderr
    (root / "version").write_text("3.11")
    shutil.rmtree(root / "build")
    done, log_of = made("lint")  # a goal's needs are there before it begins
    assert log_of == sorted([*apt("demo", "lint"), *of("-lint", "-lint")]) and (root / "build/setup/lint.stamp").exists()


def test_judges_are_heard_one_after_the_other(house, tmp_path):
    """All of them and the report, whoever finds what; who found nothing is not asked again until something changes; Ctrl-C ends it."""
    log = tmp_path / "log"
    root = house(files={"compare/compare.mk": (ROOT / "compare/compare.mk").read_text(), "compare/truth.py": "", "compare/plain.c": "",
                        "Makefile": re.search(r"^\.PHONY: all .*\n", (ROOT / "Makefile").read_text(), re.M)[0] + "B := build\nL := libshade\nPY := ./python\nBLENDER_READY := build/ready\nPOVRAY := build/povray\nall povray:\n\t@:\ninclude compare/compare.mk\n",
                        "python": f'#!/bin/sh\necho "$*" >>{log}\ncase "$*" in *"$BAD"*) exit ${{STATUS:-1}} ;; esac\n'})
    listed = shlex.split(re.search(r"^JUDGES := (.*\\\n.*)$", (root / "compare/compare.mk").read_text(), re.M)[1].replace("\\\n", ""))
    assert {word.split()[0] for word in listed} == {f"{name}.py" for name in "truth slopes horizon steep_bumps fabric speed paths".split()}
    there = ["build/ready", "build/povray", "build/shade", "build/libshade-blender.zip", *(f"build/{name}" for name in ("horizon", "displaced", "bumps", "plain.so"))]
    (root / "build").mkdir()
    for name in there:
        (root / name).touch()
        os.utime(root / name, (1e9, 1e9))
    os.utime(root / "compare/truth.py", (1e9, 1e9))
    os.utime(root / "Makefile", (9e8, 9e8))

    def made(*words, bad="none", **more):
        log.write_text("")
        done = made_by(root, "-j1", "compare", *(word for name in ("demo", *there) for word in ("-o", name)), *words, BAD=bad, **more)
        return done, log.read_text().splitlines()
    plan, report = "compare/report_page.py --plan", "compare/report_page.py --results"
    done, asked = made(bad="compare/slopes.py")
    assert asked == [plan, *(f"compare/{judge}" for judge in listed), report] and done.returncode == 2, done.stderr + done.stdout
    assert "make compare: not within limits, or failed: compare/slopes.py; see above\n" in done.stderr
    done, asked = made("ENGINE=slurm")
    assert asked == [plan, "compare/slopes.py", report + " --engine slurm"] and done.returncode == 0, done.stderr
    assert [line for line in done.stdout.splitlines() if "within limits" in line] == [
        f"compare/{judge}: within limits, as found before" for judge in listed if judge != "slopes.py"]
    assert made()[1] == [plan, report]
    for name in ("build/povray", "build/shade", "build/horizon", "compare/plain.py"):  # all that one may have been measured with
        (root / name).touch()
        os.utime(root / name, (2e9, 2e9))
        assert len(made()[1]) == len(listed) + 2, name
        os.utime(root / name, (1e9, 1e9))
    (root / "compare/truth.py").touch()
    os.utime(root / "compare/truth.py", (2e9, 2e9))
    done, asked = made(bad=f"compare/{listed[1]}", STATUS="130")
    assert asked == [plan, *(f"compare/{judge}" for judge in listed[:2])] and done.returncode == 2 and "not within limits" not in done.stderr


COMPARED = {  # by goal and its words, what is asked
    "compare-quick": "compare/report_page.py --quick", "compare-quick ENGINE=slurm": "compare/report_page.py --quick --engine slurm",
    "compare-peers": "compare/report_page.py --only peers --output build/compare/peers", "compare-files": "compare/real_files.py",
    "compare-files 'FILES=--filter a --count 5'": "compare/real_files.py --filter a --count 5", "compare-materials 'MATERIALS=--blender 5.0'": "compare/materials.py --blender 5.0",
    "bench-povray": "compare/twins.py build/povray -o build/twins.csv", "bench-frames BEFORE=HEAD": "compare/bench_frames.py HEAD",
    "bench-frames 'ONLY=plate pan' 'FRAMES=--minutes 20' BEFORE=v1": "compare/bench_frames.py v1 --only plate pan --minutes 20"}


def test_what_make_compares(house, tmp_path):
    """The demo's table is kept where the verdict is good, and shown in any case; other goals ask one script each."""
    log = tmp_path / "log"
    goals = re.search(r"^\.PHONY: all .*\n", (ROOT / "Makefile").read_text(), re.M)[0]
    root = house(files={"compare/compare.mk": (ROOT / "compare/compare.mk").read_text(), "compare/page.py": "", "examples/blender/suzanne/make_scene.py": "",
                        "Makefile": goals + "B := build\nVENV_BPY := build/venv-bpy\nPY := ./python\nBLENDER_READY := build/ready\nPOVRAY := build/povray\nall povray:\n\t@:\ninclude compare/compare.mk\n",
                        "python": f'#!/bin/sh\necho "$*" >>{log}\necho a table\n[ ! -e bad ]\n',
                        "blender": f'#!/bin/sh\nfor made; do :; done\necho "blender $* by $BLENDER_USER_SCRIPTS" >>{log}\nseq 20\n[ ! -e bad ] || exit 3\ntouch $made\n'})
    (root / "build/venv-bpy").mkdir(parents=True)
    there = ["build/ready", "build/povray", "build/shade", "build/libshade-blender.zip", "build/venv-bpy/done", "povray", "setup-demo", "setup-test",
             *(f"build/{name}" for name in ("horizon", "displaced", "bumps", "plain.so"))]
    for name in there:
        if name.startswith("build/"):
            (root / name).touch()
            os.utime(root / name, (1e9, 1e9))

    def made(words):
        log.write_text("")
        done = made_by(root, "-j1", "BLENDER=./blender", *shlex.split(words), *(word for name in there for word in ("-o", name)))
        return done, log.read_text().splitlines()
    for words, wanted in COMPARED.items():
        done, asked = made(words)
        assert asked == [wanted] and done.returncode == 0, (words, done.stderr)
    done, asked = made("bench-frames")
    assert done.returncode == 2 and asked == [] and "make bench-frames: BEFORE=COMMIT is missing: what to compare with" in done.stderr
    (root / "bad").touch()
    done, asked = made("demo")
    assert done.returncode == 2 and done.stdout.splitlines()[1:16] == [f"{k}" for k in range(6, 21)] and len(asked) == 1 and not (root / "build/demo/suzanne.blend").exists()
    (root / "bad").unlink()
    scene = "blender -b --factory-startup --addons libshade --python-exit-code 1 -P examples/blender/suzanne/make_scene.py -- build/demo/suzanne.blend by build/blender"
    judge = "compare/consistency.py --all --output build/demo build/demo/suzanne.blend"
    done, asked = made("demo")
    assert asked == [scene, judge] and done.stdout == "Building the scene build/demo/suzanne.blend\na table\n" and done.returncode == 0
    done, asked = made("demo")
    assert asked == [] and done.stdout == "a table\n"
    os.utime(root / "compare/page.py", (2e9, 2e9))
    (root / "bad").touch()
    for _ in range(2):  # it is asked again until it is good
        done, asked = made("demo")
        assert asked == [judge] and done.returncode == 2 and done.stdout == "a table\n"
    os.utime(root / "compare/page.py", (1e9, 1e9))  # what was good before is so no longer
    assert made("demo")[1] == [judge]


def test_make_as_on_a_machine_that_has_nothing(house, programs, tmp_path):
    root = house("chroot-demo.sh", files={"build/.keep": "", "host/resolv.conf": "nameserver here\n", "host/ssl/ca.crt": "a certificate\n", "host/ca/one.crt": "another\n", "host/pip.conf": "[global]\n"})
    apt = {"apt-get": '[ -f "$HOME/no-lists" ] || printf "http://x/security trixie-security main\\nhttp://x/more trixie contrib\\nhttp://y sid main\\nhttp://mirror/debian trixie main\\n"'}
    stand_ins = {**apt, "id": 'cat "$HOME/user"', "debootstrap": 'mkdir -p "$3/etc/apt/apt.conf.d"; seq 25; echo wrong >&2; [ ! -f "$HOME/no-net" ]',
                 "apt-config": 'echo "Acquire::http::Proxy \\"p\\";"; echo "Acquire::Check-Valid-Until \\"0\\";"; echo "Dir \\"/\\";"', "git": 'for w; do :; done; mkdir -p "$w"', "du": "echo 9G",
                 "unshare": '[ "$1 $2 $3" = "--mount --pid --fork" ] && shift 3 && exec "$@"', "mount": '! grep -qx "$3" "$HOME/unmounted" 2>/dev/null',
                 "chroot": 'case "$*" in *"make -C"*) [ -f "$HOME/good" ] || exit 7 ;; *"install --yes"*) seq 30; [ ! -f "$HOME/no-make" ] ;; esac'}
    script = root / "setup/chroot-demo.sh"
    text = script.read_text()
    for there, here in (("/etc/resolv.conf ", "resolv.conf "), ("/etc/ssl/certs/ca-certificates.crt", "ssl/ca.crt"), ("/usr/local/share/ca-certificates", "ca"), ("/etc/pip.conf ", "pip.conf ")):
        text = text.replace(f" {there}", f" {root}/host/{here}")
    script.write_text(text)

    def made(*words, user="0", without=(), there=(), **more):
        (tmp_path / "user").write_text(user)
        for name in ("no-net", "no-make", "no-lists", "unmounted", "good"):
            (tmp_path / name).unlink(missing_ok=True)
        for name in there:
            (tmp_path / name.partition(":")[0]).write_text(name.partition(":")[2] + "\n")
        environment = programs(stand_ins, "sort", "cut", "seq", without=without)
        done = run(script, *words, env={**environment, **more})
        return done, (tmp_path / "log").read_text()
    assert [made(*words)[0].returncode for words in ((), ("sid",), ("--help",), ("-h",))] == [2, 2, 0, 0]
    assert "setup/chroot-demo.sh bookworm " in made("-h")[0].stdout
    done = made("trixie", user="1000")[0]
    assert done.returncode == 1 and done.stderr == f"{script}: needs root (chroot, mount)\n"
    done = made("trixie", without=["debootstrap"])[0]
    assert done.returncode == 1 and done.stderr == f"{script}: needs debootstrap: apt-get install debootstrap\n"
    done, log = made("bookworm", PIP_CERT="/c.pem")
    assert done.returncode == 7 and re.search(r"chroot: make demo ended with 7 after \d+ s; 9G on disk", done.stdout), done.stderr
    chroot = root / "build/chroot-bookworm"
    assert f"debootstrap --variant=minbase bookworm {chroot} http://mirror/debian\n" in log and f"git clone --quiet --no-hardlinks . {chroot}/clone" in log
    assert re.search(r"HOME=/root PATH=\S+ LANG=C\.UTF-8 TERM=dumb PIP_CERT=/c\.pem make -C /clone demo$", log, re.M) and not chroot.exists()
    inside = [line.partition(f"chroot {chroot} env -i ")[2] for line in log.splitlines() if line.startswith("chroot ")]
    assert inside[0].endswith("sh -c apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install --yes --no-install-recommends make") and len(inside) == 2
    assert log.splitlines().count(f"mount -t proc proc {chroot}/proc") == log.splitlines().count(f"mount -t tmpfs shm {chroot}/dev/shm") == 2
    assert done.stdout.splitlines()[:3] == ["chroot: debootstrap of Debian's bookworm (minbase)", "chroot: installing make", "chroot: make demo"]
    done, _log = made("bookworm", there=["good:"])
    assert done.returncode == 0 and "chroot: make demo ended with 0 after" in done.stdout
    for place in ("proc", "shm"):
        assert "\nchroot " not in made("bookworm", there=[f"unmounted:{place}"])[1]
    for there, last in (("no-net:", [*map(str, range(7, 26)), "wrong"]), ("no-make:", list(map(str, range(11, 31))))):
        done, log = made("bookworm", there=[there])
        assert done.returncode == 1 and done.stderr.splitlines() == last and not chroot.exists() and "make -C" not in log
    network = {"http_proxy": "a", "https_proxy": "b", "no_proxy": "c", "PIP_INDEX_URL": "d", "PIP_EXTRA_INDEX_URL": "e", "PIP_CERT": "f", "SSL_CERT_FILE": "g"}
    done, log = made("trixie", "blender", "povray", KEEP="1", OTHER="x", **network)
    assert " TERM=dumb " + " ".join("=".join(item) for item in network.items()) + " make -C /clone" in log
    chroot = root / "build/chroot-trixie"
    assert re.search(r"make -C /clone blender povray$", log, re.M) and "chroot: make blender povray ended with 7" in done.stdout
    assert (chroot / "etc/apt/sources.list").read_text() == "deb http://mirror/debian trixie main\ndeb http://x/security trixie-security main\n"
    assert (chroot / "etc/apt/apt.conf.d/90host").read_text() == 'Acquire::http::Proxy "p";\nAcquire::Check-Valid-Until "0";\n'
    assert (chroot / "etc/resolv.conf").read_text() == "nameserver here\n" and (chroot / "etc/pip.conf").read_text() == "[global]\n"
    assert [(chroot / f"{root}/host/{name}".lstrip("/")).exists() for name in ("ssl/ca.crt", "ca/one.crt")] == [True, True]
    assert f" bookworm {root}/build/chroot-bookworm http://deb.debian.org/debian\n" in made("bookworm", there=["no-lists:"])[1]


POVRAY = """#!/bin/sh
for word; do case $word in +I*) name=${word#+I} ;; +O*) out=${word#+O} ;; esac; done
grep -q "fails in SIDE" $name && exit 3
{ echo "P6 of $0"; head -c 18432 /dev/zero; } >$out
grep -q "new in SIDE" $name && printf x | dd of=$out bs=1 seek=$(($(stat -c %s $out) - 1)) conv=notrunc status=none
exit 0
"""


def test_scenes_that_patches_change_are_named(house):
    """By their pixels alone: a picture's head holds when it was made."""
    scenes = {"textures/same.pov": "", "textures/deep/new.pov": "new in old", "lights/one.pov": "fails in old", "lights/both.pov": "fails in old fails in new",
              "objects/other.pov": "", "textures/readme.txt": "new in old", "advanced/new.pov": "new in new"}
    root = house(files={f"scenes/{name}": text for name, text in scenes.items()} | {side: POVRAY.replace("SIDE", side) for side in ("old", "new")})
    check = lambda *words: run(ROOT / "povray_patches/check.sh", *words, env={**os.environ, "JOBS": "2"})
    done = check(root / "new", root / "old", root)
    assert done.returncode == 1 and done.stdout.splitlines()[:3] == [
        "DIFFERS lights/one.pov (exit status 0, unpatched 3)", "DIFFERS textures/deep/new.pov", "fails   lights/both.pov (both, exit status 3)"], done.stdout + done.stderr
    assert re.match(r"2 of 5 scenes pixel-identical, \d+ s$", done.stdout.splitlines()[3])
    done = check(root / "new", root / "old", root, "objects")
    assert done.returncode == 0 and "1 of 1 scenes" in done.stdout
    assert check("--help").returncode == 0 and "SCENE-FOLDER" in check("-h").stdout and check(root / "new", root / "old").returncode == 2
    for words, said in (((root / "none", root / "old", root), "none: no such program"), ((root / "new", root / "none", root), "none: no such program"),
                        ((root / "new", root / "old", root, "odd"), "scenes/odd: no such folder")):
        done = check(*words)
        assert done.returncode == 2 and said in done.stderr


# ---- DLLs


def dll(*names, magic=b"PE\0\0\x64\x86"):
    """A DLL of one section, from 0x400 on, at address 0x1000, whose table of imports begins 16 bytes in."""
    data = bytearray(0x800)
    data[:2] = b"MZ"
    struct.pack_into("<I", data, 0x3C, 0x80)
    data[0x80:0x86] = magic
    struct.pack_into("<H", data, 0x86, 1)
    struct.pack_into("<H", data, 0x94, 240)
    struct.pack_into("<I", data, 0x80 + 24 + 112 + 8, 0x1010)
    struct.pack_into("<IIII", data, 0x80 + 24 + 240 + 8, 0x200, 0x1000, 0x400, 0x400)
    at = 0x100
    for number, name in enumerate(names):
        struct.pack_into("<I", data, 0x410 + 20 * number + 12, 0x1000 + at)
        data[0x400 + at:0x400 + at + len(name)] = name.encode()
        at += len(name) + 3
    return bytes(data)


def test_a_dll_that_looks_for_others(tmp_path):
    """By names that are no longer; a file that is no DLL, and a name that does not fit, are said."""
    (tmp_path / "a.dll").write_bytes(dll("tbb12.dll", "other.dll"))
    tool = ROOT / "setup/own_dll.py"
    done = run(sys.executable, tool, tmp_path / "a.dll", tmp_path / "b.dll", "tbb12.dll=own.dll", "other.dll=third.dll")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "") and sorted(path.name for path in tmp_path.iterdir()) == ["a.dll", "b.dll"]
    wanted = bytearray(dll("tbb12.dll", "other.dll"))
    wanted[0x500:0x509], wanted[0x50C:0x515] = b"own.dll\0\0", b"third.dll"
    assert (tmp_path / "b.dll").read_bytes() == wanted
    for names, said in ((["tbb12.dll=longer-one.dll"], "longer-one.dll cannot take the place of tbb12.dll: it needs tbb12.dll, other.dll"),
                        (["none.dll=a.dll"], "a.dll cannot take the place of none.dll: it needs tbb12.dll, other.dll")):
        done = run(sys.executable, tool, tmp_path / "a.dll", tmp_path / "c.dll", *names)
        assert done.returncode == 1 and done.stderr == f"own_dll.py: {tmp_path}/a.dll: {said}\n" and not (tmp_path / "c.dll").exists()
    for data, said in ((dll("a.dll", magic=b"PE\0\0\x4c\x01"), "no DLL for x86-64"), (b"ELF" + dll("a.dll")[3:], "no DLL for x86-64"),
                       (dll("a.dll").replace(struct.pack("<I", 0x1010), struct.pack("<I", 0x3010)), "address 0x3010 is in no section")):
        (tmp_path / "a.dll").write_bytes(data)
        assert said in run(sys.executable, tool, tmp_path / "a.dll", tmp_path / "c.dll").stderr
    done = run(sys.executable, tool, "a.dll")
    assert done.returncode == 1 and "usage: own_dll.py FROM TO [OLD=NEW...]" in done.stderr


# ---- pictures


def test_sheets_of_pictures_are_full(monkeypatch, tmp_path):
    """Nothing lies on anything, no place stays empty, and each scene is there."""
    spec = importlib.util.spec_from_file_location("pictures_of_the_manual", ROOT / "setup/pictures.py")
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    covered = [[0] * 480 for _ in range(270)]
    for _name, _words, (x, y, width, height) in pictures._BLENDER:
        for row in covered[y:y + height]:
            row[x:x + width] = [count + 1 for count in row[x:x + width]]
    assert {count for row in covered for count in row} == {1}
    assert [2 * sum(width for *_scene, width in scenes) for _height, scenes in pictures._TWINS] == [1152] * 3
    strip = pictures.side_by_side([Image.new("RGB", (2, 3), "red"), Image.new("RGB", (1, 3), "blue")])
    assert (strip.size, strip.getpixel((1, 2)), strip.getpixel((2, 0))) == ((3, 3), (255, 0, 0), (0, 0, 255))
    assert pictures.scaled(Image.new("RGB", (400, 100))).size == (1600, 400)
    asked = []

    def rendered(words, **_options):
        asked.append([str(word) for word in words])
        for word in asked[-1]:
            path = word.removeprefix("+O")
            if path.endswith(".png"):
                Path(path).parent.mkdir(parents=True, exist_ok=True)
                Image.new("RGB", (960, 540), (len(asked), 0, 0)).save(path)
    (tmp_path / "examples").mkdir()
    monkeypatch.setattr(pictures, "ROOT", tmp_path)
    monkeypatch.setattr(pictures.subprocess, "run", rendered)
    pictures.povray_sheet()
    names = [re.search(r"examples/povray/(\w+)/\1\.pov", " ".join(words))[1] for words in asked[1:]]
    assert sorted([*names, "suzanne", "cloth", "cookbook"]) == sorted({path.parent.name for path in (ROOT / "examples/povray").glob("*/*.pov")})
    sheet = Image.open(tmp_path / "examples/povray.jpg")
    assert sheet.size == (1440, 810)
    for k in range(9):  # in the order of their names, by rows
        assert abs(sheet.getpixel((480 * (k % 3) + 240, 270 * (k // 3) + 135))[0] - (k + 2)) <= 2
    asked.clear()
    pictures.povray_cloth()
    pictures.swatches()
    assert "+W960" in asked[0] and Image.open(tmp_path / "examples/povray-cloth.jpg").size == (960, 540)
    assert asked[1][1:5] == ["swatch", "--all", "--size", "136"] and (tmp_path / "examples/swatches.jpg").exists()
    steps = ["swatches", "blender_sheet", "twins", "povray_cloth", "povray_sheet"], ["nodes", "first", "effects", "cookbook"]
    for name in (*steps[0], *steps[1]):
        monkeypatch.setattr(pictures, name, lambda name=name: asked.append(name))
    for name in ("blender", "povray"):
        monkeypatch.setattr(pictures, "DEMO", tmp_path)
        Image.new("RGB", (800, 450), name == "povray" and "red" or "blue").save(tmp_path / f"{name}.png")
    monkeypatch.setattr(pictures, "STRIP", tmp_path / "povray.png")
    for make, wanted in zip((pictures.main, pictures.manual), steps):
        asked.clear()
        make()
        assert asked == wanted
    both = Image.open(tmp_path / "examples/suzanne.jpg")
    assert both.size == (1600, 450) and both.getpixel((10, 10))[2] > 200 and both.getpixel((1590, 10))[0] > 200  # Blender's on the left
    assert Image.open(tmp_path / "examples/plate.jpg").size == (1600, 900)


STARTED = {  # by function, what it starts in the tree's folder
    "swatches": ["build/shade swatch --all --size 136 -o build/swatches.png"],
    "povray_cloth": ["build/povray/povray +Iexamples/povray/cloth/cloth.pov +Obuild/povray-cloth.png +W960 +H540 +A0.1 -D -V"],
    "povray_sheet": ["build/shade weave --name basket --cells 16 --curve .35 --ridge 0 --map normal --bits 16 -o build/basket.png",
                     *(f"build/povray/povray +Iexamples/povray/{name}/{name}.pov +Lbuild +Obuild/povray-{name}.png +W960 +H540 +A0.2 -D -V"
                       for name in "embossed lampshade reflection kitchen presets inlay scratches turned metals".split())],
    "blender_sheet": [f"blender -b --factory-startup --addons libshade --python-exit-code 1 -P examples/blender/{name}/make_scene.py -- build/blender-{name}{end}"
                      for name, end in (("pan", ".png"), ("dial", ".png"), ("drape", ".png"), ("jacket", ".png"), ("jacket", "-near.png near"))],
    "twins": [f"blender -b --factory-startup --addons libshade --python-exit-code 1 -P examples/blender/{name}/make_scene.py -- build/blender-{name}{end}"
              for name, end in (("pan", "-cycles.png cycles"), ("dial", "-cycles.png cycles"), ("scratches", ".png"), ("scratches", "-cycles.png cycles"),
                                ("jacket", "-near-cycles.png near cycles"), ("drape", "-cycles.png cycles"), ("jacket", "-cycles.png cycles"))],  # ours are there
    "nodes": ["xvfb-run -a -s -screen 0 1600x1100x24 blender --factory-startup --window-geometry 0 0 1600 1100 --addons libshade "
              "-P examples/blender/nodes/make_pictures.py -- examples/nodes"],
    "first": ["blender -b --factory-startup --addons libshade --python-exit-code 1 -P examples/blender/nodes/make_first.py -- build/first.png"],
    "effects": ["build/venv-bpy/bin/python examples/blender/nodes/make_effects.py -- docs/pictures"],
    "cookbook": ["build/povray/povray +Ia_b.pov +Obuild/map.png Declare=Map=1 -D -V", "build/povray/povray +Ia_b.pov +Obuild/a_b.png -D -V"],
}
MADE = {"swatches": ("examples/swatches.jpg", (8, 6)), "povray_cloth": ("examples/povray-cloth.jpg", (8, 6)), "povray_sheet": ("examples/povray.jpg", (1440, 810)),
        "blender_sheet": ("examples/blender.jpg", (1440, 810)), "twins": ("examples/twins.jpg", (1152, 620)), "first": ("docs/pictures/first.jpg", (640, 360)),
        "cookbook": ("docs/pictures/povray-a-b.jpg", (480, 270))}


def test_what_is_started_for_pictures(monkeypatch, tmp_path):
    """Of this tree's programs and add-on, and where it lands; a render of Blender's that is there stays."""
    spec = importlib.util.spec_from_file_location("pictures_of_the_manual", ROOT / "setup/pictures.py")
    pictures = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(pictures)
    for folder in ("examples/povray/cookbook", "examples/nodes", "docs/pictures", "build"):
        (tmp_path / folder).mkdir(parents=True)
    for name in ("a_b", "costs"):
        (tmp_path / f"examples/povray/cookbook/{name}.pov").write_text(
            f"// A scene.\n//   build/povray/povray +I{name}.pov +Obuild/map.png Declare=Map=1\n//   build/povray/povray +I{name}.pov +Obuild/{name}.png\n")
    Image.new("RGB", (8, 6), "red").save(tmp_path / "examples/nodes/a.png")
    asked, colours = [], {}

    def started(words, check, env=None, cwd=None, **_options):
        words = [str(word) for word in words]
        assert check and (words[0] not in ("blender", "xvfb-run") or env["BLENDER_USER_SCRIPTS"] == str(tmp_path / "build/blender"))
        asked.append(" ".join(words).replace(f"{tmp_path}/", ""))
        for word in words:
            path = Path(word.removeprefix("+O"))
            if path.suffix == ".png":
                colours[path.name] = colour = 3 + 8 * len(colours)
                Image.new("RGB", (8, 6), (colour,) * 3).save((cwd or tmp_path) / path)
    monkeypatch.setattr(pictures, "ROOT", tmp_path)
    monkeypatch.setattr(pictures.subprocess, "run", started)
    for name, wanted in STARTED.items():
        asked.clear()
        getattr(pictures, name)()
        assert asked == wanted, name
        if name in MADE:
            made = Image.open(tmp_path / MADE[name][0])
            assert made.size == MADE[name][1] and made.mode == "RGB" and made.info["progressive"], name
    assert Image.open(tmp_path / "examples/nodes/a.png").mode == "P" and not (tmp_path / "docs/pictures/povray-costs.jpg").exists()
    asked.clear()
    pictures.blender_sheet()
    assert not asked
    both = Image.open(tmp_path / "examples/twins.jpg")  # by rows ours and, on its right, Cycles'
    for (x, y), name in {(4, 4): "pan", (284, 157): "pan", (292, 4): "pan-cycles", (580, 4): "dial", (1148, 157): "dial-cycles", (4, 166): "scratches", (634, 200): "jacket-near",
                         (1148, 368): "jacket-near-cycles", (4, 376): "drape", (542, 616): "jacket", (1148, 616): "jacket-cycles"}.items():
        assert abs(both.getpixel((x, y))[0] - colours[f"blender-{name}.png"]) < 4, name
    sheet = Image.open(tmp_path / "examples/blender.jpg")
    for (x, y), name in {(4, 4): "pan", (1436, 400): "dial", (4, 410): "drape", (442, 806): "jacket", (1436, 806): "jacket-near"}.items():
        assert abs(sheet.getpixel((x, y))[0] - colours[f"blender-{name}.png"]) < 4, name


def test_pictures_of_nodes_are_cut_out(monkeypatch, tmp_path):
    """By what is not the editor's background, but its header and scroll bars; one after another, then Blender ends."""
    done, files = [], {}
    area, region = types.SimpleNamespace(width=80, height=60), types.SimpleNamespace(type="WINDOW")
    area.regions = [types.SimpleNamespace(type="HEADER"), region]
    window = types.SimpleNamespace(screen=types.SimpleNamespace(areas=[types.SimpleNamespace(width=90, height=3), area]), width=1600, cursor_warp=lambda *place: done.append(place))
    shown = np.full((200, 300, 4), .2, np.float32)
    shown[80:120, 100:180] = .9
    shown[-34:] = shown[:20] = shown[:, -20:] = .5
    shown[150, 40:45] = 1  # a grid's point

    class Pictured:
        def __init__(self, name, *size):
            self.name, self.size, self.pixels = name, size, self

        def foreach_set(self, values):
            self.made = np.reshape(values, (self.size[1], self.size[0], 4))

        def save(self):
            files[self.filepath_raw] = (self.file_format, self.made)
    step = lambda name: lambda *given, **words: done.append((name, *given, words))
    ops = types.SimpleNamespace(wm=types.SimpleNamespace(quit_blender=step("quit"), redraw_timer=step("draw")), node=types.SimpleNamespace(view_all=step("all")),
                                screen=types.SimpleNamespace(screenshot_area=step("taken")))
    timers, view = [], types.SimpleNamespace(show_splash=True, show_tooltips=True, smooth_view=200)
    context = types.SimpleNamespace(window_manager=types.SimpleNamespace(windows=[window]), preferences=types.SimpleNamespace(view=view), temp_override=lambda **_words: contextlib.nullcontext(),
                                    scene=types.SimpleNamespace(render=types.SimpleNamespace(engine="")))
    images = types.SimpleNamespace(load=lambda _path: types.SimpleNamespace(size=(300, 200), pixels=shown.ravel()), new=Pictured)
    monkeypatch.setitem(sys.modules, "bpy", types.SimpleNamespace(ops=ops, context=context, data=types.SimpleNamespace(images=images), app=types.SimpleNamespace(
        timers=types.SimpleNamespace(register=lambda call, first_interval: timers.append((call, first_interval))))))
    monkeypatch.setattr(sys, "argv", ["blender", "--", str(tmp_path / "made")])
    runpy.run_path(str(ROOT / "examples/blender/nodes/make_pictures.py"))
    (pictures, first), = timers
    assert first > 1 and (view.show_splash, view.show_tooltips, view.smooth_view) == (False, False, 0) and (tmp_path / "made").is_dir()
    assert [make.__name__ for make in pictures.left] == ["metal", "fabric", "groove", "scratches"] and context.scene.render.engine == "LIBSHADE"
    monkeypatch.setattr(type(pictures), "show", lambda _self, make: done.append(make.__name__))
    waits = [pictures() for _ in range(16)]
    assert waits == [.7] * 15 + [None] and done[-1] == ("quit", {})
    drawn = ("draw", {"type": "DRAW_WIN_SWAP", "iterations": 1})
    for k, name in enumerate(("metal", "fabric", "groove", "scratches")):
        path = str(tmp_path / f"made/{name}.png")
        assert done[6 * k:6 * k + 6] == [name, (1596, 4), drawn, ("all", {}), drawn, ("taken", {"filepath": path})]
        kind, made = files[path]
        assert kind == "PNG" and (made == shown[64:135, 84:195]).all()  # sixteen pixels around
