# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers at the corners of meshes, beside their UV map: what materials ask for, each once.

A layer is a kind and a name: UV, a map that is not the mesh's main one; TANGENT, its direction, which the
native module makes; GENERATED, places in the object's texture space; COLOR, a colour attribute ("": the
active one); ATTRIBUTE, any other, FACTOR, it as one number; POINTINESS and ISLAND, what the Geometry node says (islands.py); PARAMETRIC,
the first two weights of a triangle's corners; STRAND, what hair is where (strands.py), which no mesh has.
"""

import ctypes

import numpy as np

from . import islands

_WIDTHS = dict.fromkeys(("UV", "FACTOR", "POINTINESS", "ISLAND", "PARAMETRIC"), 2)  # the others have four


class Layers:
    """`listed`: what the native module gets."""

    def __init__(self):
        self.listed = []
        self._numbers = {}  # by kind and name

    def number(self, kind, name):
        key = kind, name
        if key not in self._numbers:
            given = {"width": _WIDTHS.get(kind, 4)}
            if kind == "TANGENT":
                given["tangents_of"] = self.number("UV", name)
            self._numbers[key] = len(self.listed)
            self.listed.append(given)
        return self._numbers[key]


def read(collection, attribute, width, dtype=np.float32):
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(attribute, values)
    return values


def integers(items, attribute, width):
    """The same of the integers that each item begins with, where items lie in one array: Blender asks for each by itself,
    which takes most of the time that a mesh does."""
    count = len(items)
    if count < 64:
        return read(items, attribute, width, np.int32)
    first, second, last = (items[at].as_pointer() for at in (0, 1, count - 1))
    step = second - first
    if step % 4 or not 4 * width <= step <= 16 or last != first + (count - 1) * step:
        return read(items, attribute, width, np.int32)
    there = np.ctypeslib.as_array((ctypes.c_int32 * (count * step // 4)).from_address(first)).reshape(count, step // 4)
    values = there[:, :width].copy()
    for at in (0, count // 2, count - 1):
        if not np.array_equal(values[at], np.ravel(getattr(items[at], attribute))):
            return read(items, attribute, width, np.int32)
    return values.ravel()


def uv_layer(mesh, name, owner, messages):
    """The UV map of that name, or the active render map; None without it."""
    if not name:
        return next((l for l in mesh.uv_layers if l.active_render), None)
    layer = mesh.uv_layers.get(name)
    if not layer:
        messages.warning(f"object '{owner}': no UV map '{name}'; 0 is used, as in Cycles")
    return layer


def uvs_of(layer):
    """Pairs, as one 64-bit number each, which move 5 times faster."""
    if hasattr(layer, "uv"):  # from 3.5 on
        return read(layer.uv, "vector", 2).view(np.int64)
    return read(layer.data, "uv", 2).view(np.int64)


def data_of(mesh, kind, name, where, owner, messages):
    """A layer of a mesh, by corner of its triangles; None where it has none, with a message. where:
    by domain, what each corner of a triangle is there."""
    if kind == "UV":
        layer = uv_layer(mesh, name, owner, messages)
        return uvs_of(layer)[where["CORNER"]].view(np.float32) if layer else None
    if kind == "GENERATED":
        return _generated(mesh)[where["POINT"]].ravel()
    if kind == "STRAND":
        return None
    if kind == "PARAMETRIC":
        return np.tile(np.float32([1, 0, 0, 1, 0, 0]), len(where["CORNER"].ravel()) // 3)
    if kind in ("POINTINESS", "ISLAND"):
        told = _of_islands(mesh, kind)
        return np.stack([told, 0 * told], 1)[where["POINT"]].ravel()
    attribute = _attribute(mesh, kind, name)
    if kind == "FACTOR":
        numbers = data_of(mesh, "ATTRIBUTE", name, where, owner, messages).reshape(-1, 4)
        pairs = attribute.data_type == "FLOAT2" if attribute else name in mesh.uv_layers
        return as_factor(numbers, pairs).ravel()
    layer = None if attribute else mesh.uv_layers.get(name) if name else None
    if layer:
        numbers = _four(uvs_of(layer).view(np.float32).reshape(-1, 2))
        return numbers[where["CORNER"]].ravel()
    domain = attribute.domain if attribute else ""
    later = hasattr(mesh, "corner_normals")  # 4.2 and 5.0 are as from 4.1 on, 3.4 is not [measured in Cycles]
    unread = domain == "EDGE" and attribute.data_type == "QUATERNION" or not later and domain and attribute.data_type == "INT8"
    numbers = four_of(attribute) if not unread and (domain in where or domain == "EDGE") else None
    if numbers is not None and domain == "EDGE":
        numbers, domain = _of_edges(mesh, attribute, numbers, later), "POINT"
    if numbers is None:
        what = "has no attribute" if not attribute else "cannot read its attribute"
        messages.warning(f"object '{owner}' {what} '{name}'; 0 is used")
        return np.tile(np.float32([0, 0, 0, 1]), len(where["CORNER"].ravel()))  # its alpha is 1, as in Cycles
    return numbers[where[domain]].ravel()


def _of_edges(mesh, attribute, numbers, later):
    """By vertex, four numbers from those of its edges: their mean, in later Blenders as Blender itself makes it."""
    at, count = integers(mesh.edges, "vertices", 2), len(mesh.vertices)
    edges = np.bincount(at, minlength=count)
    kind = attribute.data_type if later else ""
    if kind == "BYTE_COLOR":
        numbers = read(attribute.data, "color_srgb", 4).reshape(-1, 4)
    means = np.stack([np.bincount(at, np.repeat(part, 2), count) for part in numbers.T], 1) / np.maximum(edges, 1)[:, None]
    if kind == "BOOLEAN":
        means[:, :3] = means[:, :3] > 0
    elif kind in ("INT", "INT8"):
        means = np.floor(means + 0.5)
    elif kind == "BYTE_COLOR":
        means = np.floor(means * 255 + 1e-3) / 255
        means[:, :3] = np.where(means[:, :3] <= 0.04045, means[:, :3] / 12.92, ((means[:, :3] + 0.055) / 1.055) ** 2.4)
    return means.astype(np.float32)


def as_factor(numbers, pairs=False):
    """One number of four: of pairs the first, of others the mean."""
    return np.stack([numbers[:, 0] if pairs else numbers[:, :3].mean(1), 0 * numbers[:, 0]], 1)


def four_of(attribute):
    """Four numbers of each of its items; None where it is none that nodes can read."""
    if not attribute or attribute.data_type not in _READ:
        return None
    member, width = _READ[attribute.data_type]
    return _four(_numbers(attribute, member, width))


def _of_islands(mesh, kind):
    edges = integers(mesh.edges, "vertices", 2).reshape(-1, 2)
    if kind == "ISLAND":
        return islands.random_of_islands(edges, len(mesh.vertices))
    return islands.pointiness(*(read(mesh.vertices, what, 3).reshape(-1, 3) for what in ("co", "normal")), edges)


# What an attribute's items are called, and how many numbers they are, by its type.
_READ = {"FLOAT": ("value", 1), "INT": ("value", 1), "INT8": ("value", 1), "BOOLEAN": ("value", 1), "FLOAT2": ("vector", 2),
         "FLOAT_VECTOR": ("vector", 3), "FLOAT_COLOR": ("color", 4), "BYTE_COLOR": ("color", 4), "QUATERNION": ("value", 4)}


def _numbers(attribute, member, width):
    kind = {"INT": np.int32, "INT8": np.int8, "BOOLEAN": bool}.get(attribute.data_type, np.float32)
    return read(attribute.data, member, width, kind).astype(np.float32).reshape(-1, width)


def _four(numbers):
    """One number three times; what is missing of a vector is 0, of alpha 1."""
    count, width = numbers.shape
    if width == 4:
        return numbers
    made = np.zeros((count, 4), np.float32)
    made[:, 3] = 1
    made[:, :3 if width == 1 else width] = numbers
    return made


def _attribute(mesh, kind, name):
    if kind == "COLOR" and not name:
        colors = mesh.color_attributes
        at = colors.render_color_index
        return colors[at] if 0 <= at < len(colors) else None
    return mesh.attributes.get(name)


def _generated(mesh):
    """0 to 1 over the texture space of the mesh before modifiers deform it."""
    made = np.zeros((len(mesh.vertices), 4), np.float32)
    at = read(mesh.vertices, "undeformed_co", 3).reshape(-1, 3)
    place, size = np.array(mesh.texspace_location), np.array(mesh.texspace_size)
    scale = np.where(size != 0, 0.5 / np.where(size != 0, size, 1), 0)
    made[:, :3] = (at - place) * scale + 0.5
    return made
