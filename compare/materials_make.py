# SPDX-License-Identifier: Apache-2.0
"""Run inside Blender, or by the Python of bpy: the materials of materials.py, in one file.

    blender -b --factory-startup --python-exit-code 9 -P materials_make.py -- OUTPUT.blend

Each function of materials_list.py builds one: its name is the material's.
"""
import os
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import materials_list  # noqa: E402

# Sockets by their names of 4.0 on, and what those of 3.4 are called.
OLD = {"Specular IOR Level": "Specular", "Coat Weight": "Clearcoat", "Coat Roughness": "Clearcoat Roughness",
       "Coat Normal": "Clearcoat Normal", "Sheen Weight": "Sheen", "Transmission Weight": "Transmission",
       "Emission Color": "Emission", "Subsurface Weight": "Subsurface"}
NEW = {"Fac": "Factor"}  # of 5.x
# Of the same node, where Blender has no such socket: a picture without is as good.
GONE = {"Coat Tint", "Coat IOR", "Sheen Roughness", "Thin Film Thickness", "Thin Film IOR", "Diffuse Roughness", "Subsurface Color",
        "Subsurface Scale", "Lacunarity", "Normalize"}


def _found(sockets, name):
    """That of a name, or of one that it has in other Blenders; KeyError where there is none."""
    for want in (name, OLD.get(name), NEW.get(name)):
        for socket in sockets:
            if socket.enabled and socket.name == want:
                return socket
    raise KeyError(f"no socket '{name}' among {[socket.name for socket in sockets]}")


class Node:
    """One node; linked by its first output that is on, or by the output of a name."""

    def __init__(self, node):
        self.node = node

    def output(self):
        return next(socket for socket in self.node.outputs if socket.enabled)

    def __getitem__(self, name):
        return _Output(_found(self.node.outputs, name))


class _Output:
    def __init__(self, socket):
        self.socket = socket

    def output(self):
        return self.socket


class Maker:
    """Of one material: called with a kind of node, its properties in `set` and its inputs by their names, _ for a space."""

    def __init__(self, name):
        material = bpy.data.materials.new(name)
        if bpy.app.version < (5, 0):
            material.use_nodes = True
        material.use_fake_user = True
        self.tree, self.new = material.node_tree, bpy.app.version >= (4, 0)
        self.tree.nodes.clear()
        self.end = self("OutputMaterial")

    def __call__(self, kind, set=None, **inputs):  # noqa: A002 as Blender's node says it
        node = self.tree.nodes.new("ShaderNode" + kind)
        for name, value in (set or {}).items():
            setattr(node, name, value)
        for name, value in inputs.items():
            self._give(node, name.replace("_", " "), value)
        return Node(node)

    def _give(self, node, name, value):
        try:
            socket = ([s for s in node.inputs if s.enabled][int(name[3:])] if name.startswith("in ") else
                      _found(node.inputs, name))
        except KeyError:
            if name not in GONE:
                raise
            return
        if hasattr(value, "output"):
            self.tree.links.new(value.output(), socket)
        elif socket.type == "RGBA":
            socket.default_value = (*value[:3], 1) if not isinstance(value, (int, float)) else (value, value, value, 1)
        else:
            socket.default_value = value

    def surface(self, shader):
        self._give(self.end.node, "Surface", shader)

    def displaced(self, vector):
        self._give(self.end.node, "Displacement", vector)

    def principled(self, **inputs):
        return self("BsdfPrincipled", **inputs)

    def place(self, scale=1.0, kind="Object", turn=(0, 0, 0)):
        """Coordinates, scaled."""
        scale = (scale,) * 3 if isinstance(scale, (int, float)) else scale
        return self("Mapping", Vector=self("TexCoord")[kind], Scale=scale, Rotation=turn)

    def noise(self, at=None, scale=5.0, detail=2.0, roughness=0.5, distortion=0.0, color=False):
        made = self("TexNoise", Scale=scale, Detail=detail, Roughness=roughness, Distortion=distortion,
                    **({"Vector": at} if at else {}))
        return made["Color" if color else "Fac"]

    def musgrave(self, at, scale, detail, kind="FBM", **more):
        """A node until 4.0, then a kind of noise."""
        if hasattr(bpy.types, "ShaderNodeTexMusgrave"):
            return self("TexMusgrave", {"musgrave_type": kind}, Vector=at, Scale=scale, Detail=detail, **more)
        return self("TexNoise", {"noise_type": kind, "normalize": False}, Vector=at, Scale=scale, Detail=detail - 1, **more)

    def voronoi(self, at, scale, feature="F1", output="Distance", **more):
        return self("TexVoronoi", {"feature": feature}, Vector=at, Scale=scale, **more)[output]

    def wave(self, at, scale, distortion=0.0, kind="BANDS", detail=2.0, profile="SIN", way="X"):
        return self("TexWave", {"wave_type": kind, "wave_profile": profile, f"{kind.lower()}_direction": way},
                    Vector=at, Scale=scale, Distortion=distortion, Detail=detail)["Fac"]

    def ramp(self, by, *stops, how="LINEAR"):
        """stops: (place, colour or grey)"""
        node = self("ValToRGB", Fac=by)
        ramp = node.node.color_ramp
        ramp.interpolation = how
        while len(ramp.elements) < len(stops):
            ramp.elements.new(0.5)
        for element, (at, color) in zip(ramp.elements, stops):
            element.position = at
            element.color = (*color, 1) if not isinstance(color, (int, float)) else (color, color, color, 1)
        return node

    def range(self, value, low, high, first=0.0, last=1.0):
        return self("MapRange", Value=value, From_Min=first, From_Max=last, To_Min=low, To_Max=high)

    def math(self, operation, *values):
        return self("Math", {"operation": operation}, **{f"in_{k}": value for k, value in enumerate(values)})

    def color(self, blend, by, a, b):
        return self("Mix", {"data_type": "RGBA", "blend_type": blend}, in_0=by, in_1=a, in_2=b)

    def bump(self, height, strength=0.3, distance=0.1, normal=None, invert=False):
        return self("Bump", {"invert": invert}, Height=height, Strength=strength, Distance=distance,
                    **({"Normal": normal} if normal else {}))

    def mix(self, by, a, b):
        return self("MixShader", in_0=by, in_1=a, in_2=b)

    def add(self, a, b):
        return self("AddShader", in_0=a, in_1=b)

    def image(self, pixels, at=None, data=False):
        """pixels: rows from below of colours in 0 to 1."""
        rows, columns, _three = pixels.shape
        made = bpy.data.images.new(self.tree.name, columns, rows)
        made.pixels.foreach_set(np.concatenate([pixels, np.ones((rows, columns, 1))], 2).astype(np.float32).ravel())
        made.pack()
        if data:
            made.colorspace_settings.name = "Non-Color"
        return self("TexImage", {"image": made}, **({"Vector": at} if at else {}))["Color"]


def main(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name, build in (materials_list.BUILDERS | materials_list.STRANDS).items():
        made = Maker(name)
        made.surface(build(made))
    bpy.ops.wm.save_as_mainfile(filepath=path)
    sys.stdout.flush()
    os._exit(0)  # bpy's own exit hangs in some versions


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1])
