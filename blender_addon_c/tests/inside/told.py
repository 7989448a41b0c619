# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render and a viewport tell while they work, and what the module is told of lamps, worlds, images and cameras, by tables: told.py."""

import contextlib
import math
import operator
import os
import struct
import sys
from types import SimpleNamespace as Of

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import common  # noqa: E402
from parts_of import bare_cloth, module, raised, replaced  # noqa: E402


def close(found, wanted):
    return np.allclose(found, wanted, rtol=1e-5, atol=1e-6)


def test_waiting_for_a_picture():
    """Progress and memory are told each time, in megabytes; Esc ends the job; a window gets the picture each half second, a file never."""
    engine = module("engine")
    for background, shows in ((False, True), (False, False), (True, True)):
        now, told, shown, left, cancelled = [50.0], [], [], [4], []

        def wait(_job, seconds, now=now, left=left):
            assert seconds == 0.05
            now[0] += 0.3
            left[0] -= 1
            return left[0] < 0

        def state(_job, left=left):
            return {"progress": 0.25 * (4 - left[0]), "memory": 3 << 20, "memory_peak": 5 << 20, "stage": "render", "sample": 2, "samples": 8}
        fake = Of(test_break=lambda left=left: left[0] == 1, update_progress=told.append, update_stats=lambda *_texts: None,
                  update_memory_stats=lambda memory_used, memory_peak, told=told: told.append((memory_used, memory_peak)), update_result=shown.append)
        native = Of(wait=wait, poll=state, cancel=cancelled.append, image=lambda *_which, told=told: told.append("picture"))
        with replaced(engine, _native=native, time=Of(perf_counter=lambda now=now: now[0]), bpy=Of(app=Of(background=background)),
                      _set_pixels=lambda result, pixels, exposure, told=told: told.append(exposure)):
            last = engine.LibshadeEngine._wait(fake, "job", Of(whole="all", view="") if shows else None, "pixels", 2.5)
        drawn = ["picture", 2.5] if shows and not background else []
        assert told == [0.25, (3, 5), 0.5, (3, 5), *drawn, 0.75, (3, 5), 1.0, (3, 5), *drawn], told
        assert cancelled == ["job"] and shown == (["all"] * 2 if drawn else []) and last["progress"] == 1.25


def test_what_the_engine_says_of_itself():
    """To Blender: material balls, Eevee's material preview in viewports, Cycles' nodes; one picture of four channels before all passes."""
    engine, asked = module("engine").LibshadeEngine, []
    assert (engine.bl_use_preview, engine.bl_use_eevee_viewport, engine.bl_use_shading_nodes_custom) == (True, True, False)
    assert (engine.bl_idname, engine.bl_label) == ("LIBSHADE", "libshade")
    layer = common.empty_scene().view_layers[0]
    layer.use_pass_z = layer.use_pass_uv = True
    engine.update_render_passes(Of(register_pass=lambda _scene, _layer, *said: asked.append(said)), bpy.context.scene, layer)
    assert asked == [("Combined", 4, "RGBA", "COLOR"), ("Depth", 1, "Z", "VALUE"), ("UV", 3, "UVA", "VECTOR")], asked
    registered = []  # by what is switched on there is another pass
    with replaced(engine, update_render_passes=lambda _engine, _scene=None, _layer=None: registered.append(1)):
        for owner, word in ((layer.libshade, "denoising_store_passes"), (layer.libshade, "use_pass_shadow_catcher"), (layer.libshade, "pass_debug_sample_count"),
                            (bpy.context.scene.libshade, "use_denoising")):
            registered.clear()
            setattr(owner, word, True)
            assert registered, word


def test_whether_there_is_something_to_draw():
    """A viewport draws again what is done, what has failed and what was changed; while a tree of another view is built it waits, and of a coarse
    picture it draws no parts, of the best one each tenth of a second."""
    viewport, now = module("viewport"), [7.0]
    for changed, job, behind, state, stage, factor, seconds, wanted in (
            (True, 1, False, "running", "render", 1, 0.0, True), (False, None, False, "running", "render", 1, 0.0, True),
            (False, 1, False, "done", "render", 8, 0.0, True), (False, 1, False, "failed", "build", 8, 0.0, True),
            (False, 1, True, "running", "build", 1, 9.0, False), (False, 1, True, "running", "render", 1, 0.0, True),
            (False, 1, False, "running", "render", 1, 0.11, True), (False, 1, False, "running", "render", 1, 0.09, False),
            (False, 1, False, "running", "build", 1, 9.0, False), (False, 1, False, "running", "render", 2, 9.0, False)):
        shown = viewport.Viewport()
        shown._changed, shown._job, shown._behind, shown._made = changed, job, behind, Of(factor=factor)
        shown._whole, shown._fetched = "a picture", now[0] - seconds
        with replaced(viewport, _native=Of(poll=lambda _job, state=state, stage=stage: {"state": state, "stage": stage}), time=Of(perf_counter=lambda: now[0])):
            assert shown.has_news() == wanted, (changed, job, behind, state, stage, factor, seconds)
            shown._whole = None
            assert wanted is False or shown.has_news() == (seconds != 0.11)
    # what only the first picture of a scene takes says nothing of how coarse the next is to be
    for made, factor, timings, wanted in ((8, 8, (9.0, 3.0, 3.0, 2.97), 8), (8, 8, (9.0, 3.0, 3.0, 2.995), 4), (8, 8, (9.0, 3.0, 3.0, 2.94), 16), (4, 8, (9.0, 0, 0, 0), 8)):
        shown = viewport.Viewport()
        shown._made, shown._factor = Of(factor=made), factor
        with replaced(viewport, _native=Of(timings=lambda _job, timings=timings: dict(zip(("wall", "image", "mesh", "bvh"), timings)))):
            shown._adapt()
        assert shown._factor == wanted, timings


def test_how_a_picture_gets_finer():
    """Coarse first, each next one twice as fine, the best by all samples; seen from elsewhere the same job looks again, coarse first; after what
    failed comes no finer one; while another view's tree is built the job goes on."""
    viewport, calls = module("viewport"), []
    state = {"state": "done", "stage": "render"}

    def made(kind, answer):
        def record(*given):
            calls.append((kind, given[0 if kind == "start" else 1]["samples"], given[0 if kind == "start" else 1]["width"]))
            return answer
        return record
    native = Of(start=made("start", "job"), look=made("look", "job"), wait=lambda _job, _seconds: state["state"] != "running", poll=lambda _job: dict(state))
    views = [viewport._View((100, 60), Matrix.Translation((x, 0, 0)), Matrix.Identity(4), (0.1, 9), (0, 0, 100, 60)) for x in (0, 1)]
    shown = viewport.Viewport()
    shown._adapt = shown._fetch = lambda: None

    def read(view, _depsgraph, _space):
        calls.append("read")
        shown._scene, shown._waiting, shown._changed = {"by_camera": by_camera[0], "samples": 9}, True, False

    by_camera = [False]
    shown._read = read
    with replaced(viewport, _native=native):
        for _ in range(6):
            assert shown._advance(views[0], None, None)
        assert calls == ["read", ("start", 1, 13), ("start", 1, 25), ("start", 1, 50), ("start", 9, 100)] or \
            calls == ["read", ("start", 1, 13), ("look", 1, 25), ("look", 1, 50), ("look", 9, 100)], calls
        del calls[:]
        for _ in range(2):
            shown._advance(views[1], None, None)
        assert calls == [("look", 1, 13), ("look", 1, 25)], calls
        state["state"] = "failed"
        for _ in range(3):
            shown._advance(views[0], None, None)
        assert calls[2:] == [("look", 1, 13)], calls
        state.update(state="running", stage="build")
        shown._changed = True
        for _ in range(3):
            shown._advance(views[0], None, None)
        assert calls[3:] == ["read", ("start", 1, 13)], calls
        shown._advance(views[1], None, None)
        assert len(calls) == 5, calls
        state["stage"] = "render"
        shown._advance(views[1], None, None)
        assert calls[5:] == [("look", 1, 13)], calls
        by_camera[0] = shown._changed = True
        shown._advance(views[1], None, None)
        assert calls[6:] == ["read", ("start", 1, 13)], calls
        shown._advance(views[0], None, None)  # where a material is another from elsewhere
        assert calls[8:] == ["read", ("start", 1, 13)], calls


def test_how_a_viewport_is_drawn():
    """Over what is there, in the colours of the display, where it stands; nothing of the graphics card stays as it was set. The header says how far the
    picture is, and what went wrong."""
    viewport, report, scene = module("viewport"), module("report"), common.empty_scene()
    for texture in (None, "picture"):
        for stage, factor, finished, warnings, text, more in (("build", 1, False, [], "Building the BVH", True), ("render", 8, False, [], "Sample 0/9", True),
                                                              ("render", 1, False, ["odd"], "Sample 3/9 | odd", True), ("render", 1, True, ["odd", "old"], "odd (and 1 more)", False),
                                                              ("render", 2, True, [], "Sample 0/9", True)):
            calls, asked, view = [], [], object()
            shown = viewport.Viewport()
            shown._texture, shown._place, shown._job, shown._view, shown._waiting = texture, (3, 4, 13, 24), "job", view, False
            shown._made, shown._finished, shown._scene = Of(factor=factor), finished, {"samples": 9, "materials": []}
            shown._advance = lambda *_which: True
            gpu = Of(state=Of(blend_set=lambda word, calls=calls: calls.append(word)))
            engine = Of(bind_display_space_shader=lambda _scene, calls=calls: calls.append("bound"), unbind_display_space_shader=lambda calls=calls: calls.append("unbound"))
            state = {"state": "done" if finished else "running", "stage": stage, "sample": 3, "warnings": warnings}
            with replaced(viewport, gpu=gpu, draw_texture_2d=lambda *said, calls=calls: calls.append(said), _view_of=lambda *_which, view=view: view,
                          _native=Of(poll=lambda _job, state=state: state, slopes=lambda _job, asked=asked: asked.append("slopes") or [])):
                assert shown.draw(engine, Of(space_data=None), Of(scene=scene)) == (text, more), (stage, factor, finished, warnings)
            assert calls == (["ALPHA_PREMULT", "bound", ("picture", (3, 4), 10, 20), "unbound", "NONE"] if texture else []), calls
            assert [said for said, _error in report.told(scene)] == warnings and shown._behind is False and len(asked) == finished
    shown._advance = lambda *_which: False
    with replaced(viewport, _view_of=lambda *_which: None, gpu=gpu, draw_texture_2d=lambda *_said: None):
        assert shown.draw(engine, Of(space_data=None), Of(scene=scene)) == ("Reading the scene", True)
        shown._advance, shown._job, shown._error = lambda *_which: True, None, "no camera"
        assert shown.draw(engine, Of(space_data=None), Of(scene=scene)) == ("no camera", False)
    report._forget()


def test_which_part_of_a_view_is_rendered():
    """That which the view has of its own, to the nearest pixel and within the view; all where it is of no size."""
    region = module("viewport")._region_of
    for border, wanted in (((0.1, 0.5, 0.25, 0.75), (10, 15, 50, 45)), ((0.104, 0.506, 0, 1), (10, 0, 51, 60)), ((-1, 2, -1, 2), (0, 0, 100, 60)),
                           ((0.5, 0.5, 0, 1), (0, 0, 100, 60)), ((0.6, 0.4, 0, 1), (0, 0, 100, 60))):
        names = ("render_border_min_x", "render_border_max_x", "render_border_min_y", "render_border_max_y")
        space = Of(camera=None, use_render_border=True, **dict(zip(names, border)))
        context = Of(space_data=space, region_data=Of(view_perspective="PERSP"))
        assert region(context, Of(scene=Of(render=Of(use_border=True))), (100, 60)) == wanted, border
        space.use_render_border = False
        assert region(context, Of(scene=Of(render=Of(use_border=True))), (100, 60)) == (0, 0, 100, 60)


def test_what_multiplies_pixels():
    """Exposure does, of light, and not of what covers it or says something else; passes of pictures of their own come later."""
    engine, export, rects = module("engine"), module("export"), {}
    layer = Of(passes=Of(find_by_name=lambda name, view: Of(rect=Of(foreach_set=lambda pixels: rects.update({(name, view): np.ravel(pixels).tolist()})))))
    result = engine._Result(Of(layers=[layer]), "left")
    engine._set_pixels(result, np.float32([1, 2, 3, 0.5]), 2.0)
    engine._set_pixels(result, np.float32([1, 2, 3]), 2.0, "Emit", 3)
    engine._set_pixels(result, np.float32([1, 2, 3, 0.5]), 1.0, "Plain")
    assert rects == {("Combined", "left"): [2, 4, 6, 0.5], ("Emit", "left"): [2, 4, 6], ("Plain", "left"): [1, 2, 3, 0.5]}
    rects.clear()
    passes = [Of(name=name, channels=letters, plane=plane) for name, letters, plane in (
        ("Depth", "Z", "DEPTH"), ("DiffDir", "RGB", "DIFFUSE_DIRECT"), ("DiffCol", "RGB", "DIFFUSE_COLOR"), ("Noisy", "RGBA", module("export.passes").NOISY), ("Shadow", "RGB", export.CATCHER))]
    native = Of(image=lambda _job, numbers, _plane: numbers.__setitem__(slice(None), 3))
    with replaced(engine, _native=native):
        engine._set_passes(result, "job", passes, np.float32([0.25, 0.5, 1]), 2.0)
    assert rects == {("Depth", "left"): [3], ("DiffDir", "left"): [6] * 3, ("DiffCol", "left"): [3] * 3, ("Noisy", "left"): [6, 6, 6, 3],
                     ("Shadow", "left"): [0.25, 0.5, 1]}, rects


def test_who_waits_for_a_viewport():
    """Each once, until it has shown something new or is gone; nobody looks then."""
    engine, timers, news = module("engine"), [], {"a": False, "b": False}

    class Shown:
        def __init__(self, name):
            self.name = name

        def look(self):
            if self.name not in news:
                raise ReferenceError
            return news[self.name]
    a, b = Shown("a"), Shown("b")
    fake = Of(app=Of(timers=Of(is_registered=lambda _function: bool(timers), register=lambda function, first_interval: timers.append(first_interval))))
    with replaced(engine, bpy=fake, _watched=[]):
        for one in (a, b, a):
            engine._watch(one)
        assert engine._watched == [a, b] and timers == [0.01]
        assert engine._look() == 0.01 and engine._watched == [a, b]
        news["a"] = True
        assert engine._look() == 0.01 and engine._watched == [b]
        del news["b"]
        assert engine._look() is None and not engine._watched


def test_where_a_scene_is_saved():
    """A file of its own for each layer and eye; by the environment a picture is rendered all the same."""
    saved, scene = module("saved"), common.empty_scene()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    first = bpy.path.clean_name(bpy.context.view_layer.name)
    assert saved.place_of(depsgraph, "") == ("", False)
    os.environ["LIBSHADE_SCENE"] = "/tmp/a.b.shscene"
    try:
        assert saved.place_of(depsgraph, "") == ("/tmp/a.b.shscene", False) and saved.place_of(depsgraph, "left") == ("/tmp/a.b-left.shscene", False)
        scene.view_layers.new("second").use = False
        assert saved.place_of(bpy.context.evaluated_depsgraph_get(), "") == ("/tmp/a.b.shscene", False)
        scene.view_layers["second"].use = True
        depsgraph = bpy.context.evaluated_depsgraph_get()
        assert saved.place_of(depsgraph, "") == (f"/tmp/a.b-{first}.shscene", False) and saved.place_of(depsgraph, "right") == (f"/tmp/a.b-{first}-right.shscene", False)
        with replaced(saved, _chosen="/tmp/c.shscene"):
            assert saved.place_of(depsgraph, "") == (f"/tmp/c-{first}.shscene", True)
    finally:
        del os.environ["LIBSHADE_SCENE"]


def test_what_is_selected_of_a_message():
    """What it is said of and nothing else, the slot that has the material, and the node that it names; what is not in the file any more is said."""
    common.empty_scene()
    steel, wood = bpy.data.materials.new("steel"), bpy.data.materials.new("wood")
    for name in ("first", "second"):
        common.tree_of(steel).nodes.new("ShaderNodeBump").name = name
    plates = [common.plane(wood) for _ in range(3)]
    plates[1].data.materials.append(steel)
    plates[2].data.materials.append(steel)
    plates[2].hide_set(True)
    lamp = common.light(bpy.context.scene)
    for text, chosen in (("material 'steel': 'second': left out", [plates[1]]), ("light 'sun': odd", [lamp]), (f"object '{plates[0].name}': odd", [plates[0]]),
                         ("material 'steel': odd", [plates[1]])):
        assert bpy.ops.libshade.select_cause(text=text) == {"FINISHED"}
        assert [ob for ob in bpy.context.view_layer.objects if ob.select_get()] == chosen and bpy.context.view_layer.objects.active == chosen[0], text
    assert plates[1].active_material_index == 1 and plates[0].active_material_index == 0
    assert [node.name for node in steel.node_tree.nodes if node.select and node.name in ("first", "second")] == ["second"] and steel.node_tree.nodes.active.name == "second"
    said, report = [], module("report")
    fake = Of(text="material 'gone': odd", nothing=lambda text: said.append(text) or {"CANCELLED"})
    assert report.LIBSHADE_OT_select_cause.execute(fake, bpy.context) == {"CANCELLED"} and said == ["It is not in this file any more"]
    told = Of(window_manager=Of(clipboard=""), scene=bpy.context.scene)
    assert report.LIBSHADE_OT_copy_report.execute(Of(report=lambda *words: said.append(words)), told) == {"FINISHED"} and said[1:] == [({"INFO"}, "Copied")]
    assert told.window_manager.clipboard == report.whole(bpy.context.scene)
    # editors and panels show the new words a third of a second later at most, others are left alone
    drawn = []
    areas = [Of(type=kind, tag_redraw=lambda kind=kind: drawn.append(kind)) for kind in ("PROPERTIES", "VIEW_3D", "NODE_EDITOR")]
    with replaced(report, bpy=Of(context=Of(window_manager=Of(windows=[Of(screen=Of(areas=areas))])))):
        report._stale[0] = True
        assert [report._redraw(), report._redraw()] == [0.3, 0.3] and drawn == ["PROPERTIES", "NODE_EDITOR"]


class Layout:
    """What a node draws: words of properties, operators and labels, those that are grey in brackets."""

    def __init__(self, drawn):
        self.drawn, self.enabled = drawn, True

    def _draw(self, text):
        self.drawn.append(text if self.enabled else f"[{text}]")
        return Of()

    def prop(self, owner, name, text=None, **_more):
        self._draw(getattr(owner, "name", name) if name == "default_value" else name)

    def prop_search(self, _owner, name, where, among, **_more):
        self._draw(f"{name} of {where.name}'s {among}")

    def label(self, text, icon="NONE"):
        self._draw(text)

    def operator(self, name, **_more):
        return self._draw(name)

    def operator_menu_enum(self, name, _property, **_more):
        self._draw(name)

    def row(self, **_more):
        return Layout(self.drawn)
    column = row

    def template_ID(self, _owner, name, new, open):
        self._draw(f"{name}, {new}, {open}")

    def context_pointer_set(self, *_which):
        pass


