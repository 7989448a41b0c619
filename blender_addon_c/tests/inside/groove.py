# SPDX-License-Identifier: GPL-3.0-or-later
"""Plates of compare/plate.py by Cycles, and by our engine, with and without Libshade Groove; asserts what
the operator does to a file. argument: a folder, for NAME.exr of each picture"""

import os
import sys

import bpy
import numpy as np
from mathutils import Matrix, Vector

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "..", "compare")]
import common
import plate

SIZE = 64
# shader, anisotropy, rotation
SHADERS = {
    "along": ("ShaderNodeBsdfAnisotropic", -0.8, 0.0),
    "across": ("ShaderNodeBsdfAnisotropic", 0.8, 0.0),
    "turned": ("ShaderNodeBsdfAnisotropic", 0.8, 0.1),
    "principled": ("ShaderNodeBsdfPrincipled", 0.8, 0.0),
    "principled_turned": ("ShaderNodeBsdfPrincipled", 0.8, 0.1),
}


UNLINKED = ("across", "principled")


def new_scene(engine):
    scene = common.empty_scene(SIZE, SIZE, 16)
    scene.render.engine = engine
    cycles = scene.cycles
    cycles.samples, cycles.max_bounces, cycles.pixel_filter_type = 16, 0, "BOX"
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.light_sampling_threshold = cycles.blur_glossy = cycles.sample_clamp_indirect = 0
    scene.libshade.filter_normals = False
    sun = common.light(scene, "SUN", 1.0)
    sun.rotation_euler = Vector(plate.SUN).to_track_quat("Z", "Y").to_euler()
    common.camera(scene, (0, 0, 2), type="ORTHO", ortho_scale=1)
    return scene


