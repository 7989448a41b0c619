# SPDX-License-Identifier: GPL-3.0-or-later
"""Functions of the add-on that need little of Blender, by tables: small.py."""

import ast
import fnmatch
import math
import os
import sys
import threading
from types import SimpleNamespace as Of
from unittest import mock

import bpy
import numpy as np
from mathutils import Euler, Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402
from parts_of import bare_cloth, module, raised, replaced  # noqa: E402


def close(found, wanted, rtol=1e-5):
    return np.allclose(found, wanted, rtol=rtol, atol=1e-6)


def test_which_rays_see_it():
    seen = module("export.visibility")
    for kind, bit in (("camera", 1), ("diffuse", 2), ("glossy", 4), ("transmission", 8), ("shadow", 16)):
        assert seen.hidden(Of(**{f"visible_{kind}": False}), seen.ALL) == bit
        assert seen.hidden(Of(**{f"visible_{kind}": False}), [other for other in seen.ALL if other != kind]) == 0
        assert seen.hidden(Of(**{f"is_{kind}": False}), seen.ALL, "is_") == bit and seen.hidden(Of(**{f"visible_{kind}": True}), seen.ALL) == 0
    one, other = Of(visible_camera=False), Of(visible_shadow=False, visible_camera=False)
    assert [seen.of_both(one, maker, seen.ALL) for maker in (None, one, other)] == [1, 1, 17]
    assert [seen.is_hidden(bits, *seen.BOUNCED) for bits in (14, 31, 12, 16, 0)] == [True, True, False, False, False]


def test_what_the_module_says_is_of_names():
    named, scene = module("export.messages").named, {"lights": [{}, {"name": "lamp"}], "materials": [{"name": "steel"}], "meshes": [{"name": "object 'ball'"}]}
    for text, wanted in (("scene.lights[1]: angle must be", "light 'lamp': angle must be"), ("scene.lights[0]: angle", "scene.lights[0]: angle"),
                         ("scene.materials[0].nodes[2]: image must", "material 'steel': nodes[2]: image must"), ("scene.meshes[0]: positions", "object 'ball': positions"),
                         ("scene.images[0]: width", "scene.images[0]: width"), ("width must be", "width must be")):
        assert named(text, scene) == wanted, text
    told = module("export.messages").Messages()
    for text in ("b", "a", "b"):
        told.warning(text)
    told.error("c")
    assert list(told.warnings) == ["b", "a"] and list(told.errors) == ["c"]


def test_which_part_of_the_picture():
    region_of = module("export.camera").region_of
    border = Of(use_border=True, border_min_x=0.1, border_max_x=0.999, border_min_y=0.25, border_max_y=0.75)
    assert region_of(Of(render=border), 101, 50) == (10, 12, 100, 37)
    assert region_of(Of(render=Of(use_border=False)), 101, 50) == (0, 0, 101, 50)


# Of a camera: what is set, size of the picture, aspect of a pixel, and left, right, bottom and top of what it sees at a distance of 1, or in space
VIEWS = (({}, (64, 48), (1, 1), (-0.36, 0.36, -0.27, 0.27)), ({}, (48, 64), (1, 1), (-0.27, 0.27, -0.36, 0.36)),
         ({"lens": 25}, (64, 64), (1, 1), (-0.72, 0.72, -0.72, 0.72)), ({"shift_x": 0.25, "shift_y": -0.5}, (64, 48), (1, 1), (-0.18, 0.54, -0.63, -0.09)),
         ({"sensor_fit": "VERTICAL", "sensor_height": 30}, (64, 32), (1, 1), (-0.6, 0.6, -0.3, 0.3)), ({"sensor_fit": "HORIZONTAL"}, (32, 64), (1, 1), (-0.36, 0.36, -0.72, 0.72)),
         ({}, (64, 64), (1, 2), (-0.18, 0.18, -0.36, 0.36)), ({"type": "ORTHO", "ortho_scale": 3}, (64, 32), (1, 1), (-1.5, 1.5, -0.75, 0.75)))


def test_what_a_camera_sees():
    scene, camera_of, told = common.empty_scene(), module("export.camera").camera_of, module("export.messages").Messages()
    for settings, size, aspect, frame in VIEWS:
        camera = common.camera(scene, (1, 2, 3), **settings)
        camera.rotation_euler, camera.scale, camera.data.clip_start, camera.data.clip_end = (0.3, 0.2, 0.1), (2, 3, 4), 0.5, 70
        scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
        bpy.context.view_layer.update()
        seen = camera_of(camera, bpy.context.evaluated_depsgraph_get(), size, told)
        assert close(seen["frame"], frame), (settings, size, seen["frame"])
        assert seen["type"] == settings.get("type", "PERSP") and close(seen["clip"], (0.5, 70)) and "lens" not in seen
        wanted = Matrix.Translation((1, 2, 3)) @ Euler((0.3, 0.2, 0.1)).to_matrix().to_4x4()
        assert close(np.reshape(seen["matrix"], (4, 4)), wanted)
    assert not told.warnings and "the scene has no camera" in raised(camera_of, None, None, (1, 1), told)
    dof, data = Of(aperture_fstop=2.0, aperture_ratio=0.5, aperture_blades=5000, aperture_rotation=0.7, focus_object=None, focus_distance=3.0), Of(lens=50.0, type="PERSP")
    data.dof, lens = dof, module("export.camera")._lens
    assert lens(Of(name="eye"), data, None, told) == {"lens": (0.025, 0.0125), "focus": 3.0, "blades": 1024, "turn": 0.7}
    data.type = "ORTHO"
    assert lens(Of(name="eye"), data, None, told)["lens"] == (0.5, 0.25)
    dof.focus_distance = 0.0
    assert lens(Of(name="eye"), data, None, told) == {} and list(told.warnings) == ["camera 'eye': its focus is on the camera itself; all is sharp"]


def test_units_of_lights():
    """By what light is: a point of P watts has P / 4 pi a steradian; a face of P watts that shines by the cosine P / pi (until 3.4 P / 4); a sun's
    disc of radiance L sends pi L sin^2. What is not normalized is a power a square metre."""
    light, here, strength = module("export.light"), Matrix.Translation((1, 2, 3)), (4 * math.pi, 0.0, 8 * math.pi)

    def made(kind, matrix=here, **settings):
        given = {"angle": 0.2, "shadow_soft_size": 0.5, "spot_size": 0.8, "spot_blend": 0.3, "size": 2.0, "size_y": 0.5, "shape": "SQUARE", "spread": 1.5}
        return light._LIGHTS[kind](Of(**{**given, **settings}), matrix, strength)
    bulb = made("POINT")
    assert close(bulb["intensity"], (1, 0, 2)) and bulb["radius"] == 0.5 and bulb["position"] == (1, 2, 3) and not bulb["ball"]
    assert close(made("POINT", normalize=False)["intensity"], np.multiply(strength, 0.25)) and made("POINT", use_soft_falloff=False)["ball"]
    assert close(made("POINT", normalize=False, shadow_soft_size=0)["intensity"], np.divide(strength, math.pi))
    sun = made("SUN", Matrix.Rotation(math.pi / 2, 4, "X"))
    assert sun["irradiance"] == strength and sun["angle"] == 0.2 and close(sun["direction"], (0, -1, 0)) and sun["even"] == (bpy.app.version >= (3, 5))
    assert close(made("SUN", normalize=False)["irradiance"], np.multiply(strength, math.pi * math.sin(0.1) ** 2))
    assert made("SUN", normalize=False, angle=0)["irradiance"] == strength
    spot = made("SPOT", here @ Matrix.Diagonal((2, 3, 6, 1)))
    assert (spot["angle"], spot["blend"], spot["cosine_law"]) == (0.8, 0.3, bpy.app.version < (3, 5)) and close(spot["direction"], (0, 0, -1))
    if bpy.app.version >= (3, 5):
        assert close(spot["across_u"], (3, 0, 0)) and close(spot["across_v"], (0, 2, 0))
    share = 0.25 if bpy.app.version < (3, 5) else 1 / math.pi
    for shape, v, round_, area in (("SQUARE", 1.0, False, 4.0), ("RECTANGLE", 0.25, False, 1.0), ("DISK", 1.0, True, math.pi), ("ELLIPSE", 0.25, True, math.pi / 4)):
        face = made("AREA", shape=shape)
        assert close(face["axis_u"], (1, 0, 0)) and close(face["axis_v"], (0, v, 0)) and face["round"] == round_ and face["spread"] == 1.5, shape
        assert close(face["intensity"], np.multiply(strength, share)) and close(face["direction"], (0, 0, -1)), shape
        assert close(made("AREA", shape=shape, normalize=False)["intensity"], np.multiply(strength, area / math.pi)), shape
    table = Of(shines={}, unknown=None)
    lamp = Of(energy=10.0, exposure=2.0, color=(1, 0.5, 0.25), node_tree=None, use_nodes=False)
    assert light._strength(lamp, here, table, None) == ((40.0, 20.0, 10.0), {})
    lamp.use_temperature, lamp.temperature_color = True, (1.0, 0.5, 0.0)
    assert light._strength(lamp, here, table, None)[0] == (40.0, 10.0, 0.0)
    assert light._unit(Vector((0, 0, 0))) == (0, 0, 1) and light.kinds("and") == "sun and point and spot and area"


def test_where_the_sun_of_a_sky_is():
    sky = module("export.sky")

    def to(elevation, azimuth):
        return np.array((math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)))
    node = {"name": "sky", "sky_type": "NISHITA", "sun_size": 0.02, "sun_disc": True, "altitude": 100.0, "air_density": 1.5, "dust_density": 2.0, "ozone_density": 3.0,
            "sun_intensity": 0.7, "sun_rotation": 0.4, "sun_elevation": 0.3}
    for elevation in (-3.0, -2.0, -0.5, 0.0, 0.7, 1.5, 2.0, 3.0, 5.0, 7.0):
        said, up, around = sky._scattering(Of(**{**node, "sun_elevation": elevation}))
        assert abs(up) <= math.pi / 2 and close(to(up, around), to(elevation, math.pi / 2 - 0.4)), elevation
    assert said == {"model": "SINGLE", "altitude": 100, "air": 1.5, "dust": 2, "ozone": 3, "later": bpy.app.version >= (5, 0), "sun_size": 0.02, "sun_bright": 0.7}
    for change, key, value in (({"sun_disc": False}, "sun_size", 0), ({"sun_size": 0}, "sun_size", 0.0005), ({"aerosol_density": 9}, "dust", 9),
                               ({"sky_type": "MULTIPLE_SCATTERING"}, "model", "MULTIPLE"), ({"sky_type": "SINGLE_SCATTERING"}, "model", "SINGLE")):
        assert sky._scattering(Of(**{**node, **change}))[0][key] == value, change
    assert sky._scattering(Of(**{**node, "sun_elevation": math.nan, "sun_rotation": math.inf}))[1:] == (0, math.pi / 2)
    warned = []
    reader = Of(warn=warned.append)
    said, up, around = sky._fitted(reader, Of(name="sky", sky_type="PREETHAM", sun_direction=(0, 3, 3), turbidity=2.5))
    assert said == {"model": "PREETHAM", "turbidity": 2.5} and close((up, around), (math.pi / 4, math.pi / 2)) and not warned
    sky._fitted(reader, Of(name="sky", sky_type="HOSEK_WILKIE", sun_direction=(0, math.nan, 3), turbidity=2.5))
    assert warned == ["'sky': sky type 'HOSEK_WILKIE' is not supported; that of Preetham is used"]
    turn = Matrix.Rotation(0.5, 4, "Z")
    made = sky.sky_of(reader, Of(**node), -2.0, turn)
    assert made["strength"] == (0, 0, 0) and sky.sky_of(reader, Of(**node), 2.0, turn)["strength"] == (2, 2, 2) and len(warned) == 1
    # the direction that comes to the sun's own in the sky is that of its elevation, above x
    assert close(np.reshape(made["matrix"], (3, 4))[:, :3] @ np.array(turn.to_3x3().inverted()) @ to(0.3, math.pi / 2 - 0.4), to(0.3, 0))
    for bad in (Matrix.Scale(2, 4), Matrix.Translation((1, 0, 0))):
        found = sky.sky_of(reader, Of(**node), 1.0, bad)
        assert close(found["matrix"], sky.sky_of(reader, Of(**node), 1.0, Matrix.Identity(4))["matrix"])
    assert len(warned) == 3 and warned[1] == "'sky': coordinates that are not only turned are not supported; directions are used as they are"