def test_what_a_metal_shows():
    """The width of strokes where there are some, the UV map where it counts, with its object's maps to choose from; numbers of the lobe as they are
    asked for, or what they are linked to. Strokes have a lobe of their own: then its words are grey."""
    common.empty_scene()
    _material, tree, node = common.metal()

    def shown(draw, **settings):
        for name, value in settings.items():
            setattr(node, name, value)
        drawn = []
        draw(Layout(drawn))
        return drawn
    buttons = lambda ob=None: lambda layout: type(node).draw_buttons(node, Of(object=ob), layout)
    first = ["libshade.metal_preset", "grain"]
    assert shown(buttons(), strokes=0.0, grain="AXIS_X") == [*first, "strokes", "bump_response"]
    assert shown(buttons(), strokes=0.5) == [*first, "strokes", "stroke_width", "bump_response"]
    assert shown(buttons(), grain="UV") == [*first, "uv_map", "strokes", "stroke_width", "bump_response"]
    plate = common.plane()
    assert shown(buttons(plate), strokes=0.0) == [*first, f"uv_map of {plate.data.name}'s uv_layers", "strokes", "bump_response"]
    assert shown(buttons(common.light(bpy.context.scene))) == [*first, "uv_map", "strokes", "bump_response"]
    advanced = lambda layout: node.draw_advanced(layout)
    words, numbers = shown(advanced, width_as="ROUGHNESS"), lambda drawn: drawn[drawn.index("width_as") + 1:]
    assert {"distribution", "brdf"} < set(words) and numbers(words) == ["Roughness", "Anisotropy"]
    assert {"[distribution]", "[brdf]"} == {word for word in shown(advanced, strokes=0.5) if word[0] == "["}
    assert [word for word in words if word in ("horizon", "bumps_are")] == ["horizon", "bumps_are"] and node.bumps_are == "RELIEF"
    assert "bumps_are" not in shown(advanced, horizon="HARD")
    node.ax, node.ay = 0.5, 0.25
    assert numbers(shown(advanced, strokes=0.0, width_as="ALPHA")) == ["Alpha Along U: 0.5", "shown_ax", "Alpha Across U: 0.25", "shown_ay"]
    assert numbers(shown(advanced, width_as="EXPONENTS")) == ["Exponent Along U: 6", "shown_ex", "Exponent Across U: 30", "shown_ey"]
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], node.inputs["Anisotropy"])
    assert numbers(shown(advanced)) == ["By what is linked to", "Roughness, Anisotropy"]
    conductor, schlick = (shown(advanced, fresnel=fresnel) for fresnel in ("CONDUCTOR", "SCHLICK"))
    assert {"eta", "k"} < set(conductor) and not {"eta", "k"} & set(schlick)


def test_what_cannot_be_shaded_is_said():
    """A group that ends in nothing, a shader of others, a colour where a normal belongs."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    material, tree, node = common.metal("steel")
    common.plane(material)
    end = tree.get_output_node("ALL").inputs["Surface"]
    tree.links.new(tree.nodes.new("ShaderNodeRGB").outputs[0], node.inputs["Normal"])
    assert any(text.startswith(f"material 'steel': '{node.name}': Normal is fed by a colour ('") for text in read(scene)[1])
    inside = bpy.data.node_groups.new("inside", "ShaderNodeTree")
    module("group").new_socket(inside, "BSDF", "OUTPUT", "NodeSocketShader")
    group, hair = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeBsdfHairPrincipled")
    group.node_tree = inside
    for maker, output, words in ((group, "BSDF", f"'{group.name}' (BSDF) has nothing to shade by; left out"),
                                 (hair, 0, f"'{hair.name}' is not supported; shaded as a Diffuse BSDF of its colour")):
        tree.links.new(maker.outputs[output], end)
        assert f"material 'steel': {words}" in read(scene)[1], (words, read(scene)[1])


def test_groups_that_nodes_share_are_the_file_s_own():
    """One of that mark is taken again, but not what is linked from another file: that cannot be changed."""
    builder, made = module("builder"), []

    class Tree(dict):
        library = None
    theirs, other, new = Tree(mark=True), Tree(another=True), Tree()
    theirs.library = "another.blend"
    for trees, wanted in (([theirs, other], new), ([theirs, new], new), ([], new)):
        with replaced(builder, bpy=Of(data=Of(node_groups=trees)), new_inside=lambda name: made.append(name) or new, arrange=lambda _tree: None):
            assert builder.shared("Strokes", "mark", lambda tree: made.append(tree)) is wanted and new["mark"]
    assert made == ["Strokes", new, "Strokes", new]


def test_ends_of_strands_are_closed():
    """Its surface bounds what a prism of so many sides holds, from outside all round: by the volume that faces span with the origin, far away."""
    strands = module("export.strands")
    axis = np.float32([(5, 1, 2), (5, 1, 3), (5, 1, 4), (5, 1, 6)])
    made = strands.tubes(strands.Strands(axis, np.full(4, 0.1, np.float32), np.array([4]), None, lambda _name: None), Matrix.Identity(4), "object 'fur'", 3)
    corners = made["positions"].reshape(-1, 3).astype(float)[made["corner_position"].reshape(-1, 3)]
    sides = 24
    prism = 4 * 0.5 * sides * math.sin(2 * math.pi / sides) * (0.1 * math.pi / (sides * math.sin(math.pi / sides))) ** 2
    assert abs(np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6 - prism) < 1e-3 * prism
    # no edge has one face alone
    edges = np.sort(np.round(np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]]), 5), 1).reshape(-1, 6)
    counts = np.unique(np.sort(edges.reshape(-1, 2, 3).view([("", float)] * 3).reshape(-1, 2), 1), return_counts=True, axis=0)[1]
    assert (counts == 2).all() and (made["material"] == 3).all() and made["name"] == "object 'fur'"


def test_strokes_are_as_wide_and_uneven_for_others():
    """Inside the node is noise of as many octaves as our engine has at most, each as much weaker; of .05 mm twenty waves a millimetre of a scene in metres
    lie across, a fortieth of that along; alphas are up to 1 + 4 strength times as large."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    material, _tree, node = common.metal("steel")
    common.plane(material)
    node.strokes, node.stroke_width, node.grain = 0.5, 50.0, "AXIS_Y"
    inner = node.node_tree.nodes
    noise = next(one for one in inner if one.bl_idname == "ShaderNodeTexNoise")
    ours, = {(one["type"], *one["roughness"], *one["lacunarity"]) for one in read(scene)[0]["materials"][0]["nodes"] if one["type"] == "NOISE"}
    assert close(ours[1:], (noise.inputs["Roughness"].default_value, noise.inputs["Lacunarity"].default_value if "Lacunarity" in noise.inputs else 2))
    assert [noise.inputs[name].default_value for name in ("Scale", "Detail", "Distortion")] == [1, 8, 0]
    assert close(inner["Sizes"].inputs[1].default_value, (20, 0.5, 20)) and close(inner["Share of Strokes"].inputs["To Max"].default_value, 3)
    assert [inner["Share of Strokes"].inputs[name].default_value for name in ("From Min", "From Max", "To Min")] == [0.25, 0.75, 1]
    node.grain = "RADIAL_Z"
    assert close(inner["Sizes"].inputs[1].default_value, (0.5, 0.5, 20))  # they run round it, beside each other along it
    node.grain = "UV"
    assert close(inner["Sizes"].inputs[1].default_value, (0.5, 20, 0))


def test_a_world_is_rendered_once():
    """While it asks for the same, of the same images."""
    kept, made = module("export.kept").Kept(), []
    one, other = np.zeros(3), np.zeros(3)
    for program, images, count in (("a", [one], 1), ("a", [one], 1), ("b", [one], 2), ("a", [other], 3), ("a", [one], 3)):
        kept.begin()
        assert kept.around(program, images, lambda: made.append(1) or len(made)) in (1, 2, 3) and len(made) == count, (program, count)
    kept.end()  # only the last was asked for
    kept.begin()
    assert kept.around("a", [one], lambda: 9) == 1 and kept.around("b", [one], lambda: 9) == 9


def test_light_of_one_group():
    """Lamps, a world and what shines of that name alone; a mesh that shines is made dark once for all who have it, of another name."""
    groups = module("export.groups")
    shine, matt, hole = {"closure": "EMISSION", "weight": 1}, {"closure": "DIFFUSE"}, {"closure": "EMISSION", "holds": True}
    scene = {"group": "far", "sky": 1, "looks": 2, "backdrop": 3, "backdrop_sky": 4, "background": (1, 2, 3), "planes": 5, "mist": 6, "use_denoising": True, "dump": "x", "width": 7,
             "lights": [{"name": "a", "group": "near"}, {"name": "b", "group": ""}],
             "materials": [{"name": "lamp", **shine}, {"name": "both", "closures": [shine, matt]}, {"name": "matt", **matt}, {"name": "hole", **hole}],
             "meshes": [{"material": np.int32([0, 1, 2])}, {"material": np.int32([2, 3])}],
             "instances": [{"mesh": 0, "group": "near"}, {"mesh": 0, "group": ""}, {"mesh": 0, "group": "far"}, {"mesh": 1, "group": ""}]}
    near, far = groups.view(scene, "near"), groups.view(scene, "far")
    assert [one["name"] for one in near["lights"]] == ["a"] and not far["lights"]
    assert near["background"] == (0, 0, 0) and not {"sky", "looks", "backdrop", "backdrop_sky", "planes", "mist", "use_denoising"} & set(near)
    assert far["background"] == (1, 2, 3) and far["sky"] == 1 and far["backdrop_sky"] == 4 and near["dump"] == "" and near["width"] == 7
    assert [one["mesh"] for one in near["instances"]] == [0, 2, 2, 1] and [one["mesh"] for one in far["instances"]] == [2, 2, 0, 1]
    dark = near["meshes"][2]["material"].tolist()
    assert dark == [4, 5, 2] and near["meshes"][0]["material"].tolist() == [0, 1, 2] and len(near["meshes"]) == 3
    assert near["materials"][5]["closures"] == [matt] and near["materials"][4] == {"name": "lamp", "closure": "EMISSION", "weight": (0, 0, 0)}


def test_cycles_settings_that_make_another_picture():
    scene, settings = common.empty_scene(), module("export.scene")
    cycles, render = scene.cycles, scene.render
    render.use_simplify = True
    for owner, name, value, words in ((cycles, "use_fast_gi", True, "Fast GI Approximation"), (cycles, "use_camera_cull", True, "Camera Culling (Simplify)"),
                                      (cycles, "use_distance_cull", True, "Distance Culling (Simplify)"), (cycles, "texture_limit_render", "512", "Texture Limit (Simplify)")):
        for simplified in (True, False):
            messages, held = module("export.messages").Messages(), getattr(owner, name)
            render.use_simplify = simplified
            setattr(owner, name, value)
            settings._name_settings(scene, messages)
            setattr(owner, name, held)
            said = [f"Cycles' {words} is not supported; left out"] if simplified or "Simplify" not in words else []
            assert list(messages.warnings) == said, (name, simplified, list(messages.warnings))


def read(scene):
    """(what the module is told of the scene, what artists are)."""
    bpy.context.view_layer.update()
    export, depsgraph = module("export"), bpy.context.evaluated_depsgraph_get()
    messages = export.Messages()
    camera = export.camera_of(scene.camera, depsgraph, (16, 12), messages)
    return export.read(depsgraph, camera, (16, 12), (0, 0, 16, 12), 4, messages), list(messages.warnings)


def test_what_a_lamp_is():
    scene = common.empty_scene()
    common.camera(scene)
    scene.frame_set(1)
    assert read(scene)[1] == ["no sun or point or spot or area light in the scene: surfaces will be black"]
    lamp = common.light(scene, "AREA", 10)
    lamp.location = (1, 2, 3)
    for met, casts in ((True, True), (False, True), (True, False)):
        lamp.data.cycles.use_multiple_importance_sampling = met
        common.cast_shadow(lamp.data, casts)
        lamp.data.update_tag()
        (found,), said = read(scene)[0]["lights"], read(scene)[1]
        assert (found["met"], found["shadow"], found["type"], found["name"], said) == (met, casts, "AREA", "area", [])
    lamp.visible_glossy = False
    assert read(scene)[0]["lights"][0]["hidden"] == 4
    lamp.visible_diffuse = lamp.visible_transmission = False
    assert read(scene)[0]["lights"] == []


def test_what_versions_do_of_catchers():
    """Before 4.0 they count twice in ambient occlusion and are in light groups: that is said where one of these is asked for."""
    scene, layer = common.empty_scene(4, 4, 1), bpy.context.view_layer
    common.camera(scene)
    common.light(scene)
    common.plane().is_shadow_catcher = True
    occlusion, groups = "shadow catchers count once, not twice as in this Cycles", "light groups are without shadow catchers, which are in those of this Cycles"
    for twice, asks_occlusion, asks_groups in ((True, False, False), (True, True, False), (True, False, True), (False, True, True)):
        layer.use_pass_ambient_occlusion = asks_occlusion
        if asks_groups != bool(layer.lightgroups):
            (bpy.ops.scene.view_layer_add_lightgroup if asks_groups else bpy.ops.scene.view_layer_remove_lightgroup)()
        with replaced(module("versions"), CATCHERS_TWICE=twice):
            bpy.ops.render.render()
        told = [text for text, _error in module("report").told(scene)]
        said = [words for words in (occlusion, groups) if any(words in text for text in told)]
        assert said == [words for words, asked in ((occlusion, asks_occlusion), (groups, asks_groups)) if asked and twice], told


def test_what_a_world_is():
    """A colour, an image or both by strength; what is no light is 0; who sees it; an image that is not there is pink."""
    scene = common.empty_scene()
    common.camera(scene)
    world = scene.world = bpy.data.worlds.new("world")
    image = bpy.data.images.new("sky", 4, 2)
    image.pack()
    tree = common.tree_of(world)
    tree.nodes.clear()
    end, shader = tree.nodes.new("ShaderNodeOutputWorld"), tree.nodes.new("ShaderNodeBackground")
    tree.links.new(shader.outputs[0], end.inputs["Surface"])
    color, strength = shader.inputs["Color"], shader.inputs["Strength"]
    color.default_value, strength.default_value = (0.25, 0.5, 0, 1), 2
    assert close(read(scene)[0]["background"], (0.5, 1, 0))
    strength.default_value = -1
    assert close(read(scene)[0]["background"], (0, 0, 0))
    value, plain = tree.nodes.new("ShaderNodeValue"), tree.nodes.new("ShaderNodeRGB")
    value.outputs[0].default_value, plain.outputs[0].default_value = 3, (1, 0.5, 0.25, 1)
    tree.links.new(value.outputs[0], strength)
    tree.links.new(plain.outputs[0], color)
    assert close(read(scene)[0]["background"], (3, 1.5, 0.75))
    around = tree.nodes.new("ShaderNodeTexEnvironment")
    tree.links.new(around.outputs[0], color)
    found, said = read(scene)
    assert close(found["background"], (3, 0, 3)) and "world 'world': 'Environment Texture' has no image" in said
    around.image = image
    for interpolation, projection, bright, filtering in (("Linear", "EQUIRECTANGULAR", 3, "LINEAR"), ("Closest", "MIRROR_BALL", 0.5, "CLOSEST"),
                                                         ("Cubic", "EQUIRECTANGULAR", -2, "LINEAR"), ("Smart", "EQUIRECTANGULAR", 1, "LINEAR")):
        around.interpolation, around.projection, value.outputs[0].default_value = interpolation, projection, bright
        found, said = read(scene)
        sky = found["sky"]
        assert sky["strength"] == (max(bright, 0),) * 3 and sky["projection"] == projection and found["background"] == (0, 0, 0)
        assert found["images"][sky["image"]]["filter"] == filtering and found["images"][sky["image"]]["wrap"] == "REPEAT"
        words = f"world 'world': 'Environment Texture': interpolation {interpolation.lower()} is not supported; linear"
        assert (words in said) == (interpolation in ("Cubic", "Smart")), said
    # where a direction is looked up: the normal of what is around is the way back
    place, turn = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    turn.inputs["Rotation"].default_value = (0, 0, math.pi / 2)
    tree.links.new(turn.outputs[0], around.inputs["Vector"])
    for output, sign in (("Generated", 1), ("Object", 1), ("Normal", -1)):
        tree.links.new(place.outputs[output], turn.inputs["Vector"])
        assert close(np.reshape(read(scene)[0]["sky"]["matrix"], (3, 4))[:, :3], sign * np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)])), output
    for kind, bit in (("camera", 1), ("diffuse", 2), ("glossy", 4), ("transmission", 8)):
        setattr(world.cycles_visibility, kind, False)
        world.update_tag()
        assert read(scene)[0]["sky_hidden"] == bit
        setattr(world.cycles_visibility, kind, True)
    world.update_tag()
    assert read(scene)[0]["sky_hidden"] == 0
    scene.world = None
    found, said = read(scene)
    assert found["background"] == (0, 0, 0) and "sky" not in found and len(said) == 1


def test_what_is_mixed_into_a_world():
    """By a factor that is known, one of both is all there is; of Math nodes, too."""
    scene = common.empty_scene()
    common.camera(scene)
    world = scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(world)
    tree.nodes.clear()
    end, mix, sum_ = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("OutputWorld", "MixShader", "Math"))
    tree.links.new(mix.outputs[0], end.inputs["Surface"])
    tree.links.new(sum_.outputs[0], mix.inputs[0])
    for at, tint in ((1, 0.2), (2, 0.7)):
        shader = tree.nodes.new("ShaderNodeBackground")
        shader.inputs["Color"].default_value = (tint,) * 3 + (1,)
        tree.links.new(shader.outputs[0], mix.inputs[at])
    for operation, clamp, a, b, seen in (("ADD", False, 0.5, 0.5, 0.7), ("SUBTRACT", False, 0.5, 0.5, 0.2), ("MULTIPLY", False, 2, 0.5, 0.7),
                                         ("MAXIMUM", False, 0, 1, 0.7), ("MINIMUM", False, 0, 1, 0.2), ("ADD", True, 2, 3, 0.7), ("SUBTRACT", True, 0, 4, 0.2)):
        sum_.operation, sum_.use_clamp, sum_.inputs[0].default_value, sum_.inputs[1].default_value = operation, clamp, a, b
        found = read(scene)[0]
        assert close(found["background"], (seen,) * 3) and "sky" not in found, (operation, found["background"])


def test_whose_material_hair_is_of():
    """Of the slot that its system says, the last where there is none of that number; it is there without what grows it."""
    common.empty_scene()
    bpy.ops.mesh.primitive_plane_add()
    ob = bpy.context.object
    for name in ("skin", "fur", "wool"):
        ob.data.materials.append(bpy.data.materials.new(name))
    ob.modifiers.new("hair", "PARTICLE_SYSTEM")
    hair = ob.particle_systems[0].settings
    hair.type, hair.count = "HAIR", 3
    depsgraph, shapes = bpy.context.evaluated_depsgraph_get(), module("export.scene")._shapes
    for slot, wanted in ((1, "skin"), (2, "fur"), (3, "wool"), (9, "wool")):
        hair.material = slot
        for skin, strands in ((True, True), (False, True), (True, False)):
            ob.show_instancer_for_render = ob.show_instancer_for_viewport = skin
            bpy.context.view_layer.update()
            for item in depsgraph.object_instances:
                told = [[material.name for material in shape.slots] for shape in shapes(
                    Of(object=item.object, show_self=skin, show_particles=strands, matrix_world=item.matrix_world), depsgraph, module("export.motion").Still(), None)]
            # a slot's number is at most that of the last in Blender itself
            assert told == [["skin", "fur", "wool"]] * skin + [[wanted]] * strands, (slot, skin, told)


def test_what_a_camera_sees_around_it():
    panorama = module("export.camera")._panorama
    own = {"panorama_type": "FISHEYE_LENS_POLYNOMIAL", "fisheye_fov": 2.5, "fisheye_lens": 12.0, "longitude_min": -1.0, "longitude_max": 2.0, "latitude_min": -0.5,
           "latitude_max": 0.75, **{f"fisheye_polynomial_k{k}": 0.1 * (k + 1) for k in range(5)}, "central_cylindrical_radius": 2.0,
           "central_cylindrical_range_u_min": -0.3, "central_cylindrical_range_u_max": 0.4, "central_cylindrical_range_v_min": -1.0, "central_cylindrical_range_v_max": 3.0}
    data = Of(sensor_fit="AUTO", sensor_width=36.0, sensor_height=24.0, shift_y=0.25, clip_start=0.5, clip_end=70.0, stereo=Of(use_spherical_stereo=False), **own)
    render, told = Of(use_multiview=False, views_format="STEREO_3D", pixel_aspect_x=1.0, pixel_aspect_y=2.0), module("export.messages").Messages()

    def seen(size=(60, 40), **changes):
        return panorama(Of(name="eye"), Of(**{**vars(data), **changes}), render, size, (Matrix.Translation((1, 2, 3)), 0.1), told)
    found = seen()
    assert found["panorama"] == "FISHEYE_LENS_POLYNOMIAL" and close(found["polynomial"], (0.1, 0.2, 0.3, 0.4, 0.5)) and found["type"] == "PANO"
    assert (found["fov"], found["focal"], found["clip"], found["frame"]) == (2.5, 12.0, (0.5, 70.0), (0.1, 1.1, 0.25, 1.25))
    assert close(found["range"], (-1, 2, -0.5, 0.75)) and close(np.reshape(found["matrix"], (4, 4)), Matrix.Translation((1, 2, 3)))
    # pixels are twice as high as wide: 60 by 80, upright
    for fit, size, sensor in (("AUTO", (60, 40), (27, 36)), ("HORIZONTAL", (60, 40), (36, 48)), ("VERTICAL", (60, 40), (18, 24)), ("AUTO", (80, 20), (36, 18))):
        assert close(seen(size, sensor_fit=fit)["sensor"], sensor), (fit, size)
    assert close(seen(panorama_type="CENTRAL_CYLINDRICAL")["range"], (-0.3, 0.4, -0.5, 1.5))
    assert seen(fisheye_lens=0.0)["focal"] == 1e-6 and not told.warnings
    assert seen(panorama_type="ODD")["panorama"] == "EQUIRECTANGULAR"
    render.use_multiview, spherical = True, Of(use_spherical_stereo=True)
    seen(stereo=spherical)
    render.views_format = "MULTIVIEW"
    seen(stereo=spherical)
    assert list(told.warnings) == ["camera 'eye': panoramas of type odd are not supported; equirectangular",
                                   "camera 'eye': Spherical Stereo is not supported; its eyes stand still"]


