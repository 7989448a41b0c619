# SPDX-License-Identifier: Apache-2.0
"""The Python module: its structures and prototypes against a C compiler and the headers, what it shades against the
reference (through the tool), arrays of all shapes, errors."""
import contextlib
import doctest
import inspect
import itertools
import math
import os
import pathlib
import pickle
import re
import subprocess
import sys
import textwrap
import warnings

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "libshade" / "python"))
import shade  # noqa: E402
from shade import _library, _structs  # noqa: E402

COST = 1.9

SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))
HEADERS = sorted((ROOT / "libshade/include/shade").glob("*.h"))


# ---- the C interface ------------------------------------------------------------------------

def test_structures(tmp_path):
    """Size of every structure, offset and size of every member, as a C compiler has them."""
    structures = [*_structs.ALL, _library.Preset]
    lines, ours = [], []
    for structure in structures:
        for name in structure.c_names:
            if structure is not _structs.ParamsHead:
                lines.append(f'printf("{name} %zu\\n", sizeof({name}));')
                ours.append(f"{name} {_structs.ctypes.sizeof(structure)}")
            for member, _ in structure._fields_:
                field = getattr(structure, member)
                lines.append(f'printf("{name}.{member} %zu %zu\\n", offsetof({name}, {member}), '
                             f'sizeof((({name} *)0)->{member}));')
                ours.append(f"{name}.{member} {field.offset} {field.size}")
    (tmp_path / "print.c").write_text(
        "#include <stdio.h>\n" + "".join(f'#include "shade/{header.name}"\n' for header in HEADERS)
        + "int main(void) {\n" + "\n".join(lines) + "\n}\n")
    subprocess.run(["cc", "-std=c11", f"-I{ROOT}/libshade/include", "print.c", "-o", "print"], cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "print"], capture_output=True, text=True, check=True).stdout
    assert printed.splitlines() == ours
    assert len(ours) > 250


def kind(declared):
    """p, s, n, i, u, d or v, as _library.PROTOTYPES writes them, of a C declaration without its name."""
    if "*" in declared or "[" in declared:
        return "s" if re.match(r"const char \*(?!\*)", declared) else "p"
    word = declared.split()[0]
    return {"size_t": "n", "unsigned": "u", "double": "d", "void": "v"}.get(word, "i")


def test_prototypes():
    text = "".join(header.read_text() for header in HEADERS)
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    declared = {}
    for returns, name, parameters in re.findall(r"SHADE_API\s+([^;(]*?)(\bshade_\w+)\(([^)]*)\)", text):
        listed = [" ".join(p.split()) for p in parameters.split(",")]
        declared[name] = kind(returns) + " " + "".join(kind(p) for p in listed if p != "void")
    for line in filter(None, _library.PROTOTYPES.splitlines()):
        returns, name, *parameters = line.split()
        assert f"{returns} {''.join(parameters)}" == declared[name], name


def test_types():
    """Everything public says what it takes and gives; mypy (make lint) holds the code to it."""
    public = [made for name in shade.__all__ if callable(made := getattr(shade, name))]
    public += [method for made in public if inspect.isclass(made) for name, method in vars(made).items()
               if inspect.isfunction(method) and (not name.startswith("_") or name == "__init__")]
    functions = [made for made in map(inspect.unwrap, public) if inspect.isfunction(made)]
    untyped = [f"{made.__qualname__}: {name}" for made in functions
               for name in [*inspect.signature(made).parameters, "return"] if name not in (*made.__annotations__, "self")]
    assert not untyped and len(functions) > 25 and (ROOT / "libshade/python/shade/py.typed").exists()


@pytest.mark.parametrize("name, says", [
    ("/no/such/libshade.so", "no such file"), (str(ROOT / "README.md"), "invalid ELF")])
def test_no_library(name, says, monkeypatch):
    """What `import shade` does."""
    monkeypatch.setenv("LIBSHADE_LIBRARY", name)
    with pytest.raises((ImportError, OSError), match=says) as failed:
        _library.load(_library.found())
    assert name in str(failed.value)


def test_a_library_of_another_version():
    with pytest.raises(ImportError, match="libm.so.6 has no shade_params_init: it is of another version than this module"):
        _library.load("libm.so.6")


def test_which_library(tmp_path, monkeypatch):
    """That of the same `make install`; else the tree's that was built last."""
    here, build = tmp_path / "libshade/python/shade", tmp_path / "build"
    here.mkdir(parents=True)
    build.mkdir()
    monkeypatch.delenv("LIBSHADE_LIBRARY", raising=False)
    monkeypatch.setattr(_library, "HERE", here)
    with pytest.raises(ImportError, match="run make"):
        _library.found()
    for seconds, name in ((3, "libshade.so.0.2.0"), (9, "libshade.so.0.3.0"), (6, "libshade.so.0.4.0")):
        (build / name).touch()
        os.utime(build / name, (seconds, seconds))
    assert _library.found() == str(build / "libshade.so.0.3.0")
    (here / "library.txt").write_text("../../../build/libshade.so.0.4.0\n")
    assert os.path.realpath(_library.found()) == str(build / "libshade.so.0.4.0")
    (build / "libshade.so.0.4.0").unlink()
    with pytest.raises(ImportError, match="no such file"):
        _library.found()


def test_page_examples():
    """The examples of docs/library/python.md, in order, in one session."""
    page = (ROOT / "docs/library/python.md").read_text(encoding="utf-8")
    blocks = "\n".join(re.findall(r"^```python\n(.*?)^```$", page, flags=re.S | re.M))
    parsed = doctest.DocTestParser().get_doctest(blocks, {}, "python.md", "docs/library/python.md", 0)
    assert len(parsed.examples) > 20
    assert doctest.DocTestRunner().run(parsed).failed == 0


def test_first_steps(capsys):
    """Python in five minutes, word for word; and what the page says of its numbers."""
    page = (ROOT / "docs/start/python.md").read_text(encoding="utf-8")
    code = re.search(r"^ +import numpy.*\n(?: +\S.*\n)+", page, re.M)[0]
    exec("\n".join(line.strip() for line in code.splitlines()), {})
    exec("\n".join(line.strip() for line in code.splitlines()).replace("ex=200, ey=10", "ex=10, ey=200"), {})
    fast, slow = (np.array(text.split(), float) for text in re.findall(r"\[([^]]*)\]", capsys.readouterr().out))
    assert len(fast) == 18 and (np.diff(fast[:8]) < 0).all()
    assert fast[4] / fast[0] < .5 * slow[4] / slow[0]


def test_first_curve(tmp_path, monkeypatch):
    """The page's picture, word for word: two curves that peak at different angles."""
    pytest.importorskip("matplotlib.pyplot").close("all")  # what another test drew
    page = (ROOT / "docs/start/python.md").read_text(encoding="utf-8")
    code = re.search(r"^    import matplotlib.*\n(?:    .+\n)+", page, re.M)[0]
    monkeypatch.chdir(tmp_path)
    said = {}
    exec(textwrap.dedent(code), said)
    assert (tmp_path / "lobes.png").stat().st_size > 1000
    peaks = [line.get_ydata().argmax() for line in said["plt"].gca().get_lines()]
    said["plt"].close()
    assert len(peaks) == 2 and peaks[0] != peaks[1]


def test_reference_examples():
    """Those of the docstrings, which are the manual's reference; each public name is in it, and has one of its own or of its methods."""
    page = (ROOT / "docs/library/python.md").read_text(encoding="utf-8")
    shown = set(re.findall(r"^\.\. auto(?:function|class|data):: shade\.(\w+)(?:\(\))?$", page, re.M))
    assert shown == set(shade.__all__)
    without = []
    for name in sorted(shown - {"library"}):
        tests = doctest.DocTestFinder(recurse=True).find(inspect.unwrap(getattr(shade, name)), name, globs={"np": np, "shade": shade})
        assert all(doctest.DocTestRunner().run(one).failed == 0 for one in tests), name
        without += [] if any(one.examples for one in tests) else [name]
    assert not without