def test_four_numbers():
    four = module("export.attributes").four
    for value, wanted in ((2, (2, 2, 2, 1)), (True, (1, 1, 1, 1)), (0.5, (0.5, 0.5, 0.5, 1)), ([1, 2], (1, 2, 0, 1)), ((1, 2, 3), (1, 2, 3, 1)), ([1, 2, 3, 4], (1, 2, 3, 4)),
                          ([1], (1, 0, 0, 1)), ([], (0, 0, 0, 1)), ("text", None), (b"1", None), ({"a": 1}, None), ([1, 2, 3, 4, 5], None), (["a"], None), (None, None), (object(), None)):
        assert four(value) == wanted, value
    table = module("export.attributes").Attributes(module("export.messages").Messages(), 7.0)
    assert [table.number(kind, name) for kind, name in (("OBJECT", "a"), ("INSTANCER", "a"), ("OBJECT", "b"), ("INSTANCER", "a"), ("OBJECT", "a"))] == [0, 1, 2, 1, 0]
    assert close(table.array([(1, 2, 3, 4), (math.nan, math.inf, -math.inf, 0)]), [1, 2, 3, 4, 0, 3e38, -3e38, 0, 0, 0, 0, 0], rtol=1e-6)
    place = module("export.attributes")._place_on_instancer
    item = Of(is_instance=True, uv=(0.25, 0.75), orco=(1.0, -1.0, 0.5))
    assert place(item, "UV") == (0.25, 0.75, 0, 1) and place(item, "Generated") == (0, -1, -0.25, 1) and place(Of(is_instance=False), "UV") == (0,) * 4
    scene = common.empty_scene()
    scene.world, layer = bpy.data.worlds.new("world"), bpy.context.view_layer
    found = lambda name: module("export.attributes").of_view_layer(bpy.context.evaluated_depsgraph_get(), name)
    for owner, value in ((scene.world, 3.0), (scene, 2.0), (layer, 1.0)):  # each hides what is behind it
        owner["tone"] = value
        scene.update_tag()
        bpy.context.view_layer.update()
        assert found("tone") == (value, value, value, 1), owner
    assert found("none") == (0,) * 4 and found("") == (0,) * 4 and found("render.resolution_x") == (64, 64, 64, 1)


def test_attributes_of_particles():
    attributes = module("export.attributes")
    table = attributes.Attributes(None, 7.5)
    names = ("Index", "Random", "Age", "Lifetime", "Location", "Size", "Velocity", "Angular Velocity")
    grain = Of(birth_time=3.0, lifetime=9.0, location=(1, 2, 3), size=0.5, velocity=(4, 5, 6), angular_velocity=(7, 8, 9))
    def told(item):
        return [table._of_particle(item, name) for name in names]
    shown = Of(is_instance=True, particle_system=Of(settings=Of(type="EMITTER"), particles=[None, grain]), persistent_id=(1,))
    chance = float(module("export.strands").by_chance(1))
    assert told(shown) == [(1, 1, 1, 1), (chance,) * 3 + (1,), (4.5, 4.5, 4.5, 1), (9, 9, 9, 1), (1, 2, 3, 1), (0.5, 0.5, 0.5, 1), (4, 5, 6, 1), (7, 8, 9, 1)]
    shown.particle_system.settings.type = "HAIR"
    assert told(shown)[0] == (0, 0, 0, 1) and told(shown)[2:] == [(0,) * 4] * 6
    assert told(Of(is_instance=False))[0] == (0, 0, 0, 1) and 0 <= chance < 1 and chance != float(module("export.strands").by_chance(0))


def test_how_large_cloth_is():
    size = module("export.size")
    assert [size.unit_of(scene and Of(unit_settings=Of(scale_length=scene))) for scene in (0.01, 0.0001, None, math.inf, math.nan, -1.0)] == [0.01, 0.0001, 1, 1, 1, 1]
    mesh = bpy.data.meshes.new("plate")
    mesh.from_pydata([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (4, 0, 0), (4, 2, 0)], [], [(0, 1, 2, 3), (1, 4, 5), (1, 5, 2)])
    assert size.unit_size(mesh, "") == 1.0
    for name, factor in (("first", 0.5), ("second", -0.125), ("none", 0.0)):  # mirrored, and of no area
        layer = mesh.uv_layers.new(name=name)
        for loop, item in zip(mesh.loops, layer.data):
            x, y, _z = mesh.vertices[loop.vertex_index].co
            item.uv = (factor * x, abs(factor) * y)
    for name, wanted in (("first", 2), ("second", 8), ("none", 1), ("", 2), ("unknown", 2)):
        assert abs(size.unit_size(mesh, name) - wanted) < 1e-5, name
    mesh.uv_layers["second"].active_render = True
    assert abs(size.unit_size(mesh, "") - 8) < 1e-5 and size.unit_size(bpy.data.meshes.new("empty"), "") == 1.0
    assert close(size.metres(np.diag((1.0, -2.0, 4.0, 1.0)).ravel(), 3.0, 0.1), (0.6, 0.2))
    assert size.metres(np.zeros(16), 3.0, 0.1) == (3.0, 1.0)


def test_passes_beside_the_picture():
    aov = module("export.aov")
    assert [aov._as_to_shadows({"hidden": bits})["hidden"] for bits in (0, 2, 16, 18, 1, 3, 20)] == [0, 0, 18, 18, 1, 1, 22]
    floor, ball, hole, stand_in = ({"name": name, "hidden": 0} for name in ("floor", "ball", "hole", "stand-in"))
    scene = {"instances": [floor, ball, hole], "catchers": {"held": [hole], "seen": [stand_in, floor]}, "samples": 40, "aov_reach": 2.5, "sky": 1, "mist": 2, "time_limit": 3.0,
             "background": (1, 2, 3), "lights": [1], "max_bounces": 9, "transparent": False, "dump": "x", "width": 7, "sample_clamp_direct": 1.0, "sample_clamp_indirect": 2.0}
    assert [one["name"] for one in aov._with_catchers(scene)] == ["floor", "ball", "stand-in"]
    dark = {"background": (0, 0, 0), "lights": [], "max_bounces": 0, "transparent": True, "dump": "", "sample_clamp_direct": 0, "sample_clamp_indirect": 0, "materials": ["m"],
            "width": 7, "catchers": scene["catchers"], "aov_reach": 2.5}
    assert aov.view(scene, "COLOR", ["m"]) == {**dark, "samples": 40, "instances": scene["instances"]}
    seen = aov.view(scene, aov.OCCLUSION, ["m"])
    assert seen == {**dark, "samples": 80, "instances": [floor, ball, stand_in], "background": (1, 1, 1), "reach": 2.5}, seen
    assert aov.view({**scene, "samples": 50000, "aov_reach": 0.0}, aov.OCCLUSION, [])["samples"] == 65536
    assert 0 < aov.view({**scene, "aov_reach": 0.0}, aov.OCCLUSION, [])["reach"] < 1e-20
    one = lambda name, kind, valid=True: Of(name=name, type=kind, is_valid=valid)
    layer = Of(use_pass_ambient_occlusion=True, aovs=[one("a", "COLOR"), one("bad", "VALUE", False), one("b", "VALUE")])
    assert aov.wanted_of(layer) == [("AO" if bpy.app.version < (5, 0) else "Ambient Occlusion", "OCCLUSION"), ("a", "COLOR"), ("b", "VALUE")]
    layer.use_pass_ambient_occlusion = False
    assert aov.wanted_of(layer) == [("a", "COLOR"), ("b", "VALUE")] and aov.CHANNELS == {"COLOR": 4, "VALUE": 1, "OCCLUSION": 3}


def test_pictures_of_shadow_catchers():
    """By hand: a catcher that keeps a half, one that others light more, one that is black; behind something that covers a quarter."""
    catcher = module("export.catcher")
    plate, ball, held = {"hidden": 0, "name": "plate"}, {"hidden": 4, "name": "ball"}, {"hidden": 0, "name": "held"}
    scene = {"catchers": {"seen": [plate], "held": [held]}, "instances": [plate, ball], "transparent": False, "planes": 1, "mist": 2, "dump": "d", "width": 5}
    for apart in (False, True):
        made = catcher.views(scene, apart)
        assert list(made) == ["with", "without", *(() if apart else ("behind",)), "others"]
        assert [[one["name"] for one in view["instances"]] for view in made.values()] == [["plate", "ball"], ["plate"], *(() if apart else ([],)), ["ball", "held"]]
        assert [one["hidden"] for one in made["with"]["instances"]] == [0, 5] and made["others"]["transparent"] == (not apart) and made["others"]["dump"] == "d"
        assert all(made[name]["dump"] == "" and made[name]["transparent"] and "planes" not in made[name] and made[name]["width"] == 5 for name in ("with", "without"))
    assert "behind" not in catcher.views({**scene, "transparent": True}, False) and not made["others"]["transparent"]
    assert catcher.views({**scene, "catchers": {"seen": [], "held": []}}, False) is None
    rows = lambda *values: np.array(values, np.float32)
    pictures = {"with": rows((1, 1, 2, 1), (3, 3, 3, 1), (0, 0, 0, 1)), "without": rows((2, 2, 2, 1), (1, 1, 1, 1), (0, 0, 0, 1)),
                "others": rows((0.2, 0.2, 0.2, 0.25), (0, 0, 0, 0), (0.5, 0.5, 0.5, 1))}
    assert close(catcher.shadow(pictures), [(0.5, 0.5, 1), (3, 3, 3), (1, 1, 1)])
    assert close(catcher.seen_shadow(pictures), [(0.625, 0.625, 1), (3, 3, 3), (1, 1, 1)])
    assert close(catcher.composed(pictures), [(0.2, 0.2, 0.2, 0.5), (0, 0, 0, 0), (0.5, 0.5, 0.5, 1)])
    pictures["behind"] = rows((4, 4, 4, 1), (2, 2, 2, 1), (9, 9, 9, 1))
    assert close(catcher.composed(pictures), [(1.7, 1.7, 3.2, 1), (2, 2, 2, 1), (0.5, 0.5, 0.5, 1)])


def test_room_for_a_picture():
    """Four bytes a number: three of each channel, four more of a pixel."""
    memory = module("memory")
    with replaced(memory, _free=lambda: 64 * 1000 * 1000):
        assert memory.ask_for(1000, 1000, 4) is None
        assert raised(memory.ask_for, 1000, 1001, 4) == "out of memory: 1000 × 1001 pixels and their passes take 0 GiB, 0 GiB are free"
        assert raised(memory.ask_for, 1000, 1000, 5)
        assert "65536 × 65536 pixels and their passes take 256 GiB, 0 GiB are free" in raised(memory.ask_for, 65536, 65536, 4)
    with replaced(memory, _free=lambda: None):
        assert raised(memory.ask_for, 1 << 24, 1 << 24, 4) == f"out of memory: {1 << 24} × {1 << 24} pixels and their passes take 16,777,216 GiB"
    with open("/proc/meminfo", encoding="ascii") as file:
        total = 1024 * sum(int(line.split()[1]) for line in file if line.startswith(("MemTotal", "SwapTotal")))
    assert total / 100 < memory._free() <= total


def test_which_denoiser():
    denoise = module("export.denoise")
    with replaced(denoise, _path=lambda: "/lib/oidn"):
        assert denoise.denoiser(Of(use_denoising=True)) == {"use_denoising": True, "denoiser": "/lib/oidn"} and denoise.denoiser(Of(use_denoising=False)) == {}
        assert denoise.preview_denoiser(Of(use_preview_denoising=True)) == {"use_denoising": True, "denoiser": "?/lib/oidn"}
        assert denoise.preview_denoiser(Of(use_preview_denoising=False)) == {}