def test_the_focus_is_as_far_as_its_plane():
    """Along the view, not to the object itself, which may be aside or behind."""
    scene = common.empty_scene()
    eye, thing = common.camera(scene, (1, 2, 3)), common.link(scene, "thing", None)
    for place, far in (((4, 2, -1), 4), ((1, 2, 1), 2), ((9, -7, 8), 5)):
        thing.location = place
        bpy.context.view_layer.update()
        dof = Of(focus_object=thing, focus_subtarget="", focus_distance=9.0)
        assert close(module("export.camera")._focus_distance(eye, dof, bpy.context.evaluated_depsgraph_get()), far), place


def test_numbers_of_images():
    """By hand: colours times alpha and back, tiles of other sizes, frames of sequences, how steep a normal map is."""
    image, bytes_, half = module("export.image"), np.uint8, 0.5
    byte = {"channels": 4, "data": np.array([201, 100, 50, 128, 10, 20, 30, 0], bytes_), "srgb": True, "wide": False}
    times = image._times_alpha(byte, True)
    # 100.9, 50.2 and 25.1: the nearest, as of 5.2 the one below
    assert times["data"].tolist() == [101 if bpy.app.version < (5, 2) else 100, 50, 25, 128, 0, 0, 0, 0] and times["srgb"] and times["data"].dtype == bytes_
    over = image._times_alpha(byte, False)
    assert not over["srgb"] and over["wide"] and close(over["data"][3::4], (128 / 255, 0))
    assert close(over["data"][:2], [((v / 128 + 0.055) / 1.055) ** 2.4 for v in (201, 100)]) and close(over["data"][4:7], [v / 255 / 12.92 for v in (10,)] + list(image._decoded(np.array([20, 30]) / 255)))
    floats = {"channels": 2, "data": np.float32([3, half, 0.5, 1]), "srgb": False, "wide": True}
    assert close(image._times_alpha(floats, True)["data"], (1.5, half, 0.5, 1)) and close(image._times_alpha(floats, False)["data"], (6, half, 0.5, 1))
    row = np.float32([0, 4, 8]).reshape(1, 3, 1)
    assert image._resized(row, 1, 3, False) is row
    assert image._resized(row, 1, 6, True)[0, :, 0].tolist() == [0, 0, 4, 4, 8, 8]
    assert close(image._resized(row, 1, 6, False)[0, :, 0], (2, 1, 3, 5, 7, 6))  # beyond an end comes the other one
    assert image._resized(row.astype(bytes_), 1, 6, False).dtype == bytes_
    grey = {"data": np.array([7, 9], bytes_), "width": 2, "height": 1, "channels": 1}
    assert image._as_large(grey, 2, 1, 4, True).tolist() == [[[7, 7, 7, 255], [9, 9, 9, 255]]]
    assert image._as_large({**grey, "width": 1, "channels": 2}, 1, 1, 4, True).tolist() == [[[7, 7, 7, 9]]]
    user = {"frame_duration": 4, "frame_start": 3, "frame_offset": 10, "use_cyclic": False}
    for change, frames in (({}, (10, 10, 11, 12, 14, 14)), ({"use_cyclic": True, "frame_offset": 0}, (3, 4, 1, 2, 4, 1)), ({"frame_duration": 0}, (0,) * 6), ({"frame_offset": 0}, (0, 0, 1, 2, 4, 4))):
        assert tuple(image._number(Of(**{**user, **change}), frame) for frame in (1, 2, 3, 4, 6, 7)) == frames, change
    images = image.Images(None, 1)
    flat, steep, down = ([0.5, 0.5, 1], [0.9, 0.5, 0.8], [0.5, 0.5, 0.3])
    for texels, below, parts in (((flat, flat), False, (0, 0)), ((flat, steep), False, (0.5, 0)), ((flat, down), True, (0.5, 0.5))):
        number = images.made({"channels": 3, "data": np.float32(texels).ravel(), "srgb": False})
        assert images.points_down(number) == below
        # the second one leans by .8 of .6 upwards
        assert tuple(images.turned(number, slope, 1.0) for slope in (1.2, 1.5)) == parts, texels
    ranges = [images.range_of(images.made({"channels": 1, "data": data})) for data in (np.array([3, 9], bytes_), np.float32([-2, 7]), np.float32([1, math.nan]))]
    assert ranges == [(0, 1), (-2, 7), (-math.inf, math.inf)]


def test_numbers_at_corners():
    """One number is three, what is missing is 0 and alpha 1; a factor is the mean, of pairs the first; a tangent brings its map."""
    layers = module("export.layers")
    for given, wanted in (([[2.0]], [2, 2, 2, 1]), ([[2.0, 3]], [2, 3, 0, 1]), ([[2.0, 3, 4]], [2, 3, 4, 1]), ([[2.0, 3, 4, 5]], [2, 3, 4, 5])):
        assert layers._four(np.float32(given)).tolist() == [wanted]
    assert layers.as_factor(np.float32([[1, 2, 6, 9]])).tolist() == [[3, 0]] and layers.as_factor(np.float32([[1, 2, 0, 1]]), True).tolist() == [[1, 0]]
    made = layers.Layers()
    numbers = [made.number(*one) for one in (("COLOR", ""), ("TANGENT", "uv"), ("UV", "uv"), ("FACTOR", "a"), ("COLOR", ""), ("STRAND", "length"))]
    assert numbers == [0, 2, 1, 3, 0, 4] or numbers == [0, 1, 2, 3, 0, 4], numbers
    assert [made.listed[number]["width"] for number in numbers] == [4, 4, 2, 2, 4, 4] and made.listed[numbers[1]]["tangents_of"] == numbers[2]


def test_where_links_lead_by_a_choice():
    """Nodes that pass on one of their inputs, by what is known of the first: none beyond the last, nor where it is not known."""
    tree = module("export.tree")

    class Sockets(list):
        def __getitem__(self, at):
            return at if isinstance(at, str) else super().__getitem__(at)
    indexed = Of(inputs=Sockets(["Index", "zero", "one", "two", "more"]), index_switch_items=range(3))
    switch, menu = Of(inputs=Sockets(["Switch", "false", "true"])), Of(inputs=Sockets(["Menu", "a", "b"]), enum_items=[Of(name="A"), Of(name="B")])
    for function, node, cases in ((tree._index_switch, indexed, ((0, "zero"), (2.0, "two"), (3, None), (-1, None), (None, None))),
                                  (tree._switch, switch, ((True, "true"), (False, "false"), (None, None))), (tree._menu_switch, menu, (("A", "a"), ("B", "b"), ("C", None), (None, None)))):
        for chosen, wanted in cases:
            with replaced(tree, known=lambda _socket, _groups, chosen=chosen: chosen):
                assert function(node, Of(identifier="Output"), ("group",)) == (wanted, ("group",)), (function.__name__, chosen)
    with replaced(tree, known=lambda _socket, _groups: "B"):
        assert tree._menu_switch(menu, Of(identifier="Item_1"), ()) == (None, ())
        assert [tree.is_item(Of(node=menu, groups=(), output=Of(name=name))) for name in "AB"] == [0, 1]


def test_every_node_of_an_aov_counts():
    """Wherever in the tree, in groups as well; none of a group that is mute."""
    known = module("export.known")

    def aov(name):
        return Of(type="OUTPUT_AOV", mute=False, name=name)
    inner = Of(type="GROUP", mute=False, node_tree=Of(nodes=[Of(type="RGB"), aov("inner")]))
    mute, empty = Of(type="GROUP", mute=True, node_tree=Of(nodes=[aov("mute")])), Of(type="GROUP", mute=False, node_tree=None)
    found = list(known._aovs(Of(nodes=[Of(type="RGB"), aov("first"), mute, inner, empty, Of(type="RGB"), aov("last")]), ()))
    assert [(node.name, groups) for node, groups in found] == [("first", ()), ("inner", (inner,)), ("last", ())]


def test_the_active_output_of_a_group_speaks():
    """Of two, whichever comes first."""
    outer, inner = (bpy.data.node_groups.new(name, "ShaderNodeTree") for name in ("outer", "inner"))
    module("group").new_socket(inner, "Tone", "OUTPUT", "NodeSocketFloat")
    says = {}
    for name in ("first", "second"):
        value, says[name] = inner.nodes.new("ShaderNodeValue"), inner.nodes.new("NodeGroupOutput")
        value.name = name
        inner.links.new(value.outputs[0], says[name].inputs["Tone"])
    group, asks = outer.nodes.new("ShaderNodeGroup"), outer.nodes.new("ShaderNodeMath")
    group.node_tree = inner
    outer.links.new(group.outputs["Tone"], asks.inputs[0])
    for active in ("second", "first"):
        for name, output in says.items():
            output.is_active_output = name == active
        assert module("export.tree").trace(asks.inputs[0]).node.name == active


def test_what_is_clearer_than_the_alpha_threshold_lets_a_pass_through():
    """A surface whose alpha is below it is seen through in what nodes say, by as much as it is in the picture; else not at all."""
    does = {"ADD": operator.add, "SUBTRACT": operator.sub, "MULTIPLY": operator.mul, "GREATER_THAN": operator.gt}
    parts, said, material = module("export.material"), ("tone", "COLOR"), bpy.data.materials.new("pane")
    tree = common.tree_of(material)
    pane = tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(pane.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    for threshold, alpha, through in ((0.25, 0.125, 0.875), (0.25, 0.375, None), (0.75, 0.625, 0.375), (0.75, 0.875, None)):
        pane.inputs["Color"].default_value = (*[1 - alpha] * 3, 1)
        with replaced(bpy.context.view_layer, pass_alpha_threshold=threshold):
            told, depsgraph = module("export").Messages(), bpy.context.evaluated_depsgraph_get()
            table = parts.Table(told, bpy.context.scene.libshade, False, None, depsgraph, aovs=[said])
        with replaced(module("export.graph").Program, math=lambda _program, word, a, b, _c=0.0: float(does[word](a, b))):
            index = table.index(material)
        seen = [closure["weight"] for closure in table.aovs[said][index]["closures"] if closure["closure"] == "TRANSPARENT"]
        assert len(seen) == (through is not None) and np.allclose(seen, through or 0), (threshold, alpha, seen)


def test_what_an_update_makes_old():
    """A mesh whose geometry changed is read again, and an image that changed; what else changed leaves both."""
    kept, image, other = module("export.kept").Kept(), bpy.data.images.new("changed", 2, 2), bpy.data.images.new("still", 2, 2)
    material, ob = bpy.data.materials.new("material"), bpy.data.objects.new("object", bpy.data.meshes.new("mesh"))
    for thing, moves, meshes, images in ((material, True, 1, 2), (ob, False, 1, 2), (image, False, 1, 1), (ob, True, 0, 2)):
        kept._meshes = {"mesh": Of(owners=Of(all={ob.as_pointer()}))}
        kept._images = {(one.name_full, None): "pixels" for one in (image, other)}
        kept.changed(Of(updates=[Of(id=thing, is_updated_geometry=moves)]))
        assert (len(kept._meshes), len(kept._images)) == (meshes, images), thing
    kept._images = {(one.name_full, None): "pixels" for one in (image, other)}
    kept.changed(Of(updates=[Of(id=image, is_updated_geometry=False)]))
    assert list(kept._images) == [(other.name_full, None)]


def test_a_number_by_chance_of_a_name():
    """By bytes that have a sign, each after 37 times those before; mixed as numbers of strands are."""
    for name in ("Cube", "Ünï", "é" * 40, ""):
        text = 0
        for byte in np.frombuffer(name.encode(), np.int8):
            text = (37 * text + int(byte)) % 2**32
        assert abs(module("export.scene")._hash(name) - float(module("export.strands").by_chance(text)) * 0xffffffff) < 1, name


def test_drafts_of_any_encoding():
    """By their marks; without one as UTF-8, else as Windows wrote them."""
    decoded, text = module("fabric.draft").decoded, "[TEXT]\nTitle=Käse € 5"
    for data in (text.encode(), text.encode("utf-8-sig"), text.encode("utf-16"), text.encode("cp1252"), b"\xfe\xff" + text.encode("utf-16-be")):
        assert decoded(data) == text, data


def test_what_measuring_cloth_says():
    """How many objects were measured, what may not be changed, and that nothing was to be done."""
    size, said = module("fabric.size"), []
    fake = Of(report=lambda kind, text: said.append((*kind, text)), nothing=lambda text: said.append(text))
    context = Of(mode="OBJECT", scene=common.empty_scene())
    for counts in ((3, 0), (1, 2), (0, 0), (0, 4)):
        with replaced(size, measure=lambda scene, counts=counts: counts):
            size.LIBSHADE_OT_measure_cloth.execute(fake, context)
    none = "No object of this scene wears Libshade Fabric of real size"
    assert said == [("INFO", "Measured 3 object(s)"), ("WARNING", "2 linked object(s) cannot be changed"), ("INFO", "Measured 1 object(s)"), none,
                    ("WARNING", "4 linked object(s) cannot be changed"), none], said


def test_numbers_of_faces_and_of_points():
    """Each triangle has its face's, each corner its point's."""
    mesh_of, layers = module("export.mesh"), module("export.layers")
    mesh = bpy.data.meshes.new("strip")
    mesh.from_pydata([(x, y, 0) for x in range(3) for y in range(2)], [], [(0, 2, 3, 1), (2, 4, 5, 3)])
    for domain, count in (("FACE", 2), ("POINT", 6)):
        mesh.attributes.new(domain, "FLOAT", domain).data.foreach_set("value", np.arange(1, count + 1, dtype=np.float32))
    mesh.calc_loop_triangles()
    corners = layers.integers(mesh.loop_triangles, "loops", 3)
    points = mesh_of._corner_positions(mesh, corners)
    faces, factors, own = (one["data"] for one in mesh_of._layers(mesh, corners, points, [(0, "ATTRIBUTE", "FACE"), (1, "FACTOR", "FACE"), (2, "ATTRIBUTE", "POINT")], "strip", None))
    assert faces.reshape(-1, 4)[:, 0].tolist() == factors.reshape(-1, 2)[:, 0].tolist() == [1] * 6 + [2] * 6
    assert own.reshape(-1, 4)[:, 0].tolist() == (points + 1).tolist()


def test_meshes_that_cycles_shades_by_other_normals():
    """Where more than a hundredth of the edges have three faces, and corners count: later Blenders say so."""
    mesh_of, later = module("export.mesh"), hasattr(bpy.types.Mesh, "corner_normals")
    for fins, sharp, wanted in ((1, True, 1 / 7), (1, False, 0.0), (0, True, 0.0)):
        mesh = bpy.data.meshes.new("fan")
        mesh.from_pydata([(0, 0, 0), (0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0)], [], [(0, 1, 2), (1, 0, 3), (0, 1, 4)][:2 + fins])
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        if sharp and later:
            mesh.attributes.new("sharp_edge", "BOOLEAN", "EDGE").data[1].value = True
        assert close(mesh_of._crossed(mesh), wanted if later else 0.0), (fins, sharp, mesh_of._crossed(mesh))


def beside(node):
    """A node as draw_buttons_ext knows it: Blender's own call of another function takes no stand-in for its context."""
    kind = type(node)
    return type("Node", (), {"__getattr__": lambda _self, name: getattr(node, name), "draw_buttons": lambda _self, *given: kind.draw_buttons(node, *given)})()


def test_what_cloth_shows():
    """How large it is by what Size counts, and of a real size its repeat, where one number says it; in the sidebar what a custom cloth is woven of, in older
    files less. A yarn's numbers have panels of their own."""
    common.empty_scene()
    with bare_cloth() as (tree, node):
        def shown(draw, **settings):
            for name, value in settings.items():
                setattr(node, name, value)
            drawn = []
            draw(beside(node), Of(scene=bpy.context.scene), Layout(drawn))
            return drawn
        kind, lines = type(node), ["In Cycles, EEVEE", "approximate"]
        node.preset, node.repeat_mm = "DENIM", (40 / 26, 40 / 17)  # four ends of 26 a cm, four picks of 17
        real = ["preset", "size_mode", "Repeat: 1.54 × 2.35 mm", *lines, "libshade.measure_cloth"]
        assert shown(kind.draw_buttons) == real, shown(kind.draw_buttons)
        node.inputs["Scale"].default_value = -2
        assert shown(kind.draw_buttons)[2] == "Repeat: 0.769 × 1.18 mm"
        for scale, linked in ((0, False), (1, True)):
            node.inputs["Scale"].default_value = scale
            if linked:
                tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], node.inputs["Scale"])
            assert shown(kind.draw_buttons) == [*real[:2], *real[3:]], linked
        assert shown(kind.draw_buttons, size_mode="LENGTH") == ["preset", "size_mode", "size", *lines]
        assert shown(kind.draw_buttons, size_mode="REPEATS") == (plain := ["preset", "size_mode", "repeats", *lines])
        more = ["open_gaps", "distance", "weave", "libshade.import_wif", "ends_per_cm", "picks_per_cm", "libshade.convert_to_group", "wm.url_open"]
        assert shown(kind.draw_buttons_ext) == plain + more
        assert shown(kind.draw_buttons_ext, weave="DRAFT") == [*plain, *more[:3], "draft, text.new, text.open", "draft_colors", *more[3:]]
        assert shown(kind.draw_buttons_ext, based_on="") == [*plain, *more[:2], *more[-2:]]
        for name in ("warp", "weft"):
            panel, drawn = getattr(module("fabric.node"), f"NODE_PT_libshade_{name}"), []
            assert [panel.poll(Of(active_node=node)) for node.based_on in ("", "DENIM")] == [False, True] and panel.bl_label == name.title()
            panel.draw(Of(layout=Layout(drawn), yarn=panel.yarn), Of(active_node=node))
            assert drawn[:2] == [f"{name}_width", f"{name}_gap"] and {word.split("_")[0] for word in drawn} == {name} and len(drawn) == 17, drawn
        node.node_tree = bpy.data.node_groups.new("older", "ShaderNodeTree")
        assert shown(kind.draw_buttons) == ["preset", "size"] and shown(kind.draw_buttons_ext)[2:5] == ["transmission", "open_gaps", "distance"]


WIF = """[WIF]
Version=1.1
[WEAVING]
Shafts=2
Treadles=2
[WARP]
Threads=2
Units=centimeters
Thickness=.04
Spacing=.05
[WEFT]
Threads=2
Units=centimeters
Thickness=.07
Spacing=.1
[THREADING]
1=1
2=2
[TIEUP]
1=1
2=2
[TREADLING]
1=1
2=2
"""


def test_how_large_a_draft_is():
    """By its spacing; without one crossings are squares as wide as the thicker yarn, without both as many as there were."""
    read, bare = module("_native").wif, WIF.replace("Spacing", "Note")
    for text, counts, sett, widths in ((WIF, (20, 10), "spacing", [(4, 1), (7, 3)]), (bare, (100 / 7, 100 / 7), "thickness", [(4, 3), (7, 0)]),
                                       (bare.replace("Thickness", "Note"), (10, 10), "even", None)):
        found = read(text.encode(), "cloth.wif", (20, 5))
        assert close(found["counts"], counts) and found["sett"] == sett and not found["mended"], found
        assert not found["widths"] if widths is None else close([width / (width + gap) for width, gap in found["widths"]], [width / (width + gap) for width, gap in widths]), found


