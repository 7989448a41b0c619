# SPDX-License-Identifier: Apache-2.0
"""libshade-farm on this machine: pictures of parts are those of the whole, what fails is tried again and named, what is whole stays."""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import OpenImageIO as oiio
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "farm"), str(ROOT / "blender_addon_c/tests")]

import files  # noqa: E402
import png  # noqa: E402
import renderers  # noqa: E402
from native_scenes import scene  # noqa: E402
from renderers import povray  # noqa: E402
from shade_render import COMBINED, scene_file  # noqa: E402

COST = 15

RENDER, POVRAY = ROOT / "build/shade-render", ROOT / "build/povray/povray"
NAME = "kugel 球 1"  # what shells and sbatch would take apart


def farm(*words, status=0, **more):
    done = subprocess.run(["/usr/bin/python3", ROOT / "farm", *map(str, words)], capture_output=True, text=True, timeout=100, **more)
    assert done.returncode == status, (done.stdout, done.stderr)
    return done.stdout + done.stderr


def pixels(path):
    image = oiio.ImageBuf(str(path))
    return image.spec().channelnames, image.get_pixels(oiio.FLOAT)


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("saved") / f"{NAME}.shscene"
    scene_file.write(path, "L", [(scene(width=40, height=24, samples=20, planes=[{"type": "NORMAL"}]), [COMBINED, ("Normal", "XYZ", "NORMAL", 1.0)])])
    subprocess.run([RENDER, path, "-o", path.with_suffix(".exr")], check=True)
    return path


STUB = """#!/bin/sh
# stands for shade-render: writes its words, slowly where that is asked for; fails as often as the file `fails` has lines
scene=$1
echo started >>{0}/started
[ ! -e {0}/says ] || cat {0}/says >&2
while [ -e {0}/wait ]; do sleep 0.05; done
for word in "$@"; do
  [ -z "$output" ] || {{ file=$word; output=; }}
  [ "$word" != -o ] || output=yes
done
case "$*" in *"--tile 0,0"*)
  if [ -s {0}/fails ]; then sed -i 1d {0}/fails; echo "tile is too hot" >&2; exit 3; fi
  if [ -s {0}/kills ]; then sed -i 1d {0}/kills; kill -9 $PPID; exit 1; fi ;;
esac
echo "$@" >"$file"
"""


@pytest.fixture
def stub(tmp_path):
    path = tmp_path / "stub"
    path.write_text(STUB.format(tmp_path))
    path.chmod(0o755)
    return f"shade-render={path}"