def test_the_main_thread_answers():
    on_main, timers = module("export.main_thread"), []
    assert on_main.on_main_thread(lambda: 5) == 5

    def asked(function, seconds=20.0):
        answer = []

        def run():
            try:
                answer.append(on_main.on_main_thread(function))
            except Exception as error:  # whatever it is
                answer.append(error)
        thread = threading.Thread(target=run)
        with replaced(on_main, _SECONDS=seconds, bpy=Of(app=Of(timers=Of(register=timers.append)))):
            thread.start()
            while seconds > 1 and not timers:
                pass
            if seconds > 1:
                assert timers.pop()() is None
            thread.join()
        return answer[0]
    assert asked(lambda: 7) == 7 and isinstance(asked(lambda: 1 / 0), ZeroDivisionError)
    late = []
    assert isinstance(asked(lambda: late.append(1), 0.01), TimeoutError)
    timers.pop()()  # nobody waits any more
    assert not late


def test_libraries_of_assets():
    assets, here = module("assets"), os.path.dirname(os.path.abspath(__file__))
    ours, moved, other, theirs = (Of(name=name, path=path) for name, path in (
        ("any", assets.FOLDER + "/"), (assets.NAME, "/no/such/folder"), ("other", "/no/such/folder"), (assets.NAME, here)))
    for libraries, wanted in (([other, ours], ours), ([other, moved], moved), ([theirs, other], None), ([], None), ([moved, ours], moved)):
        with replaced(assets, _libraries=lambda libraries=libraries: libraries):
            assert assets.registered() is wanted
    for library in (moved, theirs, other):
        before = library.path
        with replaced(assets, _libraries=lambda library=library: [library], FOLDER=here + "/../inside"):
            assets._repair()
            assert library.path == (here + "/../inside" if library is moved else before)
    with replaced(assets, _libraries=lambda: [moved], FOLDER="/none"):
        moved.path = "/no/such/folder"
        assets._repair()
        assert moved.path == "/no/such/folder"
        said = []
        assert assets.LIBSHADE_OT_add_assets.execute(Of(report=lambda kind, text: said.append((*kind, text))), None) == {"CANCELLED"}
        assert said == [("ERROR", "/none is not there: install the add-on from its zip")]

    class Library:
        def __init__(self, *known):
            self.known, self.method = known, "PACK"

        @property
        def import_method(self):
            return self.method

        @import_method.setter
        def import_method(self, word):
            if word not in self.known:
                raise TypeError
            self.method = word
    for known, wanted in ((("APPEND_REUSE", "APPEND"), "APPEND_REUSE"), (("APPEND",), "APPEND"), ((), "PACK")):
        library = Library(*known)
        assets._import_by_appending(library)
        assert library.method == wanted
    assets._import_by_appending(Of())
    common.empty_scene()
    assert not assets.tells_timings()
    os.environ["LIBSHADE_TIMINGS"] = "1"
    try:
        assert assets.tells_timings()
    finally:
        del os.environ["LIBSHADE_TIMINGS"]
    bpy.context.preferences.addons[common.MODULE].preferences.timings = True
    assert assets.tells_timings()
    bpy.context.preferences.addons[common.MODULE].preferences.timings = False


def test_shaders_of_the_menu():
    menus, drawn = module("menus"), []
    names, labels = zip(*menus.shaders())
    assert names[:3] == ("ShaderNodeOutputMaterial", "ShaderNodeMixShader", "ShaderNodeAddShader") and list(labels[3:]) == sorted(labels[3:])
    assert {"ShaderNodeBsdfPrincipled", "ShaderNodeBsdfDiffuse", "ShaderNodeEmission", "ShaderNodeBsdfGlass"} <= set(names) and "ShaderNodeBackground" not in names
    for engine, tree, of, there in (("LIBSHADE", "ShaderNodeTree", "OBJECT", 1), ("CYCLES", "ShaderNodeTree", "OBJECT", 0), ("LIBSHADE", "GeometryNodeTree", "OBJECT", 0),
                                    ("LIBSHADE", "ShaderNodeTree", "WORLD", 0)):
        drawn.clear()
        menus._draw_add_menu(Of(layout=Of(menu=drawn.append)), Of(engine=engine, space_data=Of(tree_type=tree, shader_type=of)))
        assert len(drawn) == there, (engine, tree, of)


def test_dim_worlds():
    studio = module("studio")
    shine = lambda color, strength, linked=False: Of(bl_idname="ShaderNodeBackground", inputs=type("Inputs", (dict,), {"__iter__": lambda self: iter(self.values())})(
        Color=Of(default_value=(*color, 1.0), is_linked=linked), Strength=Of(default_value=strength, is_linked=False)))
    world = lambda *nodes: Of(use_nodes=True, node_tree=Of(nodes=list(nodes)), color=(9, 9, 9))
    for of, dim in ((None, True), (Of(use_nodes=True, node_tree=None, color=(0.1, 0.19, 0)), True), (Of(use_nodes=True, node_tree=None, color=(0.1, 0.21, 0)), False),
                    (world(), True), (world(shine((0.1, 0.05, 0), 1.9)), True), (world(shine((0, 0.1, 0), 2.1)), False), (world(shine((0.1, 0, 0), 1), shine((0, 0, 1), 1)), False),
                    (world(shine((0, 0, 0), 1, True)), False), (world(Of(bl_idname="other")), True)):
        assert studio._is_dim(of) == dim
    lamps = lambda count: Of(objects=[Of(type="LIGHT")] * count + [Of(type="MESH")], world=None)
    assert [studio.is_bare(lamps(count)) for count in (0, 1, 2)] == [True, True, False]
    with replaced(studio, _path=lambda: ""):
        said = []
        assert studio.LIBSHADE_OT_add_studio_light.execute(Of(report=lambda kind, text: said.append((*kind, text))), None) == {"CANCELLED"}
        assert said == [("ERROR", "This Blender has no studio.exr among its studio lights")]


def test_what_is_copied_from_cycles_is_named():
    scene, cycles, said = common.empty_scene(), module("cycles_settings"), []
    operator = Of(report=lambda kind, text: said.append((*kind, text)))
    for settings, theirs in ((scene.libshade, scene.cycles), (scene.view_layers[0].libshade, scene.view_layers[0].cycles)):
        for name in cycles.shared(settings, theirs):
            setattr(theirs, name, getattr(settings, name))
    scene.cycles.samples, scene.cycles.seed = 123, 45
    assert cycles.LIBSHADE_OT_copy_cycles_settings.execute(operator, Of(scene=scene)) == {"FINISHED"}
    assert cycles.LIBSHADE_OT_copy_cycles_settings.execute(operator, Of(scene=scene)) == {"FINISHED"}
    labels = [scene.libshade.bl_rna.properties[name].name for name in ("samples", "seed")]
    assert said[0][1].removeprefix("As in Cycles now: ").split(", ") == labels and said[1] == ("INFO", "All was as in Cycles already"), said
    poll = cycles.LIBSHADE_OT_copy_cycles_settings.poll
    assert poll(Of(scene=scene)) and not poll(Of(scene=None))


def test_what_the_module_is_told_of_cloth():
    """Of a preset as it is, its name; of an own one what differs, within what the library takes."""
    common.empty_scene()
    yarns = module("fabric.yarns")
    with bare_cloth() as (_tree, node):
        assert node.size_mode == "REAL"
        node.preset, node.size_mode = "LINEN", "LENGTH"
        said, trouble = yarns.settings(node, 1.0)
        assert said == {"preset": "linen", "size": node.size} and trouble == ""
        node.size = 2.0
        assert [yarns.settings(node, unit)[0]["size"] for unit in (0.5, 1e-9, 1e9)] == [1.0, 1e-6, 1e6]
        for mode, wanted in (("REAL", {"size": 1.0}), ("REPEATS", {"repeats": (50.0, 50.0)})):
            node.size_mode = mode
            assert yarns.settings(node, 0.5)[0] == {"preset": "linen", **wanted}
        for word, tier in (("NEAR", "near"), ("FAR", "far"), ("AUTO", None)):
            node.distance = word
            assert yarns.settings(node, 1.0)[0].get("tier") == tier
        node.warp_width, node.picks_per_cm = 0.5 * node.warp_width, 33.0
        said = yarns.settings(node, 1.0)[0]
        assert node.preset == "CUSTOM" and said["preset"] == "linen" and said["warp_yarn"] == {"width": node.warp_width} and said["weft_yarn"] == {}
        assert abs(said["counts"][1] - 33) < 1e-4 and abs(said["counts"][0] - node.ends_per_cm) < 1e-6 and said["weave"] == "plain"
        node.weave = "DRAFT"
        assert yarns.settings(node, 1.0)[1] == "no draft is chosen (a Text, or Import WIF, in the sidebar); woven as its preset"
        node.draft = bpy.data.texts.new("notes")
        node.draft.write("no draft at all")
        said, trouble = yarns.settings(node, 1.0)
        assert trouble.endswith("; woven as its preset") and "draft" not in said and "weave" not in said


def test_lobes_that_are_drawn_out():
    """Alphas along the tangent and across it: alpha / a and alpha a, a^2 = 1 - .9 anisotropic; of the Glossy BSDF alpha (1 - a) and alpha / (1 - a),
    below 0 the other way round; of the Metal node the way there and back."""
    groove, metal, program = module("export.closure_groove"), module("metal_tree"), module("export.graph").Program
    reader = Of(program=program())
    for a, wanted in ((0.5, (0.1, 0.4)), (-0.5, (0.4, 0.1)), (0.0, (0.2, 0.2)), (-0.9, (1.0, 0.02))):
        with replaced(groove, number_of=lambda *_which, a=a: a):
            assert close(groove.pulled(reader, Of(inputs={"Anisotropy": 1}), (), 0.2), wanted), a
    assert groove.pulled(reader, Of(inputs={}), (), 0.2) == (0.2, 0.2)
    with replaced(groove, number_of=lambda *_which: 0.8, _groove=lambda *_which: "turned"):
        alphas, to = groove.drawn_out(reader, Of(inputs={"Anisotropic": 1}), (), 0.2, "Anisotropic", "Rotation")
        assert close(alphas, (0.2 / math.sqrt(0.28), 0.2 * math.sqrt(0.28))) and to == "turned"
    with replaced(groove, number_of=lambda *_which: 0.0):
        assert groove.drawn_out(reader, Of(inputs={"Anisotropic": 1}), (), 0.2, "Anisotropic", "Rotation") == ((0.2, 0.2), None)
    asked = Of(program=program(), by_mesh=False)
    for turns, wanted in ((0.25, (-3, 2)), (0.5, (-2, -3)), (1.0, (2, 3)), (0.0, (2, 3))):
        with replaced(groove, number_of=lambda *_which, turns=turns: turns):
            assert close(groove.rotated(asked, (2.0, 3.0), None, ()), wanted), turns
            assert not asked.by_mesh
    with replaced(groove, number_of=lambda *_which: 0.25):
        assert close(groove.rotated(asked, None, None, ()), (0, 1)) and asked.by_mesh
    assert close(metal.shape_of(0.1, 0.4), (0.04 ** 0.25, 0.5)) and close(metal.shape_of(0.4, 0.1), (0.04 ** 0.25, -0.5))
    for alphas in ((0.1, 0.4), (0.4, 0.1), (0.3, 0.3), (0.01, 0.2)):
        assert close(metal.alphas_of(*metal.shape_of(*alphas)), alphas), alphas
    assert [metal.axis_vector(axis).index(max(metal.axis_vector(axis))) for axis in "XYZ"] == [0, 1, 2]
    assert abs(metal.reflectance(1.5, 0.0, 1.0) - 0.04) < 1e-9 and abs(metal.reflectance(0.2, 3.9, 1.0) - (0.64 + 3.9**2) / (1.44 + 3.9**2)) < 1e-9
    assert abs(metal.reflectance(1.5, 0.0, 0.0) - 1) < 1e-9