def test_what_importing_a_draft_says():
    """What was mended, or whose draft it is now; what is wrong by the file; a size that the file does not state, by what it is; colours of yarns become white
    where the draft's are to be seen. Files of more than 64 MiB are none."""
    common.empty_scene()
    draft, said, folder = module("fabric.draft"), [], bpy.app.tempdir
    with bare_cloth() as (_tree, node):
        found = {"counts": (14.0, 7.0), "widths": [(0.3, 0.1), (0.2, 0.6)], "colored": True, "sett": "spacing", "mended": ""}

        def imported(name="one.wif", data=b"[WIF]\r\nx=1\ry=2", **changes):
            path = os.path.join(folder, name)
            with open(path, "wb") as file:
                file.write(data)
            with replaced(draft, _native=Of(wif=lambda *_given: {**found, **changes}), _MOST_BYTES=1 << 20):
                return draft.import_wif(node, path)
        before = tuple(node.inputs["Warp Color"].default_value)
        node.draft_colors = False
        assert imported() == "" and tuple(node.inputs["Warp Color"].default_value) == before
        assert node.draft.name == "one.wif" and node.draft.as_string().split("\n")[:3] == ["[WIF]", "x=1", "y=2"] and node.draft.current_line_index == 0
        assert close((node.ends_per_cm, node.picks_per_cm, node.warp_width, node.warp_gap, node.weft_width, node.weft_gap), (14, 7, 0.75, 0.25, 0.25, 0.75))
        node.draft_colors = True
        assert imported(colored=False) == "" and tuple(node.inputs["Warp Color"].default_value) == before
        assert imported(mended="3 were mended") == "3 were mended" and all(close(node.inputs[f"{yarn} Color"].default_value, (0.8, 0.8, 0.8, 1)) for yarn in ("Warp", "Weft"))
        square = "no spacing: square crossings as wide as the yarns are thick, 14 to the centimetre"
        even = "neither spacing nor thickness: as many crossings as before, but square, 14 to the centimetre"
        assert imported(sett="thickness") == f"one.wif: {square}" and imported(sett="even", mended="a") == f"a; {even}"
        try:
            imported(data=bytes((1 << 20) + 1))
            raise AssertionError
        except ValueError as error:
            assert str(error) == "one.wif: more than 1 MiB; a Weaving Information File was expected"
        assert imported(data=bytes(1 << 20), name="two.wif") == "" and draft._MOST_BYTES == 64 << 20
        fake = Of(material="cloth", group="", node=node.name, filepath="/no/such.wif", report=lambda kind, text: said.append((*kind, text)))
        execute = draft.LIBSHADE_OT_import_wif.execute
        for answer, change, words in (("mended so", {}, ("WARNING", "mended so")), ("", {}, ("INFO", f"'{node.draft.name}' is the draft of this cloth")),
                                      (ValueError("line 3"), {}, ("ERROR", "line 3")), (OSError(2, "No such file"), {}, ("ERROR", "/no/such.wif: No such file")),
                                      (OSError("odd"), {}, ("ERROR", "/no/such.wif: odd")), ("", {"node": "none"}, ("ERROR", "No Libshade Fabric node is chosen"))):
            def answered(_node, _path, answer=answer):
                if isinstance(answer, Exception):
                    raise answer
                return answer
            with replaced(draft, import_wif=answered):
                assert execute(Of(**{**vars(fake), **change}), Of(node=None, active_node=None)) == ({"FINISHED"} if words[0] in ("INFO", "WARNING") else {"CANCELLED"})
            assert said.pop() == words


def test_what_scratches_show():
    """That images are to be baked, which there are or that they are outdated; in the sidebar how large the square is and how many scratches it has at most."""
    scene, field = common.empty_scene(), module("scratches.node")
    tree = common.tree_of(bpy.data.materials.new("scratched"))
    node = tree.nodes.new(module("scratches").SCRATCHES)
    kind = type(node)

    def shown(draw, plain, stale=False):
        drawn, plan = [], {"tile": 0.064, "fewer": fewer[0], "density": 1234.0}
        with replaced(field, scratch_tree=Of(is_plain=lambda _tree: plain), is_stale=lambda _node, _scene: stale, _native=Of(scratches=lambda _said: plan)):
            draw(beside(node), Of(scene=scene), Layout(drawn))
        return drawn
    fewer, first = [False], ["libshade.scratches_preset", "unit", "size", "seed"]
    assert shown(kind.draw_buttons, True) == [*first, "Not in Cycles, EEVEE", "until baked", "libshade.bake_scratches"]
    node.baked = "[[], 1, 0.0125]"
    again = ["libshade.bake_scratches", "libshade.drop_scratch_images"]
    assert shown(kind.draw_buttons, False) == [*first, "Baked: 1.25 cm tile", *again]
    assert shown(kind.draw_buttons, False, True) == [*first, "Images are outdated", *again]
    end = ["tile", "Repeats every 6.4 cm", "libshade.convert_to_group", "wm.url_open"]
    assert shown(kind.draw_buttons_ext, False, True) == [*first, "Images are outdated", *again, "uv_map", *end]
    node.unit, fewer[0] = "METRES", True
    del first[2]
    assert shown(kind.draw_buttons_ext, False, True) == [*first, "Images are outdated", *again, *end[:2], "Only 1,234 per cm²", *end[2:]]


def test_what_cameras_objects_and_preferences_show():
    """Of a panorama what its type reads; which rays see a thing, by their names; a library to add, or the one that there is."""
    common.empty_scene()
    panels, assets = module("panels"), module("assets")

    def shown(draw, owner, context):
        drawn = []
        owner.layout = Layout(drawn)
        draw(owner, context)
        return drawn
    panorama, camera = panels.DATA_PT_libshade_panorama, bpy.data.cameras.new("around")
    camera.type = "PANO"
    settings = panorama.settings(camera)
    assert settings == (camera if hasattr(camera, "panorama_type") else camera.cycles)
    read = {"FISHEYE_EQUIDISTANT": {"fisheye_fov"}, "FISHEYE_EQUISOLID": {"fisheye_lens", "fisheye_fov"}, "MIRRORBALL": set(),
            "EQUIRECTANGULAR": {"longitude_min", "longitude_max", "latitude_min", "latitude_max"},
            "FISHEYE_LENS_POLYNOMIAL": {"fisheye_fov", *(f"fisheye_polynomial_k{k}" for k in range(5))}}
    if "CENTRAL_CYLINDRICAL" in settings.bl_rna.properties["panorama_type"].enum_items:
        read["CENTRAL_CYLINDRICAL"] = {"central_cylindrical_radius", *(f"central_cylindrical_range_{axis}_{end}" for axis in "uv" for end in ("min", "max"))}
    for settings.panorama_type, wanted in read.items():
        drawn = shown(panorama.draw, Of(settings=panorama.settings), Of(camera=camera))
        assert drawn[0] == "panorama_type" and set(drawn[1:]) == wanted and len(drawn) == 1 + len(wanted), drawn
    assert [bool(panorama.poll(Of(engine="LIBSHADE", camera=of))) for of in (camera, bpy.data.cameras.new("lens"), None)] == [True, False, False]
    ob, world = bpy.data.objects.new("thing", None), bpy.data.worlds.new("world")
    kinds = ("camera", "diffuse", "glossy", "transmission", "shadow")
    for panel, context, wanted in ((panels.OBJECT_PT_libshade_visibility, Of(object=ob), [*(f"visible_{kind}" for kind in kinds), "is_holdout", "is_shadow_catcher"]),
                                   (panels.WORLD_PT_libshade_visibility, Of(world=world), [kind for kind in kinds if hasattr(world.cycles_visibility, kind)])):
        assert shown(panel.draw, Of(of=panel.of), context) == wanted
    assert not panels.WORLD_PT_libshade_visibility.poll(Of(engine="LIBSHADE", world=None))
    assert shown(panels.RENDER_PT_libshade_sampling.draw_header_preset, Of(), None) == ["wm.url_open"]
    for library, updated in ((None, False), (Of(), False), (None, True)):
        buttons = ["Asset library: Libshade", "libshade.remove_assets"] if library else ["libshade.add_assets"]
        with replaced(assets, registered=lambda library=library: library, sys=Of(modules={assets.__package__: Of(updated=updated)})):
            found = shown(assets.LibshadePreferences.draw, Of(), None)
        assert found == ["Updated: until Blender is started again the version before runs"] * updated + [*buttons, "wm.url_open", "timings"], found


def test_where_buttons_lead():
    """What an Add menu adds follows the mouse; the manual is opened where it tells of this; grooves are made, or taken away."""
    asked = []

    class Menu:
        operator_context = None

        def operator(self, name, text=None, **_more):
            asked.append(Of(name=name, text=text, context=self.operator_context))
            return asked[-1]

        def separator(self):
            pass
    module("own_node").add_button(Menu(), "Kind", "Label")
    assert vars(asked.pop()) == {"name": "node.add_node", "text": "Label", "context": "INVOKE_DEFAULT", "type": "Kind", "use_transform": True}
    module("manual").draw_button(Menu(), "blender/metal.html#preset", "")
    manual = asked.pop()
    assert manual.name == "wm.url_open" and manual.text == "" and manual.url.startswith("file:///") and manual.url.endswith("/manual/blender/metal.html#preset")
    groove = module("groove")
    for kind, wanted in (("ShaderNodeTree", [(False, None), (True, "Take Libshade Groove Away")]), ("GeometryNodeTree", [])):
        groove._draw_menu(Of(layout=Menu()), Of(space_data=Of(tree_type=kind)))
        assert [(one.take_away, one.text) for one in asked] == wanted and all(one.name == "libshade.follow_bumps" for one in asked)
        asked.clear()
        for draw, name in ((groove._draw_add_menu, "libshade.add_groove"), (module("nodes")._draw_add_menu, "node.add_node"), (module("fabric.node")._draw_add_menu, "node.add_node"),
                           (module("scratches.node")._draw_add_menu, "node.add_node")):
            draw(Of(layout=Menu()), Of(space_data=Of(tree_type=kind)))
            assert [(one.name, one.context) for one in asked] == ([(name, "INVOKE_DEFAULT")] if wanted else []), name
            asked.clear()
    tells = module("report").TellsOfNothing()
    tells.report, said = lambda kind, text: said.append((*kind, text)), []
    tells.execute = lambda _context: tells.nothing("none")
    assert tells.execute(None) == tells.invoke(None, None) == {"CANCELLED"} and said == [("WARNING", "none"), ("ERROR", "none")]


def test_what_operators_say_of_their_work():
    """How many; one shader is no shaders."""
    common.empty_scene()
    nodes, groove, said = module("nodes"), module("groove"), []
    fake = lambda **settings: Of(report=lambda kind, text: said.append((*kind, text)), nothing=said.append, **settings)
    for take_away, strokes, count, words in ((False, "TANGENT", 1, ("INFO", "Libshade Groove put before 1 shader")), (True, "ACROSS", 2, ("INFO", "Libshade Groove taken from 2 shaders")),
                                             (True, "TANGENT", 0, "Nothing to take away: no Libshade Groove is in the file"),
                                             (False, "ACROSS", 0, "Nothing to do: no anisotropic shader has a linked Normal (Libshade Metal needs no Libshade Groove)")):
        asked = []
        with replaced(groove, _trees=lambda: ["tree"], place=lambda _tree, name, asked=asked, count=count: asked.append(name) or count,
                      take_away=lambda _tree, count=count: count, drop_patterns=lambda: None):
            groove.LIBSHADE_OT_follow_bumps.execute(fake(take_away=take_away, strokes=strokes), None)
        assert said == [words] and asked == ([] if take_away else ["Tangent" if strokes == "TANGENT" else "Strokes Across"])
        said.clear()
    _material, tree, _node = common.metal("steel")
    group = bpy.data.node_groups.new("inside", "ShaderNodeTree")
    group.nodes.new("LibshadeMetalNode")
    renewed = []
    with replaced(nodes, UPDATES={"LibshadeMetalNode": (lambda node: node.id_data == group, lambda tree, _node: renewed.append(tree))}):
        nodes.LIBSHADE_OT_update_nodes.execute(fake(), None)
        assert renewed == [group] and said.pop() == ("INFO", "Updated 1 Libshade node(s)")
        group.nodes.clear()
        nodes.LIBSHADE_OT_update_nodes.execute(fake(), None)
        assert said.pop() == "No Libshade node is of an older version"
    convert = nodes.LIBSHADE_OT_convert_to_group.execute
    convert(fake(all_materials=True), bpy.context)
    assert said.pop() == ("INFO", "Converted 1 Libshade node(s)") and tree.nodes["Libshade Metal"].bl_idname == "ShaderNodeGroup"
    convert(fake(all_materials=True), bpy.context)
    convert(fake(all_materials=False), Of(object=None))
    assert said == ["No Libshade node here to convert"] * 2


def test_when_images_of_cloth_are_made_and_go():
    """While a window renders none are made that are not there; what nothing has used goes after five seconds, and not while something renders for good."""
    maps, now = module("fabric.maps"), [100.0]
    made = {"tilt": ("a", b""), "yarns": ("b", b""), "tint": None}
    for background, running, there, may in ((True, True, (), True), (False, False, (), True), (False, True, ("a", "b"), True), (False, True, ("a",), False)):
        app = Of(background=background, is_job_running=lambda word, running=running: running and word == "RENDER")
        with replaced(maps, bpy=Of(app=app), _there=lambda key, there=there: key in there):
            assert maps.may_show(made) == may, (background, running, there)
    removed, images, running = [], [Of(name="old"), Of(name="new")], [False]
    fake = Of(app=Of(is_job_running=lambda word: running[0] and word == "RENDER"), data=Of(images=Of(remove=lambda image: removed.append(image.name))))
    with replaced(maps, bpy=fake, time=Of(monotonic=lambda: now[0]), _unused=lambda: images, _since={}):
        for seconds, busy, wanted in ((0, False, []), (5, False, []), (5.5, True, []), (5.5, False, ["old", "new"])):
            now[0], running[0] = 100 + seconds, busy
            maps.sweep()
            assert removed == wanted, (seconds, busy)
        del images[:], removed[:]
        maps.sweep()
        images.append(Of(name="old"))  # one of that name again: from then on
        now[0] += 5
        maps.sweep()
        assert not removed and maps._since == {"old": now[0]}


def test_lights_for_some_objects():
    """Thirty sets are kept apart, the next lights all; what a set leaves out is never lit, whoever instances it."""
    light, messages = module("export.light"), module("export.messages").Messages()
    things = [type("Thing", (), {"name": f"thing {k}", "type": "MESH"})() for k in range(3)]
    for thing in things:
        thing.original = thing

    def lamp(name, kind="LIGHT", **collections):
        made = Of(name=name, type=kind)
        made.original = Of(light_linking=Of(receiver_collection=None, blocker_collection=None) if collections is not None else None)
        for word, objects in collections.items():
            state = {"INCLUDE": [things[k] for k in objects if k >= 0], "EXCLUDE": [things[~k] for k in objects if k < 0]}
            listed = state["INCLUDE"] + state["EXCLUDE"]
            how = [Of(light_linking=Of(link_state=word)) for word in ("INCLUDE", "EXCLUDE") for _ in state[word]]
            collection = type("Collection", (), {"objects": listed, "collection_objects": how, "children": [], "collection_children": []})()
            setattr(made.original.light_linking, f"{word}_collection", collection)
        return made
    links = light.Links(messages)
    assert links.of_light(lamp("for all")) == {}
    first = lamp("first", receiver=[0])
    assert links.of_light(first) == {"link": 0} == links.of_light(first)
    assert links.of_light(lamp("second", receiver=[-2], blocker=[1])) == {"link": 1, "shade": 0}
    wanted = [{"shadeless": 1}, {"unlit": 3}, {"unlit": 1, "shadeless": 1}]
    assert [links.of_object(thing, None) for thing in things] == wanted
    assert links.of_object(things[2], things[0]) == {"shadeless": 1} and links.of_object(things[0], things[1]) == {"unlit": 2}
    assert [links.of_light(lamp("more", receiver=[0])) for _ in range(2, 30)] == [{"link": k} for k in range(2, 30)] and not messages.warnings
    assert links.of_light(lamp("last", receiver=[0])) == {} == links.of_light(lamp("ball", "MESH", receiver=[0]))
    words = "the light linking of 30 sets of lights is supported; it lights all"
    assert list(messages.warnings) == [f"light 'last': {words}", f"object 'ball': {words}"]
    messages = module("export.messages").Messages()
    for kind in ("", "HEMI"):
        assert light.light_of(Of(name="sky", data=Of(type=kind)), None, None, None, None, messages) == []
    assert list(messages.warnings) == ["light 'sky': hemi lights are not supported, only sun and point and spot and area"]


def test_pictures_share_the_time_that_is_left():
    """Of those that are composed each gets an even part of what is left; Esc leaves the last one as it is. What a picture of its own is said to be goes on, and
    its job is freed whatever happens."""
    engine, now, asked = module("engine"), [50.0], []
    views = {"with": {"time_limit": 12.0, "name": "with"}, "without": {"time_limit": 12.0, "name": "without"}, "others": {"time_limit": 12.0, "name": "others"}}

    for seconds, answer, wanted, done in ((2.0, {}, [("with", 4), ("without", 5)], (True, 8)), (20.0, {}, [("with", 4), ("without", 0.05)], (True, 0.1)),
                                          (2.0, {"with": None}, [("with", 4)], (False, 12))):
        def picture(scene, _count, _messages, seconds=seconds, answer=answer):
            asked.append((scene["name"], scene.get("time_limit")))
            now[0] += seconds
            return answer.get(scene["name"], "picture")
        asked.clear()
        with replaced(engine, time=Of(perf_counter=lambda: now[0])):
            pictures = {}
            finished, last = engine.LibshadeEngine._pictures(Of(_picture=picture), views, pictures, 4, None)
        assert [name for name, _limit in asked] == [name for name, _limit in wanted] and close([limit for _name, limit in asked], [limit for _name, limit in wanted]), asked
        assert (finished, round(last["time_limit"], 6)) == done and last["name"] == "others" and set(pictures) == {name for name, _limit in wanted}
    assert engine._within({"samples": 4}, 0.0, 2) == {"samples": 4}
    freed, said = [], []
    for state, answer in (({"state": "done", "warnings": ["odd"]}, True), ({"state": "cancelled", "warnings": []}, None), ({"state": "failed", "warnings": [], "message": "bad"}, "bad")):
        freed.clear()
        native = Of(image=lambda _job, pixels: pixels.__setitem__(slice(None), 2), free=freed.append)
        with replaced(engine, _native=native, _start=lambda scene: scene):
            fake = Of(_wait=lambda _job, result, _pixels, state=state: state if result is None else None)
            try:
                found = engine.LibshadeEngine._picture(fake, "job", 8, Of(warning=said.append))
                assert (found.tolist() == [[2] * 4] * 2) if answer else found is None
            except module("export").SceneError as error:
                assert str(error) == answer == "bad"
        assert freed == ["job"]
    assert said == ["odd"]
    groups, aov = Of(names_of=lambda _layer: ["left"], pass_of=lambda name: f"Combined_{name}", view=lambda _scene, name: f"light of {name}"), Of(view=lambda _scene, kind, materials: (kind, *materials))
    passes = [Of(name="tone", channels="X"), Of(name="paint", channels="RGBA"), Of(name="Combined_left", channels="RGB")]
    with replaced(module("export"), aov=aov, groups=groups):
        found = list(engine._others({"aovs": {("tone", "VALUE"): ["m"], ("paint", "COLOR"): ["n"]}}, passes, None, 2.5))
    assert found == [(("VALUE", "m"), "tone", "X", 1.0), (("COLOR", "n"), "paint", "RGBA", 1.0), ("light of left", "Combined_left", "RGB", 2.5)]