# ---- values against the reference -------------------------------------------------------------

def tool(what, options, *columns):
    """`shade eval` by the reference, a line of numbers for a row of the columns. Of colours it takes grey ones."""
    lines = "\n".join(" ".join(map(repr, row)) for row in np.concatenate(columns, -1).tolist()) + "\n"
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    done = subprocess.run([SHADE, "eval", "--what", what, "--precision", "reference", *words], input=lines, text=True,
                          capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    return np.array(done.stdout.split(), float).reshape(len(columns[0]), -1)


def reference_f(options, *columns):
    """f in three channels, each by the colours' own."""
    return np.concatenate([tool("f", {name: value[c] if isinstance(value, tuple) else value
                                      for name, value in options.items()}, *columns) for c in range(3)], -1)


def directions(count, seed, lowest=0.2):
    random = np.random.default_rng(seed)
    z, phi = random.uniform(lowest, 1, count), random.uniform(0, 2 * np.pi, count)
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], -1)


COUNT = 40
SCRATCH = {"pits": 1, "radius": 0.01, "stretch": 1}
N, WI, WO = directions(COUNT, 1, 0.6), directions(COUNT, 2), directions(COUNT, 3)


@pytest.mark.parametrize("detail", list(shade.choices("detail")))
def test_d(detail):
    for mdf in shade.choices("mdf"):
        lobe = {"ex": 60.0, "ey": 7.0} if mdf == "ashikhmin_shirley" else {"ax": 0.2, "ay": 0.5}
        material = shade.Material(mdf=mdf, detail=detail, **lobe)
        h = directions(COUNT, 4, 0.3)
        truth = tool("D", {"mdf": mdf, "detail": detail, **lobe}, N, h)[:, 0]
        assert shade.D(material, N, h) == pytest.approx(truth, rel=1e-10, abs=1e-12)
        ours = shade.D(material, N.astype("f4"), h.astype("f4"))
        assert ours.dtype == np.float32 and ours == pytest.approx(truth, rel=1e-3, abs=1e-6)


MATERIALS = [
    {"ex": 80.0, "ey": 9.0, "fresnel": "schlick", "f0": (0.9, 0.5, 0.2), "kd": (0.1, 0.2, 0.3), "diffuse": "fibre",
     "horizon": "valid_estevez"},
    {"mdf": "ggx", "ax": 0.15, "ay": 0.4, "brdf": "microfacet", "detail": "gram_schmidt", "fresnel": "f82",
     "f0": (0.9, 0.5, 0.2), "f82": (0.8, 0.7, 0.6), "horizon": "schuessler",
     "multiscatter": "on"},
    {"mdf": "beckmann", "ax": 0.4, "ay": 0.2, "groove": "y", "fresnel": "conductor",
     "eta": (1.5, 1.0, 0.6), "k": (7.0, 6.0, 5.0), "horizon": "hard"}]


@pytest.mark.parametrize("values", MATERIALS)
def test_eval_and_pdf(values):
    material = shade.Material(**values)
    options = {key: value for key, value in values.items() if key != "fresnel"}
    truth = reference_f(options, N, WI, WO)
    said = shade.Status()
    f, cosine = shade.eval(material, N, WI, WO, status=said)
    assert f == pytest.approx(truth, rel=1e-9, abs=1e-12) and (truth > 0).any() and not said
    assert cosine.shape == (COUNT,) and np.all((cosine > 0) | (f[:, 0] == 0))
    grey = {name: 0.5 if isinstance(value, tuple) else value for name, value in options.items()}
    plain = material.replace(**{name: 0.5 for name, value in options.items() if isinstance(value, tuple)})
    density = tool("pdf", grey, N, WI, WO)[:, 0]
    assert shade.pdf(plain, N, WI, WO) == pytest.approx(density, rel=1e-9, abs=1e-12)
    u = np.random.default_rng(5).random((COUNT, 2))
    wi, f, pdf, cosine = shade.sample(plain, N, WO, u)
    drawn = pdf > 0
    assert wi == pytest.approx(tool("sample", grey, N, WO, u)[:, :3], abs=1e-12)
    assert drawn.any() and np.all(wi[~drawn] == 0)
    assert np.linalg.norm(wi[drawn], axis=-1) == pytest.approx(1, abs=1e-9)
    assert f[drawn] == pytest.approx(reference_f(grey, N[drawn], wi[drawn], WO[drawn]), rel=1e-6)
    assert pdf[drawn] == pytest.approx(tool("pdf", grey, N[drawn], wi[drawn], WO[drawn])[:, 0], rel=1e-6)


def test_parameters_of_each_sample():
    """A lane with its own parameters is the material that has them; the groove turns the frame."""
    base = shade.Material(mdf="ggx", brdf="microfacet", kd=0.2)
    random = np.random.default_rng(6)
    ax, ay, f0 = random.uniform(0.1, 0.6, 5), random.uniform(0.1, 0.6, 5), random.random((5, 3))
    f, _ = shade.eval(base, N[:5], WI[:5], WO[:5], ax=ax, ay=ay, f0=f0, kd=(0.1, 0.3, 0.5))
    for k in range(5):
        options = {"mdf": "ggx", "brdf": "microfacet", "ax": ax[k], "ay": ay[k], "f0": tuple(f0[k].tolist()),
                   "kd": (0.1, 0.3, 0.5), "horizon": "valid_estevez"}
        assert f[k] == pytest.approx(reference_f(options, N[k:k + 1], WI[k:k + 1], WO[k:k + 1])[0], rel=1e-9)
    narrow = shade.Material(mdf="ggx", ax=0.11, ay=0.07)
    assert shade.pdf(base, N, WI, WO, ax=0.11, ay=0.07, parts="specular") == pytest.approx(
        shade.pdf(narrow.replace(brdf="microfacet"), N, WI, WO), rel=1e-6)
    quarter = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    turned = shade.eval(base, N @ quarter.T, WI @ quarter.T, WO @ quarter.T).f
    assert shade.eval(base, N, WI, WO, groove=(0, 1)).f == pytest.approx(turned, rel=1e-9)
    both, specular, diffuse = (shade.eval(base, N, WI, WO, parts=p).f for p in ("both", "specular", "diffuse"))
    assert both == pytest.approx(specular + diffuse, rel=1e-9) and (diffuse > 0).any() and (specular > 0).any()


# ---- arrays --------------------------------------------------------------------------------------

def test_shapes_and_types():
    material = shade.Material(ex=50, ey=5)
    one = shade.D(material, None, WI[3])
    assert isinstance(one, float) and one == shade.D(material, (0, 0, 1), WI)[3]
    grid = shade.eval(material, N[:4, None], WI[None, :6], WO[0])
    assert grid.f.shape == (4, 6, 3) and grid.cosine.shape == (4, 6)
    assert grid.f[2, 5].tolist() == shade.eval(material, N[2], WI[5], WO[0]).f.tolist()
    strided = np.asfortranarray(np.repeat(WI, 2, 0))[::2]
    assert not strided.flags.c_contiguous
    assert shade.D(material, N, strided).tolist() == shade.D(material, N, WI).tolist()
    assert shade.D(material, N[:0], WI[:0]).shape == (0,)
    assert shade.D(material, N.astype("f4"), WI).dtype == np.float64
    assert shade.D(material, N.astype("f4"), [0, 0, 1]).dtype == np.float32
    assert shade.D(material, None, [0, 0, 1]).dtype == np.float64
    assert shade.D(material, N.astype("f4").astype("f2"), WI.astype("f4")).dtype == np.float32
    peak = math.sqrt(51 * 6) / 2 / math.pi
    assert shade.D(material, [[0, 0, 1]], [[0, 0, 1], [0, 0, 1]]) == pytest.approx([peak] * 2)
    drawn = shade.sample(material, N[:, None], WO[:, None], np.full((7, 2), 0.5))
    assert drawn.wi.shape == (COUNT, 7, 3) and drawn.pdf.shape == (COUNT, 7)


