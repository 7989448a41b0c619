# SPDX-License-Identifier: Apache-2.0
"""Time to equal error: the error's formula, what a noisy reference takes off, the verdict."""
import json
import re
import sys
from collections import defaultdict
from unittest.mock import MagicMock

import numpy as np
import pytest

import paths
import pictures
import programs
import whole

COST = 0.65


def test_relative_mse_of_a_known_error():
    reference = np.full((40, 40, 3), 0.5)
    off = reference.copy()
    off[:20] += 0.1  # half of it, by .1: .5 · .01 / (.25 + .0025)
    assert paths.relative_mse(off, reference) == pytest.approx(0.5 * 0.01 / 0.2525)
    assert paths.relative_mse(reference, reference) == 0
    fireflies = reference.copy()
    fireflies[0, 0, 0] = 1e6  # fewer than one in a thousand
    assert paths.relative_mse(fireflies, reference) < 1e-12


@pytest.mark.parametrize("samples, many", [(16, 64), (64, 1024)])
def test_the_reference_has_noise_too(samples, many):
    rng = np.random.default_rng(3)
    truth = np.full((200, 200, 3), 0.7)
    noisy, reference = (truth + rng.normal(0, 0.3 / np.sqrt(n), truth.shape) for n in (samples, many))
    alone = paths.relative_mse(noisy, truth)
    both = paths.relative_mse(noisy, reference)
    assert both > 1.02 * alone
    assert paths.own_error(both, samples, many) == pytest.approx(alone, rel=0.02)


def test_the_sky_has_what_a_studio_has():
    sky = paths.studio(64)
    assert sky.shape == (64, 128, 3) and sky.min() > 0
    assert 5 < sky.max() / sky.mean() < 1000 and (sky.reshape(-1, 3).max(axis=1) > 4).mean() < 0.1


def judge(monkeypatch, folder, change):
    """Exit status where our picture of the room is changed by `change`."""
    rng = np.random.default_rng(8)

    def step(_words, command, _log, _environment):
        order = json.loads((folder / "jobs.json").read_text())
        for job in order["jobs"]:
            picture = 0.5 + rng.normal(0, 0.5 / np.sqrt(job["samples"]), (32, 32, 3))
            ours = job["engine"] == "LIBSHADE" and job["scene"] == "room"
            pictures.write_float(job["output"], change(picture) if ours else picture)
        whole.write_text(order["result"], json.dumps(
            {"blender": "none", "seconds": [0.5] * len(order["jobs"])}))
        assert command[-1].endswith("jobs.json")

    monkeypatch.setattr(paths.report, "step", step)
    return paths.main(["--size", "32", "--samples", "64", "--reference", "65536",
                       "--output", str(folder)])


def test_equal_pictures_are_good(monkeypatch, tmp_path, capsys):
    assert judge(monkeypatch, tmp_path, lambda picture: picture) == 0
    table = capsys.readouterr().out
    assert all(row in table for row in ("studio, Cycles", "room, libshade", "room, libshade beside"))


def dimmer(picture):
    return 0.95 * picture


def stained(picture):
    picture[:12, :12, 1] *= 1.5
    return picture


@pytest.mark.parametrize("change", [dimmer, stained])
def test_one_bad_picture_is_not(monkeypatch, tmp_path, capsys, change):
    assert judge(monkeypatch, tmp_path, change) == 1
    assert "differ by more than 0.02" in capsys.readouterr().out


@pytest.mark.parametrize("words", [["--samples", "0"], ["--samples", "64", "--reference", "64"],
                                   ["--size", "2"], ["--scene", "garden"]])
def test_bad_arguments(words):
    with pytest.raises(SystemExit) as ended:
        paths.arguments(words)
    assert ended.value.code == 2


def test_blocks_are_means_of_squares():
    """Of 4 x 4 pixels; what does not fill one at the right and at the bottom is left out."""
    picture = np.arange(9 * 14 * 3.0).reshape(9, 14, 3)
    found = paths.blocks(picture)
    assert found.shape == (2, 3, 3)
    for y in range(2):
        for x in range(3):
            assert found[y, x] == pytest.approx(picture[4 * y:4 * y + 4, 4 * x:4 * x + 4].mean((0, 1)))


class Anything:
    """Of Blender: whatever is set stays."""

    def __init__(self, **parts):
        self.__dict__.update(parts)


