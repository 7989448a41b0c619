# SPDX-License-Identifier: Apache-2.0
"""The scripts on the real renderers, at small sizes and with the full limits."""
import json
import subprocess
import sys
from pathlib import Path

import pytest

import consistency
import pictures
import programs
import report
import speed
import truth

COST = 34.2

COMPARE = Path(programs.__file__).parent
MAKE_SCENE = programs.ROOT / "examples" / "blender" / "suzanne" / "make_scene.py"
AWKWARD = Path(__file__).with_name("awkward_scene.py")
EXPORTS = Path(__file__).with_name("exports.py")


def run(script, *arguments):
    """A script of compare/ as a user calls it."""
    return subprocess.run(
        [sys.executable, str(COMPARE / script), *map(str, arguments)],
        capture_output=True, text=True, check=False,
    )


def build_scene(script, path, *arguments):
    report.step("scene", programs.blender(script, path, *arguments), path.with_suffix(".log"),
                programs.ADD_ON)
    return path


@pytest.fixture(scope="module")
def suzanne(tmp_path_factory):
    return build_scene(MAKE_SCENE, tmp_path_factory.mktemp("suzanne") / "suzanne.blend")


@pytest.fixture(scope="module")
def awkward(tmp_path_factory):
    return build_scene(AWKWARD, tmp_path_factory.mktemp("awkward") / "awkward.blend", "PERSP")