def test_what_a_viewport_puts_where():
    """Pixels that are not there yet are those of the picture before, exposed, but not what covers them; a coarse one is as large as the view."""
    viewport, made, asked = module("viewport"), [], []
    view = viewport._View((100, 60), None, None, None, (0, 0, 100, 60))
    shown = viewport.Viewport()
    shown._job, shown._exposure = "job", 2.0

    def image(_job, pixels, name, parts):
        asked.append((name, parts))
        pixels[0, 0] = 0.5
        if not parts:
            pixels[:], pixels[-1] = [1, 2, 3, 0.5], [3, 3, 3, 1]
    buffer = lambda kind, count, numbers: made.append((kind, np.array(numbers).reshape(-1, 4))) or made[-1]
    fake = Of(types=Of(Buffer=buffer, GPUTexture=lambda size, format, data: (size, format)))
    with replaced(viewport, gpu=fake, _native=Of(image=image)):
        shown._made, shown._finished = viewport._picture(view, 50, 9), True
        shown._fetch()
        assert shown._texture == ((2, 2), "RGBA16F") and shown._place == (0, 0, 100, 60) and made[-1][1].tolist() == [[2, 4, 6, 0.5]] * 2 + [[6, 6, 6, 1]] * 2
        before = shown._whole.copy()
        shown._made, shown._finished = viewport._Picture(view, (4, 2), (0, 0, 4, 2), 1, 9), False
        shown._fetch()
        assert asked == [("", False), ("", True)] and made[-1][1].tolist() == [[1, 1, 1, 0.5], *[[2, 4, 6, 0.5]] * 3, *[[6, 6, 6, 1]] * 4] and (shown._whole == before).all()
        shown._exposure, shown._made = 1.0, viewport._Picture(view, (50, 30), (10, 5, 12, 7), 2, 1)
        shown._fetch()
        assert shown._place == (20, 10, 24, 14) and made[-1][1][1:].tolist() == [[1, 2, 3, 0.5], *[[3, 3, 3, 1]] * 2]
    # where reading failed what is there is still refined, where the module did it is not
    said, scene = [], common.empty_scene()
    for reading in (True, False):
        shown._job, shown._scene, shown._waiting, shown._is_reading = "job", "scene", True, reading
        with replaced(module("report"), failure=lambda error: (str(error), "lines"), keep_failure=lambda *words: said.append(words)):
            shown._give_up(ValueError("bad"), scene)
        assert (shown._job, shown._scene) == (("job", "scene") if reading else (None, None)) and not shown._waiting and not shown._is_reading and shown._error == "bad"
    assert said == [(scene, "bad", "lines")] * 2
    shown._changed = False
    kept = shown._kept = Of(changed=lambda _depsgraph: 1 / 0)
    shown.scene_changed(None)
    assert shown._changed and shown._kept is not kept


def test_what_is_said_of_worlds_lamps_and_shaders():
    """What cannot be read is black, and says why; what a lamp is told in vain."""
    world_of, messages = module("export.world"), module("export.messages").Messages()
    scene = common.empty_scene()
    world = bpy.data.worlds.new("sky")
    tree = common.tree_of(world)
    table = Of(unknown=Of(name=lambda *_which: None))
    for error, why in ((ValueError("odd"), "odd"), (RecursionError(), "its nodes are too many"), (module("export.graph").TooLarge(), "its nodes are too many")):
        def fails(*_which, error=error):
            raise error
        with replaced(world_of, _Reader=fails):
            assert world_of.world_of(world, table, messages) == {"background": (0, 0, 0), "sky_hidden": 0}
        assert list(messages.warnings)[-1] == f"world 'sky': {why}; black"
    tree.links.new(tree.nodes.new("ShaderNodeVolumeScatter").outputs[0], tree.get_output_node("ALL").inputs["Volume"])
    scene.world = world
    common.camera(scene)
    common.light(scene)
    assert read(scene)[1] == ["world 'sky': volumes are not supported; left out"]
    around, said = module("export.around"), []
    falls = Of(name="Falloff")
    for output, smooth, own, gain, warned in (("Quadratic", 0.0, False, None, False), ("Quadratic", 0.5, False, None, True), ("Linear", 0.0, False, None, True), ("Quadratic", "r", False, None, True),
                                              ("Linear", 0.5, True, (1, 0.5), False), ("Constant", -1.0, True, (2, 0.0), False), ("Quadratic", 3.0, True, (0, 3.0), False), ("Constant", "r", True, None, True)):
        said.clear()
        reader = Of(falls=falls if own else None, gain=None, warn=said.append)
        with replaced(around, number_in=lambda _reader, _found, name, smooth=smooth: smooth if name == "Smooth" else 7.0, is_known=lambda number: number != "r"):
            assert around._light_falloff(reader, Of(node=falls, output=Of(name=output))) == (7.0,)
        assert (reader.gain and (reader.gain["gain"], reader.gain["smooth"])) == gain, (output, smooth, own)
        assert said == ["'Falloff': lamps fall off as light does, without smoothing"] * warned, (output, smooth, own)
    path, emitted = around._light_path, []
    for lamp, name, what, warned in ((False, "Is Glossy Ray", "GLOSSY", False), (True, "Is Camera Ray", "CAMERA", False), (True, "Is Glossy Ray", None, True), (False, "Is Shadow Ray", None, False),
                                     (True, "Is Shadow Ray", None, True), (False, "Ray Length", None, True)):
        said.clear()
        reader = Of(lamp=lamp, asked=set(), warn=said.append, program=Of(emit=lambda _kind, _count, what: emitted.append(what) or ["register"]))
        assert path(reader, Of(node=Of(name="Path"), output=Of(name=name))) == ("register",) and emitted.pop() == what and reader.asked == ({what} if what else set())
        assert said == [f"'Path' ({name}) is not supported; 0"] * warned, (lamp, name)


def test_what_is_said_of_meshes_and_materials():
    """Places that are no numbers, what is not there or cannot be read, an index that nothing has."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    material, tree, showing = common.shown(False, "lit")
    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "tone"
    tree.links.new(attribute.outputs["Color"], showing)
    plate = common.plane(material)
    plate.name = "plate"
    assert read(scene)[1] == ["object 'plate' has no attribute 'tone'; 0 is used"]
    plate.data.attributes.new("tone", "FLOAT", "POINT")
    assert read(scene)[1] == []
    plate.data.vertices[1].co.x = math.nan
    plate.data.update()
    assert "object 'plate': some of its vertices have no valid position" in read(scene)[1]
    plate.data.vertices[1].co.x = 1
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.new("grey", 2, 2)
    texture.image.pack()
    tree.links.new(texture.outputs["Color"], showing)
    assert read(scene)[1] == []
    plate.data.uv_layers.remove(plate.data.uv_layers[0])
    plate.data.update()
    assert read(scene)[1] == ["object 'plate': textures need a UV map: each shows one point only"]
    tree.links.remove(showing.links[0])
    assert read(scene)[1] == []
    plate.matrix_world[0][3] = math.inf
    assert read(scene)[1][0] == "object 'plate': its place is not a number; left out"
    plate.matrix_world[0][3] = 0
    glass = bpy.data.materials.new("glass")
    nodes = common.tree_of(glass).nodes
    shader, index = nodes["Principled BSDF"], nodes.new("ShaderNodeValue")
    shader.inputs["Transmission" if "Transmission" in shader.inputs else "Transmission Weight"].default_value = 0.5
    glass.node_tree.links.new(index.outputs[0], shader.inputs["IOR"])
    common.plane(glass)
    index_said = "an IOR of 0.05 has no meaning; what is transmitted is off from Cycles'"
    if bpy.app.version < (4, 0):
        index_said = "an IOR of -0.05 has no meaning: as Cycles of 3.4 does not show it (black), it is shaded as 1"
    for index.outputs[0].default_value, said in ((1.5, False), (-0.05 if bpy.app.version < (4, 0) else 0.05, True)):
        assert [text for text in read(scene)[1] if "material 'glass'" in text] == [
            f"material 'glass': 'Principled BSDF': {index_said}"] * said, read(scene)[1]


def test_what_instances_of_nodes_say():
    """Each by its own number, where it has one; an instance within another says what it has, else the outer one does."""
    made_of = module("export.attributes")._Made
    value = lambda *numbers: Of(data=[Of(value=number) for number in numbers])

    def cloud(count, shown, **attributes):
        return Of(points=range(count), attributes={".reference_index": value(*shown), **attributes})

    def geometry(of, *references):
        return Of(instances_pointcloud=lambda: of, instance_references=lambda: references)
    inner = geometry(cloud(2, (0, 0), tone=value(0.25, 0.75)), "mesh")
    colors = Of(data=[Of(color=(k, k, k, 1)) for k in (1, 2, 3)])
    made = made_of(geometry(cloud(3, (0, 1, 0), tone=value(5, 6, 7), paint=colors, id=value(40, 10, 10)), "mesh", inner))
    none = 0x7fffffff
    for ids, name, wanted in (([40], "tone", 5), ([10], "tone", 6), ([1, 10], "tone", 0.75), ([0, 10, none, none], "tone", 0.25), ([1, 10], "paint", (2, 2, 2, 1)),
                              ([40], "paint", (1, 1, 1, 1)), ([7], "tone", None), ([], "tone", None), ([none], "tone", None), ([40], "other", None), ([5, 10], "tone", 6)):
        assert made.value(ids, name) == wanted, (ids, name, made.value(ids, name))
    assert made_of(geometry(cloud(2, (0, 0), tone=value(3, 4)), "mesh")).value([1], "tone") == 4 and made_of(geometry(None)).value([0], "tone") is None


def test_what_layers_ask_in_vain():
    """All at once, by Blender's names; mist is as its world says, and without one from the camera on."""
    passes, messages = module("export.passes"), module("export.messages").Messages()
    layer = Of(name="front", use_pass_shadow=True, aovs=[Of(name="tone", is_valid=False), Of(name="paint", is_valid=True)], libshade=Of(denoising_store_passes=True),
               cycles=Of(use_pass_volume_direct=True))
    for more in (False, True):
        with replaced(module("versions"), MORE_TO_DENOISE=more):
            passes.passes_left_out(layer, messages)
    words = "view layer 'front': passes that are not rendered: Shadow, AOV 'tone', whose name another has, Volume Direct"
    assert list(messages.warnings) == [words, f"{words}, Denoising Specular Albedo, Denoising Roughness"], list(messages.warnings)
    planes = [Of(plane=plane) for plane in ("DEPTH", passes.NOISY, "OBJECT_MATTE00", passes.AOV, passes.CATCHER, "MIST")]
    world = Of(mist_settings=Of(start=2.0, depth=3.0, falloff="QUADRATIC"))
    for given, mist in ((world, {"start": 2, "depth": 3, "falloff": "QUADRATIC"}), (None, {"start": 0, "depth": 100, "falloff": "LINEAR"})):
        assert passes.planes_of(planes, given) == {"planes": [{"type": "DEPTH"}, {"type": "MIST"}], "mist": mist}
    assert passes.planes_of(planes[:1], world) == {"planes": [{"type": "DEPTH"}]}
    assert passes.world_of_layer(Of(world=1), Of(world_override=2)) == 2 and passes.world_of_layer(Of(world=1), Of(world_override=None)) == passes.world_of_layer(Of(world=1), Of()) == 1
    light = {plane: passes.is_light(Of(plane=plane)) for plane in ("EMISSION", "ENVIRONMENT", passes.NOISY, "DIFFUSE_DIRECT", "GLOSSY_INDIRECT", "DIFFUSE_COLOR", "DEPTH", "MIST", "NORMAL")}
    assert [plane for plane, shines in light.items() if not shines] == ["DIFFUSE_COLOR", "DEPTH", "MIST", "NORMAL"]


def test_whose_trees_are_whose():
    """Patterns that something has inside stay; a node's tree is its own before it changes, but for one that is linked as the node is."""
    group, removed = module("group"), []

    class Tree(dict):
        users, library, name = 0, None, "tree"

        def copy(self):
            return "a copy"
    used, unused, other = Tree(libshade_pattern="x"), Tree(libshade_pattern="x"), Tree()
    used.users = 1
    with replaced(group, bpy=Of(data=Of(node_groups=type("Groups", (list,), {"remove": lambda _self, tree: removed.append(tree)})([used, unused, other])))):
        group.drop_patterns()
    assert len(removed) == 1 and removed[0] is unused
    tree = Tree()
    for shares, holders, library, owner, own in ((True, 2, None, None, False), (True, 1, None, None, True), (False, 2, None, None, True), (False, 1, "a.blend", None, False),
                                                 (False, 1, "a.blend", "a.blend", True)):
        tree.library = library
        node = Of(node_tree=tree, shares_tree=shares, id_data=Of(library=owner))
        with replaced(group, _holders=lambda _tree, holders=holders: holders):
            assert group.own_tree(node) is node.node_tree and (node.node_tree is tree) == own and node.shares_tree is False, (shares, holders, library, owner)
    for library, name in ((None, "inside"), ("a.blend", ".inside")):
        tree.library, tree.name = library, ".inside"
        group.unhide(tree)
        assert tree.name == name
    told = Of(name="none")
    lines = module("report").whole(told).split("\n")
    words = lines[0].split()
    assert len(lines) == 2 and not lines[1] and words[0] == "libshade" and words[1][0].isdigit() and words[2] in ("(avx512),", "(avx2),", "(sse2),", "(neon),")
    assert lines[0].split(", ")[1] == f"Blender {bpy.app.version_string}"


def test_what_cloths_and_fields_are_called_and_span():
    node_of, field = module("fabric.node"), module("scratches.field")
    for preset, weave, draft, name in (("SILK_CHARMEUSE", "DRAFT", None, "Silk"), ("CUSTOM", "DRAFT", Of(name="mine.wif"), "mine.wif"), ("CUSTOM", "DRAFT", None, "Draft"),
                                       ("CUSTOM", "PLAIN", Of(name="mine.wif"), "Plain")):
        assert node_of._woven(Of(preset=preset, weave=weave, draft=draft)).startswith(name), (preset, weave)
    for tile, baked, wanted in ((0.5, "[1, 0.25]", 0.005), (0.0, "[1, 0.25]", 0.25), (math.nan, "[0.5]", 0.5), (0.0, "", 0.0), (0.0, "[]", 0.0), (0.0, "[null]", 0.0), (-1.0, "7", 0.0)):
        assert close(field.tile_of(Of(tile=tile, baked=baked), 0.01), wanted), (tile, baked)
    assert [field.metres(Of(unit=unit, size=size), 0.01) for unit, size in (("UV", 0.5), ("METRES", 0.5), ("UV", math.inf))] == [0.005, 0.01, 0.01]


def test_collections_within_a_light_link():
    """All that they hold, however deep, on the side that the collection itself is on."""
    near, far, out = (type("Thing", (), {})() for _ in range(3))
    made = Of(objects=[near], collection_objects=[Of(light_linking=Of(link_state="INCLUDE"))],
              children=[Of(objects=[], all_objects=[far]), Of(objects=[], all_objects=[out])],
              collection_children=[Of(light_linking=Of(link_state=word)) for word in ("INCLUDE", "EXCLUDE")])
    assert module("export.light")._receivers(made) == ({near, far}, {out})


def test_maps_in_a_row_turn_a_world_in_their_order():
    """What the second says of what the first made of a direction: a scale along x, then a quarter turn about z."""
    scene = common.empty_scene()
    common.camera(scene)
    world = scene.world = bpy.data.worlds.new("world")
    image = bpy.data.images.new("sky", 4, 2)
    image.pack()
    tree = common.tree_of(world)
    around, first, second, place = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexEnvironment", "Mapping", "Mapping", "TexCoord"))
    around.image = image
    first.inputs["Scale"].default_value, second.inputs["Rotation"].default_value = (2, 1, 1), (0, 0, math.pi / 2)
    shader = next(node for node in tree.nodes if node.type == "BACKGROUND")
    for socket, to in ((place.outputs["Generated"], first.inputs["Vector"]), (first.outputs[0], second.inputs["Vector"]), (second.outputs[0], around.inputs["Vector"]),
                       (around.outputs[0], shader.inputs["Color"])):
        tree.links.new(socket, to)
    assert close(np.reshape(read(scene)[0]["sky"]["matrix"], (3, 4))[:, :3], [(0, -1, 0), (2, 0, 0), (0, 0, 1)])


def test_a_world_of_nodes_at_its_poles():
    """An eye that sees along parallel lines sees one direction: straight down the lowest one's colour, straight up the highest one's."""
    import tempfile
    scene = common.empty_scene(4, 4, samples=1)
    world = scene.world = bpy.data.worlds.new("world")
    tree = common.tree_of(world)
    place, half = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeVectorMath")
    half.operation = "MULTIPLY_ADD"
    half.inputs[1].default_value = half.inputs[2].default_value = (0.5,) * 3
    tree.links.new(place.outputs["Generated"], half.inputs[0])
    tree.links.new(half.outputs[0], next(node for node in tree.nodes if node.type == "BACKGROUND").inputs["Color"])
    camera = common.camera(scene)
    camera.data.type, camera.data.ortho_scale, scene.render.film_transparent = "ORTHO", 1, False
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    with tempfile.TemporaryDirectory() as folder, replaced(module("export.around"), _ROWS={False: (128, 256)}):
        for turn, blue in ((0.0, 0.0), (math.pi, 1.0)):
            camera.rotation_euler = (turn, 0, 0)
            common.render(os.path.join(folder, "a.exr"))
            image = bpy.data.images.load(os.path.join(folder, "a.exr"))
            assert np.allclose(np.reshape(image.pixels[:], (-1, 4))[:, :3], (0.5, 0.5, blue), atol=0.02), (turn, image.pixels[:4])
            bpy.data.images.remove(image)


def test_where_baked_scratches_take_their_tangents():
    """From the UV map that Vector names, past reroutes; the active one's for Texture Coordinate's; none for other places."""
    images = module("scratches.images")
    common.empty_scene()
    tree = common.tree_of(bpy.data.materials.new("scratched"))
    node, way, map_, coordinates = (tree.nodes.new(kind) for kind in ("LibshadeScratchesNode", "NodeReroute", "ShaderNodeUVMap", "ShaderNodeTexCoord"))
    node.unit, node.uv_map, map_.uv_map = "UV", "own", "other"
    assert images._source(node) == ("UV", "own")
    node.unit = "METRES"
    assert images._source(node) == ("OBJECT", None)
    for source, wanted in ((map_.outputs[0], "other"), (coordinates.outputs["UV"], ""), (coordinates.outputs["Object"], None)):
        for to in (node.inputs[images.VECTOR], way.inputs[0]):
            tree.links.new(source, to)
            if to.node == way:
                tree.links.new(way.outputs[0], node.inputs[images.VECTOR])
            assert images._source(node) == ("VECTOR", wanted), (source.name, to.node.name)


def test_which_cloth_goes_with_a_scenes_unit():
    """What is so many units large, or of real size by the world's place; not what is so by its UV map."""
    size, scene = module("fabric.size"), common.empty_scene()
    tree = common.tree_of(bpy.data.materials.new("cloth"))
    place, told = tree.nodes.new("ShaderNodeNewGeometry"), []
    with bare_cloth() as (other, node):
        other.nodes.remove(node)
        for name, mode, linked in (("length", "LENGTH", False), ("world", "REAL", True), ("map", "REAL", False)):
            node = tree.nodes.new("LibshadeFabricNode")
            node.name, node.size_mode = name, mode
            if linked:
                tree.links.new(place.outputs["Position"], node.inputs["Vector"])
    size.follow_unit(scene)
    with replaced(type(tree.nodes["length"]), update_preview=lambda node, unit=None: told.append((node.name, unit))):
        size.follow_unit(scene)
        assert told == []
        scene.unit_settings.scale_length = 0.01
        size.follow_unit(scene)
        assert sorted(told) == [(name, scene.unit_settings.scale_length) for name in ("length", "world")], told


def test_pictures_of_a_sequence_are_read_as_their_image_says():
    """Each is a file that Blender has not opened: its colours are those of the image that it is a picture of."""
    import tempfile
    images, seen = module("export.image"), []
    scene = common.empty_scene()
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "a_001.png")
        made = bpy.data.images.new("a", 2, 2)
        made.filepath_raw, made.file_format = path, "PNG"
        made.save()
        reader = images.Images(module("export").Messages(), scene.frame_current)
        with replaced(images.Images, _read=lambda _self, one, _owner: seen.append((one.colorspace_settings.name, one.alpha_mode))):
            for name, alpha in (("Non-Color", "STRAIGHT"), ("sRGB", "CHANNEL_PACKED"), ("Non-Color", "NONE")):
                reader._loaded(Of(colorspace_settings=Of(name=name), alpha_mode=alpha, name=f"{name} {alpha}"), path, "owner")
                assert seen[-1] == (name, alpha), seen
    assert len(seen) == 3 and [image.name for image in bpy.data.images if image.name.startswith("a_")] == []