def test_what_a_material_gets_of_a_closure():
    """By how it is read: as Cycles' own are or as ours; what weighs nothing is left out."""
    added = module("export.closure_add")

    def read(closure, weight=1.0, normal=None, color=None, **how):
        reader = Of(**{"transport": False, "mutual": False, "shape": False, "bumped": None, "dumps": True, "coarse": {}, "filtered": {}, "colors": False, "closures": [], "below": {}, **how})
        added.add(reader, dict(closure), weight, normal, color)
        return reader.closures[0] if reader.closures else None
    grey = {"closure": "METAL", "stock": True, "f0": (0.5,) * 3, "kd": (0.0,) * 3, "fresnel": "SCHLICK", "ax": 0.1, "ay": 0.1, "mdf": "ggx"}
    dark, drawn = {**grey, "f0": added.BLACK}, {**grey, "ay": 0.3}
    assert read(grey) == {**{key: value for key, value in grey.items() if key != "stock"}, "detail": "gram_schmidt"}
    for closure, how, horizon in ((grey, {"bumped": [1, 2]}, "valid_reflection"), (dark, {"bumped": [1, 2]}, "hard"), (grey, {"bumped": [1, 2], "mutual": True}, "mutual"),
                                  (dark, {"bumped": [1, 2], "mutual": True}, "hard"), (grey, {}, None), (grey, {"mutual": True}, "mutual"),
                                  (grey, {"bumped": [1, 2], "dumps": False}, None), ({**grey, "stock": False}, {"bumped": [1, 2]}, None)):
        assert read(closure, **how).get("horizon") == horizon, (closure["f0"], how)
    for closure, transport, detail in ((drawn, True, None), (drawn, False, "gram_schmidt"), (grey, True, "gram_schmidt"), ({**grey, "ax_from": [3]}, True, None)):
        assert read(closure, transport=transport).get("detail") == detail
    ours = {**grey, "stock": False, "horizon": "MUTUAL"}
    for closure, mutual, drawn, moment in ((grey, True, True, (7, 8, 9)), (grey, True, False, None), (grey, False, True, None), (ours, False, True, (7, 8, 9))):
        program = Of(emit={"RELIEF": [7, 8, 9]}.get, reads=lambda parts, kinds, said=drawn: said)
        assert read(closure, normal=[5], program=program, mutual=mutual).get("moment_from") == moment, (closure, mutual, drawn)
    program = Of(emit=lambda kind, count, shape: [7, 8, 9, 10, 11][:count] if shape else None, reads=lambda *_which: True)
    for closure, how in (({**ours, "shape": True}, {}), (grey, {"mutual": True, "shape": True})):
        made = read(closure, normal=[5], program=program, **how)
        assert (made["moment_from"], made["mean_from"], "shape" in made) == ((7, 8, 9), (10, 11), False)
    made = read(grey, normal=[5], program=program, shape=True)
    assert not {"moment_from", "mean_from", "shape"} & set(made)
    shine, clear = {"closure": "EMISSION"}, {"closure": "TRANSPARENT"}
    for closure, weight, wanted in ((clear, 0.0, False), (clear, (0, 0, 0.1), True), (clear, -1.0, False), (shine, (0, -1, 0), True), (shine, 0.0, False)):
        assert bool(read(closure, weight)) == wanted, (closure, weight)
    assert "weight" not in read(clear) and read(clear, 0.5)["weight"] == (0.5,) * 3 and read(clear, normal=[5, 6, 7])["normal"] == [5, 6, 7]
    assert "pass_color" not in read(clear, color=(1, 2, 3)) and read(clear, color=[1, 2, 3], colors=True)["pass_color"] == (1, 2, 3)
    for mdf, horizon, wide in (("ggx", "hard", False), ("beckmann", "hard", True), ("ward", "hard", True), ("ward_half", "hard", True), ("ASHIKHMIN_SHIRLEY", "hard", True),
                               ("ward", "MUTUAL", False), ("ASHIKHMIN_SHIRLEY", "MUTUAL", False)):
        made = read({**ours, "mdf": mdf, "horizon": horizon}, normal=[5], filtered={5: ([8], [0.1, 0.2])}, program=Of(reads=lambda *_which: False))
        assert (made["normal"], made.get("spread_from")) == (([8], [0.1, 0.2]) if wide else ([5], None)), (mdf, horizon)
    warned = []
    for alpha, strength, said in ((0.01, 1.0, True), (0.03, 1.0, False), (0.03, 2.0, True), (0.01, 0.4, False)):
        warned.clear()
        read({**grey, "ax": alpha, "ay": 0.5}, normal=[5], coarse={5: ("map", strength)}, warn=warned.append)
        assert bool(warned) == said and all("normal map 'map' has 8 bits" in text for text in warned), (alpha, strength)


def test_numbers_of_lobes():
    """By what they are: an index and extinction reflect head-on what they are found for; 1.5 reflects .04."""
    lobe, film, reader = module("export.closure_lobe"), module("export.closure_film"), Of(program=module("export.graph").Program())
    assert close(lobe.head_on_of(reader, 1.5), 0.04) and close(lobe.eta_of(reader, 0.04), 1.5) and close(lobe.mean_of(reader, 0.3), 0.3 + 0.7 / 21)
    assert close(lobe.eta_of(reader, 1.0), lobe.eta_of(reader, 0.99)) and close(lobe.eta_of(reader, -1.0), 1)
    base = (0.2, 0.5, 0.95)
    for edge in ((1.0, 0.5, 0.0), (0.3, 0.9, 1.0)):
        eta, k = film._index_of(reader, base, edge)
        for n, extinction, wanted in zip(eta, k, base):
            assert n > 0 and extinction >= 0 and close(((n - 1) ** 2 + extinction**2) / ((n + 1) ** 2 + extinction**2), wanted, 1e-4), (wanted, n, extinction)
    metal, c = module("export.closure_metal"), (np.arange(20000) + 0.5) / 20000
    conductor = metal._conductor  # within a hundredth of Fresnel's, of amplitudes across and in the plane of incidence
    for index in (0.2 - 3.9j, 1.5 - 7.5j, 3 - 3j):
        for cosine in (1.0, 0.5, 1 / 7):
            inside = (1 - (1 - cosine**2) / index**2) ** 0.5
            wanted = sum(abs((a - b) / (a + b)) ** 2 for a, b in ((cosine, index * inside), (index * cosine, inside))) / 2
            assert abs(conductor(reader, index.real, -index.imag, cosine) - wanted) < (0.01 if cosine < 1 else 1e-9), (index, cosine)
    for head_on, lost in ((0.5, 0.0), (0.8, 0.3)):  # Schlick's at 82 degrees, and the mean of even light with so much less there
        seen = head_on + (1 - head_on) * (1 - c) ** 5 - lost * c * (1 - c) ** 6 * 7 * (7 / 6) ** 6
        assert close(metal._schlick_82(reader, head_on), head_on + (1 - head_on) * (6 / 7) ** 5) and close(metal._means(reader, (head_on,), (lost,)), (2 * c * seen).mean(), 1e-4)
    # two bounces of colour c between facets of which one is left: c + c c (1 - one) ... in the mean
    one, mean = 0.8, 0.7
    assert close(lobe.kept(reader, (0.5, 1.0), one, mean), [1 + part * mean / (1 - part * (1 - mean)) * (1 - one) / one for part in (0.5, 1.0)])
    assert close(lobe.kept(reader, (1.0,), one, mean)[0] * one, 1.0)  # a white one keeps it all
    made = lobe._alphas(0.25, 1e-9)
    assert made["ax"] == 0.25 and made["ay"] == 1e-4 and close(made["ex"], 2 / 0.25**2 - 2) and "ax_from" not in made
    assert [lobe.is_smooth(alpha) for alpha in (1e-4, 1e-3, 0.2)] == [True, False, False]


def test_images_of_scratches_are_packed_as_they_are():
    """Whichever way is the shorter: each texel by itself, or by what it differs from the one before."""
    images, (y, x) = module("scratches.images"), np.mgrid[:5, :40]
    even, chance = np.stack([5 * x, 250 - 5 * x + y, 3 * x], -1), np.random.default_rng(1).integers(0, 256, (5, 40, 3))
    for levels in (even, chance, np.where(chance > 250, 255, 128)):
        image = images._image_of_bytes("levels", levels)
        assert tuple(image.size) == (40, 5) and image.packed_file and image.colorspace_settings.is_data
        assert np.array_equal(np.rint(255 * np.reshape(image.pixels[:], (5, 40, 4))[..., :3]), levels)
        bpy.data.images.remove(image)


def test_light_becomes_bytes_and_back():
    image = module("export.image")
    for light, byte in ((0.0, 0.0), (0.002, 0.02584), (0.2140411, 0.5), (1.0, 1.0), (3.0, 1.0), (-1.0, 0.0)):
        for count, by_alpha, alpha in ((1, False, None), (3, True, None), (4, False, 0.5), (4, True, 0.5), (2, True, 0.25), (4, True, 0.0)):
            shown = light * (alpha if by_alpha and alpha else 1.0)
            data = np.array([shown] * (count - (count in (2, 4))) + [alpha] * (count in (2, 4)), np.float32)
            image._encode(data, count, by_alpha)
            assert np.allclose(data[:max(1, count - (count in (2, 4)))], byte, atol=1e-4), (light, count, by_alpha, data)
            assert count not in (2, 4) or data[-1] == np.float32(alpha)
    texels = np.linspace(0, 1, 33).astype(np.float32)
    light = image._decoded(texels).astype(np.float32)
    image._encode(light, 1, False)
    assert np.allclose(light, texels, atol=1e-6) and image._bytes(np.array([0, 0.5, 1], np.float32))[0].tolist() == [0, 128, 255]
    assert image._place(1001) == (0, 0) and image._place(1010) == (9, 0) and image._place(1011) == (0, 1) and image._place(1023) == (2, 2)
    tiles = lambda *numbers: Of(source="TILED", tiles=[Of(number=number) for number in numbers])
    assert image.tiles_of(tiles(1001, 1002, 1021)) == (2, 3) and image.tiles_of(Of(source="FILE")) == (1, 1)
    names = []
    tiled = Of(tiles=[Of(number=1001), Of(number=1012)], filepath=os.path.join(os.sep, "a.<UDIM>", "b_<UVTILE>.png"), library=None)
    image.Images._tiled(Of(_loaded=lambda _image, path, _owner, _packed: names.append(os.path.relpath(path, os.sep).replace(os.sep, "/"))), tiled, "m", False)
    assert names == ["a.1001/b_u1_v1.png", "a.1012/b_u2_v2.png"], names


def test_attributes_of_one_name_are_told_apart():
    """Those of the object and of its instancer; the same one again is the same."""
    reader, listed = module("export.material").Reader, []
    fake = Of(known={}, asks_objects=lambda: None, program=Of(emit=lambda *_words, attribute: attribute),
              _table=Of(attributes=Of(number=lambda kind, name: listed.append((kind, name)) or len(listed)), of_view_layer=lambda name: name))
    asked = [reader.attribute(fake, kind, name) for kind, name in (("OBJECT", "a"), ("INSTANCER", "a"), ("OBJECT", "b"), ("OBJECT", "a"), ("VIEW_LAYER", "a"))]
    assert asked == [1, 2, 3, 1, "a"] and listed == [("OBJECT", "a"), ("INSTANCER", "a"), ("OBJECT", "b")], asked