def test_parts_merge_to_the_picture(saved, tmp_path):
    """Two submissions at once, each with a folder of its own; the frames of one are tiles, to the last bit, of the other shares too."""
    going = [subprocess.Popen(["/usr/bin/python3", ROOT / "farm", "submit", saved, *words], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
             for words in (("--tiles", "2x2"), ("--tiles", "1x2", "--shares", "3"))]
    said = [one.communicate(timeout=60)[0] for one in going]
    assert [one.returncode for one in going] == [0, 0]
    names, whole = pixels(saved.with_suffix(".exr"))
    for words, count in zip(said, (4, 6)):
        folder = pathlib.Path(words.splitlines()[0].split("; all of it is in ")[1])
        assert folder.parent == tmp_path and f"{count} of {count} items are whole" in words
        found, made = pixels(folder / "frames" / f"{NAME}.exr")
        assert found == names
        assert (made == whole).all() if count == 4 else np.allclose(made, whole, rtol=3e-6, atol=3e-6)
        assert not list((folder / "work").iterdir()) and not list((folder / "running").iterdir())


def test_what_fails_is_tried_twice_again_and_then_named(saved, stub, tmp_path):
    (tmp_path / "fails").write_text("\n" * 2)
    (tmp_path / "kills").write_text("")
    words = "submit", saved, "--tiles", "2x1", "--program", stub
    assert "1 items failed; they are tried again" in farm(*words, "-o", tmp_path / "a")
    (tmp_path / "fails").write_text("\n" * 3)
    said = farm(*words, "-o", tmp_path / "b", status=1)
    message = "item 0 (tile 0,0,20,24): stub ended with 3: tile is too hot; on "
    assert message in said and f"log {tmp_path / 'b/log/0.log'}" in said and "1 of 2 items are whole" in said
    told = farm("status", tmp_path / "b")
    assert "2 items: 1 done, 0 running, 1 failed, 0 wait" in told and f"failed: {message}" in told
    assert not list((tmp_path / "b/frames").iterdir())
    (tmp_path / "started").unlink()
    farm("resume", tmp_path / "b")
    assert len((tmp_path / "started").read_text().split()) == 2  # the one that was missing, and the merge
    told = farm("status", tmp_path / "b")
    assert "2 done, 0 running, 0 failed" in told and re.search(r"^an item took \d+\.\d s, \d+\.\d s at most, and [1-9]\d* MB at most$", told, re.M)
    assert list((tmp_path / "b/frames").iterdir())
    (tmp_path / "kills").write_text("\n")
    assert "item 0 (tile 0,0,20,24): its process was ended by SIGKILL; on " in farm(*words, "-o", tmp_path / "c")


def test_an_item_runs_alone_and_twice_at_once(saved, stub, tmp_path):
    farm("submit", saved, "--tiles", "2x1", "--program", stub, "-o", tmp_path / "a")
    shutil.rmtree(tmp_path / "a/results/0")
    (tmp_path / "started").unlink()
    (tmp_path / "wait").touch()
    words = ["/usr/bin/python3", tmp_path / "a/farm.pyz", "item", tmp_path / "a", "0"]
    both = [subprocess.Popen(words, cwd="/") for _ in range(2)]
    end = time.monotonic() + 30
    while not (tmp_path / "started").exists() or len((tmp_path / "started").read_text().split()) < 2:
        assert time.monotonic() < end
        time.sleep(0.02)
    assert "1 running" in farm("status", tmp_path / "a")
    (tmp_path / "wait").unlink()
    assert [one.wait(30) for one in both] == [0, 0]
    assert not list((tmp_path / "a/work").iterdir()) and files.read_json(tmp_path / "a/results/0/item.json")["files"]
    assert "item 0 (tile 0,0,20,24) is whole already" in subprocess.run(words, check=True, capture_output=True, text=True).stdout
    assert len((tmp_path / "started").read_text().split()) == 2
    part = tmp_path / "a/results/0/part.shshare"
    part.write_bytes(b"x" * part.stat().st_size)  # half of it lost by a disk
    subprocess.run(words, check=True)
    assert part.read_bytes() != b"x" * part.stat().st_size
    assert subprocess.run([*words[:-1], "2"], capture_output=True, text=True).stderr == "libshade-farm: item 2: there are 2, from 0 on\n"


def test_ctrl_c_keeps_what_is_whole(saved, stub, tmp_path):
    (tmp_path / "wait").touch()
    going = subprocess.Popen(["/usr/bin/python3", ROOT / "farm", "submit", saved, "--tiles", "2x2", "--threads", "1", "--program", stub, "-o", tmp_path / "a"],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "started").exists():
        time.sleep(0.02)
        assert going.poll() is None
    going.send_signal(signal.SIGINT)
    assert "stopped; go on with: libshade-farm resume" in going.communicate(timeout=60)[1] and going.returncode == 130
    assert not list((tmp_path / "a/work").iterdir()) and "4 items: 0 done, 0 running" in farm("status", tmp_path / "a")
    (tmp_path / "wait").unlink()
    farm("cancel", tmp_path / "a")
    said = farm("status", tmp_path / "a")
    assert "cancelled; go on with" in said and "hangs: nothing runs it on" in said
    assert "4 of 4 items are whole" in farm("resume", tmp_path / "a")


def test_inputs_are_those_that_were_submitted(saved, stub, tmp_path):
    own = tmp_path / "own.shscene"
    own.write_bytes(saved.read_bytes())
    words = "submit", own, "--tiles", "2x1", "--program", stub
    for name, more in (("there", ()), ("packed", ("--pack",))):
        farm(*words, *more, "-o", tmp_path / name)
        shutil.rmtree(tmp_path / name / "results/0")
    own.write_bytes(saved.read_bytes()[:-1] + b"x")
    assert f"{own}: an input is another than was submitted" in farm("resume", tmp_path / "there", status=1)
    farm("resume", tmp_path / "packed")
    own.unlink()
    assert f"{own}: an input is not there" in farm("resume", tmp_path / "there", status=1)


def test_instruction_sets_are_held_to_one(saved, stub, tmp_path):
    """And a machine that lacks it takes no other."""
    alone = tmp_path / "alone.exr"
    subprocess.run([RENDER, saved, "-o", alone], env={**os.environ, "LIBSHADE_ISA": "scalar"}, check=True)
    farm("submit", saved, "--isa", "scalar", "-o", tmp_path / "a")
    assert (pixels(tmp_path / f"a/frames/{NAME}.exr")[1] == pixels(alone)[1]).all()
    (tmp_path / "says").write_text("shade-render: warning: LIBSHADE_ISA 'avx512': this CPU has scalar, sse2; sse2 is used\n")
    assert "this machine has no avx512, to which items are held" in farm("submit", saved, "--isa", "avx512", "--program", stub, "-o", tmp_path / "b", status=1)


def test_dry_run_begins_nothing(saved, tmp_path):
    said = farm("submit", saved, "--tiles", "2x1", "--dry-run", cwd=tmp_path)
    assert not list(tmp_path.iterdir())
    assert "item 1 (tile 20,0,20,24)" in said and f"{files.sha256(saved)}  {saved}" in said and "item '" + str(tmp_path) in said
    said = farm("submit", saved, "--tiles", "2x1", "--engine", "slurm", "--dry-run", "--sbatch=--mem=4G", cwd=tmp_path)
    assert "sbatch --parsable" in said and "--array=0-1" in said and "--kill-on-invalid-dep=yes" in said and "--mem=4G" in said


def test_commands(tmp_path):
    """In their folder; one that fails is named."""
    (tmp_path / "there").touch()
    listed = tmp_path / "two.items"
    listed.write_text(json.dumps({"folder": str(tmp_path), "inputs": ["there"], "items": [
        {"name": "good", "words": ["cp", "there", "made"]}, {"name": "bad", "words": ["ls", "nowhere"]}]}))
    said = farm("submit", listed, "-o", tmp_path / "a", status=1)
    assert "item 1 (bad): ls ended with 2: ls: cannot access 'nowhere'" in said and (tmp_path / "made").exists() and "1 of 2 items are whole" in said
    (tmp_path / "nowhere").touch()
    assert f"2 of 2 items are whole; results are in {tmp_path / 'a/results'}" in farm("resume", tmp_path / "a")
    listed.write_text('{"items": [{"name": "x", "words": "ls"}]}')
    assert "JSON with folder, inputs and items" in farm("submit", listed, status=1)


@pytest.mark.parametrize("words, status, said", [
    (("x.png",), 1, "must end in .shscene, .blend, .pov, .items"), (("no.pov",), 1, "no.pov: no such file"), (("{scene}", "--frames", "1-9"), 1, "is one frame"),
    (("{scene}", "--tiles", "9"), 2, "NxM was expected"), (("{scene}", "--tiles", "41x1"), 1, "40 pixels cannot be cut into 41 tiles"),
    (("{scene}", "--shares", "21"), 1, "20 samples cannot be cut into 21 shares"), (("{adaptive}", "--shares", "2"), 1, "--shares: the scene has adaptive"),
    (("{pov}", "--shares", "2"), 1, "POV-Ray's samples have no numbers"), (("{pov}", "--tiles", "2x2"), 1, "give +W and +H"),
    (("{pov}", "--frames", "5-2"), 1, "are none"), (("{scene}", "--program", "cat=x"), 2, "blender=PATH"), (("{scene}", "-o", "{folder}"), 1, "not empty")])
def test_what_is_wrong_is_told(saved, tmp_path, words, status, said):
    places = {"scene": saved, "adaptive": tmp_path / "a.shscene", "pov": tmp_path / "a.pov", "folder": tmp_path}
    scene_file.write(places["adaptive"], "L", [(scene(samples=20, adaptive_threshold=0.1), [COMBINED])])
    places["pov"].write_text('#include "colors.inc"\n')
    assert said in farm("submit", *(word.format(**places) for word in words), status=status, cwd=tmp_path)


def test_without_slurm_it_is_said_what_to_install(saved, tmp_path):
    said = farm("submit", saved, "--engine", "slurm", status=1, cwd=tmp_path, env={**os.environ, "PATH": str(tmp_path)})
    assert "sbatch is not installed" in said and "slurm-client" in said and not list(tmp_path.iterdir())


@pytest.mark.parametrize("samples, parts, together", [(20, 3, False), (64, 64, False), (1000, 7, False), (256, 4, True), (300, 5, True), (64, 3, True), (17, 3, True), (2, 1, True)])
def test_shares_are_all_samples_once(samples, parts, together):
    found = renderers.cuts_of_samples(samples, parts, together)
    assert len(found) == parts and found[0][0] == 0 and found[-1][1] == samples
    assert all(a < b for a, b in found) and all(one[1] == two[0] for one, two in zip(found, found[1:]))
    if together or samples >= 64 * parts:
        assert all(end in (4, 16, samples) or end % 64 == 0 for _, end in found)


def test_tiles_are_all_pixels_once():
    for length, parts, grid in ((40, 3, 1), (90, 2, 32), (7, 7, 1), (1080, 5, 32)):
        found = renderers.cut(length, parts, grid)
        assert found[0][0] == 0 and found[-1][1] == length and all(a < b and a % grid == 0 for a, b in found)
        assert all(one[1] == two[0] for one, two in zip(found, found[1:]))


@pytest.mark.parametrize("kind, channels", [("uint8", 3), ("uint16", 4), ("uint8", 1)])
def test_pasted_pngs(tmp_path, kind, channels):
    """By another's reader and writer, whose rows have all filters: of smooth and of noisy pictures."""
    y, x = np.mgrid[:23, :37]
    most = np.iinfo(kind).max
    smooth = np.stack([np.sin(x / (3 + c)) * np.cos(y / 5) * 0.4 + 0.5 for c in range(channels)], -1)
    noisy = np.random.default_rng(1).random((23, 37, channels))
    tiles, whole = [], np.where((y < 9)[..., None], smooth, noisy)
    whole[..., 3:] = 1  # that reader multiplies colours by alpha
    for number, (x0, y0, x1, y1) in enumerate([(0, 0, 20, 9), (20, 0, 37, 9), (0, 9, 37, 23)]):
        inside = ((x >= x0) & (x < x1) & (y >= y0) & (y < y1))[..., None]
        path = tmp_path / f"{number}.png"
        image = oiio.ImageBuf(oiio.ImageSpec(37, 23, channels, kind))
        image.set_pixels(oiio.ROI(), (np.where(inside, whole, 0) * most + 0.5).astype(kind))
        assert image.write(str(path))
        tiles.append((path, (x0, y0, x1 - x0, y1 - y0)))
    png.paste(tiles, tmp_path / "all.png")
    found = oiio.ImageBuf(str(tmp_path / "all.png")).get_pixels(getattr(oiio, kind.upper()))
    assert (found.reshape(whole.shape) == (whole * most + 0.5).astype(kind)).all()
    damaged = bytearray((tmp_path / "1.png").read_bytes())
    damaged[60] ^= 1
    (tmp_path / "1.png").write_bytes(damaged)
    with pytest.raises(files.Refusal, match="1.png"):
        png.paste(tiles, tmp_path / "other.png")


def test_packed_for_povray(tmp_path):
    """What lies beside the scene keeps its place; what lies elsewhere is named."""
    (tmp_path / "home/maps").mkdir(parents=True)
    for name, text in (("home/a.pov", '#include "maps/b.inc" #declare f = "../far.png";'), ("home/maps/b.inc", ""), ("far.png", "")):
        (tmp_path / name).write_text(text)
    found, _ = povray.inputs_of(str(tmp_path / "home/a.pov"), [str(tmp_path / "home")])
    with pytest.raises(files.Refusal, match="far.png: --pack takes what lies in the scene's folder"):
        povray.pack(str(tmp_path / "home/a.pov"), found, str(tmp_path / "packed"), None)
    place = povray.pack(str(tmp_path / "home/a.pov"), found[:1] + [path for path in found if path.endswith(".inc")], str(tmp_path / "packed"), None)
    assert place == str(tmp_path / "packed/a.pov") and (tmp_path / "packed/maps/b.inc").exists()


def test_inputs_of_povray(tmp_path):
    (tmp_path / "lib").mkdir()
    for name, text in (("a.pov", '#include "b.inc" // "no.png"\n/* "no.png" */ #declare f = "tex 球.png";'), ("lib/b.inc", '#local d = "c.wif";'),
                       ("c.wif", ""), ("no.png", ""), ("tex 球.png", "")):
        (tmp_path / name).write_text(text)
    found, _ = povray.inputs_of(str(tmp_path / "a.pov"), [str(tmp_path), str(tmp_path / "lib")])
    assert {os.path.relpath(path, tmp_path) for path in found} == {"a.pov", "lib/b.inc", "c.wif", "tex 球.png"}


@pytest.mark.skipif(not POVRAY.exists(), reason="POV-Ray with libshade is not built (make povray)")
def test_frames_and_tiles_of_povray(tmp_path):
    """Each frame is POV-Ray's own of an animation; tiles are the picture."""
    scene_of = tmp_path / f"{NAME}.pov"
    scene_of.write_text('#version 3.7; global_settings { assumed_gamma 1 } camera { location -3*z } light_source { <2, 3, -4> 1 }\n'
                        'sphere { <clock - .5, 0, 0>, 1 pigment { checker rgb 1 rgb <1, 0, 0> scale .3 } finish { specular .5 } }\n')
    words = "+W80", "+H50", "+A0.1"
    (tmp_path / "plain.pov").write_bytes(scene_of.read_bytes())  # its own command line takes Latin letters alone
    subprocess.run([POVRAY, "+Iplain.pov", *words, "-D", "+KFI1", "+KFF3"], check=True, capture_output=True, cwd=tmp_path)
    said = farm("submit", scene_of, "--frames", "1-3/2", "-o", tmp_path / "frames", "--", *words)
    farm("submit", scene_of, "--frames", "3", "--tiles", "2x2", "-o", tmp_path / "tiles", "--", *words, "+KFI1", "+KFF3")
    movie = tmp_path / f"frames/frames/{NAME}.mp4"
    if shutil.which("ffmpeg"):
        assert f"movie: {movie}" in said and subprocess.run(
            ["ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames,width,height", "-of", "csv=p=0", movie], check=True,
            capture_output=True, text=True).stdout.strip() == "80,50,2"
        movie.unlink()
    else:
        assert "no movie: ffmpeg is not installed here" in said
    assert sorted(os.listdir(tmp_path / "frames/frames")) == [f"{NAME}_0001.png", f"{NAME}_0003.png"]
    for folder, frame in (("frames", 1), ("frames", 3), ("tiles", 3)):
        assert (pixels(tmp_path / folder / f"frames/{NAME}_000{frame}.png")[1] == pixels(tmp_path / f"plain{frame}.png")[1]).all(), (folder, frame)


SCENE = """
import bpy, sys
bpy.ops.preferences.addon_enable(module="libshade")
scene, layer = bpy.context.scene, bpy.context.view_layer
scene.render.engine, scene.libshade.samples = "LIBSHADE", 4
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 40, 24, 100
scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
layer.use_pass_z = layer.use_pass_diffuse_direct = layer.use_pass_cryptomatte_object = True
image = bpy.data.images.new("image", 4, 4)
image.generated_color = 0.8, 0.5, 0.2, 1
image.filepath_raw, image.file_format = sys.argv[-1] + ".png", "PNG"
image.save()
material = bpy.data.objects["Cube"].active_material
node = material.node_tree.nodes.new("ShaderNodeTexImage")
node.image = image
material.node_tree.links.new(node.outputs[0], material.node_tree.nodes["Principled BSDF"].inputs[0])
bpy.data.objects["Cube"].keyframe_insert("rotation_euler", frame=1)
bpy.data.objects["Cube"].rotation_euler[2] = 1
bpy.data.objects["Cube"].keyframe_insert("rotation_euler", frame=5)
liquid = bpy.data.objects.new("liquid", bpy.data.meshes.new("liquid"))
liquid.hide_render = True
scene.collection.objects.link(liquid)
liquid.modifiers.new("liquid", "FLUID").fluid_type = "DOMAIN"
liquid.modifiers[0].domain_settings.cache_directory = "//liquid"
frames = bpy.data.images.load(sys.argv[-1] + ".frame_01.png")
frames.source, frames.use_fake_user = "SEQUENCE", True
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[-1])
"""


@pytest.mark.skipif(not (ROOT / "build/blender/ready").exists() or not shutil.which("blender"), reason="Blender with the add-on is not there (make blender)")
def test_frames_and_tiles_of_blender(tmp_path):
    """A tile's pixels are those of the frame that Blender renders whole, with all passes and the list of names."""
    blend = tmp_path / f"{NAME}.blend"
    environment = {"BLENDER_USER_SCRIPTS": str(ROOT / "build/blender"), "HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
    beside = ["liquid/data/fluid_data_0001.vdb", f"blendcache_{NAME}/cloth_000001_00.bphys", f"{blend.name}.frame_01.png", f"{blend.name}.frame_02.png"]
    for name in (*beside, f"{blend.name}.other_01.png"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(name.encode())
    subprocess.run(["blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python-expr", SCENE, "--", blend], env=environment, check=True,
                   capture_output=True)
    for folder, words in (("whole", ()), ("tiles", ("--tiles", "2x1"))):
        farm("submit", blend, "--frames", "3", "-o", tmp_path / folder, *words, env=environment)
    assert {one["path"] for one in json.loads((tmp_path / "tiles/job.json").read_text())["inputs"]} == {
        str(tmp_path / name) for name in (*beside, blend.name, blend.name + ".png")}
    whole, tiles = (oiio.ImageBuf(str(tmp_path / folder / f"frames/{NAME}_0003.exr")) for folder in ("whole", "tiles"))
    names = whole.spec().channelnames
    assert len(names) > 12 and set(names) == set(tiles.spec().channelnames)
    a, b = whole.get_pixels(oiio.FLOAT), tiles.get_pixels(oiio.FLOAT)
    assert np.ptp(a[..., names.index("ViewLayer.Combined.R")]) > 0.1
    for k, name in enumerate(names):
        assert (a[..., k] == b[..., tiles.spec().channelnames.index(name)]).all(), name
    manifests = [{one.name: one.value for one in image.spec().extra_attribs if "manifest" in one.name} for image in (whole, tiles)]
    assert manifests[0] == manifests[1] and "Cube" in str(manifests[0])
