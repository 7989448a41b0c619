# SPDX-License-Identifier: Apache-2.0
"""Writes what the Blender that runs this has for Cycles to setup/cycles-has.txt, beside what others have: nodes with their
sockets, lights, cameras, passes. For a new version of Blender:

    blender -b --factory-startup --python-exit-code 1 -P setup/cycles_has.py        (of PyPI's bpy: python setup/cycles_has.py)
    make supported
"""
from pathlib import Path

import bpy

LIST = Path(__file__).with_name("cycles-has.txt")
HEAD = """# SPDX-License-Identifier: Apache-2.0
# Made by setup/cycles_has.py: kind | identifier | type | name | versions of Blender | inputs | outputs. Versions after a socket are those that have it."""
# What Blender has for EEVEE, Grease Pencil or Freestyle alone: nodes, a socket, passes.
NOT_CYCLES = ("ShaderNodeEeveeSpecular", "ShaderNodeShaderToRGB", "ShaderNodeOutputLineStyle", "ShaderNodeUVAlongStroke",
              "ShaderNodeLightAccumulation", "ShaderNodeLightEvaluation", "ShaderNodeLightInfo", "ShaderNodeLightIterInternalInput",
              "ShaderNodeLightIterInternalOutput", "ShaderNodeShadowRaycast", "ShaderNodeSqueeze", "LightIndex", "use_pass_grease_pencil",
              "use_pass_cryptomatte_accurate")
OF_ALL = ("NodeReroute", "NodeFrame", "NodeGroupInput", "NodeGroupOutput", "ShaderNodeGroup", "ShaderNodeCustomGroup")  # of no say


def nodes():
    group = bpy.data.node_groups.new("all", "ShaderNodeTree")
    for name in sorted(dir(bpy.types)):
        kind = getattr(bpy.types, name)
        if not (isinstance(kind, type) and issubclass(kind, bpy.types.Node)) or name in (*NOT_CYCLES, *OF_ALL):
            continue
        try:
            node = group.nodes.new(name)
        except RuntimeError:  # of no shader
            continue
        yield "node", name, node.type, node.bl_label, *([s.identifier for s in side if s.identifier not in ("__extend__", *NOT_CYCLES)]
                                                         for side in (node.inputs, node.outputs))


def choices(kind, rna):
    for item in rna.enum_items:
        yield kind, item.identifier, "", item.name, [], []


def passes():
    layer = bpy.context.view_layer
    for owner in (layer, layer.cycles):
        for rna in owner.bl_rna.properties:
            if rna.identifier.startswith(("use_pass_", "pass_debug", "denoising_store")) and rna.type == "BOOLEAN" \
                    and rna.identifier not in NOT_CYCLES:
                yield "pass", rna.identifier, "", rna.name, [], []


def everything():
    yield from nodes()
    yield from choices("light", bpy.types.Light.bl_rna.properties["type"])
    camera = bpy.data.cameras.new("camera")
    yield from choices("camera", camera.bl_rna.properties["type"])
    settings = camera if hasattr(camera, "panorama_type") else camera.cycles
    yield from choices("camera", settings.bl_rna.properties["panorama_type"])
    yield from passes()


def read():
    """By (kind, identifier): [type, name, versions, (socket: versions of it) of inputs, the same of outputs]."""
    found = {}
    for line in LIST.read_text(encoding="utf-8").splitlines() if LIST.is_file() else ():
        if line.startswith("#"):
            continue
        kind, identifier, type_, name, versions, *sides = (part.strip() for part in line.split("|"))
        versions = versions.split()
        found[kind, identifier] = [type_, name, versions, *({socket.partition(" (")[0]: socket.partition(" (")[2].rstrip(")").split() or versions
                                                             for socket in side.split(", ") if socket} for side in sides)]
    return found


def in_order(versions):
    return sorted(versions, key=lambda version: [int(part) for part in version.split(".")])


def add(found, version):
    for kept in found.values():  # of an earlier run
        for versions in (kept[2], *kept[3].values(), *kept[4].values()):
            if version in versions:
                versions.remove(version)
    for kind, identifier, type_, name, *sides in everything():
        kept = found.setdefault((kind, identifier), [type_, name, [], {}, {}])
        if version == in_order([version, *kept[2]])[-1]:
            kept[:2] = type_, name
        kept[2].append(version)
        for has, side in zip(kept[3:], sides):
            for socket in side:
                has.setdefault(socket, []).append(version)


def written(found):
    yield HEAD
    for (kind, identifier), (type_, name, versions, *sides) in sorted(found.items()):
        if versions:
            texts = (", ".join(socket if set(has) == set(versions) else f"{socket} ({' '.join(in_order(set(has)))})"
                               for socket, has in side.items() if has) for side in sides)
            yield " | ".join((kind, identifier, type_, name, " ".join(in_order(set(versions))), *texts)).rstrip()


def main():
    found = read()
    for kept in found.values():  # each its own list
        kept[2] = list(kept[2])
        for side in kept[3:]:
            side.update((socket, list(has)) for socket, has in side.items())
    add(found, "{}.{}".format(*bpy.app.version))
    LIST.write_text("\n".join(written(found)) + "\n", encoding="utf-8")


main()