@pytest.mark.parametrize("camera", ["PERSP", "ORTHO"])
def test_renderers_agree_on_an_awkward_scene(camera, awkward, tmp_path):
    """On Suzanne the quick report asks them, which test_report_page makes."""
    scene = awkward if camera == "PERSP" else build_scene(AWKWARD, tmp_path / "awkward.blend", camera)
    done = run("consistency.py", scene, "--all", "--output", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "both renderers agree" in done.stdout
    shapes = {pictures.read(tmp_path / f"{name}.png").shape for name in ("blender", "povray", "difference")}
    assert len(shapes) == 1 and shapes.pop()[2] == 3


@pytest.mark.parametrize("scene", ["metals", "suzanne"])
def test_povray_examples_shade_what_the_reference_says(scene, suzanne, tmp_path):
    if scene == "suzanne":
        report.step("Exporting", programs.blender(COMPARE / "export_povray.py",
                                                  suzanne.parent / "povray", scene=suzanne),
                    tmp_path / "export.log", programs.ADD_ON)
    source = programs.ROOT / "examples" / "povray" / scene / f"{scene}.pov"
    report.step("Rendering", [programs.POVRAY, f"+I{source}", f"+L{suzanne.parent / 'povray'}",
                              f"+O{tmp_path / 'picture.png'}", "+W160", "+H120", "-D"],
                tmp_path / "povray.log", {"LIBSHADE_DUMP": str(tmp_path / "dump.exr")})
    said = report.step("Checking", [programs.SHADE, "check", "--json", "--all", "--tolerance", "5e-5",
                                    str(tmp_path / "dump.exr")], tmp_path / "check.log")
    assert json.loads(said)["pass"]
    assert pictures.read(tmp_path / "picture.png").max() > 0.5


def test_rotate_follows_the_displaced_plate(tmp_path):
    done = run("truth.py", "--size", 160, "--samples", 96, "--quads", 500, "--map", 1024, "--output", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    errors = json.loads((tmp_path / "truth.json").read_text())["errors"]
    assert errors["rotate"] <= 0.02
    assert errors["Cycles' Anisotropic, here"] <= 0.01
    # What everyone else does, by Cycles' own node and by our method of the same kind.
    assert errors["Cycles' normal map"] == pytest.approx(errors["gram_schmidt"], abs=0.01)
    assert errors["gram_schmidt"] > 0.3 and errors["perturb"] > 0.3 and errors["none"] > 0.3
    assert (tmp_path / "strip.png").stat().st_size > 0
    assert (tmp_path / "chart.png").stat().st_size > 0


NODES = "bpy.data.materials['Fine, bumped'].node_tree.nodes"


CANNOT = [
    ("bpy.data.lights['Sun'].type = 'AREA'", "light 'Sun': only sharp sun and point lights"),
    ("bpy.data.lights['Lamp'].shadow_soft_size = 1", "light 'Lamp': only sharp sun and point"),
    ("bpy.data.lights['Sun'].cycles.cast_shadow = False", "light 'Sun': it casts no shadow"),
    ("bpy.context.scene.camera = None", "the scene has no camera"),
    ("bpy.data.meshes['Cube'].uv_layers.remove(bpy.data.meshes['Cube'].uv_layers[0])",
     "object 'Cube': the mesh has no UV map"),
    ("bpy.data.images['hammered.png'].filepath = '//none.png'", "material 'Fine, bumped', Normal"),
    ("bpy.data.images['hammered.png'].colorspace_settings.name = 'sRGB'",
     "material 'Fine, bumped', Normal: image 'hammered.png' has colour space 'sRGB'"),
    (f"{NODES}['Image Texture'].interpolation = 'Closest'",
     "material 'Fine, bumped', Normal: only linear interpolation can be written, not Closest"),
    ("bpy.data.meshes['Sphere'].uv_layers.new(name='Second'); "
     f"{NODES}['Normal Map'].uv_map = 'Second'",
     "object 'Sphere', material 'Fine, bumped', Normal: UV map 'Second' is not the active one"),
    (f"{NODES}['Libshade Metal'].inputs['Rotation'].default_value = 0.1",
     "material 'Fine, bumped', Rotation: only whole and half turns can be written"),
    (f"{NODES}['Libshade Metal'].grain = 'RADIAL_Y'; bpy.data.meshes['Sphere'].vertices[0].co.z = 9",
     "material 'Fine, bumped' on mesh 'Sphere': strokes round an axis are ellipses there"),
    (f"bpy.data.materials['Fine, bumped'].node_tree.links.new({NODES}['Image Texture'].outputs['Alpha'], "
     f"{NODES}['Libshade Metal'].inputs['Roughness'])",
     "material 'Fine, bumped', Roughness: what is linked cannot be written"),
    (f"{NODES}['Libshade Metal'].strokes = 0.5", "material 'Fine, bumped', Strokes: no block of POV-Ray's has them"),
    (f"n = {NODES}['Libshade Metal']; n.horizon, n.bumps_are = 'MUTUAL', 'SHAPE'",
     "material 'Fine, bumped', Bumps Are: no block of POV-Ray's has a Shape"),
    ("bpy.data.materials['Across'].node_tree.nodes.clear()",
     "material 'Across': it has no Libshade Metal node"),
]
WRITTEN = [
    ("n.inputs['Roughness'].default_value = 0.5; n.inputs['Anisotropy'].default_value = 0.5",
     ["ashikhmin_shirley 126.0, 6.0"]),  # alphas .25 * .5 and .25 / .5
    ("n.inputs['Diffuse Color'].default_value = (0.25, 0.5, 0.75, 1); n.diffuse = 'LAMBERT'",
     ["diffuse lambert rgb <0.25, 0.5, 0.75>"]),
    ("n.inputs['Edge Tint'].default_value = (0.5, 0.25, 1, 1)", ["fresnel f82 rgb <0.5, 0.25, 1.0>"]),
    ("n.grain = 'RADIAL_Z'", ["tangent radial <-0.0, -1.0, -0.0> at <"]),
    ("n.grain = 'AXIS_Y'; n.inputs['Rotation'].default_value = 0.5", ["tangent <-1e-06, -0.001, -1.0>"]),
    ("n.inputs['Rotation'].default_value = 1.5", ["tangent uv", "rotate 180*z"]),
]
# What is not of a material: the file that says it, what it says
SCENE = "s = bpy.context.scene; "
SAID = [
    (SCENE + "s.render.resolution_percentage = 50", "scene.ini", "Width=120\nHeight=160\nInput_File_Name=scene.pov\n"),
    (SCENE + "s.render.film_transparent = False; s.world = bpy.data.worlds.new('w'); s.world.use_nodes = False; s.world.color = (.25, .5, .75)",
     "scene.pov", "background { rgb <0.25, 0.5, 0.75> }"),
    (SCENE + "s.render.film_transparent = False; s.world = bpy.data.worlds.new('w'); s.world.use_nodes = True; b = s.world.node_tree.nodes['Background']; "
     "b.inputs['Strength'].default_value = 2; b.inputs['Color'].default_value = (.25, .5, .75, 1)", "scene.pov", "background { rgb <0.5, 1.0, 1.5> }"),
    (SCENE + "s.render.film_transparent = True", "scene.pov", "background { rgb <0.0, 0.0, 0.0> }"),
    ("bpy.data.objects['Mirrored twin'].hide_render = True", "scene.pov", "// Made from awkward.blend by compare/export_povray.py.\n#version 3.7;\n#declare mdf_Defaults = 1;\n"),
    # an orthographic camera looks from its plane, as wide as its scale by the shorter side, moved by its shift
    (SCENE + "s.camera.parent = None; s.camera.matrix_world.identity(); s.camera.data.type = 'ORTHO'; s.camera.data.shift_x = s.camera.data.shift_y = 0; "
     "s.camera.data.ortho_scale = 4", "camera.inc", "orthographic\n  location <0.0, 0.0, 0.0>\n  direction <0.0, -1.0, 0.0>\n  right <3.0, 0.0, 0.0>\n  up <0.0, 0.0, 4.0>"),
]


@pytest.fixture(scope="module")
def exported(awkward, tmp_path_factory):
    """{change: (where it was written, what kept it from that)}, of one Blender."""
    out = tmp_path_factory.mktemp("exported")
    metal = f"n = {NODES}['Libshade Metal']; "
    changes = [change for change, _ in CANNOT] + [metal + change for change, _ in WRITTEN] + [change for change, *_ in SAID]
    (out / "changes.json").write_text(json.dumps([f"import bpy; {change}" for change in changes]), encoding="utf-8")
    report.step("Exporting", programs.blender(EXPORTS, out / "changes.json", out, scene=awkward), out / "log",
                programs.ADD_ON)
    said = json.loads((out / "said.json").read_text(encoding="utf-8"))
    return {change: (out / str(k), said[k]) for k, change in enumerate(c for c, *_ in CANNOT + WRITTEN + SAID)}


@pytest.mark.parametrize("change, said", CANNOT)
def test_what_cannot_be_written_is_named(exported, change, said):
    folder, error = exported[change]
    assert said in error
    assert not folder.exists(), "no half-written scene"


def test_what_cannot_be_written_ends_the_export(awkward, tmp_path):
    change, said = CANNOT[0]
    command = programs.blender(COMPARE / "export_povray.py", tmp_path / "out", scene=awkward)
    where = command.index("-P")
    command[where:where] = ["--python-expr", f"import bpy; {change}"]
    with pytest.raises(report.StepFailed) as failure:
        report.step("Exporting", command, tmp_path / "log", programs.ADD_ON)
    assert said in str(failure.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("change, written", WRITTEN)
def test_what_sockets_say_is_written(exported, change, written):
    folder, error = exported[change]
    assert not error
    text = (folder / "materials.inc").read_text(encoding="utf-8")
    fine = text[text.index("Metal_Fine__bumped"):]
    fine = fine[:fine.index("\n}")]
    assert all(words in fine for words in written), fine


@pytest.mark.parametrize("change, file, words", SAID)
def test_what_the_scene_says_is_written(exported, change, file, words):
    folder, error = exported[change]
    assert not error
    text = (folder / file).read_text(encoding="utf-8")
    assert words in text, text[:900]
    if file == "scene.pov":
        assert [name for name in ("camera", "lights", "materials", "meshes") if f'#include "{name}.inc"' in text] == ["camera", "lights", "materials", "meshes"]
        assert text.count("object { Mesh_") == (2 if "hide_render" in change else 3)
    else:
        assert text.startswith((";" if file.endswith(".ini") else "//") + " Made from awkward.blend by compare/export_povray.py.\n")


def test_scripts_explain_themselves_and_refuse_bad_usage(tmp_path):
    done = run("consistency.py", "--help")
    assert done.returncode == 0 and "--output" in done.stdout
    for module in (consistency, truth, speed):
        with pytest.raises(SystemExit) as ended:
            module.arguments(["--none"])
        assert ended.value.code == 2
    done = run("consistency.py", tmp_path / "none.blend")
    assert done.returncode == 1 and "none.blend: no such file" in done.stderr


@pytest.mark.parametrize("words", (["displaced", "pictures"], ["displaced"], ["horizon"], ["bumps"]))
def test_programs_explain_themselves_and_write_nothing(words, tmp_path):
    for asked, status in (("--help", 0), ("--none", 2)):
        done = subprocess.run([programs.ROOT / "build" / words[0], *words[1:], asked], cwd=tmp_path, capture_output=True,
                              text=True, check=False)
        told, silent = (done.stdout, done.stderr) if asked == "--help" else (done.stderr, done.stdout)
        assert done.returncode == status and words[0] in told and not silent, (asked, done)
    assert not list(tmp_path.iterdir())


def test_export_explains_itself(exported):
    ends = json.loads((next(iter(exported.values()))[0].parent / "ends.json").read_text(encoding="utf-8"))
    for words in ("-h", "--help"):
        assert ends[words][0] == 0 and "FOLDER gets scene.ini" in ends[words][1]
    for words in ("", "--folder", "a b"):
        assert ends[words] == [2, "export_povray: expected one FOLDER after `--`; see `-- --help`\n"]