def test_every_image_is_averaged():
    """Where its neighbours are looked up, the next one is looked up where the point is: in a row all are averaged, as each alone is."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    scene.libshade.texture_blur = 1.0
    material, tree, showing = common.shown(False, "two")
    common.plane(material)
    where, mapping, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "Mapping", "MixRGB"))
    tree.links.new(where.outputs[0], mapping.inputs["Vector"])
    tree.links.new(mix.outputs[0], showing)
    mapping.inputs["Scale"].default_value = (2, 2, 1)
    for name, socket in (("one", mix.inputs[1]), ("two", mix.inputs[2])):
        picture = common.image_node(tree, bpy.data.images.new(name, 2, 2))
        picture.image.pack()
        tree.links.new(mapping.outputs[0], picture.inputs["Vector"])
        tree.links.new(picture.outputs["Color"], socket)
    made = [node for node in read(scene)[0]["materials"][0]["nodes"] if node["type"] == "IMAGE"]
    assert [node["image"] for node in made] == [0, 1] and all(node["averaged"] and node["at"] == made[0]["at"] and node["near"] == made[0]["near"] for node in made), made
    # a sixteenth of a sixteenth along u and along v, twice as far by the mapping
    assert made[0]["step"] == 1 / 256
    scene.libshade.texture_blur = 0.0
    assert not any(node.get("averaged") for node in read(scene)[0]["materials"][0]["nodes"])


def test_a_map_that_is_not_everybodys_active_one():
    """A map by name is the meshes' own where it is the active one of all who wear the material, else they have it beside theirs."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    material, tree, showing = common.shown(False, "mapped")
    where, picture = tree.nodes.new("ShaderNodeUVMap"), common.image_node(tree, bpy.data.images.new("grey", 2, 2))
    picture.image.pack()
    where.uv_map = "first"
    tree.links.new(where.outputs[0], picture.inputs["Vector"])
    tree.links.new(picture.outputs["Color"], showing)
    plates = [common.plane(material) for _ in range(2)]
    for plate in plates:
        plate.data.uv_layers[0].name = "first"
        for loop in plate.data.uv_layers.new(name="second").data:
            loop.uv = (0.25, 0.75)
    for active in (("first", "first"), ("first", "second"), ("second", "second")):
        for plate, name in zip(plates, active):
            plate.data.uv_layers[name].active_render = True
            plate.data.update()
        found, said = read(scene)
        spans = [np.ptp(np.reshape(mesh["corner_uvs"], (-1, 2)), axis=0).tolist() for mesh in found["meshes"]]
        assert not said and spans == [[1, 1]] * 2, (active, spans)


def test_an_edited_draft_is_followed_once():
    """By the materials and groups whose cloth reads it, and no others; then no more until it is edited again."""
    common.empty_scene()
    draft, told = module("fabric.draft"), []
    texts = {name: bpy.data.texts.new(name) for name in ("mine.wif", "other.wif", "unused.wif")}
    with bare_cloth() as (_tree, node), bare_cloth() as (_other, beside_it):
        node.name, beside_it.name = "one", "two"
        node.draft, beside_it.draft = texts["mine.wif"], texts["other.wif"]
        draft._seen.clear()
        with replaced(type(node), update_preview=lambda of, *_more, **_by: told.append(of.name)), replaced(draft, maps=Of(sweep=lambda: told.append("swept"))):
            for edited, wanted in ((None, []), ("mine.wif", ["one"]), (None, []), ("other.wif", ["two"]), ("unused.wif", []), (None, []), ("mine.wif", ["one"]), (None, [])):
                if edited:
                    texts[edited].write("x")
                told.clear()
                assert draft.follow() == 0.5 and told == ["swept", *wanted], (edited, told)
    assert bpy.app.timers.is_registered(draft.follow)


def test_a_groove_is_added_where_the_mouse_is():
    """Chosen alone, and it moves with the mouse; in shader trees of this file."""
    common.empty_scene()
    groove, tree, asked = module("groove"), common.tree_of(bpy.data.materials.new("steel")), []
    before, place = list(tree.nodes), []
    space = Of(tree_type="ShaderNodeTree", edit_tree=tree, cursor_location=(12, 34), cursor_location_from_region=lambda x, y: place.append((x, y)))
    for node in before:
        node.select = True
    fake = Of(execute=lambda context: groove.LIBSHADE_OT_add_groove.execute(fake, context))
    with replaced(groove, bpy=Of(data=bpy.data, ops=Of(node=Of(translate_attach_remove_on_cancel=asked.append)))):
        assert groove.LIBSHADE_OT_add_groove.invoke(fake, Of(space_data=space), Of(mouse_region_x=5, mouse_region_y=6)) == {"FINISHED"}
    new, = set(tree.nodes) - set(before)
    assert place == [(5, 6)] and asked == ["INVOKE_DEFAULT"] and tuple(new.location) == (12, 34) and new.label == "Libshade Groove" == new.node_tree.name
    assert tree.nodes.active == new and not any(node.select for node in before)
    may = groove.LIBSHADE_OT_add_groove.poll
    assert [may(Of(space_data=one)) for one in (space, Of(tree_type="ShaderNodeTree", edit_tree=None), Of(tree_type="GeometryNodeTree", edit_tree=tree), Of(),
                                                Of(tree_type="ShaderNodeTree", edit_tree=Of(library="a.blend")))] == [True, False, False, False, False]


def test_when_a_view_is_drawn_again():
    """At once where there is something new, later where there will be, and not where all is done."""
    engine, done = module("engine"), []
    fake = Of(update_stats=lambda *said: done.append(said), tag_redraw=lambda: done.append("again"))
    for more, news, wanted in ((True, True, "again"), (True, False, "watched"), (False, True, None), (False, False, None)):
        done.clear()
        fake._viewport = Of(draw=lambda *_which, more=more: ("a text", more), has_news=lambda news=news: news, scene_changed=done.append)
        with replaced(engine, _watch=lambda one: done.append("watched" if one is fake else one)):
            engine.LibshadeEngine.view_draw(fake, None, None)
        assert done == [("libshade", "a text"), *([wanted] if wanted else [])], (more, news)
        done.clear()
        assert engine.LibshadeEngine.look(fake) == news and done == ["again"] * news
    engine.LibshadeEngine.view_update(fake, None, "a depsgraph")
    assert done[-1] == "a depsgraph"
    made = Of(_viewport=None)
    with replaced(engine, Viewport=lambda: Of(scene_changed=done.append)):
        engine.LibshadeEngine.view_update(made, None, "of another")
    assert done[-1] == "of another" and made._viewport
    # a view that could not be drawn is not asked for again until it is another
    viewport, view = module("viewport"), object()
    shown = viewport.Viewport()

    def fails(*_which):
        raise module("export").SceneError("no camera")
    shown._advance = fails
    with replaced(viewport, _view_of=lambda *_which: view):
        assert shown.draw(None, Of(space_data=None), Of(scene=common.empty_scene())) == ("no camera", False) and shown._view is view
    module("report")._forget()
    # how long a redraw waits: longer for the first picture after an edit, which most often is there then
    waited, shown = [], viewport.Viewport()
    shown._scene, shown._fetch = {"samples": 4}, lambda: None
    native = Of(start=lambda *_given: "job", wait=lambda _job, seconds: waited.append(seconds), poll=lambda _job: {"state": "running", "stage": "build"}, look=lambda *_given: "job")
    picture = viewport._picture(viewport._View((8, 6), Matrix.Identity(4), Matrix.Identity(4), (0.1, 9), (0, 0, 8, 6)), 2, 4)
    with replaced(viewport, _native=native):
        shown._make(picture, first=True)
        shown._make(picture)
    assert waited == [0.08, 0.02] and not shown._waiting


def test_what_dumps_say_of_shadow_catchers():
    scene = common.empty_scene(4, 4, 1)
    common.camera(scene)
    common.light(scene)
    plate = common.plane()
    held, words = os.environ.get("LIBSHADE_DUMP", ""), "a dump shows shadow catchers as they are"
    try:
        for catches, dump, said in ((True, "dump.exr", True), (False, "dump.exr", False), (True, "", False)):
            plate.is_shadow_catcher, os.environ["LIBSHADE_DUMP"] = catches, dump and os.path.join(bpy.app.tempdir, dump)
            bpy.ops.render.render()
            assert ((words, False) in module("report").told(scene)) == said, (catches, dump, module("report").told(scene))
    finally:
        os.environ["LIBSHADE_DUMP"] = held


def test_what_lies_in_a_file_of_an_image():
    """Integers of 16 bits, in PNG and TIFF of either order; not floats, other widths, files that end too soon or are not read."""
    images, path = module("export.image"), os.path.join(bpy.app.tempdir, "picture")

    def tiff(order, bits, kind=None, mark=None):
        rows = [(258, 3, 1, bits)] + ([(339, 3, 1, kind)] if kind else [])
        body = struct.pack(order + "H", len(rows)) + b"".join(struct.pack(order + "HHI", *row[:3]) + struct.pack(order + "HH", row[3], 0) for row in rows)
        return (mark or {"<": b"II*\0", ">": b"MM\0*"}[order]) + struct.pack(order + "I", 26) + bytes(18) + body + bytes(4)
    png = lambda bits: b"\x89PNG\r\n\x1a\n" + bytes(16) + bytes([bits, 2])
    for data, wanted in ((png(16), True), (png(8), False), (png(16)[:25], False), (b"\x89PNX" + png(16)[4:], False), (tiff("<", 16), True), (tiff(">", 16), True), (tiff("<", 8), False),
                         (tiff("<", 16, 1), True), (tiff("<", 16, 3), False), (tiff(">", 32, 3), False), (tiff("<", 16)[:28], False), (tiff("<", 16, mark=b"II+\0"), False), (b"", False)):
        with open(path, "wb") as file:
            file.write(data)
        with replaced(images, _absolute=lambda _image, where: where):
            for on_disk in (True, False):
                with replaced(images, _is_on_disk=lambda _image, on_disk=on_disk: on_disk):
                    assert images._is_of_integers(Of(filepath=path)) == (wanted and on_disk), (data, on_disk)
            os.remove(path)
            with replaced(images, _is_on_disk=lambda _image: True):
                assert images._is_of_integers(Of(filepath=path)) is False
    assert [images._is_on_disk(Of(**{"packed_file": None, "is_dirty": False, "source": "FILE", **change})) for change in (
        {}, {"packed_file": 1}, {"is_dirty": True}, {"source": "GENERATED"}, {"source": "MOVIE"})] == [True, False, False, False, True]
    # of a movie what a texture of its own shows, which goes whatever happens
    made, gone = Of(image=None, image_user=Of(frame_current=0), evaluate=lambda at: None), []
    fake = Of(data=Of(textures=Of(new=lambda _name, kind: kind == "IMAGE" and made, remove=gone.append)))
    with replaced(images, bpy=fake):
        assert images.Images._movie(Of(_read=lambda image, owner: (image, owner)), "film", 7, "steel") == ("film", "steel")
        assert (made.image, made.image_user.frame_current, gone) == ("film", 7, [made])
        assert raised(images.Images._movie, Of(_read=lambda *_which: 1 / 0), "film", 7, "steel") and gone == [made, made]


def test_tiles_as_one_image():
    """As large as the largest, beside and above each other; where there is none it is pink; bytes and floats together are floats; one that is beyond
    0 to 1 is enough."""
    images = module("export.image")
    bytes_ = {"width": 2, "height": 1, "channels": 3, "data": np.array([255, 0, 51, 0, 255, 102], np.uint8), "srgb": True, "wide": False, "straight": True}
    floats = {"width": 2, "height": 1, "channels": 4, "data": np.float32([3, 0, 0, 0.5, 0, 3, 0, 1]), "srgb": True, "wide": True, "straight": False}
    tiled = lambda *numbers: Of(name="map", source="TILED", filepath="a.<UDIM>.png", packed_files=(), tiles=[Of(number=number) for number in numbers])
    with replaced(images, _absolute=lambda _image, path: path):
        def whole(**files):
            return images.Images._tiled(Of(_loaded=lambda _image, path, _owner, _packed: files.get("at" + path.split(".")[1]), _messages=None), tiled(1001, 1002, 1011), "m", True)
        made = whole(at1001=bytes_, at1002=bytes_)
        assert (made["width"], made["height"], made["channels"], made["data"].dtype, made["wide"], made["straight"], made["srgb"]) == (4, 2, 3, np.uint8, False, True, True)
        rows = made["data"].reshape(2, 4, 3)
        assert rows[0].tolist() == [[255, 0, 51], [0, 255, 102]] * 2 and (rows[1] == (255, 0, 255)).all()
        made = whole(at1001=bytes_, at1011=floats)
        assert made["channels"] == 4 and made["data"].dtype == np.float32 and made["wide"] is True and made["straight"] is True
        rows = made["data"].reshape(2, 4, 4)
        assert close(rows[0, :2], [[1, 0, 0.2, 1], [0, 1, 0.4, 1]]) and close(rows[1, :2], [[3, 0, 0, 0.5], [0, 3, 0, 1]]) and (rows[:, 2:] == (1, 0, 1, 1)).all()
        assert whole() == images.MISSING


def test_what_old_nodes_show_and_images_that_stay():
    """A button that renews it, and the numbers that no socket says; images that others have go on when a node drops its own."""
    common.empty_scene()
    nodes, (_material, _tree, node) = module("nodes"), common.metal()

    def shown():
        drawn = []
        type(node).draw_buttons(node, Of(object=None), Layout(drawn))
        return drawn
    with replaced(nodes, is_old=lambda _node: True):
        assert shown() == ["libshade.metal_preset", "libshade.update_nodes"]
        with replaced(nodes, SHAPE=("of", "before")):
            for node.distribution, numbers in (("ASHIKHMIN_SHIRLEY", ["ex", "ey"]), ("GGX", ["ax", "ay"])):
                assert shown() == ["libshade.metal_preset", "libshade.update_nodes", *numbers], shown()
    images = module("scratches.images")
    tree, other = bpy.data.node_groups.new("baked", "ShaderNodeTree"), bpy.data.node_groups.new("other", "ShaderNodeTree")
    pictures = {name: bpy.data.images.new(name, 2, 2) for name in ("alone", "shared")}
    for picture in pictures.values():
        tree.nodes.new("ShaderNodeTexImage").image = picture
    other.nodes.new("ShaderNodeTexImage").image = pictures["shared"]
    baked = Of(node_tree=tree, baked="[1]")
    images.drop(baked)
    assert [name in bpy.data.images for name in ("alone", "shared")] == [False, True] and "baked" not in bpy.data.node_groups
    assert module("scratches.tree").is_plain(baked.node_tree) and baked.baked == ""
    images.drop(baked)
    assert bpy.data.node_groups.get(baked.node_tree.name) == baked.node_tree  # nodes without images share one


def test_whom_measuring_and_animation_ask():
    """Objects that wear such cloth, but not those of other files; of an animated cloth its gaps and its size are those of the frame."""
    scene = common.empty_scene()
    size, tree = module("fabric.size"), module("fabric.tree")
    wears, other = bpy.data.materials.new("wears"), bpy.data.materials.new("other")
    thing = lambda **about: Of(**{"type": "MESH", "library": None, "material_slots": [Of(material=wears)], **about})
    things = [thing(library="a.blend"), thing(material_slots=[Of(material=other), Of(material=None)], library="a.blend"), thing(type="CURVE", library="a.blend"),
              thing(material_slots=[Of(material=other), Of(material=wears)], library="a.blend")]
    with replaced(size, is_measured=lambda material: material == wears):
        assert size.measure(Of(objects=things)) == (0, 2)
        plate = common.plane(wears)
        plate.data.uv_layers[0].data[0].uv = plate.data.uv_layers[0].data[0].uv  # as long as wide
        assert size.measure(scene) == (1, 0) and close([plate["libshade_metres"], plate["libshade_metres_of_unit"]], (2, 1))
    asked = []
    with bare_cloth() as (_one, node), bare_cloth() as (_two, animated):
        node.open_gaps, node.size_mode, animated.open_gaps, animated.size_mode = False, "LENGTH", True, "REPEATS"
        fabric = module("fabric.node")
        made = {"repeat": (2, 4), "per_unit": (1000, 2000)}
        with replaced(tree, can_update=lambda _tree: True, is_stand_in=lambda _tree: False, update=lambda *given: asked.append(given[1:])), \
                replaced(fabric, own_tree=lambda _node: None), replaced(fabric.maps, of=lambda _said: made, may_show=lambda _made: may[0]):
            may = [True]
            node.update_preview(0.5, animated)
            node.update_preview(0.5)
            assert [(real, unit, gaps) for _made, _name, real, unit, gaps in asked] == [(None, 0.5, True), (None, 0.5, False)], asked
            animated.size_mode = "REAL"
            asked.clear()
            node.update_preview(0.5, animated)
            assert asked[0][2:] == ("MAP", 0.5, True) and close(node.repeat_mm, (2, 2))  # millimetres of 2 in 1000 and of 4 in 2000
            may[0] = False
            asked.clear()
            node.update_preview(0.5, animated)
            assert asked == []


def test_how_long_a_unit_of_cloth_is():
    """Of a map or of an object's space an attribute says it, of the world the scene's unit, and cloth in repeats is not measured: 1."""
    fabric = module("fabric.tree")
    tree = bpy.data.node_groups.new("measured", "ShaderNodeTree")
    nodes = {name: tree.nodes.new(kind) for name, kind in ((fabric._PLACE, "ShaderNodeMath"), (fabric._METRES, "ShaderNodeAttribute"), (fabric._KNOWN, "ShaderNodeMath"))}
    for name, node in nodes.items():
        node.name = name
    metres = nodes[fabric._PLACE].inputs[0]
    metres.name = "Metres"
    for real, unit, linked, said in (("WORLD", 0.01, False, 0.01), (None, 0.01, False, 1.0), ("MAP", 0.01, True, "libshade_metres"), ("OBJECT", 2.0, True, "libshade_metres_of_unit"),
                                     ("WORLD", 1000.0, False, 1000.0), ("OBJECT", 1.0, True, "libshade_metres_of_unit"), (None, 3.0, False, 1.0)):
        fabric._measure(tree, real, unit)
        assert metres.is_linked == linked, (real, unit)
        assert close(metres.default_value, said) if not linked else nodes[fabric._METRES].attribute_name == said, (real, unit)


def test_eyes_beside_each_other():
    """An eye's picture is the camera's moved aside by so much of its longest side, as wide and as high."""
    scene = common.empty_scene()
    camera, camera_of, told = common.camera(scene, (0, 0, 5)), module("export.camera").camera_of, module("export").Messages()
    for size, aspect, longest in (((64, 48), (1, 1), 1.0), ((48, 64), (1, 1), 4 / 3), ((64, 64), (1, 2), 2.0)):
        scene.render.pixel_aspect_x, scene.render.pixel_aspect_y = aspect
        for own in (0.0, 0.125):
            camera.data.shift_x = own
            bpy.context.view_layer.update()
            depsgraph = bpy.context.evaluated_depsgraph_get()
            plain, there = camera_of(camera, depsgraph, size, told), Matrix.Translation((0.5, 0, 5))
            seen = camera_of(camera, depsgraph, size, told, (there, own + 0.25))
            left, right, *rest = plain["frame"]
            assert close(seen["frame"], (left + 0.25 * longest * (right - left), right + 0.25 * longest * (right - left), *rest)), (size, aspect, own)
            assert close(np.reshape(seen["matrix"], (4, 4)), there)
            assert camera_of(camera, depsgraph, size, told, (camera.matrix_world, own)) == plain
    # of another lens of the same shift Blender itself says so
    scene.render.pixel_aspect_x = scene.render.pixel_aspect_y = 1
    camera.data.shift_x = 0.375
    bpy.context.view_layer.update()
    assert close(camera_of(camera, bpy.context.evaluated_depsgraph_get(), (48, 64), told)["frame"][:2], np.add((-0.27, 0.27), 0.375 * 0.72))


