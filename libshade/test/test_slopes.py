# SPDX-License-Identifier: Apache-2.0
"""`shade slopes`: pictures of several formats, look-ups, widened lobes, and bad files."""
import os
import pathlib
import shutil
import subprocess

import numpy as np
import OpenImageIO as oiio
import pytest

COST = 11.8

ROOT = pathlib.Path(__file__).resolve().parents[2]
SHADE = os.environ.get("SHADE", str(ROOT / "build" / "shade"))


def run(*arguments, text="", shade=SHADE):
    return subprocess.run([shade, "slopes", *map(str, arguments)], input=text, capture_output=True,
                          text=True, timeout=120)


def look_up(*arguments, points):
    text = "".join(" ".join(repr(float(x)) for x in p) + "\n" for p in points)
    result = run(*arguments, text=text)
    assert result.returncode == 0, result.stderr
    return np.array([[float(x) for x in line.split()] for line in result.stdout.splitlines()])


def write(path, pixels, kind):
    image = oiio.ImageOutput.create(str(path))
    height, width, channels = pixels.shape
    assert image.open(str(path), oiio.ImageSpec(width, height, channels, kind)), oiio.geterror()
    assert image.write_image(pixels.astype(np.float32))
    image.close()
    return path


def normals(width=24, height=17, seed=1):
    """A picture of unit normals as colours; row 0 is the top."""
    random = np.random.default_rng(seed)
    n = np.concatenate([random.uniform(-0.4, 0.4, (height, width, 2)),
                        np.ones((height, width, 1))], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return n


def centres(n):
    height, width = n.shape[:2]
    return [((i + 0.5) / width, 1 - (j + 0.5) / height)
            for j in range(height) for i in range(width)]


@pytest.mark.parametrize("name, kind, step", [
    ("a.exr", "float", 1e-6), ("a.exr", "half", 1e-3), ("a.png", "uint8", 5e-3),
    ("a.png", "uint16", 2e-5), ("a.tif", "uint16", 2e-5), ("a.tif", "float", 1e-6)])
def test_texel_centres_are_the_pictures(tmp_path, name, kind, step):
    n = normals()
    picture = write(tmp_path / name, 0.5 + 0.5 * n, kind)
    got = look_up(picture, points=centres(n))
    assert np.abs(got[:, :3] - n.reshape(-1, 3)).max() < step
    assert (got[:, 3:] == 0).all()
    turned = look_up(picture, "--directx", points=centres(n))
    assert np.abs(turned[:, :3] - got[:, :3] * [1, -1, 1]).max() < step


def test_other_encodings(tmp_path):
    n = normals()
    signed = write(tmp_path / "s.exr", n, "float")
    slope = write(tmp_path / "d.exr", -n[..., :2] / n[..., 2:], "float")
    alpha = write(tmp_path / "a.exr", np.concatenate([0.5 + 0.5 * n, 0 * n[..., :1]], -1), "float")
    for arguments in ((signed, "--normals", "signed"), (slope, "--normals", "slope"), (alpha,)):
        got = look_up(*arguments, points=centres(n))
        assert np.abs(got[:, :3] - n.reshape(-1, 3)).max() < 1e-5
    strong = look_up(signed, "--normals", "signed", "--strength", 2, points=centres(n))
    want = n.reshape(-1, 3) * [2, 2, 1]
    want /= np.linalg.norm(want, axis=-1, keepdims=True)
    assert np.abs(strong[:, :3] - want).max() < 1e-5


def test_wrap(tmp_path):
    n = normals(8, 8)
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * n, "float")
    inside = [(0.5 / 8, 0.3)]
    for wrap, outside in (("repeat", 1 + 0.5 / 8), ("mirror", -0.5 / 8), ("clamp", -3)):
        a = look_up(picture, "--wrap", wrap, points=inside)
        b = look_up(picture, "--wrap", wrap, points=[(outside, 0.3)])
        assert np.abs(a - b).max() < 1e-12


