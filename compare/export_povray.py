# SPDX-License-Identifier: Apache-2.0
"""Write the POV-Ray form of a Blender file. Run inside Blender:

    BLENDER_USER_SCRIPTS=build/blender blender -b --factory-startup \
        --addons libshade SCENE.blend --python-exit-code 1 \
        -P compare/export_povray.py -- FOLDER

FOLDER gets scene.ini (width, height, input file), scene.pov and the files that
it includes: camera.inc, lights.inc, materials.inc, meshes.inc. A scene of your
own can include the same files. Render with

    cd FOLDER && povray scene.ini

What is written: the visible meshes as they are after modifiers, but for those that
are disabled in renders, with smooth normals and UVs; their Libshade Metal materials with normal map and grain, by what sockets
and properties say, and Libshade Fabric by preset and length, in the cloth's own colours;
sun and point lights, likewise; the camera; the world's plain colour. Anything else is an error that
names it, for the picture would not be the same. So are a metal's Strokes: no block of
POV-Ray's has them, and with Strokes 0 the rest is written.

Tangents. Round an axis they run the other way in POV-Ray's formula, whose world is mirrored:
the axis is written turned round. In Blender it stands in the middle of the mesh, in POV-Ray
where `at` says.

Frames. Blender is right-handed with z up, POV-Ray left-handed with y up: every
vector (x, y, z) becomes (x, z, y), which keeps the picture as it is.

Normals. POV-Ray interpolates them before an object's transformation, our engine
after it: under an uneven scale they differ by what one triangle bends (0.2 degrees
on a sphere of 48 x 24 faces scaled 1 : 0.6), otherwise not at all.

Units. POV-Ray multiplies the library's pi f cos by the light's colour, so a
light of irradiance E gets the colour E / pi. Its fading 2 / (1 + (d/fade)^2)
tends to 2 fade^2 / d^2 for a fade distance far below the distances in the
scene, so a point light of intensity I gets the colour I / (2 pi fade^2).
"""
import math
import os
import re
import sys

import bpy
import numpy as np
from libshade import _native, fabric, metal_tree, nodes
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import whole  # noqa: E402