def test_what_keyframes_set_is_followed_once():
    """Each of two nodes where what it says is another, and not again where it is the same."""
    scene, nodes, followed = common.empty_scene(), module("nodes"), []
    tree = common.tree_of(bpy.data.materials.new("animated"))
    ours = [tree.nodes.new("LibshadeMetalNode") for _ in range(2)]
    common.plane(bpy.data.materials["animated"], 1)
    said = {1: "a", 2: "b", 3: "b"}
    ours[0].id_data.animation_data_create()
    with replaced(nodes, FOLLOWED={"LibshadeMetalNode": lambda node: (node.name, said[scene.frame_current])}), \
            replaced(nodes.LibshadeMetalNode, follow=lambda node, _animated: followed.append(node.name)):
        for frame, count in ((1, 2), (1, 0), (2, 2), (3, 0), (1, 2)):
            followed.clear()
            scene.frame_set(frame)
            nodes._follow_animation(scene, bpy.context.evaluated_depsgraph_get())  # the frame's own handler may have been there before
            assert sorted(followed) == (sorted(node.name for node in ours) if count else []), (frame, followed)
        nodes._forget_followed()
        followed.clear()
        nodes._follow_animation(scene, bpy.context.evaluated_depsgraph_get())
        assert len(followed) == 2
        nodes._follow_animation(scene)
        assert len(followed) == 2


def test_what_is_inside_our_nodes_is_hidden():
    """Of menus, by a name that begins with a point; and what was said of a node is red on it."""
    common.empty_scene()
    tree = common.tree_of(bpy.data.materials.new("all"))
    for kind in ("LibshadeMetalNode", "LibshadeFabricNode", "LibshadeScratchesNode"):
        assert tree.nodes.new(kind).node_tree.name.startswith("."), kind
    report, drawn = module("report"), []

    class Layout:
        alert = False

        def column(self, **_more):
            drawn.append(Layout())
            drawn[-1].lines = []
            return drawn[-1]

        def label(self, text, icon="NONE"):
            self.lines.append((text, icon))

        def context_pointer_set(self, *_which):
            pass
    with replaced(report, of_node=lambda _node: ["one", "word " * 20]):
        assert report.draw_on(Of(width=140), Layout())
    assert [column.alert for column in drawn] == [True, True] and drawn[0].lines == [("one", "ERROR")]
    assert [icon for _text, icon in drawn[1].lines] == ["ERROR"] + ["NONE"] * (len(drawn[1].lines) - 1) and len(drawn[1].lines) == 5


def test_where_a_groove_finds_room():
    """Left of its shader and a little below, or farther down until nothing of its frame is within 170 of it; what stands beside that column is not in its way."""
    node = Of(parent=None, location=(0.0, 0.0), width=150)
    for others, wanted in (((), -250), (((-150, -300, 140, None),), -490), (((-150, -300, 140, None), (-300, -600, 140, None)), -790), (((-150, -90, 140, None),), -280),
                           (((-150, -300, 140, "frame"),), -250), (((0, -300, 140, None),), -250), (((-400, -300, 140, None),), -250), (((-400, -300, 240, None),), -490)):
        tree = Of(nodes=[node, *(Of(location=(x, y), width=width, parent=parent) for x, y, width, parent in others)])
        assert module("groove")._free_place(tree, node) == (-200, wanted), (others, module("groove")._free_place(tree, node))


def test_what_the_report_shows():
    """A box for each thing that was said: whose it is, a button that selects that, and the rest in lines as wide as the region; red where it is an error."""
    common.empty_scene()
    report, drawn = module("report"), []
    steel, lamp, world = bpy.data.materials.new("steel"), bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "POINT")), bpy.data.worlds.new("world")
    common.tree_of(steel).nodes.new("ShaderNodeBump").name = "Bump"
    for text, wanted in (("material 'steel': 'Bump': left out", (steel, "Bump", "MATERIAL", "'Bump': left out")), ("light 'lamp': odd", (lamp, "", "LIGHT", "odd")),
                         ("object 'lamp': odd", (lamp, "", "OBJECT_DATA", "odd")), ("camera 'lamp': odd", (lamp, "", "CAMERA_DATA", "odd")),
                         ("world 'world': odd", (world, "", "WORLD", "odd")), ("view layer 'lamp': odd", (None, "", "RENDERLAYERS", "view layer 'lamp': odd")),
                         ("material 'gone': odd", (None, "", "MATERIAL", "material 'gone': odd")), ("the scene is odd", (None, "", "ERROR", "the scene is odd"))):
        assert report.cause(text) == wanted, (text, report.cause(text))

    class Layout:
        alert = False

        def label(self, text, icon="NONE"):
            drawn.append((text, icon, self.alert))

        def operator(self, name, text=None, icon="NONE"):
            drawn.append((name, icon, text))
            return Of()

        def box(self, **_more):
            return Layout()
        row = column = box
    scene = bpy.context.scene
    texts = [("material 'steel': " + "word " * 20, True), ("the scene is odd", False)]
    panel = report.RENDER_PT_libshade_differences
    assert not panel.poll(Of(engine="LIBSHADE", scene=scene))
    report._keep(scene, texts)
    try:
        assert panel.poll(Of(engine="LIBSHADE", scene=scene)) and not panel.poll(Of(engine="CYCLES", scene=scene))
        panel.draw_header(Of(layout=Layout()), Of(scene=scene))
        for width, scale, lines in ((10, 1.0, 5), (650, 1.0, 2), (650, 2.0, 3)):
            del drawn[1:]
            panel.draw(Of(layout=Layout()), Of(scene=scene, region=Of(width=width), preferences=Of(system=Of(ui_scale=scale))))
            assert drawn[:3] == [("2", "NONE", False), ("steel", "MATERIAL", True), ("libshade.select_cause", "RESTRICT_SELECT_OFF", "")]
            assert len(drawn) == 3 + lines + 3 and all(icon == "NONE" and red for _line, icon, red in drawn[3:3 + lines]), (width, scale, drawn)
            assert drawn[-3:] == [("Scene", "ERROR", False), ("the scene is odd", "NONE", False), ("libshade.copy_report", "COPYDOWN", None)]
        assert report.of_node(steel.node_tree.nodes["Bump"]) == [texts[0][0].removeprefix("material 'steel': ")]
        report.keep_slopes(scene, [(0, 0, 0, 0.04, 0, 0.0009), (1, 0, 0, 0, 0, 0.01), (0, 0, 0, 0, 0, 0)], [{"name": "steel"}, {}])
        assert report.slopes(scene) == "steel: slopes 0.2, 0.03\nA material: slopes 0, 0.1"
        report.keep_failure(scene, "broken", "where it was")
        assert report.told(scene) == [("broken", True), *texts]
        first, *rest = report.whole(scene).splitlines()
        assert first.startswith("libshade ") and f", Blender {bpy.app.version_string}, " in first
        assert rest == ["Error: broken", f"Error: {texts[0][0]}", "Warning: the scene is odd", "Note: steel: slopes 0.2, 0.03", "Note: A material: slopes 0, 0.1", "where it was"]
    finally:
        report._forget()
    assert not report.told(scene) and report.slopes(scene) == "" and len(report.whole(scene).splitlines()) == 1
    assert [report.in_digits(number) for number in (0, 0.5, 12.345, 999.4, 1234567, 1.25e-5, 1e-9)] == ["0", "0.5", "12.3", "999", "1,234,567", "0.000013", "0"]
    said = [report.failure(error)[0] for error in (MemoryError(), MemoryError("a  map"), ValueError("odd\nthing"))]
    assert said[:2] == ["out of memory", "out of memory: a map"] and said[2] == "internal error: ValueError: odd thing (Copy Report is in the Render properties)"


# Of each node of ours what its properties are called and are at first, and of numbers their range, how far sliders go and what they count; None: not of this kind
PROPERTIES = {
    "LibshadeMetalNode": {
        "distribution": ("Distribution", "ASHIKHMIN_SHIRLEY"), "brdf": ("BRDF", "ASHIKHMIN_SHIRLEY"), "detail": ("Detail Method", "ROTATE"), "groove": ("Stroke Axis", "AUTO"),
        "fresnel": ("Fresnel", "SCHLICK"), "diffuse": ("Diffuse Model", "LAMBERT"), "horizon": ("Horizon", "VALID_ESTEVEZ"), "multiscatter": ("Multiscatter", "OFF"),
        "ex": ("Exponent Along U", 200, 0, 1e6, 1e6), "ey": ("Exponent Across U", 10, 0, 1e6, 1e6), "ax": ("Alpha Along U", 202**-0.5 * 2**0.5, 1e-4, 10, 10),
        "ay": ("Alpha Across U", 6**-0.5, 1e-4, 10, 10), "f82": ("Edge Tint", (1, 1, 1), 0, 1, 1, "COLOR"), "eta": ("Index of Refraction", (0.5, 0.5, 0.5), 1e-3, 100, 100),
        "k": ("Extinction", (3, 3, 3), 0, 100, 100), "kd": ("Diffuse Color", (0, 0, 0), 0, 1, 1, "COLOR"), "grain": ("Grain", "UV"), "uv_map": ("UV Map", ""),
        "bump_response": ("Bump Response", "FOLLOW"), "bumps_are": ("Bumps Are", "RELIEF"), "strokes": ("Strokes", 0, 0, 1, 1, "FACTOR"), "stroke_width": ("Width mm", 60, 0.01, 1e5, 1000),
        "width_as": ("Width as", "ROUGHNESS"), "shown_ax": ("Alpha Along U", 0, -4, 1, 1, "FACTOR"), "shown_ay": ("Alpha Across U", 0, -4, 1, 1, "FACTOR"),
        "shown_ex": ("Exponent Along U", 0, -2, 6, 6, "FACTOR"), "shown_ey": ("Exponent Across U", 0, -2, 6, 6, "FACTOR")},
    "LibshadeFabricNode": {
        "preset": ("Cloth", "SILK_CHARMEUSE"), "weave": ("Weave", "PLAIN"), "draft": ("Draft", None), "draft_colors": ("Draft Colors", True), "ends_per_cm": ("Ends per cm", 20, 0.1, 1000, 200),
        "picks_per_cm": ("Picks per cm", 20, 0.1, 1000, 200), "size_mode": ("Size", "LENGTH"), "size": ("Length per Unit", 0.2, 1e-4, 1e4, 10, "DISTANCE"),
        "repeats": ("Repeats", (50, 50), -1e6, 1e6, 1e6), "distance": ("Distance", "AUTO"), "transmission": ("Translucency", 0, 0, 1, 1, "FACTOR"), "open_gaps": ("Open Gaps", False),
        **{f"{yarn}_{word}": said for yarn in ("warp", "weft") for word, said in {
            "width": ("Width", 1, 1e-6, 1e6, 1, "FACTOR"), "gap": ("Gap", 0, 0, 1e6, 1, "FACTOR"), "twist": ("Twist", 0, -math.pi / 2, math.pi / 2, math.pi / 2, "ANGLE"),
            "segments": ("Strands", 1, 0, 1000, 8), "crimp": ("Crimp", 0, 0, 0.98, 0.98, "FACTOR"), "slub": ("Slub", 0, 0, 1, 1, "FACTOR"),
            "vary_brightness": ("Varied Brightness", 0, 0, 1, 1, "FACTOR"), "vary_tilt": ("Varied Tilt", 0, 0, 1, 1, "FACTOR"), "curve": ("Roundness", 0.5, 0, 0.98, 0.98, "FACTOR"),
            "ridge": ("Strand Relief", 0.2, 0, 0.98, 0.98, "FACTOR"), "crimp_length": ("Crimp Length", 0.5, 0.01, 16, 16), "along_brightness": ("Brightness Along", 0, 0, 1, 1, "FACTOR"),
            "along_tilt": ("Tilt Along", 0, 0, 1, 1, "FACTOR"), "along_length": ("Variation Length", 4, 0.01, 1e6, 32), "fuzz": ("Fibres in Gaps", 0, 0, 1, 1, "FACTOR"),
            "along": ("Exponent Along", 100, 0, 1e6, 1000), "across": ("Exponent Across", 10, 0, 1e6, 100)}.items()}},
    "LibshadeScratchesNode": {
        "unit": ("Vector In", "UV"), "size": ("Size", 0.1, 1e-4, 1e4, 10, "DISTANCE"), "uv_map": ("UV Map", ""), "seed": ("Seed", 1, -2**31, 2**31 - 1, 2**31 - 1),
        "tile": ("Tile", 0, 0, 1000, 10, "DISTANCE")}}