def test_the_lobe_widens_by_the_covariance(tmp_path):
    n = normals(64, 64)
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * n, "float")
    whole = [(0.5, 0.5, 1, 0, 0, 1)]
    plain = look_up(picture, points=whole)[0]
    # tilted lobes are narrower than slopes that add, more so with microfacet, which goes with Beckmann (maps.h)
    for share, said in ((1, ()), (1, ("--defaults", 1)), (0.5, ("--defaults", 0))):
        lobe = ("--mdf", "beckmann", "--ax", 0.1, "--ay", 0.3)
        wide = look_up(picture, *said, *lobe, points=whole)[0]
        assert (look_up(picture, *lobe, *said, points=whole)[0] == wide).all()
        assert (wide[:6] == plain).all()
        turn = np.radians(wide[8])
        r = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        got = r @ np.diag(wide[6:8] ** 2) @ r.T
        narrow = np.diag(1 / (1 + share * np.array([0.01, 0.09])))
        want = np.diag([0.01, 0.09]) + 2 * narrow @ [[plain[3], plain[4]], [plain[4], plain[5]]] @ narrow
        assert np.abs(got - want).max() < 1e-3 * want.max()  # the mean normal is not quite z
    exponents = look_up(picture, "--ex", 200, "--ey", 10, points=whole)[0]
    assert abs(1 / exponents[6] - 1 / 200 - plain[3]) < 1e-3


@pytest.mark.parametrize("lobes", [1, 4, 8])
def test_several_lobes_keep_the_mean_and_no_more_than_the_covariance(tmp_path, lobes):
    n = normals(64, 64)
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * n, "float")
    whole = [(0.5, 0.5, 1, 0, 0, 1)]
    lobe = ("--mdf", "ggx", "--ax", 0.1, "--ay", 0.3)
    one = look_up(picture, *lobe, points=whole)[0]
    got = look_up(picture, *lobe, "--lobes", lobes, points=whole)[0]
    assert len(got) == 9 + 4 * lobes and (got[:6] == one[:6]).all()
    alone = look_up(picture, "--lobes", lobes, points=whole)[0]  # of the lobe that there is without a word
    assert (alone == look_up(picture, "--mdf", "ashikhmin_shirley", "--lobes", lobes, points=whole)[0]).all()
    weight, *normal = got[9:].reshape(lobes, 4).T
    slopes = -np.array(normal[:2]) / normal[2]
    assert abs(weight.sum() - 1) < 1e-12
    assert np.abs(slopes @ weight + one[:2] / one[2]).max() < 1e-9
    spread = np.cov(slopes, aweights=weight, ddof=0) if lobes > 1 else np.zeros((2, 2))
    covariance = np.array([[one[3], one[4]], [one[4], one[5]]])
    assert np.linalg.eigvalsh(covariance - spread).min() > -1e-12
    if lobes > 1:
        assert np.trace(spread) > 0.3 * np.trace(covariance)
        assert got[6] < one[6] and got[7] < one[7]


@pytest.mark.parametrize("arguments, expected", [
    (("a.exr", "--lobes", "9"), "from 1 to 8"),
    (("a.exr", "--lobes", "2.5"), "from 1 to 8"),
    (("a.exr", "--defaults", "2"), "a version of the defaults"),
    ((), "expected a picture"),
    (("a.exr", "b.exr"), "unexpected argument 'b.exr'"),
    (("a.exr", "--wrap", "torus"), "repeat, clamp or mirror"),
    (("a.exr", "--normals", "rgb"), "colour, signed or slope"),
    (("a.exr", "--strength", "-1"), "0 to 100"),
    (("a.exr", "--strength", "nan"), "0 to 100"),
    (("a.exr", "--mdf", "phong"), "ashikhmin_shirley"),
    (("a.exr", "--ex", "1"), "--ex and --ey"),
    (("a.exr", "--ax", "0", "--ay", "1"), "from 0.0001 to 10"),
    (("a.exr", "--ex", "1", "--ey", "1", "--ax", "1", "--ay", "1"), "not both"),
    (("a.exr", "--wrap"), "lacks its value"),
    (("a.exr", "--wrong"), "unknown option '--wrong'")])
def test_bad_usage(arguments, expected):
    result = run(*arguments)
    assert result.returncode == 2 and expected in result.stderr and result.stdout == ""


def test_ends_of_ranges(tmp_path):
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * normals(8, 8), "float")
    whole = "0.5 0.5 1 0 0 1\n"
    assert run(picture, "--strength", "100", "--lobes", "8", "--defaults", "0", "--ax", "10", "--ay", ".0001", text=whole).returncode == 0
    for option, beyond in (("--strength", "100.1"), ("--lobes", "0"), ("--defaults", "-1"), ("--ex", "-1"), ("--ey", "1.1e6"), ("--ax", "10.1")):
        result = run(picture, option, beyond, text=whole)
        assert result.returncode == 2 and f"{option} '{beyond}': expected " in result.stderr, option
    # the version of the defaults leaves the distribution that was asked for, whichever comes first
    ggx = ("--mdf", "ggx", "--ax", ".1", "--ay", ".3")
    first, last = (run(picture, *words, text=whole).stdout for words in ((*ggx, "--defaults", "1"), ("--defaults", "1", *ggx)))
    assert first == last != ""