def bumps():
    image = bpy.data.images.new("bumps", 256, 256, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.ones((256, 256, 4), np.float32)
    pixels[..., :3] = plate.normal_map(256)[::-1]
    image.pixels.foreach_set(pixels.ravel())
    return image


def new_material(name, image=None):
    """The shader; with an image its normal is bumped."""
    kind, anisotropy, rotation = SHADERS[name]
    material = bpy.data.materials.new(name)
    tree = common.tree_of(material)
    tree.nodes.clear()
    shader, output, tangent = (tree.nodes.new(kind) for kind in (
        kind, "ShaderNodeOutputMaterial", "ShaderNodeTangent"))
    tangent.direction_type = "UV_MAP"
    if kind == "ShaderNodeBsdfPrincipled":
        settings = {"Metallic": 1, "Roughness": 0.4, "Anisotropic": anisotropy, "Anisotropic Rotation": rotation,
                    "Base Color": (1, 1, 1, 1)}
        shader.distribution = "GGX"
    else:
        settings = {"Roughness": plate.ROUGHNESS, "Anisotropy": anisotropy, "Rotation": rotation,
                    "Color": (1, 1, 1, 1)}
        shader.distribution = "ASHIKHMIN_SHIRLEY"
    for word, value in settings.items():
        shader.inputs[word].default_value = value
    tree.links.new(tangent.outputs[0], shader.inputs["Tangent"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    if image:
        common.normal_map(tree, shader, image)
    return material, tree, shader


def new_plate(quads):
    positions, normals, faces, uv = plate.mesh(quads)
    if quads == 1:
        positions[:, 2] = 0
    mesh = bpy.data.meshes.new("plate")
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.uv_layers.new(name="UVMap").data.foreach_set("uv", uv[faces.ravel()].astype(np.float32).ravel())
    if hasattr(mesh, "use_auto_smooth"):  # removed in 4.1
        mesh.use_auto_smooth, mesh.auto_smooth_angle = True, np.pi
    mesh.update()
    if quads > 1:
        mesh.normals_split_custom_set_from_vertices(normals.tolist())
    return mesh


def pictures(folder, engine, words):
    """NAME_bumped and NAME_groove; by Cycles NAME_displaced, and of two NAME_unlinked of the same."""
    scene = new_scene(engine)
    image = bumps()
    flat = common.link(scene, "flat", new_plate(1))
    fine = common.link(scene, "fine", new_plate(300)) if engine == "CYCLES" else None

    def render(ob, material, name):
        for other in filter(None, (flat, fine)):
            other.hide_render = other != ob
        ob.data.materials.clear()
        ob.data.materials.append(material)
        common.render(os.path.join(folder, f"{engine.lower()}_{name}.exr"))

    for word in words:
        material, tree, shader = new_material(word, image)
        before = shader.inputs["Tangent"].links[0].from_socket
        render(flat, material, word + "_bumped")
        assert bpy.ops.libshade.follow_bumps() == {"FINISHED"}
        group = shader.inputs["Tangent"].links[0].from_node
        assert group.bl_idname == "ShaderNodeGroup" and group.inputs["Tangent"].links[0].from_socket == before
        render(flat, material, word + "_groove")
        assert bpy.ops.libshade.follow_bumps() == {"CANCELLED"}  # not twice
        assert bpy.ops.libshade.follow_bumps(take_away=True) == {"FINISHED"}
        assert shader.inputs["Tangent"].links[0].from_socket == before
        if not fine:
            continue
        plain, tree, shader = new_material(word)
        render(fine, plain, word + "_displaced")
        if word not in UNLINKED:
            continue
        group = groove_in(tree)  # its Normal not linked: as if it were not there
        tree.links.new(shader.inputs["Tangent"].links[0].from_socket, group.inputs["Tangent"])
        tree.links.new(group.outputs["Tangent"], shader.inputs["Tangent"])
        render(fine, plain, word + "_unlinked")
    if not fine:
        return
    # strokes across the tangent, on the lines of the surface: those along dP/dv, the tangent of a map
    # whose u and v are exchanged
    assert bpy.ops.libshade.follow_bumps(strokes="ACROSS") == {"FINISHED"}
    render(flat, bpy.data.materials["across"], "strokes_groove")
    along, tree, shader = new_material("across")
    shader.inputs["Anisotropy"].default_value *= -1
    tree.nodes["Tangent"].uv_map = "swapped"
    uv = np.empty(2 * len(fine.data.loops), np.float32)
    fine.data.uv_layers["UVMap"].data.foreach_get("uv", uv)
    fine.data.uv_layers.new(name="swapped").data.foreach_set("uv", uv.reshape(-1, 2)[:, ::-1].ravel())
    render(fine, along, "strokes_displaced")


def metals(folder):
    """Libshade Metal in Cycles, of the alphas of "across" there; by our engine the same."""
    for engine in ("CYCLES", "LIBSHADE"):
        scene = new_scene(engine)
        flat = common.link(scene, "flat", new_plate(1))
        for horizon, bumped in (("VALID_ESTEVEZ", True), ("HARD", False)):
            narrow = 0.018 if bumped else 0.15  # noise of pixels is not what is asked
            material, tree, node = common.metal("metal", fresnel="NONE", ax=narrow, ay=0.45, horizon=horizon)
            node.inputs["Color"].default_value = (1, 1, 1, 1)
            if bumped:
                common.normal_map(tree, node, bumps())
                flat.data.materials.append(material)
            else:
                bpy.data.objects.remove(flat)
                bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)
                common.smooth(common.added(material).data)
            word = "plate" if bumped else "ball"
            common.render(os.path.join(folder, f"{engine.lower()}_metal_{word}.exr"))


def turned_metals(folder):
    """Libshade Metal on the bumped plate, its strokes along the other axis: by properties, by the socket, and by
    what goes from one side of the plate to the other."""
    for engine in ("CYCLES", "LIBSHADE"):
        scene = new_scene(engine)
        flat, image = common.link(scene, "flat", new_plate(1)), bumps()
        scene.cycles.samples = scene.libshade.samples = 64
        for word in ("properties", "socket", "crossing"):
            wide, narrow = (0.45, 0.1) if word == "properties" else (0.1, 0.45)
            material, tree, node = common.metal(word, fresnel="NONE", ax=wide, ay=narrow, horizon="HARD")
            node.inputs["Color"].default_value = (1, 1, 1, 1)
            common.normal_map(tree, node, image)
            if word == "socket":
                node.inputs["Anisotropy"].default_value *= -1
            if word == "crossing":
                uv, parts, wave = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("UVMap", "SeparateXYZ", "MapRange"))
                wave.inputs["To Min"].default_value, wave.inputs["To Max"].default_value = -0.6, 0.6
                for source, target in ((uv.outputs[0], parts.inputs[0]), (parts.outputs["X"], wave.inputs["Value"]),
                                       (wave.outputs[0], node.inputs["Anisotropy"])):
                    tree.links.new(source, target)
            flat.data.materials.clear()
            flat.data.materials.append(material)
            common.render(os.path.join(folder, f"{engine.lower()}_metal_{word}.exr"))


# A torus about z: radii, and waves of its height round it and round its tube, of slopes up to .5.
RADIUS, TUBE, WAVES, HEIGHT = 0.33, 0.14, (16, 6), 0.0103
TORUS_SIZE = 128


def torus_slopes(u, v):
    """Height at angles, and how it grows per length along u and v."""
    a, b = WAVES
    return (HEIGHT * np.sin(a * u) * np.sin(b * v),
            HEIGHT * a * np.cos(a * u) * np.sin(b * v) / (RADIUS + TUBE * np.cos(v)),
            HEIGHT * b * np.sin(a * u) * np.cos(b * v) / TUBE)


def torus(displaced, across=480, around=200):
    steps = np.stack(np.meshgrid(np.arange(across), np.arange(around), indexing="ij"), -1).reshape(-1, 2)
    u, v = (2 * np.pi * steps / (across, around)).T
    normal = np.stack([np.cos(v) * np.cos(u), np.cos(v) * np.sin(u), np.sin(v)], 1)
    ring = np.stack([np.cos(u), np.sin(u), 0 * u], 1)
    out = RADIUS * ring + (TUBE + (torus_slopes(u, v)[0] if displaced else 0 * u))[:, None] * normal
    corners = steps[:, None] + np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    faces = corners[..., 0] % across * around + corners[..., 1] % around
    mesh = bpy.data.meshes.new("torus")
    mesh.from_pydata(out.tolist(), [], faces.tolist())
    mesh.uv_layers.new(name="UVMap").data.foreach_set(
        "uv", (corners / (across, around)).astype(np.float32).ravel())
    common.smooth(mesh)
    return mesh


def torus_bumps():
    """Its normal map."""
    width, height = 1024, 512
    u, v = np.meshgrid(2 * np.pi * (np.arange(width) + 0.5) / width, 2 * np.pi * (np.arange(height) + 0.5) / height)
    _height, along, around = torus_slopes(u, v)
    normal = np.stack([-along, -around, np.ones_like(along)], -1)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = 0.5 + 0.5 * normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    image = bpy.data.images.new("torus", width, height, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.pixels.foreach_set(pixels.ravel())
    return image


def toruses(folder):
    """Brushed along u, 25 : 1, displaced and bumped, with the group and without; bumped by our engine. The left half."""
    for engine in ("CYCLES", "LIBSHADE"):
        scene = new_scene(engine)
        scene.render.resolution_x = scene.render.resolution_y = TORUS_SIZE
        scene.render.use_border, scene.render.border_max_x = True, 0.5
        scene.cycles.samples = scene.libshade.samples = 128
        image, shown = torus_bumps(), []
        for word in ("displaced", "bumped", "groove") if engine == "CYCLES" else ("bumped",):
            material, tree, shader = new_material("across", None if word == "displaced" else image)
            shader.inputs["Roughness"].default_value, shader.inputs["Anisotropy"].default_value = 0.45, 0.8
            if word == "groove":
                group = groove_in(tree)
                for name in ("Normal", "Tangent"):
                    tree.links.new(shader.inputs[name].links[0].from_socket, group.inputs[name])
                tree.links.new(group.outputs["Tangent"], shader.inputs["Tangent"])
            for ob in shown:
                ob.hide_render = True
            shown.append(common.link(scene, word, torus(word == "displaced")))
            shown[-1].data.materials.append(material)
            common.render(os.path.join(folder, f"{engine.lower()}_torus_{word}.exr"))


def sockets(folder):
    """Libshade Metal told by its sockets: by what varies over a ball, in both engines; by numbers in ours."""
    for engine in ("CYCLES", "LIBSHADE"):
        new_scene(engine)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)
        ball = common.added(None)
        common.smooth(ball.data)

        def render(word, material):
            ball.data.materials.clear()
            ball.data.materials.append(material)
            common.render(os.path.join(folder, f"{engine.lower()}_sockets_{word}.exr"))

        for number, distribution in enumerate(("ASHIKHMIN_SHIRLEY", "GGX", "BECKMANN")):
            material, tree, node = common.metal("varied", fresnel="NONE", ax=0.15, ay=0.45, horizon="HARD",
                                                distribution=distribution)
            uv, parts = tree.nodes.new("ShaderNodeUVMap"), tree.nodes.new("ShaderNodeSeparateXYZ")
            tree.links.new(uv.outputs[0], parts.inputs[0])
            for part, name, low, high in (("Y", "Roughness", 0.2, 0.9), ("X", "Anisotropy", -0.7, 0.7), ("Y", "Rotation", 0, 0.5)):
                wave = tree.nodes.new("ShaderNodeMapRange")
                wave.inputs["To Min"].default_value, wave.inputs["To Max"].default_value = low, high
                tree.links.new(parts.outputs[part], wave.inputs["Value"])
                if number != 1 or name == "Roughness":  # of one roughness alone
                    tree.links.new(wave.outputs[0], node.inputs[name])
            tree.links.new(uv.outputs[0], node.inputs["Diffuse Color"])
            render(f"varied_{distribution.lower()}", material)
        for told in (False, True):
            material, tree, node = common.metal("told", fresnel="NONE", ax=0.1, ay=0.4, horizon="HARD", kd=(0.1, 0.2, 0.3))
            if told:  # the same by numbers
                node.ax, node.ay, node.kd = 0.3, 0.2, (0, 0, 0)
                node.inputs["Roughness"].default_value = 0.2**0.5
                node.inputs["Anisotropy"].default_value = 0.5
                node.inputs["Diffuse Color"].default_value = (0.1, 0.2, 0.3, 1)
            render(f"told_{told}", material)


def grains(folder):
    """A ball of Libshade Metal by each kind of grain, in both engines; at last without a UV map."""
    for engine in ("CYCLES", "LIBSHADE"):
        new_scene(engine)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.5)
        ball = common.added(None)
        common.smooth(ball.data)
        ball.rotation_euler = (0.4, 0.3, 0.2)
        uv = np.empty(2 * len(ball.data.loops), np.float32)
        ball.data.uv_layers[0].data.foreach_get("uv", uv)
        swapped = ball.data.uv_layers.new(name="swapped")
        swapped.data.foreach_set("uv", uv.reshape(-1, 2)[:, ::-1].ravel())
        for grain, name in (("UV", ""), ("UV", "swapped"), ("RADIAL_Y", ""), ("AXIS_X", ""), ("IGNORE", ""), ("MAPLESS", "")):
            while grain == "MAPLESS" and ball.data.uv_layers:
                ball.data.uv_layers.remove(ball.data.uv_layers[0])
            material, tree, node = common.metal("grain", fresnel="NONE", ax=0.15, ay=0.45, horizon="HARD", uv_map=name)
            if grain == "IGNORE":
                node.bump_response = "IGNORE"
                common.normal_map(tree, node, bumps())
            elif grain != "MAPLESS":
                node.grain = grain
            ball.data.materials.clear()
            ball.data.materials.append(material)
            common.render(os.path.join(folder, f"{engine.lower()}_grain_{grain}{name}.exr"))
        stock_without_a_map(folder, engine, ball)