# Choices of its own, in their order
CHOICES = {"grain": "UV, Radial X, Radial Y, Radial Z, Object X, Object Y, Object Z", "bump_response": "Follow, Ignore", "bumps_are": "Relief, Shape", "width_as": "Roughness, Alpha, Exponents",
           "size_mode": "Length, Real World, Repeats", "distance": "Automatic, Near, Far", "unit": "UV, Lengths"}
WIDTHS = {"LibshadeMetalNode": ("Libshade Metal (brushed, anisotropic)", 230), "LibshadeFabricNode": ("Libshade Fabric (woven cloth)", 200), "LibshadeScratchesNode": ("Libshade Scratches", 240)}
# Of sockets that are numbers: at first, and of scratches their range
SOCKETS = {"LibshadeMetalNode": {"Roughness": 0.4489427, "Anisotropy": 0.5063064, "Rotation": 0},
           "LibshadeFabricNode": {"Gloss": 1, "Fuzz": 0, "Translucency": 0, "Alpha": 1, "Scale": 1, "Rotation": 0},
           "LibshadeScratchesNode": {"Amount": (1, 0, 1), "Density per cm²": (20, 0, 1e6), "Length mm": (8, 1e-3, 1e4), "Width mm": (0.03, 1e-3, 1e3), "Depth": (0.15, 0, 0.99),
                                     "Direction": (0, -200 * math.pi, 200 * math.pi), "Spread": (math.pi / 2, 0, math.pi / 2)}}


def test_what_nodes_of_ours_have():
    """Names, defaults and ranges, as the manual tells them; what a node keeps for itself is hidden."""
    common.empty_scene()
    tree = common.tree_of(bpy.data.materials.new("of ours"))
    for kind, table in PROPERTIES.items():
        node = tree.nodes.new(kind)
        assert (node.bl_label, node.bl_width_default, node.width) == (*WIDTHS[kind], WIDTHS[kind][1])
        found = {p.identifier: p for p in node.bl_rna.properties if p.identifier in type(node).__annotations__}
        assert {name for name, p in found.items() if not p.is_hidden} == set(table), kind
        for name, (label, initial, *numbers) in table.items():
            p = found[name]
            assert p.name == label and len(p.description) > 4 and not p.description.endswith("."), (kind, name)
            if not numbers:
                assert getattr(p, "default", None) == initial, (kind, name)
                continue
            assert close(p.default_array[:] if isinstance(initial, tuple) else p.default, initial), (kind, name)
            subtype = (*numbers[3:], "NONE")[0]
            assert close((p.hard_min, p.hard_max, p.soft_min, p.soft_max), (*numbers[:2], numbers[0], numbers[2])) and p.subtype == subtype, (kind, name)
            assert p.unit == {"DISTANCE": "LENGTH", "ANGLE": "ROTATION"}.get(subtype, "NONE"), (kind, name)
        for name in set(CHOICES) & set(table):
            assert ", ".join(item.name for item in found[name].enum_items) == CHOICES[name]
            assert all(item.description for item in found[name].enum_items), name
        numbers = {socket.name: socket for socket in node.inputs if socket.type == "VALUE"}
        assert set(numbers) == set(SOCKETS[kind])
        inside = node.node_tree.interface.items_tree if hasattr(node.node_tree, "interface") else node.node_tree.inputs
        for name, wanted in SOCKETS[kind].items():
            assert close(numbers[name].default_value, wanted[0] if isinstance(wanted, tuple) else wanted), (kind, name)
            asked = next(socket for socket in inside if socket.name == name)
            assert not isinstance(wanted, tuple) or close((asked.min_value, asked.max_value), wanted[1:]), name
        assert [socket.name for socket in node.inputs if socket.hide_value] == [name for name in ("Vector", "Normal", "Tangent") if name in node.inputs]


def test_presets_of_scratches():
    """How many a square centimetre, how long and wide in millimetres, how deep in half widths, which way and how far to either side."""
    common.empty_scene()
    tree = common.tree_of(bpy.data.materials.new("scratched"))
    node, field = tree.nodes.new("LibshadeScratchesNode"), module("scratches.field")
    for word, label, numbers in (("Fine polish", "Fine Polish", (1200, 4, 0.012, 0.06, 0, math.pi / 2)), ("brushed", "Brushed", (500, 25, 0.03, 0.12, 0, math.radians(2))),
                                 ("used", "Used", (20, 8, 0.03, 0.15, 0, math.pi / 2)), ("DEEP", "Deep", (1.5, 25, 0.15, 0.35, 0.3, 0.9))):
        node.preset = word
        assert node.preset == word.upper().replace(" ", "_") and field.PRESETS[node.preset][0] == label
        assert close([node.inputs[name].default_value for name in ("Density per cm²", "Length mm", "Width mm", "Depth", "Direction", "Spread")], numbers, rtol=3e-3), word
    assert raised(setattr, node, "preset", "worn") == "preset: 'worn' is none of FINE_POLISH, BRUSHED, USED, DEEP" and node.preset == "DEEP"
    # what the module gets: within ranges, what is no number as at first, a tile of its own before that of its images
    said = field.description(node, 0.5, {"Density per cm²": -1, "Length mm": math.nan, "Width mm": 2e3, "Depth": 1, "Direction": math.inf, "Spread": 0.2})
    assert said == {"density": 0, "length": 8, "width": 1e3, "depth": 0.99, "direction": 0, "spread": 0.2, "seed": 1, "tile": 0}
    for baked, tile, wanted in (("", 0, 0), ("[1, 0.25]", 0, 0.25), ("[1, 0.25]", 3, 1.5), ("[]", 0, 0), ("[null]", 0, 0), ("{", 0, 0)):
        node.baked, node.tile = baked, tile
        assert field.tile_of(node, 0.5) == wanted, baked
    assert [field.metres(Of(unit=unit, size=size), 0.5) for unit, size in (("UV", 3.0), ("UV", math.nan), ("METRES", 3.0))] == [1.5, 0.5, 0.5]


def test_what_dialogs_ask():
    """Of an operator: names and defaults of what it asks, and of numbers their range."""
    common.enable()
    for word, table in (("bake_scratches", {"size": ("Size", "2048"), "samples": ("Samples", 3, 1, 8), "tile": ("Tile", 0, 0, 1000), "points": ("Seen from Afar", False)}),
                        ("convert_to_group", {"all_materials": ("All Materials", False)}), ("follow_bumps", {"take_away": ("Take Away", False), "strokes": ("Strokes", "TANGENT")}),
                        ("measured_metal", {"metal": ("Metal", "SILVER")}), ("metal_preset", {"preset": ("Metal", "BRUSHED_STEEL")}), ("scratches_preset", {"preset": ("Scratches", "FINE_POLISH")}),
                        ("import_wif", {}), ("measure_cloth", {}), ("update_nodes", {}), ("copy_cycles_settings", {}), ("add_studio_light", {}), ("select_cause", {})):
        properties = getattr(bpy.ops.libshade, word).get_rna_type().properties
        assert {p.identifier for p in properties if not p.is_hidden} - {"rna_type", "filepath"} == set(table), word
        for name, wanted in table.items():
            p = properties[name]
            assert (p.name, p.default, *((p.hard_min, p.hard_max) if len(wanted) > 2 else ())) == wanted and (p.description or p.type == "ENUM"), (word, name)
    sizes = bpy.ops.libshade.bake_scratches.get_rna_type().properties["size"].enum_items
    assert [(item.identifier, item.name) for item in sizes] == [(str(n), f"{n} × {n}") for n in (512, 1024, 1536, 2048, 4096, 8192)]
    strokes = bpy.ops.libshade.follow_bumps.get_rna_type().properties["strokes"].enum_items
    assert [(item.identifier, item.name) for item in strokes] == [("TANGENT", "As Displaced"), ("ACROSS", "On the Surface")]
    for word, end in (("import_wif", ".wif"), ("save_scene", ".shscene")):
        assert getattr(bpy.types, f"LIBSHADE_OT_{word}").filename_ext == end
        assert getattr(bpy.ops.libshade, word).get_rna_type().properties["filter_glob"].default == "*" + end
    save = bpy.types.LIBSHADE_OT_save_scene.poll
    assert [save(Of(engine=engine)) for engine in ("LIBSHADE", "CYCLES")] == [True, False]


def test_where_the_manual_tells_of_what():
    """Blender's names of what the mouse is over, and where F1 leads: page and place."""
    prefix, places = module("manual")._places()
    assert prefix.startswith("file://") and prefix.endswith("/manual/")
    for name, wanted in (("types.LibshadeMetalNode.strokes", "metal"), ("types.LibshadeFabricNode", "fabric"), ("types.LibshadeScratchesNode.tile", "scratches"),
                         ("ops.libshade.scratches_preset", "scratches#preset"), ("ops.libshade.bake_scratches", "scratches#bake-to-images"), ("ops.libshade.drop_scratch_images", "scratches#bake-to-images"),
                         ("ops.libshade.import_wif", "fabric#import-wif"), ("ops.libshade.measure_cloth", "fabric#measure-for-cycles"), ("ops.libshade.metal_preset", "metal#preset"),
                         ("ops.libshade.measured_metal", "metal#measured-metal"), ("ops.libshade.update_nodes", "metal#nodes-of-older-files"),
                         ("ops.libshade.follow_bumps", "grooves-in-cycles#make-grooves-follow-bumps"), ("ops.libshade.add_groove", "grooves-in-cycles#make-grooves-follow-bumps"),
                         ("ops.libshade.add_assets", "assets#add-the-library"), ("ops.libshade.remove_assets", "assets#add-the-library"),
                         ("ops.libshade.convert_to_group", "assets#files-for-blenders-without-the-add-on"), ("ops.libshade.save_scene", "rendering#without-blender"),
                         ("ops.libshade.copy_cycles_settings", "rendering#start-from-a-file-for-cycles"), ("types.LibshadeSettings.samples", "rendering"),
                         ("types.LibshadeViewLayerSettings", "rendering"), ("types.Mesh", None)):
        page, _, place = (wanted or "").partition("#")
        found = next((there for pattern, there in places if fnmatch.fnmatchcase(f"bpy.{name}".lower(), pattern)), None)
        assert found == (wanted and f"blender/{page}.html" + (f"#{place}" if place else "")), (name, found)
    assert next(there for pattern, there in places if fnmatch.fnmatchcase("bpy.ops.libshade.copy_report", pattern)) == "start/blender.html"


def test_panels_of_nodes():
    """Beside the shader editor, within the panel of the active node, closed at first."""
    common.enable()
    for name, label in (("advanced", "Advanced"), ("warp", "Warp"), ("weft", "Weft")):
        panel = getattr(bpy.types, f"NODE_PT_libshade_{name}")
        assert (panel.bl_label, panel.bl_space_type, panel.bl_region_type, panel.bl_category) == (label, "NODE_EDITOR", "UI", "Node"), name
        assert panel.bl_parent_id == "NODE_PT_active_node_properties" and panel.bl_options == {"DEFAULT_CLOSED"}, name
    told = bpy.types.RENDER_PT_libshade_differences
    assert (told.bl_label, told.bl_space_type, told.bl_region_type, told.bl_context) == ("Not Rendered as in Cycles", "PROPERTIES", "WINDOW", "render")
    assert told.bl_options == {"DEFAULT_CLOSED"} and told.COMPAT_ENGINES == {"LIBSHADE"}


def test_memory_that_is_free():
    """As the kernel tells it, in kibibytes: what is available and what may be swapped out; nothing where it does not say."""
    memory = module("memory")
    for text, wanted in (("MemTotal: 9 kB\nMemFree: 1 kB\nMemAvailable:   3 kB\nSwapTotal: 8 kB\nSwapFree: 4 kB\n", 7 << 10), ("MemFree: 1 kB\nSwapFree: 4 kB\n", None),
                         ("MemAvailable: many kB\nSwapFree: 4 kB\n", None), ("MemAvailable 3 kB\n", None)):
        with mock.patch.object(memory, "open", mock.mock_open(read_data=text), create=True):
            assert memory._free() == wanted, text
    with mock.patch.object(memory, "open", mock.Mock(side_effect=OSError), create=True):
        assert memory._free() is None