def test_bad_files(tmp_path):
    good = write(tmp_path / "good.exr", 0.5 + 0.5 * normals(), "float")
    data = good.read_bytes()
    files = {
        "missing.exr": None, "empty.exr": b"", "text.png": b"not a picture\n" * 50,
        "cut.exr": data[: len(data) // 2], "header.exr": data[:40], "name.xyz": data[:100],
        "noise.exr": data[:60] + os.urandom(400),
    }
    for name, content in files.items():
        if content is not None:
            (tmp_path / name).write_bytes(content)
        result = run(tmp_path / name, text="0.5 0.5\n")
        assert result.returncode == 1, (name, result.stdout)
        assert result.stderr.startswith(f"shade slopes: {tmp_path / name}: cannot read: ")
        assert result.stdout == ""
    result = run(tmp_path, text="0.5 0.5\n")
    assert result.returncode == 1 and "is a folder" in result.stderr
    grey = write(tmp_path / "grey.png", normals()[..., :1], "uint8")
    result = run(grey, text="0.5 0.5\n")
    assert result.returncode == 1 and "2 channels or more, found 1" in result.stderr
    result = run(write(tmp_path / "wide.exr", np.zeros((1, 65537, 3)), "half"), text="0.5 0.5\n")
    assert result.returncode == 1 and result.stderr.endswith("cannot read: expected 1 to 65536 texels a side and 2^30 at most, found 65537 x 1\n"), result.stderr
    spec = oiio.ImageSpec(2, 2, 3, "float")
    spec.deep = True
    deep = oiio.ImageOutput.create(str(tmp_path / "deep.exr"))
    texels = oiio.DeepData()
    texels.init(spec)
    assert deep.open(str(tmp_path / "deep.exr"), spec) and deep.write_deep_image(texels)
    deep.close()
    result = run(tmp_path / "deep.exr", text="0.5 0.5\n")
    assert result.returncode == 1 and result.stderr.endswith("cannot read: expected a flat picture, not a deep or solid one\n"), result.stderr


def test_texels_that_are_no_normals_are_told(tmp_path):
    n = 0.5 + 0.5 * normals(8, 8)
    n[3, 3] = np.nan
    n[5, 5] = [0.5, 0.7, 0]
    result = run(write(tmp_path / "a.exr", n, "float"), text="0.5 0.5 1 0 0 1\n")
    assert result.returncode == 0
    assert "no normal count as flat" in result.stderr and "point inwards" in result.stderr
    assert "nan" not in result.stdout and "inf" not in result.stdout
    for (row, column), said, unsaid in (((3, 3), "no normal count", "inwards"), ((5, 5), "inwards", "no normal")):  # one of them
        one = 0.5 + 0.5 * normals(8, 8)
        one[row, column] = n[row, column]
        message = run(write(tmp_path / "b.exr", one, "float"), text="0.5 0.5\n").stderr
        assert said in message and unsaid not in message


def test_bad_points_name_their_line(tmp_path):
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * normals(), "float")
    result = run(picture, text="0.1 0.2\n\n0.1\n")
    assert result.returncode == 1 and "line 3: " in result.stderr
    assert "expected u v or u v du1" in result.stderr


def test_without_the_module(tmp_path):
    alone = shutil.copy(SHADE, tmp_path / "shade")
    picture = write(tmp_path / "a.exr", 0.5 + 0.5 * normals(), "float")
    result = run(picture, shade=alone)
    assert result.returncode == 1
    assert "libopenimageio-dev" in result.stderr and "a.exr" in result.stderr
    (tmp_path / "shade_image_oiio.so").write_text("no module")
    result = run(picture, shade=alone)
    assert result.returncode == 1 and f"{picture}: cannot load the reader of pictures: " in result.stderr, result.stderr
    (tmp_path / "bin").mkdir()  # as installed
    shutil.move(alone, tmp_path / "bin/shade")
    (tmp_path / "libexec/shade").mkdir(parents=True)
    shutil.move(tmp_path / "shade_image_oiio.so", tmp_path / "libexec/shade/shade_image_oiio.so")
    assert "cannot load the reader of pictures" in run(picture, shade=tmp_path / "bin/shade").stderr