def stock_without_a_map(folder, engine, ball):
    """Tangents that nodes ask of a UV map that is not there: a Tangent's, and a Normal Map's, which is bent one way all over."""
    material = bpy.data.materials.new("mapless")
    tree = common.tree_of(material)
    tree.nodes.clear()
    shader, tangent, bent = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfAnisotropic", "Tangent", "NormalMap"))
    shader.distribution, tangent.direction_type = "GGX", "UV_MAP"
    shader.inputs["Roughness"].default_value, shader.inputs["Anisotropy"].default_value = 0.5, 0.7
    bent.inputs["Color"].default_value = (0.6, 0.6, 0.96, 1)
    for source, target in ((tangent.outputs[0], shader.inputs["Tangent"]), (bent.outputs[0], shader.inputs["Normal"]),
                           (shader.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])):
        tree.links.new(source, target)
    ball.data.materials.clear()
    ball.data.materials.append(material)
    ball.rotation_euler = (0.9, 0, 0)  # away from the seam at -y, where 3.4's own map is torn
    bpy.context.scene.libshade.groove_transport = False
    common.render(os.path.join(folder, f"{engine.lower()}_grain_stock.exr"))


# Of the plate below: colours head-on and at 82 degrees.
COLOR, TINT = (0.9, 0.6, 0.3), (0.8, 0.5, 0.9)