def test_slopes_of_a_map():
    """Of the material, or of each sample; the digits are those of the C tests."""
    slopes = (0.1, -0.2, 0.2, 0.05, 0.1)
    flat = shade.Material(mdf="ggx", ax=0.2, ay=0.4, horizon="mutual")
    bumpy = flat.replace(slopes=slopes)
    assert bumpy.slopes == slopes and eval(repr(bumpy)).slopes == slopes and flat.slopes == (0,) * 5
    assert "slopes" not in flat.json() and bumpy.json()["slopes"] == list(slopes)
    whole = shade.eval(bumpy, N, WI, WO)
    assert whole.f.tolist() == shade.eval(flat, N, WI, WO, slopes=slopes).f.tolist()
    assert whole.f.tolist() != shade.eval(flat, N, WI, WO).f.tolist()
    for wrong in ((1, 2), (0, 0, -1, 0, 1), (0, 0, 1, 2, 1), (np.nan, 0, 1, 0, 1)):
        with pytest.raises(ValueError, match="slopes: .* expected x, y from"):
            shade.Material(slopes=wrong)


def test_what_was_mended_is_said():
    said = shade.Status()
    assert not said and str(said) == "ok"
    assert shade.D(shade.Material(), [0, 0, -1.0], [0, 0, 1.0], status=said) >= 0
    assert str(said) == "clamped normal" and repr(said) == "<shade.Status: clamped normal>" and "clamped normal" in said and "bad input" not in said
    f = shade.eval(shade.Material(), None, [np.nan, 0, 1], [0, 0, 1], status=said).f
    assert f.tolist() == [0, 0, 0] and "bad input" in said and said.bits == 6 and str(said) == "clamped normal, bad input"