# As both renderers are told: nothing that would end paths, clamp or filter light in one of them
FAIR = {"seed": 7, "blur_glossy": 0, "sample_clamp_direct": 0, "sample_clamp_indirect": 0, "light_sampling_threshold": 0, "pixel_filter_type": "BOX",
        "use_adaptive_sampling": False, "use_denoising": False, "filter_normals": False}


def of_blender(name, monkeypatch, **bpy):
    """A script that runs in Blender, as far as it stands without."""
    monkeypatch.setitem(sys.modules, "bpy", Anything(**bpy))
    monkeypatch.setitem(sys.modules, "mathutils", Anything(Vector=list, Matrix=list, Euler=list))
    monkeypatch.setitem(sys.modules, "addon_utils", Anything())
    path = programs.HERE / f"{name}.py"
    given = {"__file__": str(path), "__name__": name}
    exec(compile(re.split(r"^(?:main|run)\(", path.read_text(encoding="utf-8"), flags=re.M)[0], str(path), "exec"), given)
    return given


@pytest.mark.parametrize("engine", ["LIBSHADE", "CYCLES"])
@pytest.mark.parametrize("place, bounces", [("studio", 4), ("room", 8)])
def test_both_renderers_are_told_the_same(monkeypatch, engine, place, bounces):
    told, other = ({name: None for name in (*FAIR, "samples", "max_bounces", "diffuse_bounces", "glossy_bounces")} for _ in "ab")
    scene = Anything(render=Anything(image_settings=Anything()), view_settings=Anything(), libshade=Anything(**told), cycles=Anything(**other))
    job = {"engine": engine, "scene": place, "size": 96, "samples": 33, "seed": 7, "output": "x.exr"}
    of_blender("paths_render", monkeypatch)["set_render"](scene, job)
    own, idle = (scene.libshade, scene.cycles) if engine == "LIBSHADE" else (scene.cycles, scene.libshade)
    assert vars(own) == {**FAIR, "samples": 33, "max_bounces": bounces, "diffuse_bounces": bounces, "glossy_bounces": bounces}
    assert set(vars(idle).values()) == {None}
    render = scene.render
    assert (render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage, render.filepath) == (engine, 96, 96, 100, "x.exr")
    assert vars(render.image_settings) == {"file_format": "OPEN_EXR", "color_depth": "32"} and not render.use_file_extension


@pytest.mark.parametrize("engine", ["LIBSHADE", "CYCLES"])
@pytest.mark.parametrize("was, size, now", [((1920, 1080), 480, (480, 272)), ((1080, 1920), 480, (272, 480)), ((4000, 16), 400, (400, 16)), ((100, 100), 200, (200, 200))])
def test_files_of_others_are_rendered_at_one_size(monkeypatch, engine, was, size, now):
    """By the longer side, both by 4; as the file has it, but for what would add to the picture."""
    flags = "use_border use_compositing use_sequencer use_freestyle use_multiview use_stamp use_file_extension use_persistent_data".split()
    render = Anything(resolution_x=was[0], resolution_y=was[1], image_settings=Anything(media_type="VIDEO"), threads_mode="AUTO", **dict.fromkeys(flags, True))
    scene = Anything(render=render, libshade=Anything(samples=1, seed=1), cycles=Anything(samples=1, seed=1))
    script = of_blender("real_files_render", monkeypatch, context=Anything(scene=scene), app=Anything(version=(5, 0)))
    settings = script["set_render"]({"engine": engine, "size": size, "threads": 3, "grooves": False})
    assert settings is (scene.libshade if engine == "LIBSHADE" else scene.cycles)
    assert (render.resolution_x, render.resolution_y) == now and render.engine == engine and not any(getattr(render, flag) for flag in flags)
    assert (render.threads_mode, render.threads, render.use_single_layer) == ("FIXED", 3, True)
    assert vars(render.image_settings) == {"media_type": "IMAGE", "file_format": "OPEN_EXR", "color_mode": "RGBA", "color_depth": "32"}
    render.threads_mode = "AUTO"
    script["set_render"]({"engine": engine, "size": size, "threads": 0, "grooves": True})
    assert render.threads_mode == "AUTO"


class Shader(Anything):
    """A node of Blender's, whose sockets hold what is set."""

    def __init__(self, kind):
        super().__init__(kind=kind, distribution="", type=kind.removeprefix("ShaderNode").upper(), inputs=defaultdict(Anything), outputs=defaultdict(Anything))
        if kind == "ShaderNodeBsdfAnisotropic":
            self.inputs["Tangent"] = Anything()