def test_whose_draft_is_imported():
    """Of the node that the editor shows: its material, or the group that holds it; without one none is named."""
    common.empty_scene()
    invoke, group = module("fabric.draft").LIBSHADE_OT_import_wif.invoke, bpy.data.node_groups.new("inside", "ShaderNodeTree")
    with bare_cloth() as (tree, node):
        inner = group.nodes.new("LibshadeFabricNode")
        material = next(m for m in bpy.data.materials if m.node_tree == tree)
        for shown, wanted in ((node, (material.name, "", node.name)), (inner, ("", "inside", inner.name)), (None, ("", "", "")), (tree.nodes.new("ShaderNodeBump"), ("", "", ""))):
            asked = Of(material="", group="", node="")
            with contextlib.suppress(TypeError):  # a stand-in has no file browser
                invoke(asked, Of(node=shown, active_node=None), None)
            assert (asked.material, asked.group, asked.node) == wanted, wanted


def test_words_of_images_that_cannot_be_read():
    """By whose they are: a movie, a colour space and a file that Blender gives up on."""
    images, said = module("export.image"), []
    table = images.Images(Of(warning=said.append), 1)

    def fails(*_which):
        raise RuntimeError(" no way \n")
    image = bpy.data.images.new("map", 2, 2)
    there = os.path.join(bpy.app.tempdir, "there")
    with open(there, "wb") as file:
        file.write(b"x")
    movie = Of(name="film", source="MOVIE", filepath=there, packed_file=None, is_dirty=False, size=(2, 2), library=None)
    with replaced(images, on_main_thread=fails, _absolute=lambda _image, path: path):
        assert table._fetch(movie, "material 'steel'", 3) == images.MISSING and said.pop() == "material 'steel': image 'film': no way"
        assert table._loaded(image, there, "material 'steel'") is None and said.pop() == f"material 'steel': {there}: no way"
        bytes_ = np.arange(12, dtype=np.uint8)
        odd = Of(name="map", channels=3, colorspace_settings=Of(name="ACES"))
        assert table._in_scene_light(odd, bytes_, "pages", "material 'steel'") == (bytes_, "pages", False)
        assert said.pop() == "material 'steel': image 'map': colour space 'ACES' is read as Non-Color (no way)"
    # else each colour becomes what Blender makes of it, and alpha stays
    halved = lambda colors, space: np.stack([(colors >> 8 * (2 - k) & 255) / 510 for k in range(3)], 1).astype(np.float32)
    with replaced(images, _converted=halved):
        for channels, data, wanted in ((3, [10, 20, 30, 250, 0, 255], [10, 20, 30, 250, 0, 255]), (4, [10, 20, 30, 51], [10, 20, 30, 102]), (1, [7, 9], [7, 9]), (2, [7, 51], [7, 102])):
            found, _pages, wide = table._in_scene_light(Of(name="map", channels=channels, colorspace_settings=Of(name="ACES")), np.array(data, np.uint8), None, "m")
            assert close(found, np.divide(wanted, 510)) and not wide, channels
    with replaced(images, _converted=lambda colors, _space: np.full((len(colors), 3), 1.5, np.float32)):
        assert table._in_scene_light(odd, bytes_, None, "m")[2]
    bpy.data.images.remove(image)


def test_what_coordinates_of_cloth_count():
    """Units of the world's space or the object's, wherever in what feeds Vector they come from; else those of the map. So do our engine and Cycles."""
    common.empty_scene()
    size, cloth = module("fabric.size"), module("export.cloth")
    with bare_cloth() as (tree, node):
        geometry, place, mapping, mix, turn = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "TexCoord", "Mapping", "VectorMath", "VectorRotate"))
        node.size_mode = "REAL"
        tree.links.new(mapping.outputs[0], node.inputs["Vector"])
        tree.links.new(mix.outputs[0], mapping.inputs["Vector"])
        tree.links.new(turn.outputs[0], mix.inputs[1])
        for source, wanted in ((geometry.outputs["Position"], "WORLD"), (geometry.outputs["Normal"], "MAP"), (place.outputs["Object"], "OBJECT"), (place.outputs["UV"], "MAP")):
            for to in (turn.inputs["Vector"], mix.inputs[0], node.inputs["Vector"]):
                link = tree.links.new(source, to)
                assert size.space_of(node) == cloth._space(node.inputs["Vector"], (), set()) == wanted, (source.name, to.node.name)
                assert size.space_of(node, "LENGTH") is None and size.space_of(node, "REPEATS") is None
                tree.links.remove(link)
                if to.node == node:
                    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
        assert size.space_of(node) == "MAP"
        node.size_mode = "LENGTH"
        assert size.space_of(node) is None and size.space_of(node, "REAL") == "MAP"
        asked = []
        reader = Of(unit_of_length=lambda: 0.25, measures=lambda: asked.append("measured"))
        with replaced(cloth, of_object=lambda _reader, what: (7, 8) if what == "METRES" else None):
            for space, wanted, measured in (("WORLD", 0.25, []), ("MAP", 7, ["measured"]), ("OBJECT", 8, ["measured"])):
                asked.clear()
                with replaced(cloth, _space=lambda *_which, space=space: space):
                    assert cloth._metres(reader, node, ()) == wanted and asked == measured, space
            assert cloth._metres(reader, Of(inputs={}), ()) == 7
        # where its place differs a step on, along u and along v, it is read there as well
        steps = []
        reader = Of(shift=None, is_main=steps.append)
        with replaced(cloth, place=lambda reader, *_which: steps.append(reader.shift) or (1, 2, 3)):
            assert cloth._vector(reader, node, ()) == [1, 2] * 3 and steps == [None, (cloth._STEP, 0), (0, cloth._STEP)] and reader.shift is None
        with replaced(cloth, place=lambda *_which: None):
            assert cloth._vector(reader, node, ()) is None and cloth._vector(reader, Of(inputs={}), ()) is None and steps[-1] == ""


def test_a_number_of_an_older_cloth_is_edited():
    """Its other numbers become those of its preset, but not that one. How much weft shows is by its weave, or its draft where that is one."""
    common.empty_scene()
    yarns = module("fabric.yarns")
    with bare_cloth() as (_tree, node), bare_cloth() as (_other, fresh):
        node.preset = fresh.preset = "DENIM"
        node.weft_width, node.warp_gap = 0.123, 0.456
        node.preset, node.based_on = "DENIM", ""
        node.warp_gap = 0.3
        assert (node.preset, node.based_on) == ("CUSTOM", "DENIM") and close(node.warp_gap, 0.3)
        assert all(close(getattr(node, f"{yarn}_{word}"), getattr(fresh, f"{yarn}_{word}")) for yarn in yarns.YARNS for word in yarns.numbers() if (yarn, word) != ("warp", "gap"))
        node.warp_gap = 0.2  # and from then on as of any other
        assert close(node.warp_gap, 0.2) and yarns._filling == [False]
        text = bpy.data.texts.new("plain.wif")
        text.write(WIF)
        node.weave, node.draft = "DRAFT", text
        assert close(yarns.weft_share(node), 0.5)
        text.write("no draft [")
        text.clear()
        assert close(yarns.weft_share(node), yarns.weft_share(fresh))  # of one that cannot be read: as its preset
        for node.weave, share in (("PLAIN", 1 / 2), ("TWILL_3_1", 1 / 4), ("TWILL_1_2", 2 / 3), ("SATIN_8", 1 / 8), ("SATEEN_5", 4 / 5), ("BASKET", 1 / 2)):
            assert close(yarns.weft_share(node), share), node.weave


def test_what_is_said_of_a_lamps_nodes():
    """What makes it uneven in two ways at once, what does not shine, what cannot be read; lamps of the same nodes are asked once, where no place counts."""
    light, said, asked = module("export.light"), [], []
    lamp, messages = Of(name="bulb", type="AREA"), Of(warning=said.append)
    table = Of(unknown=Of(name=lambda own, warn: warn("odd")), shines={})

    def seen(shine=None, kind="EMISSION", error=None):
        def made(own, owner, _table, _messages, lamp):
            asked.append((own, owner, lamp))
            if error:
                raise error
            return shine
        said.clear()
        asked.clear()
        found = Of(node=Of(name="Red", type=kind)) if kind else None
        with replaced(light, Shine=made, tree=Of(of=lambda _lamp: "nodes", shader_of=lambda _own: found), _face_of=lambda _lamp: "a face"):
            return light._shine(lamp, "place", table, messages)
    shines = lambda **about: Of(**{"mixed": False, "there": True, "turns": False, "color": (1, 2, 3), "even": lambda: "even", "pattern": lambda: ((4, 5, 6), "uneven"), "placed": False, **about})
    assert seen(kind=None) == (((0, 0, 0), None), False) and said == ["light 'bulb': odd"] and not asked
    assert seen(shines()) == (((1, 2, 3), "even"), False) and asked == [("nodes", "light 'bulb'", ("AREA", "place", "a face"))] and len(said) == 1
    assert seen(shines(turns=True, placed=True)) == (((4, 5, 6), "uneven"), True)
    seen(shines(mixed=True))
    assert [lamp for *_which, lamp in asked] == [("AREA", "place", "a face"), ("AREA", "place")]
    assert said[1:] == ["light 'bulb': nodes that make it uneven by direction and over its face at once are not supported; all of its face is as its middle"]
    assert seen(shines(there=False)) == (((1, 2, 3), "even"), False) and len(said) == 1
    assert seen(shines(there=False), "BSDF_DIFFUSE") == (((1, 1, 1), None), False) and said[1:] == ["light 'bulb': 'Red' is not supported; its nodes are left out"]
    for error, why in ((ValueError("images are too many"), "images are too many"), (RecursionError(), "its nodes are too many"), (module("export.graph").TooLarge(), "its nodes are too many")):
        assert seen(error=error) == (((1, 1, 1), None), False) and said[1:] == [f"light 'bulb': {why}; they are left out"]
    lamp = type("Lamp", (), {"energy": 2.0, "color": (1.0, 0.5, 0.25)})()
    places = (Matrix.Translation((1, 0, 0)), Matrix.Rotation(1.0, 4, "X"), Matrix.Diagonal((2, 1, 1, 1)))
    for placed, times in ((False, 2), (True, 3)):
        asked.clear()
        table.shines = {}
        with replaced(light, tree=Of(of=lambda _lamp: "nodes"), _shine=lambda *_which, placed=placed: asked.append(1) or (((3, 2, 4), {"width": 5}), placed)):
            for place in (*places, places[0]):
                strength, more = light._strength(lamp, place, table, messages)
                assert close(strength, (6, 2, 2)) and more["pattern"]["width"] == 5 and len(more["pattern"]["axes"]) == 9
            assert close(light._strength(lamp, places[1], table, messages)[1]["pattern"]["axes"], [1, 0, 0, 0, math.cos(1), math.sin(1), 0, -math.sin(1), math.cos(1)])
        assert len(asked) == times, (placed, asked)


def test_words_of_what_is_left_out():
    """Each begins with whose it is, and ends in what is shown in its place."""
    said, part = [], lambda name: module(f"export.{name}")

    class Inputs(list):
        def get(self, _name):
            return None
    varies = object.__new__(part("graph").Register)
    spread = Of(name="Red", inputs={"Color": 1, "Roughness": 2, "Subsurface Weight": 3, "Subsurface Anisotropy": 4, "Thin Wall": 5, "IOR": 6,
                                    "Filter Width": Of(is_linked=True, default_value=1.5), "Normal": 7, "Height": 8})
    reader = Of(warn=said.append, program=Of(math=lambda *_given: 0.0), in_height=True, owner="it", open=[(spread, ())], closures=[], nodes={}, known={(1, (), 0): None}, shift=0,
                images=Of(turned=lambda *_which: 0.031, index=lambda *_which: 0))
    found = Of(node=Of(name="Red", operation="ODD", type="ODD", bl_idname="Odd", internal_links=[], inputs=Inputs([Of(type="SHADER", is_linked=True)])), output=Of(name="Out", type="VALUE"), groups=())
    messages = Of(warning=said.append)
    ob = Of(name="ball", modifiers=[Of(type="NODES")], original=Of(light_linking=Of(blocker_collection="some")))
    depsgraph = Of(scene=Of(render=Of(use_motion_blur=True, motion_blur_shutter=0.5)), view_layer=Of(use_pass_vector=True))

    def too_deep(*_which):
        raise RecursionError
    table = (
        ("node_color", "_math", (reader, found), {"number_in": lambda *_: 1.5}, "'Red': odd is not supported; its first input is used"),
        ("node_color", "_vector_math", (reader, found), {"vector_in": lambda *_: (1, 2, 3)}, "'Red': odd is not supported; its first input is used"),
        ("node_color", "_blend", (reader, Of(name="Red", blend_type="ODD"), 0.0, (1,), (2,)), {}, "'Red': blending by odd is not supported; mixed"),
        ("node_normal", "_check_steepness", (reader, Of(name="map"), 0, 1.0), {},
         "normal map 'map' turns normals by more than 50 degrees in 3 % of it: there lights may look otherwise than in Cycles"),
        ("node_normal", "_filter_width", (reader, spread), {}, "'Red': what feeds Filter Width is left out, as in Cycles"),
        ("node_normal", "_bump", (reader, Of(node=spread, groups=())), {"normal_of": lambda *_: None}, "'Red' bends a normal that a height depends on; left out"),
        ("node_scratches", "_normal", (reader, Of(node=spread, groups=()), 0.0), {"normal_of": lambda *_: None}, "'Red' bends a normal that a height depends on; left out"),
        ("node_stand_in", "_told", (reader, found, None), {}, "'Red' (Out): what it depends on differs from place to place; 0"),
        ("node_tiling", "_radial_tiling", (reader, found), {"number_in": lambda *_: varies}, "'Red': Sides and Roundness that differ from place to place are not supported; 5 and 0 are used"),
        ("node_tiling", "_radial_tiling", (reader, found), {"number_in": lambda _reader, _found, name: {"Sides": 2.0, "Roundness": 0.5}[name]},
         "'Red': Roundness of two sides is not supported; its corners are sharp"),
        ("node_tiling", "_radial_tiling", (reader, found), {"number_in": lambda _reader, _found, name: {"Sides": 2.5, "Roundness": 1.0}[name]},
         "'Red': Roundness of a part of a side is not supported; its corners are sharp"),
        ("node_image", "image_of", (reader, Of(name="Red", image="one", extension="ODD", interpolation="Linear", image_user=None, outputs={})), {},
         "'Red': extension odd is not supported; repeated"),
        ("node_image", "image_of", (reader, Of(name="Red", image="one", interpolation="Odd", image_user=None, outputs={})), {}, "'Red': interpolation odd is not supported; linear"),
        ("node_image", "image_of", (reader, Of(name="Red", image=None)), {}, "'Red' has no image"),
        ("closure", "_unknown", (reader, found, 1.0), {"collect": lambda *_: None}, "'Red' is not supported; what feeds it is used"),
        ("closure", "collect", (reader, "socket", ()), {"tree": Of(trace=lambda *_: Of(node=spread, groups=()))}, "'Red' feeds itself; the link is left out"),
        ("closure_light", "ray_portal", (reader, spread, (), 1.0), {"transparent": lambda *_: None}, "'Red': light that goes on elsewhere is not supported; shaded as a Transparent BSDF"),
        ("closure_matt", "subsurface", (reader, spread, (), 1.0), {"spreads": lambda *_: True}, "'Red': light below the surface is not supported; shaded as a Diffuse BSDF of its colour"),
        ("closure_metal", "glossy", (reader, Of(name="Red", distribution="ODD", inputs=spread.inputs), (), 1.0), {name: lambda *_: None for name in ("color_of", "alpha_of", "normal_in")},
         "'Red': odd is not supported; shaded as GGX"),
        ("closure_principled", "_is_thin", (reader, spread, ()), {"number_of": lambda *_: varies}, "'Red': a Thin Wall that differs from place to place is not supported; left out"),
        ("closure_thin", "beyond", (reader, spread, (), 0.5), {"number_of": lambda *_: 0.5, "clamped": lambda _reader, number: number},
         "'Red': Diffuse Roughness of a Thin Wall's other side is not supported; left out"),
        ("closure_add", "_warn_of_steps", (reader, {"closure": "GLASS", "alpha": [1e-4]}, "map", 1.0), {},
         "normal map 'map' has 8 bits: its steps show in highlights as sharp as these; use 16 bits or float"),
        ("value", "_value", (reader, found, Of(name="Color")), {}, "Color: 'Red' (Out) is not supported; what feeds it is used, or the socket's own value"),
        ("attributes", "Attributes._of_nodes", (Of(_messages=messages), Of(parent=ob), "tone"), {},
         "object 'ball': what its geometry nodes say of instances ('tone') is not known to Python in this Blender; left out"),
        ("layers", "uv_layer", (Of(uv_layers={}), "map", "ball", messages), {}, "object 'ball': no UV map 'map'; 0 is used, as in Cycles"),
        ("light", "name_shading", (ob, None, None, messages), {},
         "object 'ball': shadow linking of what shines unevenly, moves or is hidden from some rays is not supported; all objects shade its light"),
        ("motion", "motion_of", ("engine", depsgraph, "camera", "dump.exr", messages), {},
         ["the Vector pass is empty where motion is blurred, as in Cycles", "a dump has no motion blur: all is as it is at the frame"]),
        ("aov", "read_into", (reader, None, "tone", "VALUE", None, False, False), {"_finished": too_deep},
         "its nodes are too many for the pass 'tone'; left out"))
    for name, function, given, parts, words in table:
        owner, call = part(name), part(name)
        for word in function.split("."):
            call = getattr(call, word)
        with replaced(owner, **parts):
            with contextlib.suppress(Exception):  # of what stands in for the rest
                call(*given)
        assert said == ([words] if isinstance(words, str) else words), (name, function, said)
        said.clear()
    still = lambda blurs, shutter, vectors: Of(scene=Of(render=Of(use_motion_blur=blurs, motion_blur_shutter=shutter)), view_layer=Of(use_pass_vector=vectors))
    quiet = (
        ("motion", "motion_of", ("engine", still(False, 0.5, True), "camera", "dump.exr", messages), {"Motion": lambda *_: None}),
        ("motion", "motion_of", ("engine", still(True, 0.0, False), "camera", "dump.exr", messages), {}), ("motion", "motion_of", ("engine", still(True, 0.5, False), "camera", "", messages), {"Motion": lambda *_: None}),
        ("node_normal", "_check_steepness", (Of(images=Of(turned=lambda *_which: 0.02), warn=said.append), Of(name="map"), 0, 1.0), {}),
        ("node_normal", "_filter_width", (reader, Of(inputs={"Filter Width": Of(is_linked=False, default_value=1.5)})), {}), ("node_normal", "_filter_width", (reader, Of(inputs={})), {}),
        ("node_stand_in", "_told", (reader, found, 0), {}),
        *(("node_tiling", "_radial_tiling", (reader, found), {"number_in": lambda _reader, _found, name, sides=sides, roundness=roundness: {"Sides": sides, "Roundness": roundness}[name]})
          for sides, roundness in ((5.0, 0.5), (2.5, 0.0), (2.0, 0.0), (2.0, 1.0))),
        ("closure_matt", "subsurface", (reader, spread, (), 1.0), {"spreads": lambda *_: False}),
        *(("closure_thin", "beyond", (reader, spread, (), roughness), {"number_of": lambda *_, below=below: below, "clamped": lambda _reader, number: number}) for below, roughness in ((0.5, 0.0), (0.0, 0.5))),
        *(("closure_add", "_warn_of_steps", (reader, closure, "map", 1.0), {}) for closure in (
            {"closure": "GLASS", "alpha": [0.5]}, {"closure": "DIFFUSE"}, {"closure": "METAL", "f0": (0, 0, 0), "ax": 1e-4, "ay": 1e-4}, {"closure": "METAL", "f0": (1, 1, 1), "ax": 0.5, "ay": 0.5})),
        ("layers", "uv_layer", (Of(uv_layers={"map": "it"}), "map", "ball", messages), {}), ("layers", "uv_layer", (Of(uv_layers=[]), "", "ball", messages), {}),
        ("light", "name_shading", (Of(name="ball", original=Of(light_linking=Of(blocker_collection=None))), None, None, messages), {}),
        ("light", "name_shading", (ob, "mesh", Of(shines_evenly=lambda _mesh: True), messages), {}),
        ("attributes", "Attributes._of_nodes", (Of(_messages=messages), Of(parent=None), "tone"), {}),
        ("attributes", "Attributes._of_nodes", (Of(_messages=messages), Of(parent=Of(name="ball", modifiers=[Of(type="SUBSURF")])), "tone"), {}))
    for name, function, given, parts in quiet:
        owner, call = part(name), part(name)
        for word in function.split("."):
            call = getattr(call, word)
        with replaced(owner, **parts):
            with contextlib.suppress(Exception):
                call(*given)
        assert not said, (name, function, said)
    moves = part("motion").Motion
    nowhere = Of(_wanted={}, _places={"key": {time: np.full(12, math.nan) for time in (-1.0, 1.0)}}, _messages=messages)
    with replaced(part("motion"), _key=lambda _item: "key", _times=lambda _steps: (-1.0, 1.0)):
        assert moves.place(nowhere, Of(object=ob)) is None
    assert said == ["object 'ball': its place is not always a number; it is not blurred"]