def test_a_library_of_assets_is_added_and_removed():
    """Under our name, from our folder, to append from; what Blender does not add is said."""
    assets, said = module("assets"), []
    libraries = [Of(name="mine", path="/mine", import_method="LINK")]
    preferences = Of(filepaths=Of(asset_libraries=libraries), is_dirty=False)

    def add(directory):
        libraries.append(Of(name="new", path=directory + "/.", import_method="LINK"))
    operators = Of(asset_library_add=add, asset_library_remove=lambda index: libraries.pop(index))
    fake = Of(context=Of(preferences=preferences), ops=Of(preferences=operators), path=bpy.path)
    operator = Of(report=lambda kind, text: said.append((*kind, text)))
    with replaced(assets, bpy=fake, FOLDER=os.path.dirname(os.path.abspath(__file__))):
        for _again in range(2):
            assert assets.LIBSHADE_OT_add_assets.execute(operator, None) == {"FINISHED"} and preferences.is_dirty
            assert [vars(one) for one in libraries[1:]] == [{"name": "Libshade", "path": assets.FOLDER, "import_method": "APPEND_REUSE"}]
        libraries.append(Of(name="last", path="/last"))
        preferences.is_dirty = False
        assert assets.LIBSHADE_OT_remove_assets.execute(operator, None) == {"FINISHED"} and preferences.is_dirty
        assert [one.name for one in libraries] == ["mine", "last"] and libraries[0].import_method == "LINK"
        preferences.is_dirty = False
        assert assets.LIBSHADE_OT_remove_assets.execute(operator, None) == {"CANCELLED"} and not preferences.is_dirty
        operators.asset_library_add = lambda directory: None
        assert assets.LIBSHADE_OT_add_assets.execute(operator, None) == {"CANCELLED"} and said == [("ERROR", "Blender added no library")]


def test_what_copying_from_cycles_says():
    """What is another now, each name once; why there is nothing to copy from."""
    cycles, said = module("cycles_settings"), []
    operator = Of(report=lambda kind, text: said.append((*kind, text)))
    labels = {"samples": Of(name="Samples"), "seed": Of(name="Seed")}
    settings = Of(bl_rna=Of(properties=labels))
    scene = Of(libshade=settings, cycles="of scene", view_layers=[Of(libshade=settings, cycles="of layer")] * 2)
    for changed, words in ((["seed"], "As in Cycles now: Seed"), (["samples", "seed"], "As in Cycles now: Samples, Seed"), ([], "All was as in Cycles already")):
        with replaced(cycles, copy=lambda _settings, theirs, changed=changed: changed[:1] if theirs == "of layer" else changed):
            assert cycles.LIBSHADE_OT_copy_cycles_settings.execute(operator, Of(scene=scene)) == {"FINISHED"} and said.pop() == ("INFO", words)
    poll = cycles.LIBSHADE_OT_copy_cycles_settings.poll.__func__
    asked = Of(poll_message_set=said.append)
    assert poll(asked, Of(scene=scene)) and not said
    for without in (Of(), None):
        assert not poll(asked, Of(scene=without)) and said.pop() == "The Cycles add-on is not enabled"


def script_of(*place):
    """What a script of the repository defines, without what it does."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), *[os.pardir] * 3, *place)
    with open(path, encoding="utf-8") as file:
        body = [one for one in ast.parse(file.read()).body if isinstance(one, (ast.FunctionDef, ast.ClassDef, ast.Import, ast.ImportFrom)) or
                isinstance(one, ast.Assign) and isinstance(one.targets[0], (ast.Name, ast.Tuple)) and getattr(one.targets[0], "id", "") != "FOLDER"]
    made = {"__name__": "script", "__file__": path}
    exec(compile(ast.Module(body, []), path, "exec"), made)
    return made


def test_pictures_of_our_nodes():
    """Links lead from left to right, and no node lies over another that it is linked with; they share their image."""
    common.empty_scene()
    script = script_of("examples", "blender", "nodes", "make_pictures.py")
    for name in ("metal", "fabric", "groove", "scratches"):
        tree = common.tree_of(bpy.data.materials.new(name))
        tree.nodes.clear()
        script[name](tree)
        assert tree.links
        for link in tree.links:
            assert link.from_node.location.x + link.from_node.width <= link.to_node.location.x, (name, link.from_node.name, link.to_node.name)
        for node in (node for node in tree.nodes if node.bl_idname == "ShaderNodeTexImage"):
            assert node.image.colorspace_settings.is_data and node.image == bpy.data.images["bumps"]


def test_a_sheet_of_pictures():
    """Rows of so many from the top, each from the left."""
    script = script_of("blender_addon_c", "make_assets.py")
    assert (script["SIZE"], script["COLUMNS"], script["SAMPLES"]) == (192, 10, 64)
    script["SIZE"], script["COLUMNS"], path = 2, 3, os.path.join(bpy.app.tempdir, "sheet.png")
    script["write_sheet"]([np.full(16, k / 5, np.float32) for k in range(1, 6)], path)
    sheet = bpy.data.images.load(path)
    assert tuple(sheet.size) == (6, 4)
    seen = np.reshape(sheet.pixels[:], (4, 6, 4))[::2, ::2]
    assert np.allclose(seen[1, :, 3], (0.2, 0.4, 0.6), atol=0.01) and np.allclose(seen[0, :, 3], (0.8, 1, 0), atol=0.01), seen
    lines = script["catalogs"]().split("\n")
    assert lines[2] == "VERSION 1" and lines[-1] == ""
    for path, line in zip(("Libshade", "Libshade/Metals", "Libshade/Fabrics", "Libshade/Grooves", "Libshade/Scratches"), lines[4:], strict=False):
        identifier, *rest = line.split(":")
        assert rest == [path, path.replace("/", "-")] and len(identifier) == 36 and identifier == script["catalog"](path), line
    # the same in every build, so that what users sorted stays where it is
    assert script["catalog"]("Libshade/Metals") == "ac73227c-25f4-579d-95e1-9ccb913f2dda"


def test_a_thin_sheet_by_its_bounces():
    """Of light that meets a side r is reflected, what goes through loses by its colour, to and fro; as much over what facets leave. With hardly any
    roughness light passes straight."""
    thin, does = module("export.closure_thin"), {**module("export.graph")._FOLDED, "POWER": lambda a, b, _c: a**b, "GREATER_THAN": lambda a, b, _c: float(a > b)}
    principled, made, warned = module("export.closure_principled")._From40, [], []
    reader = Of(program=Of(math=lambda word, a, b=0.0, c=0.0: does[word](a, b, c)), warn=warned.append)
    base, edge, cosine, eta = (0.9, 0.5, 0.2), (1.0, 1.0, 0.25), 0.6, 1.5
    inside = math.sqrt(1 - (1 - cosine**2) / eta**2)
    mirror = sum(((a - b) / (a + b)) ** 2 for a, b in ((cosine, eta * inside), (eta * cosine, inside))) / 2
    parts = {"number_of": lambda _reader, socket, _groups: socket, "alpha_of": lambda *_which: 0.01, "film_of": lambda *_which: None, "_cosine": lambda _reader, normal: cosine if normal == "n" else 0,
             "Lobe": lambda _reader, alpha, normal: Of(one=0.8 if alpha == 0.01 else 0.7), "add": lambda _reader, *what: made.append(what)}
    back, on = [], []
    for part, tint in zip(base, edge):
        r = 0.04 * tint + (mirror - 0.04) / 0.96 * (1 - 0.04 * tint)
        light, seen = 1 - r, [r, 0.0]
        for bounce in range(60):
            light *= part ** (1 / inside)
            seen[1 - bounce % 2] += light * (1 - r)
            light *= r
        back.append(seen[0])
        on.append(seen[1])
    with replaced(thin, **parts):
        for roughness in (0.003, 0.1):
            made.clear()
            sheet = Of(thin=True, reader=reader, node=Of(name="pane", inputs={"IOR": eta, "Roughness": roughness}), groups=(), base=base, edge=edge, normal="n")
            principled._transmission(sheet, 0.5)
            (passed, weight, *_), (mirrored, shine, *more) = (made[0], made[1]) if roughness < 0.01 else (made[1], made[0])
            assert len(made) == 2 and close(shine, np.multiply(back, 0.5 / 0.8)) and more[0] == "n" and close(more[1], back), (roughness, shine, back)
            assert (mirrored["closure"], mirrored["alpha"], mirrored["straight"], mirrored["reflects"], mirrored["refracts"]) == ("GLASS", [0.01], False, True, False)
            if roughness < 0.01:
                assert passed == {"closure": "TRANSPARENT"} and close(weight, np.multiply(on, 0.5)), (weight, on)
            else:
                assert (passed["closure"], passed["straight"]) == ("GLASS", True) and 1e-4 < passed["alpha"][0] < 0.01 and close(weight, np.multiply(on, 0.5 / 0.7)), (weight, on)
    assert not warned
    seen = Of(program=Of(math=reader.program.math, emit=lambda _kind, **_given: (0.6, 0.0, 0.8)))
    assert close([thin._cosine(seen, normal) for normal in (None, (0.6, 0.0, 0.8), (0.8, 0.0, -0.6))], (0.8, 1, 0))
    assert [thin._through(reader, 0.3, index) < 0.3 for index in (1.0, 1.2, 1.5)] == [True] * 3 and thin._through(reader, 0.3, 1.0) == 1e-4  # nothing is bent


def test_green_that_points_down():
    """Of a normal map: from the other end."""
    bends = module("export.node_normal")
    reader = Of(program=module("export.graph").Program())
    with replaced(bends, vector_in=lambda *_which: (0.1, 0.3, 0.9)):
        for node, wanted in ((Of(), 0.3), (Of(convention="OPENGL"), 0.3), (Of(convention="DIRECTX"), 0.7)):
            assert close(bends._color_of(reader, Of(node=node)), (0.1, wanted, 0.9))
    assert bends._across(reader, [1.0, 2.0, 3.0], True) == [1.0, -2.0, 3.0] and bends._across(reader, [1.0, 2.0, 3.0], False) == [1.0, 2.0, 3.0]


def test_zones_that_repeat():
    """The first turn has what is linked to the zone, each other what the one before made; a zone within another asks its own turn."""
    tree = module("export.tree")

    class Sockets(list):
        def __getitem__(self, name):
            return next(socket for socket in self if socket.identifier == name)
    socket = lambda text: Of(identifier="item", text=text)
    (first, last), (inner, end) = ((Of(type="REPEAT_INPUT", inputs=Sockets([Of(identifier="Iterations"), socket(f"into {name}")])),
                                    Of(type="REPEAT_OUTPUT", inputs=[socket(f"made by {name}")])) for name in ("outer", "inner"))
    for one, other in ((first, last), (inner, end)):
        one.paired_output, other.id_data = other, Of(nodes=[inner, first])
    item, group, turn = Of(identifier="item"), Of(), tree.Turn
    for function, node, groups, wanted, left in (
            (tree._repeat_input, first, (group, turn(last, 0)), "into outer", (group,)), (tree._repeat_input, first, (group, turn(last, 3)), "made by outer", (group, turn(last, 2))),
            (tree._repeat_input, first, (group, turn(last, 1), turn(end, 4)), "made by outer", (group, turn(last, 0))),
            (tree._repeat_input, first, (turn(last, 0), turn(end, 4)), "into outer", ()),
            (tree._repeat_input, inner, (group, turn(last, 1), turn(end, 4)), "made by inner", (group, turn(last, 1), turn(end, 3))),
            (tree._repeat_input, inner, (turn(last, 1), turn(end, 0)), "into inner", (turn(last, 1),))):
        found, after = function(node, item, groups)
        assert (found.text, after) == (wanted, left), (groups, found, after)
    assert tree._repeat_input(first, item, ()) == (None, ()) and tree._repeat_input(first, item, (group,)) == (None, (group,))
    assert tree._repeat_input(first, Of(identifier="Iteration"), (turn(last, 1),)) == (None, (turn(last, 1),))
    for times, wanted, left in ((0, "into outer", (group,)), (-2, "into outer", (group,)), (2.0, "made by outer", (group, turn(last, 1))), (1000, "made by outer", (group, turn(last, 999))),
                                (1001, None, (group,)), (None, None, (group,))):
        with replaced(tree, known=lambda _socket, _groups, times=times: times):
            found, after = tree._repeat_output(last, item, (group,))
        assert (found and found.text, after) == (wanted, left), (times, found, after)
    said = [tree.iteration(Of(node=node, output=Of(identifier="Iteration"), groups=(turn(last, 2), turn(end, 5), group))) for node in (inner, first)]
    assert said == [5, None]


def test_vertices_in_one_place_are_one():
    """Nearer than the root of a float's epsilon, with sums of coordinates no more than three of it apart; whoever is one with another is one with all of its. An
    octahedron's tips are a quarter of a half-turn more than flat, whether its faces share them or not."""
    islands, step = module("export.islands"), 2.0**-13  # the limit of a step along x and back along y is twice that
    eps = 2.0**-23
    for by, one in (((0, 0, 0), True), ((step, -step, 0), True), ((2 * step, -2 * step, 0), False), ((1.5 * step, -1.5 * step, 0), True), ((step, step, step), False),
                    ((-step, 0, step), True), ((step, -step, 3 * eps), True), ((step, -step, 4 * eps), False), ((0.5, -0.5, 0), False)):
        for at in ((0, 0, 0), (0.25, -0.5, 0.125)):
            seen = islands._welded(np.float32([at, np.add(at, by), (3, 3, 3)]))
            assert (seen[0] == seen[1]) == one and seen[2] not in seen[:2], (by, at, seen)
    chain = [(k * step, 0.25 - k * step, 0) for k in (0, 3, 1, 2, 9, 10)]
    seen = islands._welded(np.float32(chain))
    assert len(set(seen[:4])) == 1 == len(set(seen[4:])) and seen[0] != seen[4]
    between = np.float32([(0.05, 0.5, 0.95), (0.95, 0.5, 0.05), (0.15, 0.4, 0.95)]) * eps**0.5 + np.float32([(0, 0, 0), (0, 0, 5e-8), (0, 0, 1e-7)])
    seen = islands._welded(between)  # the second's sum is between those of the others, from which it is far
    assert seen[0] == seen[2] != seen[1]
    tips = np.concatenate([np.eye(3), -np.eye(3)])
    faces = [(a, b, c) for a in (0, 3) for b in (1, 4) for c in (2, 5)]
    alone = np.float32([tips[k] + ((number % 3) * step * (k % 3 == 0), -(number % 3) * step * (k % 3 == 0), 0) for number, face in enumerate(faces) for k in face])
    ends = lambda faces: np.array([(face[k], face[(k + 1) % 3]) for face in faces for k in range(3)])
    whole = islands.pointiness(tips.astype(np.float32), tips, ends(faces))
    split = islands.pointiness(alone, np.concatenate([tips[list(face)] for face in faces]), ends(np.arange(24).reshape(8, 3)))
    assert np.allclose(whole, 0.75, atol=1e-5) and np.allclose(split, 0.75, atol=1e-3), (whole, split)
    hat = islands.pointiness(np.float32([(0, 0, 0), (1, 0, 1), (2, 0, 0), (5, 5, 5)]), np.tile((0.0, 0.0, 2.0), (4, 1)), np.array([(0, 1), (2, 1)]))
    assert np.allclose(hat, (0.5, 1.25 / 3, 0.5, 0), atol=1e-5), hat  # the means of a quarter, three quarters and a quarter with their neighbours