METAL, FABRIC = "LibshadeMetalNode", "LibshadeFabricNode"
SWAP = Matrix(((1, 0, 0, 0), (0, 0, 1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))
FADE = 1e-4  # fade distance of point lights, in units of the scene's size: error 1e-8 there


class ExportError(Exception):
    """The scene holds something that has no POV-Ray form here."""


def number(value):
    """Shortest text that reads back as the same float32, Blender's own precision."""
    return str(np.float32(value))


def vector(values):
    return "<" + ", ".join(number(v) for v in values) + ">"


def swapped(v):
    """A Blender vector in POV-Ray's axes."""
    return (v[0], v[2], v[1])


def identifier(kind, name, taken):
    """A POV-Ray identifier for a Blender name; capital first, so never a keyword."""
    base = kind + "_" + re.sub(r"[^0-9A-Za-z]", "_", name)
    text, count = base, 1
    while text in taken:
        count += 1
        text = f"{base}_{count}"
    taken.add(text)
    return text


# ---- materials -------------------------------------------------------------------------------


def linked_node(socket, kind, what):
    """The node that feeds a socket, or None; an error if it is not a `kind`."""
    if not socket.is_linked:
        return None
    node = socket.links[0].from_node
    if node.bl_idname != kind:
        raise ExportError(f"{what}: expected a {kind} node, found '{node.name}'")
    return node


def metal_of(material):
    tree = material.node_tree if material.use_nodes else None
    output = tree.get_output_node("ALL") if tree else None
    node = output and linked_node(output.inputs["Surface"], METAL, f"material '{material.name}'")
    if not node:
        raise ExportError(f"material '{material.name}': it has no Libshade Metal node")
    return node


def bump_image(socket, material, folder):
    """The `bump_image` block for what feeds a Normal socket, or no text."""
    what = f"material '{material.name}', Normal"
    node = linked_node(socket, "ShaderNodeNormalMap", what)
    if not node:
        return ""
    texture = linked_node(node.inputs["Color"], "ShaderNodeTexImage", what)
    if not texture or not texture.image:
        raise ExportError(f"{what}: the Normal Map node has no image")
    if node.space != "TANGENT" or node.inputs["Strength"].is_linked:
        raise ExportError(f"{what}: only tangent space and a plain strength can be written")
    if texture.inputs["Vector"].is_linked or texture.extension != "REPEAT":
        raise ExportError(f"{what}: only a repeating image on the plain UV map can be written")
    if texture.interpolation != "Linear":
        raise ExportError(f"{what}: only linear interpolation can be written, "
                          f"not {texture.interpolation}")
    image = texture.image
    space = image.colorspace_settings
    if not space.is_data:
        raise ExportError(f"{what}: image '{image.name}' has colour space '{space.name}'; "
                          "only Non-Color can be written")
    path = bpy.path.abspath(image.filepath)
    kind = {"PNG": "png", "OPEN_EXR": "exr"}.get(image.file_format)
    if image.packed_file or not kind or not os.path.isfile(path):
        raise ExportError(f"{what}: image '{image.name}' ({path}) must be a PNG or OpenEXR file")
    relative = os.path.relpath(path, folder).replace("\\", "/")
    strength = node.inputs["Strength"].default_value
    if strength > 1 and bpy.app.version < (3, 5):
        raise ExportError(f"{what}: Blender {bpy.app.version_string} mixes normals by the strength, {strength:.3g}; "
                          "POV-Ray's multiplies slopes, as later Blenders do: only up to 1 can be written")
    return f'\n      bump_image {{ {kind} "{relative}" strength {number(strength)} filter off }}'


def settings_of(node, what):
    """A metal node's settings under the table's names, where its sockets say otherwise by those."""
    said = {**nodes.settings(node), "fresnel": nodes.fresnel_of(node).lower()}
    for names in (nodes.SHAPE, nodes.MATT_COLOR, nodes.EDGE):
        for name in names:
            if name in node.inputs and node.inputs[name].is_linked:
                raise ExportError(f"{what}, {name}: what is linked cannot be written")
    if nodes.sockets_rule(node, nodes.SHAPE):
        said["ax"], said["ay"] = nodes.lobe(node)
        said["ex"], said["ey"] = (nodes.exponent_of(said[name]) for name in ("ax", "ay"))
    for word, (name,) in (("kd", nodes.MATT_COLOR), ("f82", nodes.EDGE)):
        if nodes.sockets_rule(node, (name,)):
            said[word] = tuple(node.inputs[name].default_value[:3])
    return said


def tangent_text(node, middle, what):
    """What lays the strokes: `tangent …`, and a transformation of the texture or no text. middle: of the mesh."""
    if "Tangent" in node.inputs and node.inputs["Tangent"].is_linked:
        raise ExportError(f"{what}, Tangent: what is linked cannot be written")
    turns = 0.0
    if "Rotation" in node.inputs:
        turns = node.inputs["Rotation"].default_value % 1.0
        if node.inputs["Rotation"].is_linked or turns not in (0.0, 0.5):
            raise ExportError(f"{what}, Rotation: only whole and half turns can be written")
    kind, _space, axis = node.grain.partition("_")
    back = -1.0 if turns else 1.0
    if kind == "RADIAL":
        around = tuple(-back * (name == axis) for name in "XYZ")
        return f"tangent radial {vector(swapped(around))} at {vector(swapped(middle))}", ""
    if kind == "AXIS":
        return f"tangent {vector(swapped([back * part for part in metal_tree.axis_vector(axis)]))}", ""
    if node.uv_map:
        raise ExportError(f"{what}, UV Map: only strokes along the active one can be written")
    return "tangent uv", "rotate 180*z" if turns else ""


def choices_text(set_to):
    """A line for each of the table's lists: its word and the numbers that this choice reads; then
    the numbers that every material has, but for the colour, which is a socket."""
    table = _native.table()

    def text(row):
        value = set_to[row["word"]]
        return number(value) if row["components"] == 1 else f"rgb {vector(value)}"

    lines = []
    for name in table["lists"]:
        word = set_to[name]
        read = [text(row) for row in table["params"]
                if row["read_by"] and row["read_by"][0] == name and word in row["read_by"][1]]
        start = word if name == "mdf" else f"{name} {word}"  # a distribution needs no word before
        lines.append(f"{start} {', '.join(read)}".strip())
    lines += [f"{row['word']} {text(row)}" for row in table["params"]
              if not row["read_by"] and row["word"] != "f0"]
    return "\n      ".join(lines)


def fabric_of(material):
    """Its Libshade Fabric node, or None."""
    tree = material.node_tree if material.use_nodes else None
    output = tree.get_output_node("ALL") if tree else None
    links = output.inputs["Surface"].links if output else ()
    return links[0].from_node if links and links[0].from_node.bl_idname == FABRIC else None


def fabric_text(material, node):
    """`texture { … }` of cloth: a preset, so long for a unit of the UV map. All else as the preset has it."""
    what = f"material '{material.name}'"
    if node.preset not in fabric.cloths() or node.size_mode != "LENGTH" or node.open_gaps:
        raise ExportError(f"{what}: only cloth of a preset, its size a length, without open gaps can be written")
    plain = bpy.data.materials.new("plain")
    try:
        plain.use_nodes = True
        fresh = plain.node_tree.nodes.new(FABRIC)
        fresh.preset = node.preset
        for socket in node.inputs:
            if socket.is_linked or _value(socket) != _value(fresh.inputs[socket.name]):
                raise ExportError(f"{what}, {socket.name}: only what the preset has can be written")
    finally:
        bpy.data.materials.remove(plain)
    return f"""texture {{
  pigment {{ rgb 1 }}
  finish {{
    ambient 0 diffuse 0
    mdf {{ fabric {{ preset "{fabric.cloths()[node.preset]["word"]}" mm_per_unit {number(1000 * node.size)} }} }}
  }}
}}"""


def _value(socket):
    """Of an unlinked socket, as numbers that can be compared."""
    value = getattr(socket, "default_value", None)
    return tuple(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def texture_text(material, folder, middle):
    """`texture { … }` for one material, on meshes with this middle."""
    cloth = fabric_of(material)
    if cloth:
        return fabric_text(material, cloth)
    node, what = metal_of(material), f"material '{material.name}'"
    if node.strokes > 0:
        raise ExportError(f"{what}, Strokes: no block of POV-Ray's has them; set Strokes to 0 to write the rest")
    if node.inputs["Color"].is_linked:
        raise ExportError(f"{what}: a textured Color cannot be written")
    colour = node.inputs["Color"].default_value[:3]
    bump = bump_image(node.inputs["Normal"], material, folder) if node.bump_response == "FOLLOW" else ""
    if bump and node.horizon == "MUTUAL" and node.bumps_are == "SHAPE":
        raise ExportError(f"{what}, Bumps Are: no block of POV-Ray's has a Shape; set it to Relief to write the rest")
    tangent, turn = tangent_text(node, middle, what)
    said = settings_of(node, what)
    specular = f"specular rgb {vector(colour)}\n      "
    if said["fresnel"] == "conductor":  # after it the word would colour it
        if said["diffuse"] == "ashikhmin_shirley" and any(said["kd"]):
            raise ExportError(f"{what}: a conductor with the diffuse part of Ashikhmin and Shirley cannot be written")
        specular = ""
    return f"""texture {{
  pigment {{ rgb 1 }}
  finish {{
    ambient 0 diffuse 0
    mdf {{
      {choices_text(said)}
      {specular}{tangent}{bump}
    }}
  }}{turn and chr(10) + "  " + turn}
}}"""


def middle_of(mesh, material):
    """Where strokes of the material that run round an axis have it: in the middle of the mesh's texture space."""
    if fabric_of(material) or not metal_of(material).grain.startswith("RADIAL"):
        return (0.0, 0.0, 0.0)
    across = [size for size, name in zip(mesh.texspace_size, "XYZ") if name != metal_of(material).grain[-1]]
    if max(across) > 1.001 * min(across):
        raise ExportError(f"material '{material.name}' on mesh '{mesh.name}': strokes round an axis are ellipses there, "
                          "as the mesh is not as wide as deep; only circles can be written")
    return tuple(mesh.texspace_location)


# ---- meshes ----------------------------------------------------------------------------------


def read(collection, attribute, width, dtype=np.float32):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values


def active_uv_map(mesh):
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def check_uv_map(mesh, material, owner):
    """Only the active UV map is written: an error if a material's normal map is on another one."""
    if fabric_of(material):
        return
    socket = metal_of(material).inputs["Normal"]
    name = socket.links[0].from_node.uv_map if socket.is_linked else ""
    layer = active_uv_map(mesh)
    if name and layer and name != layer.name:
        raise ExportError(f"object '{owner}', material '{material.name}', Normal: "
                          f"UV map '{name}' is not the active one, '{layer.name}'")


def mesh_arrays(mesh, owner):
    """(positions, normals, uvs, corner positions, material index per triangle)."""
    if hasattr(mesh, "calc_normals_split"):  # until 4.1 corner normals are made on request
        mesh.calc_normals_split()
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    layer = active_uv_map(mesh)
    if layer is None:
        raise ExportError(f"object '{owner}': the mesh has no UV map")
    corners = read(triangles, "loops", 3, np.int32)
    if hasattr(mesh, "corner_normals"):
        normals = read(mesh.corner_normals, "vector", 3).reshape(-1, 3)[corners]
    else:
        normals = read(triangles, "split_normals", 9).reshape(-1, 3)
    return (
        read(mesh.vertices, "co", 3).reshape(-1, 3),
        normals,
        read(layer.data, "uv", 2).reshape(-1, 2)[corners],
        read(triangles, "vertices", 3, np.int32),
        read(triangles, "material_index", 1, np.int32),
    )


def list_block(name, rows):
    """`name { count, <…>, … }`, one vector a line."""
    pattern = "<" + ", ".join(["%.9g" if rows.dtype.kind == "f" else "%d"] * rows.shape[1]) + ">"
    body = ",\n".join(pattern % tuple(row) for row in rows.tolist())
    return f"{name} {{ {len(rows)},\n{body}\n}}\n"


def mesh_text(arrays, textures):
    """`mesh2 { … }`; with several textures each triangle names its own."""
    positions, normals, uvs, corner_position, material = arrays
    normal_rows, normal_index = np.unique(normals, axis=0, return_inverse=True)
    uv_rows, uv_index = np.unique(uvs, axis=0, return_inverse=True)
    text = "mesh2 {\n"
    text += list_block("vertex_vectors", positions[:, [0, 2, 1]])
    text += list_block("normal_vectors", normal_rows[:, [0, 2, 1]])
    text += list_block("uv_vectors", uv_rows)
    faces = corner_position.reshape(-1, 3)
    if len(textures) == 1:
        text += list_block("face_indices", faces)
    else:
        names = "".join(f", texture {{ {name} }}" for name in textures)
        text += f"texture_list {{ {len(textures)}{names} }}\n"
        slot = material.clip(0, len(textures) - 1)
        body = ",\n".join("<%d, %d, %d>, %d" % (*f, s) for f, s in zip(faces.tolist(), slot))
        text += f"face_indices {{ {len(faces)},\n{body}\n}}\n"
    text += list_block("normal_indices", normal_index.reshape(-1, 3))
    text += list_block("uv_indices", uv_index.reshape(-1, 3))
    if len(textures) == 1:
        text += f"texture {{ {textures[0]} }}\n"
    return text + "}"


def matrix_text(matrix):
    """POV-Ray's `matrix`, whose rows are the images of the axes and the origin."""
    m = SWAP @ matrix @ SWAP
    return "matrix " + vector(m[row][column] for column in range(4) for row in range(3))


# ---- camera, lights, world -------------------------------------------------------------------


def rotation(turn):
    """A quaternion's matrix in double: POV-Ray warns of axes that are square to float32 only."""
    w, x, y, z = np.array(turn, np.float64) / np.linalg.norm(np.array(turn, np.float64))
    return np.array([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ])


def camera_text(scene, camera):
    data = camera.data
    if data.type == "PANO" or data.dof.use_dof:
        raise ExportError(f"camera '{camera.name}': only sharp perspective or orthographic")
    place, turn, _ = camera.matrix_world.decompose()
    # The picture's corners in the camera's space, which looks along -z.
    right_top, right_bottom, left_bottom, _ = (np.array(c) for c in data.view_frame(scene=scene))
    middle = (right_top + left_bottom) / 2.0
    vectors = {
        "location": np.zeros(3),
        "direction": middle,
        "right": [right_top[0] - left_bottom[0], 0.0, 0.0],
        "up": [0.0, right_top[1] - right_bottom[1], 0.0],
    }
    if data.type == "ORTHO":
        vectors["location"] = middle * (1.0, 1.0, 0.0)
        vectors["direction"] = [0.0, 0.0, -1.0]
    world = {name: rotation(turn) @ v for name, v in vectors.items()}
    world["location"] += np.array(place)
    lines = "".join(
        f"  {name} <{', '.join(repr(float(c)) for c in swapped(v))}>\n" for name, v in world.items()
    )
    kind = {"ORTHO": "orthographic", "PERSP": "perspective"}[data.type]
    return f"camera {{\n  {kind}\n{lines}}}\n"


def light_text(light, matrix, size):
    data = light.data
    energy = [data.energy * c for c in data.color]
    if data.use_nodes:
        raise ExportError(f"light '{light.name}': nodes cannot be written")
    # until 4.1 Cycles' own property, which is what our engine reads; what scripts set of it is no change to Blender
    if not getattr(getattr(light.original.data, "cycles", None), "cast_shadow", data.use_shadow):
        raise ExportError(f"light '{light.name}': it casts no shadow, and such a lamp of POV-Ray's gives no highlight")
    if data.type == "SUN" and data.angle == 0.0:
        towards = (matrix.to_3x3() @ Vector((0.0, 0.0, 1.0))).normalized()
        return f"""light_source {{
  {vector(swapped(towards * 100.0 * size))}
  rgb {vector(e / math.pi for e in energy)}
  parallel point_at 0
}}
"""
    if data.type == "POINT" and data.shadow_soft_size == 0.0:
        fade = FADE * size
        # The power in W spreads over the sphere: intensity = power / (4 pi).
        colour = [e / (4.0 * math.pi) / (2.0 * math.pi * fade**2) for e in energy]
        return f"""light_source {{
  {vector(swapped(matrix.translation))}
  rgb {vector(colour)}
  fade_distance {number(fade)} fade_power 2
}}
"""
    raise ExportError(f"light '{light.name}': only sharp sun and point lights can be written")


def background_text(scene):
    world = scene.world
    colour = (0.0, 0.0, 0.0)
    if world and not scene.render.film_transparent:
        colour = world.color
        if world.use_nodes and world.node_tree:
            output = world.node_tree.get_output_node("ALL")
            node = output and linked_node(
                output.inputs["Surface"], "ShaderNodeBackground", f"world '{world.name}'"
            )
            strength = node.inputs["Strength"].default_value if node else 0.0
            colour = [strength * c for c in node.inputs["Color"].default_value[:3]] if node else (0, 0, 0)
    return f"background {{ rgb {vector(colour)} }}\n"


# ---- the whole -------------------------------------------------------------------------------


def scene_size(instances):
    """Largest distance of a bounding-box corner from the origin."""
    corners = (matrix @ Vector(c) for ob, matrix in instances for c in ob.bound_box)
    return max(corner.length for corner in corners)


def export(folder):
    """Write the open Blender file to `folder`; returns the number of meshes."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = depsgraph.scene_eval
    if scene.camera is None:
        raise ExportError("the scene has no camera")
    instances, lights = [], []
    for item in depsgraph.object_instances:
        if not item.show_self or item.object.hide_render or (item.parent and item.parent.hide_render):
            continue
        if item.object.type == "LIGHT":
            lights.append((item.object, item.matrix_world.copy()))
        elif isinstance(item.object.data, bpy.types.Mesh) and item.object.data.polygons:
            instances.append((item.object, item.matrix_world.copy()))
    if not instances or not lights:
        raise ExportError(f"the scene has no {'light' if instances else 'mesh'}")

    taken, textures, meshes, materials_text, meshes_text, objects = set(), {}, {}, [], [], []
    for ob, matrix in instances:
        slots = tuple(slot.material for slot in ob.material_slots)
        if not slots or None in slots:
            raise ExportError(f"object '{ob.name}': an empty material slot")
        worn = [(material, middle_of(ob.data, material)) for material in slots]
        for material, middle in worn:
            if (material, middle) not in textures:
                textures[material, middle] = identifier("Metal", material.name, taken)
                text = texture_text(material, folder, middle)
                materials_text.append(f"#declare {textures[material, middle]} = {text}\n")
            check_uv_map(ob.data, material, ob.name)
        key = (ob.data, slots)
        if key not in meshes:
            meshes[key] = identifier("Mesh", ob.name, taken)
            text = mesh_text(mesh_arrays(ob.data, ob.name), [textures[name] for name in worn])
            meshes_text.append(f"#declare {meshes[key]} = {text}\n")
        objects.append(f"object {{ {meshes[key]} {matrix_text(matrix)} }}\n")

    size = scene_size(instances)
    render = scene.render
    scale = render.resolution_percentage / 100.0
    includes = "".join(
        f'#include "{name}.inc"\n' for name in ("camera", "lights", "materials", "meshes")
    )
    files = {
        "camera.inc": camera_text(scene, scene.camera),
        "lights.inc": "".join(light_text(*light, size) for light in lights),
        "materials.inc": "".join(materials_text),
        "meshes.inc": "".join(meshes_text),
        "scene.pov": "#version 3.7;\n#declare mdf_Defaults = 1;\nglobal_settings { assumed_gamma 1 }\n"
        + includes + background_text(scene) + "".join(objects),
        "scene.ini": f"Width={int(render.resolution_x * scale)}\n"
        f"Height={int(render.resolution_y * scale)}\nInput_File_Name=scene.pov\n",
    }
    os.makedirs(folder, exist_ok=True)
    for name, text in files.items():
        note = ";" if name.endswith(".ini") else "//"
        source = os.path.basename(bpy.data.filepath) or "an unsaved file"
        whole.write_text(os.path.join(folder, name),
                         f"{note} Made from {source} by compare/export_povray.py.\n{text}")
    return len(meshes)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if arguments == ["--help"] or arguments == ["-h"]:
        print(__doc__)
        return
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("export_povray: expected one FOLDER after `--`; see `-- --help`", file=sys.stderr)
        sys.exit(2)
    try:
        count = export(os.path.abspath(arguments[0]))
    except ExportError as error:
        sys.exit(f"export_povray: {bpy.data.filepath or 'scene'}: {error}")
    print(f"export_povray: {count} meshes written to {arguments[0]}")


if __name__ == "__main__":
    main()