def test_materials():
    material = shade.Material(mdf="GGX", ax=0.2, ay=0.5, f0=0.3)
    assert (material.mdf, material.ax, material.f0) == ("ggx", 0.2, (0.3, 0.3, 0.3))
    assert {"mdf", "brdf", "detail", "groove", "diffuse", "horizon", "multiscatter", "ex", "ey", "ax", "ay", "f0", "f82", "eta", "k", "kd", "slopes", "replace", "json"} <= set(dir(material))
    other = material.replace(detail="gram-schmidt", ex=98.0)
    assert other.detail == "gram_schmidt" and other.ax == pytest.approx(math.sqrt(2 / 100)) and other.ay == 0.5
    assert material.detail == "rotate" and material.ax == 0.2
    assert shade.D(pickle.loads(pickle.dumps(other)), N, WI).tolist() == shade.D(other, N, WI).tolist()
    assert all(eval(repr(made)).json() == made.json() for made in (other.replace(slopes=(0, 0, .1, 0, 0)), other.replace(slopes=(.1, 0, .2, .1, .3))))
    assert "slopes" not in repr(other) and eval(repr(other)).json() == other.json() and other.json(7, "it")["name"] == "it"
    # the version of the defaults: of what is not said, of a preset too, and not of what is
    assert material.brdf == "auto" and shade.Material(preset="brushed_steel").brdf == "auto"
    older = shade.Material(mdf="ggx", defaults=0)
    assert older.brdf == "ashikhmin_shirley" and eval(repr(older)).json() == older.json()
    assert shade.Material(preset="brushed_steel", defaults=0).brdf == "ashikhmin_shirley"
    assert shade.Material(defaults=0, brdf="ward-dur").brdf == "ward_dur" and shade.Material(defaults=1).brdf == "auto"
    flat = (np.array((0, 0, 1.0)), WI, WO)
    truths = [tool("f", {"mdf": "ggx", "defaults": version, "horizon": "valid_estevez", "f0": 1}, *(np.tile(v, (COUNT, 1))
              if v.ndim < 2 else v for v in flat)) for version in (0, 1)]
    assert shade.eval(older, *flat).f[:, :1] == pytest.approx(truths[0]) != pytest.approx(truths[1])
    assert shade.eval(older.replace(brdf="auto"), *flat).f[:, :1] == pytest.approx(truths[1])
    # what an older version pickled is shorter
    ours, (params,) = older.replace(brdf="auto").__reduce__()
    for size, brdf in ((_library.DEFAULTS_AT, "ashikhmin_shirley"), (_library.DEFAULTS_AT + 8, "auto")):  # without and with `defaults`
        assert ours(size.to_bytes(8, sys.byteorder) + params[8:size]).json()["brdf"] == brdf
    # multiscatter where nothing reads it is told, once
    with pytest.warns(UserWarning, match="multiscatter on changes nothing with mdf ward and brdf auto; it needs mdf ggx or beckmann") as said:
        deaf = shade.Material(mdf="ward", multiscatter="on")
    assert said[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert deaf.replace(ax=.2).replace(mdf="ggx").multiscatter == "on" and pickle.loads(pickle.dumps(deaf)).mdf == "ward"
        for mdf, brdf, quiet in (("ggx", "auto", True), ("ggx", "microfacet", True), ("beckmann", "microfacet", True), ("ggx", "ward-dur", False), ("ward-half", "auto", False)):
            lost = f"with mdf {mdf} and brdf {brdf}".replace("-", "_")
            for make in (lambda: shade.Material(mdf=mdf, brdf=brdf, multiscatter="on"), lambda: shade.Material(mdf="ggx", multiscatter="on").replace(mdf=mdf, brdf=brdf)):
                with contextlib.nullcontext() if quiet else pytest.raises(UserWarning, match=lost):
                    make()
        with pytest.raises(UserWarning, match="with mdf ward"):
            shade.Material(mdf="ggx", multiscatter="on").replace(mdf="ward")
    gold = shade.Material(metal="gold")
    assert gold.fresnel == "conductor" and gold.k == shade.metals()["gold"].k
    assert shade.Material(preset="brushed_steel").ex > 100
    conventions = _library.words(_library.LIB.shade_roughness_row)
    page = (ROOT / "docs/library/python.md").read_text()
    assert len(conventions) == 6 and all(f"`{word}`" in page and word in shade.Material.__doc__ for word in conventions)
    # KHR_materials_anisotropy: alpha along the tangent is mix(a, 1, strength^2), across it a = r^2
    gltf = shade.Material(roughness=("gltf", 0.5, 0.3))
    assert sorted([gltf.ax, gltf.ay]) == pytest.approx([0.25, 0.25 + 0.75 * 0.09])
    changed = older.replace(metal="gold", roughness=("gltf", 0.5, 0.3))
    assert (changed.ax, changed.k, changed.mdf) == (gltf.ax, gold.k, "ggx")
    fast, careful = (shade.D(shade.Material(fast=f), N.astype("f4"), WI.astype("f4")) for f in (True, False))
    assert fast.dtype == np.float32 and fast.tolist() == careful.tolist()  # a word of older versions
    assert {row.word for row in shade.parameters().values() if row.list == "mdf"} == {"ex", "ey", "ax", "ay"}


@pytest.mark.parametrize("values, error, says", [
    ({"ex": 2e6}, ValueError, r"ex: 2000000.0 given; expected a number from 0 to 1e\+06"),
    ({"ay": float("nan")}, ValueError, r"ay: nan given; expected a number from 0.0001 to 10"),
    ({"ax": [0.1, 0.2]}, ValueError, r"ax: \[0.1, 0.2\] given"),
    ({"f0": (1, 2, 3)}, ValueError, r"f0: \(1, 2, 3\) given; expected one number or 3 from 0 to 1"),
    ({"f0": "red"}, ValueError, "f0: 'red' given"),
    ({"detail": "rotat"}, ValueError, "detail: 'rotat' given; expected one of none, perturb"),
    ({"roughness": ("maya", 1, 0)}, ValueError, "roughness: 'maya' given; expected one of blender_principled"),
    ({"roughness": 0.5}, ValueError, "roughness: 0.5 given"),
    ({"preset": "denim"}, ValueError, "preset: 'denim' given; expected a metal of shade.presets\\(\\)$"), ({"preset": "tin"}, ValueError, "preset: 'tin' given"),
    ({"roughness": ("gltf", 0.5)}, ValueError, r"roughness: .* expected \(convention, roughness, anisotropy\)"),
    ({"slopes": (0, 0, 1, 2, 1)}, ValueError, "slopes: .* and xy at most"), ({"slopes": 0.1}, ValueError, "slopes: 0.1 given; expected x, y"),
    ({"defaults": 1.0}, ValueError, "defaults: 1.0 given"), ({"mdf": 1}, ValueError, "mdf: 1 given; expected one of ashikhmin_shirley"),
    ({"ey": 5, "ay": 0.5}, TypeError, "ey and ay given; expected one of them"),
    ({"defaults": 2}, ValueError, "defaults: 2 given; expected a whole number from 0 to 1"),
    ({"defaults": True}, ValueError, "defaults: True given"),
    ({"metal": "cheese"}, ValueError, "metal: 'cheese' given; expected one of silver"),
    ({"ex": 5, "ay": 0.5, "ax": 0.2}, TypeError, "ex and ax given; expected one of them"),
    ({"fast": "off"}, ValueError, "fast: 'off' given; expected True or False"),
    ({"shine": 1}, TypeError, "'shine': no such parameter; there are preset, metal")])
def test_bad_parameters(values, error, says):
    with pytest.raises(error, match=says):
        shade.Material(**values)


def test_nothing_is_set_that_nobody_reads():
    cloth = shade.fabric()
    for made, name, says in (
            (shade.Material(), "ex", r"ex: a Material never changes; replace\(ex=5\) makes a material like it"),
            (shade.Material(), "fresnell", r"did you mean fresnel\? replace\(fresnel=5\)"),
            (shade.Material(), "ey_", r"did you mean ey\?"), (cloth, "nap", r"a Fabric never .*fabric\(…, nap=5\) makes another$"),
            (cloth, "pfd", r"did you mean pdf\?"), (shade.Scratches(), "cells", r"a Scratches never changes.*shade\.Scratches\(…, cells=5\) makes another$"),
            (shade.SlopeMap(np.zeros((1, 1, 3), "f4")), "strength", r"SlopeMap\(…, strength=5\) makes another$"),
            (shade.Relief([0.5, 0.5], [0.1, 0]), "weight", r"shade\.Relief\(…, weight=5\) makes another$"),
            (shade.Status(), "bit", "bit")):
        with pytest.raises(AttributeError, match=says):
            setattr(made, name, 5)


def test_bad_arrays():
    material = shade.Material()
    for call, says in (
            (lambda: shade.D(material, N, WI[:, :2]), r"h: an array of shape \(40, 2\) given; expected \(…, 3\)"),
            (lambda: shade.D(material, N, 1.0), r"h: an array of shape \(\)"),
            (lambda: shade.D(material, N + 0j, WI), "(?s)n: .* expected numbers"),
            (lambda: shade.eval(material, N, WI, WO, f0=np.uint8([255, 0, 0])), "f0: an array of uint8 .* divide by 255"),
            (lambda: shade.eval(material, N, WI, WO, kd=np.uint16([255, 0, 0])), "kd: an array of uint16 .* divide by 65535"),
            (lambda: shade.D(material, N[:3], WI[:4]), r"do not fit each other.*n \(3,\), h \(4,\)"),
            (lambda: shade.D(material, N, ["a", "b", "c"]), "h: .* expected numbers"),
            (lambda: shade.eval(material, N, WI, WO, parts="shiny"), "parts: 'shiny' given")):
        with pytest.raises(ValueError, match=says):
            call()
    for call, says in ((lambda: shade.eval(material, N, WI, WO, size=1), "'size': no parameter of a sample"),
                       (lambda: shade.pdf(material, N, WI, WO, ey=9, ax=0.1, ay=0.2), "ey and ay given"),
                       (lambda: shade.D({}, N, WI), "expected a shade.Material")):
        with pytest.raises(TypeError, match=says):
            call()


# ---- cloth ----------------------------------------------------------------------------------------

@pytest.mark.parametrize("tier, footprint", [("auto", 0.3), ("near", 0), ("far", 5), ("single", 1)])
def test_cloth_and_tool_agree(tier, footprint):
    uv = np.random.default_rng(7).uniform(0, 20, (30, 2))
    cloth = shade.fabric("denim")
    ours = cloth.eval(uv, WI[:30], WO[:30], footprint=footprint, tier=tier)
    table = np.concatenate([uv, np.full((30, 1), float(footprint)), WI[:30], WO[:30]], -1)
    lines = "\n".join(" ".join(map(repr, row)) for row in table.tolist())
    said = subprocess.run([SHADE, "fabric", "denim", "--tier", tier], input=lines, text=True, check=True,
                          capture_output=True).stdout
    assert ours == pytest.approx(np.array(said.split(), float).reshape(30, 3), rel=1e-12) and (ours > 0).any()
    floats = cloth.eval(uv.astype("f4"), WI[:30].astype("f4"), WO[:30].astype("f4"), footprint=footprint, tier=tier)
    assert floats.dtype == np.float32 and np.median(np.abs(floats - ours) / ours.mean()) < 1e-3


def test_footprints_of_cloth():
    """Along u alone, or v alone: the mean of the near model at 16 points of it."""
    cloth, uv = shade.fabric("wool_flannel"), np.array([3.3, 7.6])
    shifts = (np.arange(16) - 7.5) * 0.4 / 16
    for axis in (0, 1):
        side = np.zeros(2)
        side[axis] = 0.4
        near = cloth.eval(uv + shifts[:, None] * (side > 0), WI[0], WO[0], tier="near").mean(0)
        assert cloth.eval(uv, WI[0], WO[0], footprint=side) == pytest.approx(near, rel=1e-9)


def test_cloth_draws():
    """The mean of s/pdf is the integral of s; the drawn s is that of eval."""
    cloth, wo = shade.fabric("silk_shantung"), np.array([0.3, 0.1, 0.9]) / math.sqrt(0.91)
    u = np.random.default_rng(8).random((20000, 3))
    wi, s, pdf = cloth.sample([0.3, 0.2], wo, u, footprint=100)
    found = pdf > 0
    albedo = (s[found] / pdf[found, None]).sum(0) / len(u)
    cosines, turns = np.meshgrid((np.arange(100) + 0.5) / 100, (np.arange(200) + 0.5) / 200 * 2 * np.pi)
    sines = np.sqrt(1 - cosines ** 2)
    even = np.stack([sines * np.cos(turns), sines * np.sin(turns), cosines], -1)
    whole = cloth.eval([0.3, 0.2], even, wo, footprint=100).mean((0, 1)) * 2 * np.pi
    assert albedo == pytest.approx(whole, rel=0.02) and cloth.albedo(wo) == pytest.approx(whole, rel=0.05)
    assert cloth.pdf([0.3, 0.2], even, wo, footprint=100).mean() * 2 * np.pi == pytest.approx(found.mean(), abs=0.01)
    assert cloth.eval([0.3, 0.2], wi[found][:9], wo, footprint=100) == pytest.approx(s[found][:9], rel=1e-6)


def test_what_lies_over_what(tmp_path):
    """Patterns, matrices and files against the rule of weave.h; gaps and coverage."""
    place = np.stack(np.meshgrid(np.arange(6) + 0.5, np.arange(6) + 0.5), -1)
    u, v = place[..., 0] // 1, place[..., 1] // 1
    weft_up = (u + 2 * v) % 5 < 2
    by_pattern = shade.fabric(pattern=(2, 3, 2)).look_up(place)
    assert (by_pattern["top"] == np.where(weft_up, 0, 1)).all() and by_pattern["yarn"].max() == 4
    matrix = np.random.default_rng(9).integers(0, 2, (3, 6))
    assert (shade.fabric(draft=matrix).look_up(place)["top"] == np.concatenate([matrix, matrix])).all()
    thin = {"width": 1, "gap": 1}
    gaps = shade.fabric(warp=thin, weft=thin)
    assert all(np.isscalar(value) for value in gaps.look_up([0.99, 0.99]).values())  # as what eval returns of one place
    assert gaps.look_up([0.99, 0.99])["top"] == 2 and gaps.coverage([0.99, 0.99], [0, 0, 1.0]) == 0
    assert gaps.coverage([0.5, 0.5], [0, 0, 1.0]) == 1
    twill = shade.fabric(wif=ROOT / "examples/weaves/denim.wif")
    assert twill.look_up(place)["top"].mean() > 0.5
    (tmp_path / "bad.wif").write_text("[WIF]\nnonsense\n")
    with pytest.raises(ValueError, match="bad.wif.*expected"):
        shade.fabric(wif=tmp_path / "bad.wif")


def test_cloth_parameters():
    bright, dark = (shade.fabric(warp={"kd": kd, "f0": 0}, weft={"kd": kd, "f0": 0}, detail="none", shadows=False,
                                 occlusion="none") for kd in (0.8, 0.2))
    seen = [cloth.eval([0.4, 0.4], [0, 0, 1.0], [0, 0, 1.0])[0] for cloth in (bright, dark)]
    assert seen[0] / seen[1] == pytest.approx(4)
    plain, own, older = (shade.fabric(mdf="ggx", **given).eval([0.4, 0.4], [0.6, 0, 0.8], [0, 0, 1.0]).tolist()
                         for given in ({}, {"brdf": "microfacet"}, {"defaults": 0}))
    assert plain == own != older == shade.fabric(mdf="ggx", brdf="ashikhmin_shirley").eval(
        [0.4, 0.4], [0.6, 0, 0.8], [0, 0, 1.0]).tolist()
    varied = bright.eval([0.4, 0.4], [0, 0, 1.0], [0, 0, 1.0], warp_kd=0.2 * np.ones(3), weft_kd=(0.2, 0.2, 0.2))
    assert varied[0] == pytest.approx(seen[1])
    uv, low = np.random.default_rng(3).uniform(0, 8, (16, 2)), [0.6, 0, 0.8]
    nap, less = (shade.fabric("wool_flannel", nap=nap) for nap in (2, 0.5))
    assert nap.eval(uv, low, low, nap=0.5) == pytest.approx(less.eval(uv, low, low)) != pytest.approx(nap.eval(uv, low, low))
    shining = shade.fabric("silk_charmeuse")  # each kind of yarn where it lies on top alone
    tops = shining.look_up(uv)["top"]
    plain, warp, weft = (shining.eval(uv, low, [0, 0, 1.0], tier="near", **given) for given in ({}, {"warp_gloss": 0.2}, {"weft_gloss": 0.2}))
    assert ((warp != plain).any(-1) == (tops == 1)).all() and ((weft != plain).any(-1) == (tops == 0)).all() and set(tops) == {0, 1}
    terms = shining.eval([3.3, 7.6], low, [0, 0, 1.0], footprint=0.3, random=(np.arange(16) + 0.5) / 16)
    assert terms.mean(0) == pytest.approx(shining.eval([3.3, 7.6], low, [0, 0, 1.0], footprint=0.3)) and terms.std() > 0
    with pytest.raises(TypeError, match="'gloss': no parameter of a sample; there are warp_kd, weft_kd, warp_gloss, weft_gloss, nap, random"):
        bright.eval(uv, low, low, gloss=1)
    for given, error, says in (
            ({"warp": {"width": -1}}, ValueError, r"warp width: -1 given; expected a number from 1e-06 to 1e\+06"),
            ({"weft": {"kd": (1, 2, 3)}}, ValueError, r"weft kd: \(1, 2, 3\) given"),
            ({"weft": {"twist": 1}}, TypeError, "weft 'twist': no such parameter; there are diffuse, along"),
            ({"shadows": "off"}, ValueError, "shadows: 'off' given; expected True or False"),
            ({"draft_colors": 2}, ValueError, "draft_colors: 2 given; expected True or False"),
            ({"nap": 11}, ValueError, "nap: 11 given; expected a number from 0 to 10"),
            ({"weave": "knit"}, ValueError, "weave: 'knit' given; expected one of plain"),
            ({"pattern": (0, 1, 1)}, ValueError, "pattern: .* given"),
            ({"pattern": 3}, ValueError, "pattern: 3 given"),
            ({"draft": [1, 0]}, ValueError, r"draft: shape \(2,\) given"),
            ({"draft": [[]]}, ValueError, r"draft: shape \(1, 0\) given; expected \(picks, ends\)"),
            ({"preset": "brushed_steel"}, ValueError, "preset: 'brushed_steel' given; expected a cloth of shade.presets\\(\\)$"),
            ({"preset": "felt"}, ValueError, "preset: 'felt' given"),
            *((dict(several), TypeError, "one of weave, pattern, draft and wif, not several")
              for several in itertools.combinations({"weave": "plain", "pattern": (1, 1, 1), "draft": [[1, 0]], "wif": "a.wif"}.items(), 2)),
            ({"defaults": -1}, ValueError, "defaults: -1 given"),
            ({"shine": 1}, TypeError, "'shine': no such parameter")):
        with pytest.raises(error, match=says):
            shade.fabric(**given)
    with pytest.raises(ValueError, match="tier: 'high' given"):
        bright.eval([0, 0], WI, WO, tier="high")
    assert {row.kind for row in shade.presets().values()} == {"fabric", "metal"} and "plain" in shade.weaves()


def test_rows_of_presets():
    """Of denim, which has more ends than picks; of turned copper, whose colour is Johnson's and Christy's."""
    row = shade.presets()["denim"]
    assert (row.kind, row.label, row.weave, row.ends_per_cm, row.picks_per_cm, row.scratch_cm, row.turned) == ("fabric", "Cotton denim", "twill_3_1", 26, 17, 0, False)
    assert "indigo" in row.help and "SadeghiJensen2013" in row.source and row.color_source == "dye by eye"
    row = shade.presets()["turned_copper"]
    assert (row.kind, row.label, row.weave, row.scratch_cm, row.turned) == ("metal", "Turned copper", None, 4, True)
    assert "lathe" in row.help and "Ward1992" in row.source and row.color_source == "[JohnsonChristy1972]"


def test_what_lies_over_what_is_said_in_many_ways():
    """A weave goes before that of a preset; of a draft what is not 0 is up."""
    where = [[(end + 0.5, pick + 0.5) for end in range(4)] for pick in range(4)]
    lies = lambda **given: shade.fabric(**given).look_up(where)["top"].tolist()
    plain, twill = lies(), lies(weave="twill_3_1")
    assert sorted(map(sum, plain)) == [2] * 4 and sorted(map(sum, twill)) == [3] * 4
    assert lies(preset="denim") == twill and lies(preset="denim", weave="plain") == plain
    assert lies(draft=[[-1, 0, 0, 0.5]]) == [[1, 0, 0, 1]] * 4 and lies(draft=np.eye(4)[:1].T) == [[int(pick == 0)] * 4 for pick in range(4)]
    assert shade.Material(mdf=" GGX\n").mdf == "ggx"


def test_options_of_cloth():
    """Each changes what is seen, in the direction that its name says."""
    uv, up, low = np.random.default_rng(1).uniform(0, 8, (64, 2)), [0, 0, 1.0], np.array([0.98, 0, math.sqrt(1 - 0.98**2)])
    assert shade.fabric(occlusion="none").look_up(uv)["occlusion"].min() == 1 > shade.fabric(occlusion="sky").look_up(uv)["occlusion"].min()

    def mean(light, **given):
        return shade.fabric(**given).eval(uv, light, up, tier="near").mean(0)

    assert (mean(low, preset="denim", shadows=True) < 0.95 * mean(low, preset="denim", shadows=False)).all()
    (red, _, blue), (grey, _, same) = (mean(up, wif=ROOT / "examples/weaves/denim.wif", draft_colors=own) for own in (True, False))
    assert blue > 1.05 * red and grey == same  # indigo, as the file has it
    # light across the yarn: the fibre's normal that faces it most sees all of it
    for yarn, light in (("warp", low), ("weft", low[[1, 0, 2]])):
        lambert, facing = (mean(light, **{yarn: {"diffuse": word, "kd": 0.5}}) for word in ("lambert", "max_normal"))
        assert (facing > 1.5 * lambert).all()


def test_what_was_mended_in_a_draft_is_warned_of(tmp_path):
    file = tmp_path / "short.wif"
    text = ("[WIF]\nVersion=1.1\n[WEAVING]\nShafts=2\nTreadles=2\nRising Shed=true\n[WARP]\nThreads=2\n[WEFT]\nThreads=2\n"
            "[THREADING]\n1=1\n2=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n")
    file.write_text(text)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plain = shade.fabric(wif=file)
    file.write_text(text.replace("[TREADLING]", "[TREADLING]\n1=1\n[TREADLING]"))
    with pytest.warns(UserWarning, match=r"short.wif.*\[TREADLING\] once more") as said:
        twice = shade.fabric(wif=file)
    assert said[0].filename == __file__  # where the user's own program asks for it
    where = [(0.5, 0.5), (1.5, 0.5), (0.5, 1.5), (1.5, 1.5)]
    assert plain.look_up(where)["top"].tolist() == twice.look_up(where)["top"].tolist() == [1, 0, 0, 1]


def test_every_bit_of_a_seed_counts():
    """But for those beyond 32."""
    where = np.random.default_rng(1).uniform(0, 99, (64, 2))
    seen = [shade.fabric(seed=seed, warp={"vary_brightness": 0.5}, weft={"vary_brightness": 0.5}).look_up(where)["brightness"]
            for seed in (5, 5 + (1 << 32), *(5 + (1 << bit) for bit in (3, 15, 16, 31)))]
    assert (seen[0] == seen[1]).all() and not any((seen[0] == other).all() for other in seen[2:])


# ---- maps -----------------------------------------------------------------------------------------

@pytest.mark.parametrize("other", [0, 0.2, -0.2])
def test_slopes_of_a_ramp_and_of_two(other):
    """Half of the map leans one way, half the other: the mean of the slopes is 0 and their variance 0.09;
    what leans both ways at once varies together, or against each other."""
    pixels = np.zeros((64, 64, 3), np.float32)
    pixels[..., 0], pixels[..., 2] = -0.3, 1
    pixels[:, 32:, 0] = 0.3
    pixels[..., 1] = pixels[..., 0] * other / 0.3
    pixels /= np.linalg.norm(pixels, axis=-1, keepdims=True)
    slopes = shade.SlopeMap(pixels, normals="signed")
    point = slopes.look_up([0.25, 0.5])
    assert point.normal == pytest.approx(pixels[0, 0], abs=1e-4) and point.covariance == pytest.approx(0, abs=1e-6)
    for dtype, close in ((np.float64, 4e-3), (np.float32, 4e-3)):
        seen = slopes.look_up(np.array([[0.5, 0.5]], dtype), np.array([0.5, 0, 0, 0.5], dtype))
        assert seen.normal.dtype == dtype and seen.normal[0] == pytest.approx([0, 0, 1], abs=close)
        assert seen.covariance[0] == pytest.approx([0.09, 0.3 * other, other**2], abs=close)


def test_slopes_of_the_whole_map():
    """Several pictures wide a footprint has the moments of all of the map, as it is interpolated, wherever it lies: what the guide
    takes for horizon mutual."""
    slopes = np.random.default_rng(3).normal(size=(2, 16, 16)) * .3 + .1
    seen = shade.SlopeMap(np.stack([*-slopes, np.ones((16, 16))], -1), normals="signed").look_up([[.5, .5], [.1, .8]], [4, 0, 0, 4])
    weight = {-1: 1 / 6, 0: 2 / 3, 1: 1 / 6}  # of what is linear between neighbours
    means = slopes.mean((1, 2))
    moments = [sum(weight[i] * weight[j] * (slopes[a] * np.roll(slopes[b], (i, j), (0, 1))).mean() for i in weight for j in weight)
               - means[a] * means[b] for a, b in ((0, 0), (0, 1), (1, 1))]
    assert -seen.normal[:, :2] / seen.normal[:, 2:] == pytest.approx(np.tile(means, (2, 1)), abs=1e-4)
    assert seen.covariance == pytest.approx(np.tile(moments, (2, 1)), abs=1e-4)


def test_pixels_of_whole_numbers():
    """A picture is scaled by its type's largest number; else they are refused, in words."""
    coloured = np.random.default_rng(2).integers(90, 166, (5, 4, 3)).astype(np.uint8)
    coloured[..., 2] = 250
    truth = shade.SlopeMap(coloured / 255).look_up([0.3, 0.6])
    for pixels in (coloured, coloured.astype(np.uint16) * 257):
        assert shade.SlopeMap(pixels).look_up([0.3, 0.6]).normal == pytest.approx(truth.normal, abs=1e-6)
    for pixels, normals, says in (
            (coloured, "signed", 'an array of uint8 given; expected floats, or with normals "colour"'),
            (coloured.astype(int), "colour", "an array of int64 given"), (coloured * 1.0, "colour", "colours up to 250 given"),
            (coloured * 0.01, "colour", "colours up to 2.5 given; expected 0 to 1"), (coloured[..., :1] / 255, "colour", "or more"),
            (coloured[..., 0] / 255, "colour", r"shape \(5, 4\) given; expected \(height, width, 2 or more\)")):
        with pytest.raises(ValueError, match=says):
            shade.SlopeMap(pixels, normals=normals)


ONE = np.float32([[[0.002, 0, 1]]])


NAN = math.nan
ROUND, UPRIGHT = shade.Material(mdf="ggx", ax=.2, ay=.2), [0, 0, 1.0]


@pytest.mark.parametrize("call, said", [
    (lambda **s: shade.SlopeMap(np.float32([[[0, 0, 1], [0, 0, -1]]]), normals="signed", **s), "clamped normal"),
    (lambda **s: shade.SlopeMap(np.float32([[[0, 0, 1], [NAN, 0, 1]]]), normals="signed", **s), "bad input"),
    (lambda **s: shade.SlopeMap(ONE, normals="signed").look_up([NAN, .3], **s), "bad input"),
    (lambda **s: shade.split(ROUND, [NAN, 0, 1], [.1, 0, .1], **s), "bad input"),
    (lambda **s: shade.D(ROUND, UPRIGHT, [NAN, 0, 1], **s), "bad input"),
    (lambda **s: shade.eval(ROUND, UPRIGHT, [NAN, 0, 1], UPRIGHT, **s), "bad input"),
    (lambda **s: shade.pdf(ROUND, UPRIGHT, [NAN, 0, 1], UPRIGHT, **s), "bad input"),
    (lambda **s: shade.sample(ROUND, [0, 0, -1.0], UPRIGHT, [.5, .5], **s), "clamped normal"),
    (lambda **s: shade.Scratches(SCRATCH, cells=0).look_up([NAN, .3], **s), "bad input"),
    (lambda **s: shade.fabric("denim").look_up([NAN, .3], **s), "bad input"),
    *((lambda name=name, more=more, **s: getattr(shade.fabric("denim"), name)([.3, .4], [NAN, 0, 1], *more, **s), says)
      for name, more, says in (("eval", [UPRIGHT], "bad input"), ("coverage", [], "bad input"), ("pdf", [UPRIGHT], "bad input"),
                               ("sample", [[.1, .2, .3]], "bad input, no sample")))])
def test_each_call_says_what_it_mended(call, said):
    """By status=, which gathers: what was said before stays."""
    status = shade.Status()
    call(status=status)
    assert str(status) == said
    shade.D(ROUND, [0, 0, -1.0], UPRIGHT, status=status)
    assert all(words in status for words in ("clamped normal", *said.split(", ")))


def test_options_of_maps():
    """Strength multiplies slopes, up to 100 times; directx turns green about; beyond the edge it is as wrap says."""
    seen = shade.SlopeMap(ONE, normals="signed", strength=100).look_up([0.5, 0.5]).normal
    assert seen == pytest.approx(np.array([0.2, 0, 1]) / math.hypot(0.2, 1), rel=1e-6)
    steps = np.float32([[[0, 0.1, 1], [0.1, 0.1, 1], [0.2, 0.1, 1], [0.3, 0.1, 1]]])
    for wrap, there in (("repeat", 0.1), ("clamp", 0.3), ("mirror", 0.2)):
        x, y, z = shade.SlopeMap(steps, normals="signed", wrap=wrap, directx=wrap == "clamp").look_up([1.375, 0.5]).normal
        assert (x / z, y / z) == pytest.approx((there, -0.1 if wrap == "clamp" else 0.1), rel=1e-5)
    for make, name in ((lambda: shade.SlopeMap(ONE, directx=1.5), "directx"), (lambda: shade.Relief([0.5, 0.5], [0.1, 0], shape="on"), "shape")):
        with pytest.raises(ValueError, match=f"^{name}: .* given; expected True or False$"):
            make()


@pytest.mark.parametrize("make, low, high", [
    (lambda v: shade.SlopeMap(ONE, strength=v), 0, 100),
    (lambda v: shade.Scratches(SCRATCH, aspect=v, cells=0), 1e-3, 1e3),
    (lambda v: shade.Scratches(SCRATCH | {"radius": v}, cells=0), 1e-6, 0.5),
    (lambda v: shade.Scratches(SCRATCH | {"stretch": v}, cells=0), 1, 1e5),
    (lambda v: shade.Scratches(SCRATCH | {"depth": v}, cells=0), 0, 0.99),
    (lambda v: shade.Scratches(SCRATCH | {"direction": v}, cells=0), -1e6, 1e6),
    (lambda v: shade.Scratches(SCRATCH | {"spread": v}, cells=0), 0, math.pi / 2),
    (lambda v: shade.Material(roughness=("gltf", v, 0)), 0, 1),
    (lambda v: shade.Material(roughness=("gltf", 0.5, v)), -1, 1),
    (lambda v: shade.split(shade.Material(), None, [0.01, 0, 0.01], v), 1, 8)])
def test_ranges(make, low, high):
    """Those of maps.h and the manual: both ends are taken, what lies beyond is not."""
    for inside, beyond in ((low, low - 1e-3), (high, high * (1 + 1e-6))):
        make(inside)
        with pytest.raises(ValueError, match="expected a number from"):
            make(beyond)
    shade.Scratches(SCRATCH | {"pits": 0}, cells=0)
    for pits in (-1, 4000001):  # as many as that take long
        with pytest.raises(ValueError, match="pits: .* expected a number from 0 to 4e"):
            shade.Scratches(SCRATCH | {"pits": pits}, cells=0)


def test_what_is_made_is_freed(monkeypatch):
    """What the library hands out goes back to it, each once."""
    held, made = [], []

    def watch(name, done):
        function = getattr(_library.LIB, name)
        monkeypatch.setattr(_library.LIB, name, lambda *given: done(given[0], function(*given)))

    def taken(_given, result):
        held.append(result)
        made.append(result)
        return result

    for name in ("slope_map_create", "scratch_create", "weave_create", "fabric_create", "draft_named", "draft_from_pattern",
                 "relief_create"):
        watch(f"shade_{name}", taken)
    for name in ("slope_map_free", "scratch_free", "weave_free", "fabric_free", "draft_free", "relief_free"):
        watch(f"shade_{name}", lambda given, _result: held.remove(given))
    for make in (lambda: shade.SlopeMap(ONE), lambda: shade.Scratches(SCRATCH, cells=0), lambda: shade.fabric("denim"),
                 lambda: shade.fabric(pattern=(1, 2, 1)), lambda: shade.Relief([0.5, 0.5], [0.1, 0])):
        before, thing = len(made), make()
        assert held and len(made) > before
        del thing
        assert not held


def test_relief():
    """Of slopes that are even from -.5 to .5 on half of the map, and flat on the other, the moment is 1/12 there; half of that of
    all, or a third where the flat half counts double. A long wave is a bump, or the shape's own mean."""
    rng = np.random.default_rng(5)
    uv, lean = 3 * rng.random((1 << 16, 2)), rng.random((1 << 16, 2)) - 0.5  # of three periods
    lean[:, 0] += 0.5 * lean[:, 1]
    even = np.array([0, 0, 1.25 / 12, 0.5 / 12, 1 / 12])
    left = uv[:, 0] % 1 < 0.5
    both, bumpy = np.where(left[:, None], 0, lean), [0.6, 0.1] + [0.3, 0.8] * rng.random((4096, 2))
    for weight, part in ((None, 1 / 2), (np.where(left, 2, 1), 1 / 3), (np.where(left, 0, 7), 1)):
        relief = shade.Relief(uv, both, weight)
        assert relief.slopes == pytest.approx(part * even, abs=2e-3) and (relief.varies > 0.5) == (part < 1)
        found = relief.look_up([[[0.75, 0.3], [1.75, -0.7]], [[0.25, 0.3], [NAN, 0]]])
        flat = 0 * even if part < 1 else even
        assert found.shape == (2, 2, 5) and found.dtype == np.float64 and found[0, 0] == pytest.approx(found[0, 1], abs=1e-4)
        assert found[1, 0] == pytest.approx(flat, abs=2e-3) and relief.look_up(bumpy).mean(0) == pytest.approx(even, abs=5e-3)
        assert found[1, 1] == pytest.approx(relief.slopes, abs=1e-6)
    assert shade.Relief(uv, lean).look_up(np.float32([0.25, 0.3])).dtype == np.float32
    wave = 0.4 * np.sin(2 * np.pi * uv[:, 0])
    bumps, shape = (shade.Relief(uv, np.stack([wave, 0 * wave], -1), shape=shape) for shape in (False, True))
    assert bumps.slopes[2] == pytest.approx(0.08, rel=0.02) and shape.slopes[2] < 0.008
    assert shape.look_up([[0.25, 0.5], [0.75, 0.5]])[:, 0] == pytest.approx([0.4, -0.4], abs=0.06)
    assert shade.Relief(np.zeros((0, 2)), np.zeros((0, 2))).slopes == (0,) * 5
    with pytest.raises(ValueError, match="shape: 2 given"):
        shade.Relief(uv, lean, shape=2)


def test_each_place_has_a_footprint_of_its_own():
    """In one call as by one call each; of a map and of scratches."""
    places = np.array([[0.47, 0.5], [0.5, 0.3], [0.53, 0.7]])
    sides = np.array([[0.01, 0, 0, 0.01], [0.5, 0, 0, 0.5], [0.02, 0.1, -0.1, 0.02]])
    leaning = np.random.default_rng(3).normal(0, 0.2, (64, 64, 3)).astype(np.float32) + (0, 0, 1)
    for of in (shade.SlopeMap(leaning, normals="slope"), shade.Scratches({"pits": 40, "radius": 0.02}, seed=7)):
        together = of.look_up(places, sides)
        for k, (place, side) in enumerate(zip(places, sides)):
            alone = of.look_up(place, side)
            assert np.array_equal(together.normal[k], alone.normal) and np.array_equal(together.covariance[k], alone.covariance)
        assert not np.allclose(together.covariance, together.covariance[0])


def test_split_keeps_the_moments():
    """Of the slopes' covariance what the normals carry and what widens the lobe (1/e + S) add up to it."""
    material = shade.Material(ex=200, ey=50)
    for most in (1, 4, 8):
        lobes = shade.split(material, None, [[0.01, 0, 0.02], [0, 0, 0]], most)
        slopes = -lobes.n[..., :2] / lobes.n[..., 2:]
        carried = (lobes.weight[..., None] * slopes ** 2).sum(1)
        assert carried[0] + [1 / lobes.x[0] - 1 / 200, 1 / lobes.y[0] - 1 / 50] == pytest.approx([0.01, 0.02], rel=0.02)
        assert (lobes.x[1], lobes.y[1]) == pytest.approx((200, 50)) and lobes.weight.sum(1) == pytest.approx(1)
    lobes = shade.split(material, None, [0.01, 0.006, 0.02], 4)
    slopes = -lobes.n[..., :2] / lobes.n[..., 2:]
    turn = np.array([[np.cos(lobes.angle), -np.sin(lobes.angle)], [np.sin(lobes.angle), np.cos(lobes.angle)]])
    whole = (slopes.T * lobes.weight) @ slopes + turn @ np.diag([1 / lobes.x, 1 / lobes.y]) @ turn.T
    assert whole - np.diag([1 / 200, 1 / 50]) == pytest.approx(np.array([[0.01, 0.006], [0.006, 0.02]]), abs=1e-3)
    with pytest.raises(ValueError, match="most: 9 given; expected a number from 1 to 8"):
        shade.split(material, None, [0, 0, 0], 9)


def test_scratches_by_default():
    """One layer, in the first of its ways; each way another. A picture has a texel and a point at least."""
    seen = [shade.Scratches(seed=seed, cells=0).picture(16, 8)[0] for seed in (None, 1, 0, 1 << 40)]
    assert seen[0].any() and np.array_equal(seen[0], seen[1]) and not any(np.array_equal(seen[0], other) for other in seen[2:])
    field = shade.Scratches(cells=0)
    for size, samples in (((0, 8), 1), ((8, 0), 1), ((8, 8), 0)):
        with pytest.raises(ValueError, match=f"picture: {size[0]} x {size[1]}, {samples} samples given; expected 1 or more"):
            field.picture(*size, samples=samples)
    with pytest.raises(ValueError, match="layers: 9 given; expected at most 8"):
        shade.Scratches(*[{"pits": 1}] * 9)
    assert [array.dtype for array in (*field.look_up(np.float32([[0.5, 0.5]])), *field.look_up([0.5, 0.5]))] == [np.float32] * 2 + [np.float64] * 2


def test_a_split_lobe_in_its_own_numbers():
    """Exponents of Ashikhmin's and Shirley's, alphas of all others; lobes that are not needed point up and weigh nothing."""
    for mdf, narrow in (("ashikhmin_shirley", {"ex": 200, "ey": 50}), ("ggx", {"ax": 0.1, "ay": 0.2}), ("beckmann", {"ax": 0.1, "ay": 0.2})):
        lobes = shade.split(shade.Material(mdf=mdf, **narrow), np.float32([0, 0, 1]), np.float32([0, 0, 0]), 4)
        assert (lobes.x, lobes.y) == pytest.approx(tuple(narrow.values())) and lobes.x.dtype == np.float64, mdf
        assert lobes.weight.tolist() == [1, 0, 0, 0] and lobes.n.tolist() == [[0, 0, 1]] * 4, mdf
        short, whole = (shade.split(shade.Material(mdf=mdf, **narrow), given([0, 0.25, 1]), given([0.125, 0, 0.25]), 4) for given in (np.float32, np.float64))
        assert short.n.tolist() == whole.n.tolist() and short.x == whole.x, mdf


def test_scratches():
    """Depth over the radius is what was asked for, and normals are those of the heights."""
    field = shade.Scratches({"pits": 3, "radius": 0.1, "stretch": 1, "depth": 0.2}, cells=0, seed=3)
    height, normal = field.picture(400, 400)
    assert height.min() == pytest.approx(-0.02, rel=1e-3) and height.max() == 0
    dv, du = np.gradient(height.astype(float), 1 / 400)
    off = np.abs(-du - normal[..., 0] / normal[..., 2]) + np.abs(dv - normal[..., 1] / normal[..., 2])
    assert np.median(off[height < 0]) < 1e-3 and np.mean(height < 0) > 0.05
    for seed, same in ((3, True), (4, False)):
        again = shade.Scratches({"pits": 3, "radius": 0.1, "stretch": 1, "depth": 0.2}, cells=0, seed=seed).picture(400, 400)[0]
        assert np.array_equal(again, height) == same
    y, x = 120, 250
    seen = field.look_up([(x + 0.5) / 400, 1 - (y + 0.5) / 400]).normal
    assert seen == pytest.approx(normal[y, x], abs=1e-6)
    assert field.picture(100, 100, samples=4)[0] == pytest.approx(height.reshape(100, 4, 100, 4).mean((1, 3)), abs=1e-7)
    for name, ends, seen in (("depth", (.05, .8), lambda h: -h.min() / .05), ("radius", (.005, .05), lambda h: -h.min() / .2), ("stretch", (1, 20), lambda h: np.mean(h < 0))):
        same = {"pits": 60, "radius": .05 if name == "depth" else .005, "stretch": 1, "depth": .2}
        least, most, between = (seen(shade.Scratches(same | {name: value}, cells=0).picture(100, 100)[0]) for value in (ends[0], ends[1], ends))
        assert 2 * least < between < most, name  # from one end of the range to the other
    tall = shade.Scratches({"pits": 3, "radius": 0.1, "stretch": 1, "depth": 0.2}, cells=0, seed=3, aspect=2).picture(200, 400)[0]
    assert np.mean(tall < 0) == pytest.approx(np.mean(height < 0) / 2, rel=0.05)
    for layer, error, says in (({"depth": 2}, ValueError, "depth: 2.* given; expected a number from 0 to 0.99"),
                               ({"radius": (1, 2, 3)}, ValueError, "radius"), ({"wide": 1}, TypeError, "'wide'")):
        with pytest.raises(error, match=says):
            shade.Scratches(layer)