def edges(folder):
    """A smooth plate seen at 82 degrees under an even sky."""
    for engine in ("CYCLES", "LIBSHADE"):
        scene = new_scene(engine)
        for ob in [ob for ob in scene.objects if ob.type == "LIGHT"]:
            bpy.data.objects.remove(ob)
        scene.world = bpy.data.worlds.new("even")
        common.tree_of(scene.world).nodes["Background"].inputs["Color"].default_value = (1,) * 4
        scene.cycles.max_bounces = scene.libshade.max_bounces = 2
        plate_ = common.link(scene, "flat", new_plate(1))
        plate_.rotation_euler = (np.arccos(1 / 7), 0, 0)
        for word, fresnel in (("socket", "SCHLICK"), ("property", "F82")):
            material, _tree, node = common.metal(word, fresnel=fresnel, ax=1e-3, ay=1e-3, distribution="GGX", brdf="MICROFACET")
            node.inputs["Color"].default_value = (*COLOR, 1)
            if word == "socket":
                node.inputs["Edge Tint"].default_value = (*TINT, 1)
            else:
                node.f82 = TINT
            plate_.data.materials.clear()
            plate_.data.materials.append(material)
            common.render(os.path.join(folder, f"{engine.lower()}_edge_{word}.exr"))


def groove_in(tree):
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = sys.modules[f"{common.MODULE}.groove"].groove_tree()
    return group