def test_words_of_files_of_lamps_and_of_images():
    """What is wrong with a file of light, by its line or its kind; with an image, by whose it is."""
    ies, images = module("export.ies"), module("export.image")
    head = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 {kind} 2 0 0 0\n1 1 100\n"
    for text, words in (("IESNA\n1 2 3\n", "it has no line that begins with TILT="), (head.format(kind=4) + "0 90\n0\n5 5\n", "photometric type 4: expected 1, 2 or 3"),
                        (head.format(kind=1) + "90 0\n0\n5 5\n", "the vertical angles do not rise"), (head.format(kind=1) + "0 90\n0\n5 bright\n", "line 7: a candela value was expected, not 'bright'"),
                        (head.format(kind=1) + "0 90\n0\n5\n", "it ends where a candela value was expected")):
        assert raised(ies._read, text) == words, raised(ies._read, text)
    kind, vertical, horizontal, candela = ies._read(head.format(kind=1) + "0 90\n0\n5 7\n")
    assert kind == 1 and vertical.tolist() == [0, 90] and horizontal.tolist() == [0] and candela.tolist() == [[5, 7]]
    up, around, ones = np.array([0.0, 90]), np.array([0.0, 90, 180]), np.ones((3, 2))
    with replaced(ies.versions, OLD_IES=True):
        for given, words in (((3, up, around, ones), "photometric type A: this Blender's Cycles does not show it"),
                             ((1, up + 5, around, ones), "its vertical angles begin neither at 0 nor at 90; this Blender's Cycles does not show it"),
                             ((1, up, np.array([0.0, 100]), ones[:2]), "its horizontal angles do not go all around; this Blender's Cycles does not show it")):
            assert raised(ies._closed, *given) == words, raised(ies._closed, *given)
    said = []
    table = images.Images.__new__(images.Images)
    table._messages = Of(warning=said.append)
    folder = bpy.app.tempdir
    with open(os.path.join(folder, "no.png"), "wb") as file:
        file.write(b"no picture")
    image = bpy.data.images.new("map", 2, 2)
    assert table._fetch(Of(source="VIEWER", name="map"), "material 'steel'", "") == -1 and said.pop() == "material 'steel': image 'map' is a viewer: only images are supported"
    there = os.path.join(folder, "no.png")
    assert table._loaded(image, "/no/such.png", "material 'steel'") is None and said.pop() == "material 'steel': image file not found: /no/such.png"
    assert table._loaded(image, there, "material 'steel'") is None and said.pop() == f"material 'steel': image cannot be read: {there}", said
    tiled = Of(name="map", source="TILED", filepath="/tmp/a.<UDIM>.png", tiles=[Of(number=number) for number in (1001, 1012)], packed_files=())
    table._loaded = lambda *_which: {"width": 4, "height": 2, "channels": 3}
    with replaced(images, _MOST_TEXELS=31, _absolute=lambda _image, path: path):
        assert table._tiled(tiled, "material 'steel'", False) == -1 and said.pop() == "material 'steel': image 'map': 2 times 2 tiles are too many"
    bpy.data.images.remove(image)


def test_what_a_file_of_a_lamp_is_asked_for():
    """By its line, each number by its name, wherever lines end; what the lamp itself is like (TILT=INCLUDE) is passed over, what multiplies candelas is not."""
    ies = module("export.ies")
    fields = [("1", 3, "the lamp's geometry"), ("2", 4, "the number of tilt angles"), *((text, line, "a tilt angle or factor") for line in (5, 6) for text in "09"),
              ("1", 7, "the number of lamps or lumens"), ("1000", 7, "the number of lamps or lumens"), ("2", 7, "the multiplier"), ("2", 7, "the number of vertical angles"),
              ("1", 7, "the number of horizontal angles"), ("1", 7, "the photometric type"), *((text, 7, "the unit or size of the opening") for text in ("2", ".1", ".2", ".3")),
              ("1.5", 8, "the ballast factor"), (".5", 8, "the ballast-lamp factor"), ("100", 8, "the input watts"), ("0", 9, "a vertical angle"), ("90", 9, "a vertical angle"),
              ("0", 10, "a horizontal angle"), ("5", 11, "a candela value"), ("7", 11, "a candela value")]

    def text(**odd):
        words = {}
        for k, (word, line, _what) in enumerate(fields):
            words.setdefault(line, []).append(odd.get(f"at{k}", word))
        return "IESNA:LM-63-2002\nTILT=INCLUDE\n" + "\n".join(" ".join(words[line]) for line in sorted(words))
    kind, vertical, horizontal, candela = ies._read(text())
    assert kind == 1 and vertical.tolist() == [0, 90] and horizontal.tolist() == [0] and candela.tolist() == [[7.5, 10.5]]
    for k, (_word, line, what) in enumerate(fields):
        assert raised(ies._read, text(**{f"at{k}": "odd"})) == f"line {line}: {what} was expected, not 'odd'", k
    for k in (1, 9, 10):
        assert raised(ies._read, text(**{f"at{k}": "0"})) == f"{fields[k][2]} is 0; expected 1 or more"
    assert raised(ies._read, text(at9="2000", at10="1000")) == "it has 2000 times 1000 angles; 1048576 are supported"
    assert raised(ies._read, text(at21="nan")) == "line 10: a horizontal angle was expected, not 'nan'"
    assert ies._read(text().replace(" ", ","))[3].tolist() == ies._read(text().replace("5 7", "5;\n7"))[3].tolist() == [[7.5, 10.5]]
    node = Of(mode="INTERNAL", ies=None, filepath="//lamp.ies", id_data=Of(library=None))
    assert raised(ies.text_of, node) == "it has no text"
    node.mode, place = "EXTERNAL", os.path.join(bpy.app.tempdir, "lamp.ies")
    assert raised(ies.text_of, node).startswith("file not found: ") and raised(ies.text_of, node).endswith("lamp.ies")
    with open(place, "wb") as file:
        file.write(b"a \xff b")
    node.filepath = place
    assert ies.text_of(node) == "a \ufffd b"


def test_words_of_materials_that_are_shaded_otherwise():
    """Too deep, of too many shaders, without one, displaced or with a volume."""
    scene = common.empty_scene()
    common.camera(scene)
    common.light(scene)
    material, tree, _node = common.metal("steel")
    common.plane(material)
    end, whose = tree.get_output_node("ALL"), "material 'steel': "
    reader = module("export.material")
    for error, words in ((RecursionError(), "deep"), (module("export.graph").TooLarge(), "many at once")):
        def fails(*_which, error=error):
            raise error
        with replaced(reader, collect=fails):
            assert read(scene)[1] == [f"{whose}its nodes are too {words}; shaded as a Diffuse BSDF of its viewport colour"]
    one, other, both = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfDiffuse", "Emission", "AddShader"))
    tree.links.new(one.outputs[0], both.inputs[0])
    tree.links.new(other.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], end.inputs["Surface"])
    assert read(scene)[1] == []
    tree.links.new(one.outputs[0], both.inputs[1])  # twice the same is no circle
    assert read(scene)[1] == []
    tree.links.new(other.outputs[0], both.inputs[1])
    with replaced(reader, _MOST=1):
        assert read(scene)[1] == [f"{whose}its 2 shaders are more than 1; the last are left out"]
    noise = tree.nodes.new("ShaderNodeTexNoise")
    height = tree.nodes.new("ShaderNodeDisplacement")
    tree.links.new(noise.outputs[0], height.inputs["Height"])
    tree.links.new(height.outputs[0], end.inputs["Displacement"])
    with replaced(reader, displacement_method=lambda _material: "BOTH"):
        assert read(scene)[1] == [f"{whose}displacement of the surface itself is not supported; its normals are bumped"]
    for link in end.inputs["Displacement"].links:
        tree.links.remove(link)
    clear = tree.nodes.new("ShaderNodeBsdfTransparent")
    tree.links.new(clear.outputs[0], both.inputs[1])
    with replaced(module("versions"), SHADOWS_STOP=False), replaced(reader.Reader, _shades=lambda _reader: True):
        assert read(scene)[1] == [f"{whose}Transparent Shadows (off) are not supported; its shadows are transparent"]
    for link in end.inputs["Surface"].links:
        tree.links.remove(link)
    assert read(scene)[1] == [f"{whose}no shader (its surface has none); black, as in Cycles"]
    tree.links.new(tree.nodes.new("ShaderNodeVolumeScatter").outputs[0], end.inputs["Volume"])
    assert read(scene)[1] == [f"{whose}volumes are not supported; left out"]


def test_what_feeds_itself_is_its_own_value():
    """Blender 5.0 takes a link from a node to itself for a valid one; of links round a circle of two there is always one that is not."""
    tree = common.tree_of(bpy.data.materials.new("round"))
    value, said = module("export.value"), []
    for count in (1, 2):
        nodes = [tree.nodes.new("ShaderNodeMath") for _ in range(count)]
        for node, before in zip(nodes, nodes[-1:] + nodes[:-1]):
            node.inputs[0].default_value, node.inputs[1].default_value = 0.25, 0.5
            tree.links.new(before.outputs[0], node.inputs[0])
        last = tree.nodes.new("ShaderNodeMath")
        tree.links.new(nodes[0].outputs[0], last.inputs[0])
        reader = Of(warn=said.append, program=module("export.graph").Program(), known={}, shift=None, nodes=module("export.node_color").NODES)
        assert value.number_of(reader, last.inputs[0], ()) in ((0.75,), (0.75, 1.25))[count - 1]
        itself = bpy.app.version >= (5, 0) and count == 1
        assert said == [f"'{nodes[0].name}' feeds itself; the link is left out"] * itself, said
        said.clear()


def test_rays_of_occlusion_and_of_bevels():
    """As many as the node says, up to 128; as far as the world's where nothing says how far; none at all where it is nowhere."""
    part, asked, far = module("export.node_occlusion"), [], [0.0]
    program = Of(emit=lambda kind, count, **given: asked.append((kind, given)) or (1.0,) * count, math=lambda _kind, a, b: a * b)
    reader = Of(program=program, reach=lambda: 7.0, below={}, has_surface=True)

    def node(samples, linked):
        inputs = {name: Of(is_linked=linked) for name in ("Color", "Distance", "Radius", "Normal")}
        return Of(node=Of(samples=samples, inside=True, only_local=False, inputs=inputs), output=Of(name="Color"), groups=())
    stands_in = {"color_of": lambda *_: (0.5, 0.25, 1.0), "number_in": lambda *_: far[0], "normal_of": lambda *_: None, "surface_normal": lambda _reader: (0, 0, 1),
                 "tree": Of(trace=lambda *_: Of(node=None))}
    with replaced(part, **stands_in):
        for samples, linked, far[0], wanted in ((127, False, 0.0, (127, 7.0)), (500, False, 2.0, (128, 2.0)), (500, True, 3.0, (128, 3.0)), (5, True, 0.0, None), (0, False, 2.0, None)):
            assert part._ambient_occlusion(reader, node(samples, linked)) == (0.5, 0.25, 1.0)
            found = [("OCCLUSION", {"samples": wanted[0], "distance": [wanted[1]], "inside": True, "local": False})] if wanted else []
            assert asked == found, (samples, linked, asked)
            asked.clear()
        for samples, far[0], wanted in ((127, 2.0, 127), (500, 2.0, 128), (5, 0.0, None), (0, 2.0, None)):
            assert part._bevel(reader, node(samples, False)) == ((1.0,) * 3 if wanted else (0, 0, 1))
            assert asked == ([("BEVEL", {"samples": wanted, "radius": [far[0]]})] if wanted else []), (samples, asked)
            asked.clear()


def test_which_slot_a_face_has():
    """One beyond the last is the last; a slot that no face has is not read; the only one is everybody's."""
    mesh, asked = bpy.data.meshes.new("sheets"), []
    mesh.from_pydata([(x, y, z) for z in range(3) for x, y in ((0, 0), (1, 0), (0, 1))], [], [(0, 1, 2), (3, 4, 5), (6, 7, 8)])
    mesh.polygons[0].material_index, mesh.polygons[2].material_index = 1, 7
    if hasattr(mesh, "calc_loop_triangles"):
        mesh.calc_loop_triangles()
    table = Of(index=lambda *which: asked.append(which) or 10 * "abc".index(which[0]) + 5)
    of = module("export.mesh")._triangle_materials
    for slots, wanted in (("abc", [15, 5, 25]), ("ab", [15, 5, 15]), ("c", [25] * 3)):
        materials, used = of(mesh, slots, (True,), table)
        assert materials.tolist() == wanted and used == sorted(set(wanted)), (slots, materials, used)
        assert asked == [(slot, True, "mapless") for slot in slots], asked
        asked.clear()
    mesh.polygons[2].material_index = 0
    mesh.uv_layers.new(name="map")
    mesh.calc_loop_triangles()
    assert of(mesh, "abc", (False,), table)[1] == [5, 15] and asked == [("a", False), ("b", False)], asked


def test_lamps_that_are_alike_all_around():
    """A file says a half, a quarter or steps of what is all around: seen from straight behind, from 90 degrees on and from where it ends."""
    ies = module("export.ies")
    for given, around, wanted in (((0, 90), (0, 90, 180, 270, 360), (1, 2, 1, 2, 1)), ((0, 90, 180), (0, 90, 180, 270, 360), (1, 2, 3, 2, 1)),
                                  ((90, 180, 270), (0, 90, 180, 270, 360), (1, 2, 3, 2, 1)), ((0, 120, 240), (0, 120, 240, 360), (1, 2, 3, 1)),
                                  ((0, 90, 180, 270, 360), (0, 90, 180, 270, 360), (1, 2, 3, 4, 5))):
        values = np.arange(1.0, 1 + len(given))[:, None] * (1, 1)
        _up, turned, candela = ies._closed(1, np.array([0.0, 90]), np.array(given, float), values)
        assert turned.tolist() == list(around) and candela[:, 0].tolist() == list(wanted), (given, turned, candela[:, 0])
    with replaced(ies.versions, OLD_IES=False):  # types A and B: a half says what lies before 0 as well; of B the poles lie across
        for given, around, wanted in (((0, 30, 90), (90, 150, 180, 210, 270), (3, 2, 1, 2, 3)), ((-90, 0, 90), (90, 180, 270), (3, 2, 1))):
            up, turned, candela = ies._closed(3, np.array([-90.0, 0, 90]), np.array(given, float), np.array([[1.0] * 3, [2] * 3, [3] * 3]))
            assert up.tolist() == [0, 90, 180] and turned.tolist() == list(around) and candela[:, 1].tolist() == list(wanted), (given, turned, candela)
        up, turned, candela = ies._closed(2, np.array([0.0, 90]), np.array([-90.0, 0, 90]), np.array([[1.0, 2], [3, 4], [5, 6]]))
        assert up.tolist() == turned.tolist() == [0, 90, 180] and candela.tolist() == [[2, 4, 6], [1, 3, 5], [2, 4, 6]], (up, turned, candela)


def test_a_vector_in_the_world_as_a_normal():
    """Two are made: one that is never below the surface, and by its first register the one that may be."""
    asked = []
    reader = Of(below={}, program=Of(emit=lambda kind, **given: asked.append((kind, given)) or tuple(f"{len(asked)}{axis}" for axis in "xyz")))
    assert module("export.value").framed(reader, "there") == ("1x", "1y", "1z") and reader.below == {"1x": ("2x", "2y", "2z")}
    assert asked == [("FRAME", {"vector": "there", "to": "SHADING"}), ("FRAME", {"vector": "there", "to": "SHADING", "below": True})]


def test_which_part_of_a_cameras_view_is_rendered():
    """The border of its frame, wherever that lies in the view; all without one, or where a part of the frame is behind the eye."""
    scene = common.empty_scene()
    lamp = common.light(scene)
    eye = common.camera(scene, (0, 0, 0))
    bpy.context.view_layer.update()
    depsgraph, region = bpy.context.evaluated_depsgraph_get(), module("viewport")._region_of
    render = scene.render
    render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y = 0.25, 0.75, 0.5, 1
    whole = eye.calc_matrix_camera(depsgraph, x=64, y=48)
    for border, camera, matrix, view, wanted in (
            (True, eye, whole, "CAMERA", (20, 30, 60, 60)), (False, eye, whole, "CAMERA", (0, 0, 80, 60)), (True, eye, whole * -1, "CAMERA", (0, 0, 80, 60)),
            (True, eye, Matrix.Diagonal((0.5, 0.5, 1, 1)) @ whole, "CAMERA", (30, 30, 50, 45)), (True, eye, whole, "PERSP", (8, 0, 80, 60)), (True, lamp, whole, "CAMERA", (8, 0, 80, 60)),
            (True, None, whole, "CAMERA", (8, 0, 80, 60))):
        render.use_border = border
        space = Of(camera=camera, use_render_border=True, render_border_min_x=0.1, render_border_max_x=1.0, render_border_min_y=0.0, render_border_max_y=1.0)
        context = Of(space_data=space, region_data=Of(view_perspective=view, perspective_matrix=matrix))
        assert region(context, depsgraph, (80, 60)) == wanted, (border, view, region(context, depsgraph, (80, 60)))


def test_what_stands_on_a_node():
    """What was said of it, in red lines as wide as the node, the first with a sign; nothing but that it is disabled where it is."""
    scene, report, drawn = common.empty_scene(), module("report"), []
    _material, tree, node = common.metal("steel")

    class Lines:
        alert = False

        def label(self, text, icon):
            drawn.append((text, icon, self.alert))

        def column(self, align):
            assert align
            return Lines()

        def context_pointer_set(self, name, of):
            drawn.append((name, of))
    report._keep(scene, [("material 'steel': " + "word " * 20, True), ("material 'tin': odd", True), ("material 'steel': 'Other': odd", False)])
    tree.nodes.new("ShaderNodeBump").name = "Other"
    try:
        for width, lines in ((100, 5), (140, 5), (700, 1)):
            drawn.clear()
            node.width = width
            assert report.draw_on(node, Lines()) and drawn[0] == ("node", node)
            assert [icon for _text, icon, _red in drawn[1:]] == ["ERROR"] + ["NONE"] * (lines - 1) and all(red for *_said, red in drawn[1:]), (width, drawn)
        drawn.clear()
        with replaced(report, is_enabled=lambda: False):
            assert report.draw_on(node, Lines()) is False and drawn == [("libshade is disabled", "ERROR", False)]
    finally:
        report._forget()


def test_colours_of_a_files_working_space():
    """Rows of the matrix to it; a file of Rec. 709 has none, and counts green most."""
    space = module("working_space")

    class Wide:
        """Red and green change places, and each is half as large."""
        def __init__(self, unit):
            self.unit = unit

        def from_rec709_linear_to_scene_linear(self):
            return (0.5 * self.unit[1], 0.5 * self.unit[0], self.unit[2])

        def from_scene_linear_to_xyz_d65(self):
            return (9, 1 + 2 * self.unit[1], 9)
    assert space.from_rec709() is None and space.here((1, 2, 3)) == (1, 2, 3) and space.luminance() == (0.2126, 0.7152, 0.0722)
    assert space.from_xyz() is None and space.told("matrix", None) == {}
    with replaced(space, Color=Wide):
        assert space.here((1, 2, 4)) == (1, 0.5, 4) and space.luminance() == (1, 3, 1)
        assert space.told("matrix", space.from_rec709()) == {"matrix": [0, 0.5, 0, 0.5, 0, 0, 0, 0, 1]}
        red, green, blue = space.XYZ_TO_REC709
        assert np.allclose(space.from_xyz(), (np.multiply(green, 0.5), np.multiply(red, 0.5), blue))


for test in [value for name, value in list(globals().items()) if name.startswith("test_")]:
    test()
    print(test.__name__, "done", flush=True)
print("all asserted")
common.finish()