def test_how_finely_a_world_of_nodes_is_rendered():
    """Of 1024 rows, in a viewport of half as many; of as many as its largest image has, up to twice that. Of a lamp a quarter."""
    around, asked = module("export.around"), []

    def of(heights, kept, shape=lambda rows: np.ones((rows, 2, 3), np.float32)):
        listed = [{"height": height} for height in heights]
        return Of(_kept=kept, gain={}, even=lambda: "even", _rendered=lambda rows: asked.append(rows) or shape(rows),
                  _reader=Of(images=Of(listed=listed), program=Of(faced=None, upright=7)))
    for heights, kept, world, lamp in (([], None, 1024, 256), ([30, 1500], None, 1500, 512), ([4000], None, 2048, 512), ([], "kept", 512, 128), ([200, 90], "kept", 512, 200),
                                       ([700], "kept", 700, 256), ([3000], "kept", 1024, 256)):
        asked.clear()
        made = around.Shine.picture(of(heights, kept))
        assert (made["width"], made["height"], made["channels"], made["srgb"], made["wrap"], made["filter"]) == (2, world, 3, False, "EXTEND", "LINEAR")
        mean, pattern = around.Shine.pattern(of(heights, kept))
        assert len(made["data"]) == 6 * world and close(mean, (1, 1, 1)) and pattern == "even" and asked == [world, lamp], (heights, kept, asked)
    # the mean over the sphere: rows near the poles are small, those of a face are not; what is left says how much of it is along each
    step = lambda rows: np.where(np.arange(rows)[:, None, None] < rows // 2, 0.0, np.float32([2, 4, 0])) * np.ones((rows, 2, 1))
    mean, made = around.Shine.pattern(of([], None, step))
    assert close(mean, (1, 2, 0)) and made["upright"] == 7 and made["face"] is False and close(np.unique(made["data"]), (0, 2))
    pole = lambda rows: np.where(np.arange(rows)[:, None, None] < rows // 4, 1.0, 0.0) * np.ones((rows, 2, 3))
    assert close(around.Shine.pattern(of([], None, pole))[0], [(1 - math.sqrt(0.5)) / 2] * 3, rtol=1e-3)  # within 45 degrees of a pole
    face = of([], None, pole)
    face._reader.program.faced = "somewhere"
    assert close(around.Shine.pattern(face)[0], [0.25] * 3) and around.Shine.pattern(face)[1]["face"] is True
    assert around.Shine.even(Of(gain={})) is None and around.Shine.even(Of(gain={"gain": 2}))["gain"] == 2


def test_when_each_sample_asks_a_worlds_nodes():
    """Where it has a pattern of noise, and what that says differs within a texel by more than a twentieth; its images are then the scene's, too."""
    around, made = module("export.around"), []
    noise, image = {"type": "NOISE"}, {"type": "IMAGE", "image": 1}
    for nodes, off, wanted in (([image], 1.0, False), ([noise, image], 0.051, True), ([noise, image], 0.049, False), ([noise, image, {**image, "image": 0}, image], 9.0, True)):
        given = []
        shine = Of(_closures="closures", _reader=Of(program=Of(finish=lambda closures, nodes=nodes: (nodes, closures)), images=Of(listed=["first", "second"])),
                   _kept_picture=lambda scene, given=given, off=off: given.append(scene) or np.full(4, 1 + off), _rendered=lambda rows: np.ones(4))
        made.clear()
        found = around.Shine.shader(shine, 512, Of(made=lambda one: made.append(one) or 10 + len(made)))
        assert bool(found) == wanted, (nodes, off)
        if given:  # through as many texels as it has of the picture's, by other samples
            assert (given[0]["filter_width"], given[0]["seed"], given[0]["height"], given[0]["samples"]) == (3 * 64 / 512, 1, 64, 1)
        assert made == ["second", "first"][:len({node["image"] for node in nodes if node["type"] == "IMAGE"})] * wanted
        assert not found or [node.get("image") for node in found["nodes"]] == [None, *[{1: 11, 0: 12}[node["image"]] for node in nodes[1:]]] and found["closures"] == "closures"


def test_the_sun_in_a_picture_of_a_sky():
    """Is rendered by many samples, wherever it is and on both sides of the seam; the rest by one."""
    around = module("export.around")
    rows, columns = 64, 128
    for turn, elevation in ((0.0, 0.3), (1.0, -0.4), (math.pi, 0.2), (-3.1, 0.0), (0.5, 1.5)):
        asked = []

        def render(scene, asked=asked):
            x0, y0, x1, y1 = scene["region"]
            asked.append(scene)
            return np.full((y1 - y0, x1 - x0, 3), scene["samples"], np.float32)
        sky = {"sun_size": 0.1, "elevation": elevation, "matrix": [math.cos(turn), math.sin(turn)] + [0.0] * 10}
        with replaced(around, _render=render):
            data = around._of_sky(sky, rows)
            plain = around._of_sky({**sky, "sun_size": 0.0}, rows)
        assert (plain == 1).all() and asked[0]["region"] == (0, 0, columns, rows) and all(scene["samples"] == 64 and scene["filter_width"] == 0 for scene in asked[1:-1])
        # directions within the sun's disc and a pixel around, by the picture's own map: a circle of longitude is its width
        longitude, latitude = np.meshgrid((np.arange(columns) + 0.5) / columns * 2 * np.pi - np.pi, (np.arange(rows) + 0.5) / rows * np.pi - np.pi / 2)
        to = np.stack([np.cos(latitude) * np.cos(longitude), -np.cos(latitude) * np.sin(longitude), np.sin(latitude)], -1)
        # the matrix turns directions to the sky's own, whose sun stands over x
        sun = np.array((math.cos(elevation) * math.cos(turn), math.cos(elevation) * math.sin(turn), math.sin(elevation)))
        disc = to @ sun > math.cos(0.05)
        assert disc.any() or elevation > 1.4
        assert (data[disc][:, 0] == 64).all(), (turn, elevation)
        assert (data[..., 0] == 64).mean() < (0.04 if elevation < 1 else 0.12), (turn, elevation, (data[..., 0] == 64).mean())


def test_how_fine_balls_and_tubes_are():
    """The coarser the more there are. A ball's outline is in the mean over all sides as large as a circle: its surface is a sphere's. Of a tube of a
    straight strand of two points: sides times what lies between its rings, two triangles each; discs at both ends, where there are many sides."""
    strands = module("export.strands")
    for count, faces in ((1, 1280), (500, 1280), (501, 320), (5000, 320), (5001, 80)):
        made = strands.ball(count, "object 'cloud'", 3)
        corners = made["positions"][made["corner_position"]].reshape(-1, 3, 3).astype(float)
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert len(corners) == faces == len(made["material"]) and (made["material"] == 3).all() and made["name"] == "object 'cloud'"
        assert close(0.5 * np.linalg.norm(across, axis=1).sum(), 4 * math.pi) and ((across * corners.mean(1)).sum(1) > 0).all()
        normals = made["corner_normals"].reshape(-1, 3)
        assert close(np.linalg.norm(normals, axis=1), 1) and ((normals * corners.reshape(-1, 3)).sum(1) > 0.99).all()
    for count, sides, parts in ((2, 24, 8), (325, 24, 8), (326, 24, 4), (520, 24, 4), (521, 16, 4), (977, 16, 2), (1954, 8, 2)):
        points = np.zeros((2 * count, 3), np.float32)
        points[:, 0], points[1::2, 2] = np.repeat(np.arange(count), 2), 1
        made = strands.tubes(strands.Strands(points, np.full(2 * count, 0.1, np.float32), 2 * np.arange(1, count + 1), None, lambda _name: None), Matrix.Identity(4), "object 'fur'", 0)
        assert len(made["corner_position"]) // 3 == count * (2 * sides * parts + 2 * sides * (sides >= 16)), (count, sides, parts, len(made["corner_position"]) / 3 / count)


def run(tests):
    for name, test in list(tests.items()):
        if name.startswith("test_"):
            test()
            print(name, "done", flush=True)


run(globals())
print("all asserted")
common.finish()