def turned_strokes(folder):
    """What the tool left, turned with the highlight: on a plate, by a map and by one that is mirrored, on a mirrored object, round the
    middle, and by a texture that turns on from below to above. On a face that leans towards the axis, turned and not."""
    turned = {"axis": "AXIS_X", "map": "UV", "mirrored_map": "UV", "mirrored": "AXIS_X", "round": "RADIAL_Z", "leaning": "AXIS_X",
              "leaning_turned": "AXIS_X", "textured": "AXIS_X"}
    for engine, words in (("CYCLES", ("axis", "map")), ("LIBSHADE", turned)):
        scene = new_scene(engine)
        material, tree, node = common.metal("strokes")
        node.strokes, node.stroke_width = 1.0, 60.0
        for name, value in (("Roughness", 0.5), ("Anisotropy", 0.5), ("Rotation", 0.1)):
            node.inputs[name].default_value = value
        shown = common.plane(material)
        corners = shown.data.uv_layers[0].data
        for word in words:
            node.grain, shown.scale.x = turned[word], -1 if word == "mirrored" else 1
            for corner in corners if word == "mirrored_map" else ():
                corner.uv.x *= -1
            # to the right of the middle circles run along y
            scene.camera.location.x, scene.camera.data.ortho_scale = (0.7, 0.3) if word == "round" else (0, 1)
            lean = Matrix.Rotation(0.6 if word.startswith("leaning") else 0.0, 4, "Y")
            shown.data.transform(lean)
            shown.rotation_euler = lean.inverted().to_euler()
            node.inputs["Rotation"].default_value = 0.0 if word == "leaning" else 0.1
            if word == "textured":
                place, part, by = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "SeparateXYZ", "Math"))
                by.operation, by.inputs[1].default_value, by.inputs[2].default_value = "MULTIPLY_ADD", 0.1, 0.1
                for source, target in ((place.outputs["Object"], part.inputs[0]), (part.outputs["Y"], by.inputs[0]),
                                       (by.outputs[0], node.inputs["Rotation"])):
                    tree.links.new(source, target)
            common.render(os.path.join(folder, f"{engine.lower()}_strokes_{word}.exr"))
            shown.data.transform(lean.inverted())