def made_by_blender(bpy):
    """Materials, objects and lamps that a script asks of Blender: (name, what), in their order."""
    made = []

    def tree():
        nodes = MagicMock(new=lambda kind: made.append((kind, Shader(kind))) or made[-1][1])
        nodes.__iter__.side_effect = lambda: iter([Shader("ShaderNodeBackground"), *(what for _name, what in made if isinstance(what, Shader))])
        return MagicMock(nodes=nodes)
    bpy.data.materials.new = lambda name: made.append((name, "material")) or MagicMock(node_tree=tree())
    bpy.data.worlds.new = lambda _name: MagicMock(node_tree=tree())
    bpy.data.lights.new = lambda name, kind: made.append((name, Anything(type=kind))) or made[-1][1]
    bpy.data.meshes.new = lambda name: Anything(name=name, materials=[], from_pydata=lambda *given: made.append((name, given)))
    bpy.data.objects.new = lambda name, data: made.append((f"object {name}", Anything(data=data))) or made[-1][1]
    return made


@pytest.mark.parametrize("place", ["studio", "room"])
def test_scenes_are_what_their_description_says(monkeypatch, place):
    """Metal of alphas .05 and .3 in Cycles' measure, a matt and a shining ball on a grey floor, or in a closed box under a lamp of 2 m that looks down
    from within it. No lamp in the studio, and no sky in the room."""
    bpy = MagicMock()
    made = made_by_blender(bpy)
    script = of_blender("paths_render", monkeypatch, context=bpy.context, data=bpy.data, ops=bpy.ops)
    script["Vector"] = MagicMock()
    script["set_render"] = lambda _scene, _job: None
    scene = script["build"]({"scene": place}, "sky.exr")
    bsdfs = [what for name, what in made if name.startswith("ShaderNodeBsdf")]
    grey, brushed, matt, gloss = bsdfs
    assert [b.kind.removeprefix("ShaderNodeBsdf") for b in bsdfs] == ["Diffuse", "Anisotropic", "Diffuse", "Glossy"] and brushed.distribution == gloss.distribution == "GGX"
    r, a = (brushed.inputs[name].default_value for name in ("Roughness", "Anisotropy"))
    assert (r * r * (1 - a), r * r / (1 - a)) == pytest.approx((0.05, 0.3)) and gloss.inputs["Roughness"].default_value ** 2 == pytest.approx(0.1)
    assert [b.inputs["Color"].default_value for b in bsdfs] == [(0.5, 0.5, 0.5, 1), (0.9, 0.75, 0.5, 1), (0.6, 0.2, 0.15, 1), (0.8, 0.8, 0.85, 1)]
    assert next(what for name, what in made if name == "ShaderNodeTangent").direction_type == "UV_MAP"
    balls = [call.kwargs for call in bpy.ops.mesh.primitive_uv_sphere_add.call_args_list]
    assert [(ball["location"][2], ball["radius"]) for ball in balls] == [(0.6, 0.6)] * 2 and balls[0]["location"][0] == -balls[1]["location"][0] == -1.7
    assert bpy.ops.mesh.primitive_monkey_add.call_args.kwargs["location"] == (0, 0, 1)
    eye = next(what for name, what in made if name == "object camera")
    assert scene.camera is eye and eye.data.lens == 45
    lamps = [what for name, what in made if name == "object area"]
    if place == "studio":
        assert not lamps and bpy.ops.mesh.primitive_plane_add.call_args.kwargs == {"size": 40} and bpy.data.images.load.call_args.args == ("sky.exr",)
        return
    (lamp,), (corners, _edges, faces) = lamps, next(what for name, what in made if name == "box")
    low, high = np.min(corners, 0), np.max(corners, 0)
    assert low.tolist() == [-4, -7, 0] and high.tolist() == [4, 4, 5] and np.bincount(np.ravel(faces)).tolist() == [3] * 8
    assert (lamp.data.type, lamp.data.energy, lamp.data.size) == ("AREA", 400, 2) and lamp.rotation_euler == (0, 0, 0)
    assert (low < np.array(lamp.location) - (1, 1, 0)).all() and (np.array(lamp.location) + (1, 1, 0) < high).all() and high[2] - lamp.location[2] < 0.1
    for face in faces:  # each of the box's six sides
        corner = np.array([corners[k] for k in face])
        assert (np.ptp(corner, axis=0) == 0).sum() == 1
    assert not bpy.data.images.load.called and not bpy.ops.mesh.primitive_plane_add.called