def operator():
    """Reroutes, tangents that nothing feeds, groups, shaders that are not concerned."""
    common.empty_scene()
    image = bumps()
    _material, tree, shader = new_material("across", image)
    tree.links.remove(shader.inputs["Tangent"].links[0])
    knee = tree.nodes.new("NodeReroute")
    tree.links.new(shader.inputs["Normal"].links[0].from_socket, knee.inputs[0])
    tree.links.new(knee.outputs[0], shader.inputs["Normal"])
    new_material("along")  # without a bump
    _material, other, round_one = new_material("along", image)
    other.links.remove(round_one.inputs["Tangent"].links[0])
    round_one.inputs["Anisotropy"].default_value = 0
    inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
    principled, bump = (inner.nodes.new(kind) for kind in ("ShaderNodeBsdfPrincipled", "ShaderNodeBump"))
    principled.inputs["Anisotropic"].default_value = 0.5
    inner.links.new(bump.outputs[0], principled.inputs["Normal"])
    for kind in ("NodeGroupInput", "NodeGroupOutput"):  # as in every group that an artist makes
        inner.nodes.new(kind)
    material, ours, node = common.metal()
    ours.links.new(ours.nodes.new("ShaderNodeBump").outputs[0], node.inputs["Normal"])

    def followed():
        return [s for s in (shader, principled, round_one) if s.inputs["Tangent"].is_linked]
    assert bpy.ops.libshade.follow_bumps(strokes="ACROSS") == {"FINISHED"}
    assert followed() == [shader, principled]
    link = shader.inputs["Tangent"].links[0]
    assert link.from_socket.name == "Strokes Across" and not link.from_node.inputs["Tangent"].is_linked
    assert link.from_node.inputs["Normal"].links[0].from_node.bl_idname == "ShaderNodeNormalMap"
    assert abs(link.from_node.location[1] - tree.nodes["Normal Map"].location[1]) > 150  # not upon it
    inside = node.node_tree

    def groups_inside():
        return [n.name for n in inside.nodes if n.bl_idname == "ShaderNodeGroup"]
    assert groups_inside() == ["Groove"]
    by_hand = groove_in(tree)
    assert bpy.ops.libshade.follow_bumps(take_away=True) == {"FINISHED"}
    assert not followed() and by_hand.name in tree.nodes and "Libshade Groove" in bpy.data.node_groups
    assert "Groove" in inside.nodes
    bpy.data.materials.remove(material)
    assert bpy.ops.libshade.follow_bumps() == {"FINISHED"}
    assert groups_inside() == ["Groove"]  # of a node that is gone, as of a plain group that it has become
    bpy.data.node_groups.remove(inside)
    tree.nodes.remove(by_hand)
    bpy.ops.libshade.follow_bumps()
    bpy.ops.libshade.follow_bumps(take_away=True)
    assert "Libshade Groove" not in bpy.data.node_groups
    assert bpy.ops.libshade.follow_bumps(take_away=True) == {"CANCELLED"}


if __name__ == "__main__":
    folder, = common.arguments()
    common.enable()
    operator()
    pictures(folder, "CYCLES", SHADERS)
    pictures(folder, "LIBSHADE", ("across", "principled"))
    metals(folder)
    turned_metals(folder)
    toruses(folder)
    sockets(folder)
    grains(folder)
    edges(folder)
    turned_strokes(folder)
    print("all asserted", flush=True)
    common.finish()
