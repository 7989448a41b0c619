# SPDX-License-Identifier: GPL-3.0-or-later
"""What a read of the scene leaves to the next one: meshes and images that nothing has changed since."""

import os
import time
from collections import namedtuple

import bpy

from .. import working_space
from .messages import Messages

_SLICE_SECONDS = 0.05
_undone = [0]  # how often: what is undone changes without updates


class Later(Exception):
    """The scene is not all read yet: ask again. What was read is kept."""


# asked: (number of the slot, how its material is, its index in the table); told: what the materials want of it
_Mesh = namedtuple("_Mesh", "mesh asked told owners messages")
# Addresses of the originals that it is made of. all: any of them; data: of the mesh; alone: the object where no other has it.
Owners = namedtuple("Owners", "all data alone")


class Kept:
    """Of one viewport. `meshes_read`: how many, ever."""

    def __init__(self):
        self.meshes_read = 0
        self._meshes, self._images, self._around, self._wanted = {}, {}, {}, set()
        self._read_as = None  # what else tells that all is to be read again
        self._spent, self._budget, self._started = 0.0, _SLICE_SECONDS, 0.0

    def changed(self, depsgraph):
        """Forget what a depsgraph's updates change."""
        for update in depsgraph.updates:
            place = update.id.original.as_pointer()
            if update.is_updated_geometry:
                self._meshes = {key: m for key, m in self._meshes.items() if place not in m.owners.all}
            if isinstance(update.id, bpy.types.Image):
                self._images = {key: found for key, found in self._images.items() if key[0] != update.id.name_full}

    def begin(self):
        read_as = _undone[0], working_space.from_rec709()
        if self._read_as != read_as:
            self._meshes, self._images, self._read_as = {}, {}, read_as
        self._wanted, self._spent, self._started = set(), 0.0, time.perf_counter()

    def end(self):
        """All is read: what was not asked for is gone from the scene."""
        self._meshes, self._images, self._around = ({key: found for key, found in kept.items() if key in self._wanted}
                                                    for kept in (self._meshes, self._images, self._around))
        self._budget = _SLICE_SECONDS

    def mesh(self, shape, way, owners, table, messages):
        """That of a shape, read or as it was; None without faces. Later where this slice has read enough."""
        key = (_address(shape.of), way, *(slot and slot.original.as_pointer() for slot in shape.slots))
        found = self._meshes.get(key)
        # what has gone may have left its address to another
        if not found or found.owners[1:] != owners[1:] or not _fits(found, shape, table):
            found = self._meshes[key] = self._read(shape, way, owners, table)
        self._wanted.add(key)
        for text in found.messages.warnings:
            messages.warning(text)
        return found.mesh and {**found.mesh, "name": shape.owner}

    def _read(self, shape, way, owners, table):
        if self._spent > self._budget:  # as long as the rest of a slice takes, or most time would go to that
            self._budget = max(_SLICE_SECONDS, time.perf_counter() - self._started - self._spent)
            raise Later
        started, recording, messages = time.perf_counter(), _Recording(table, shape.slots), Messages()
        mesh = shape.make(way, recording, messages)
        self._spent += time.perf_counter() - started
        self.meshes_read += 1
        return _Mesh(mesh, recording.asked, _told(recording.asked, table), owners, messages)

    def image(self, image, path, fetch):
        """Pixels of an image, fetched or as they were."""
        key, about = (image.name_full, path), _about(image, path)
        found = self._images.get(key)
        if not found or found[0] != about or image.is_dirty:
            found = (about, fetch())
            if not isinstance(found[1], int):
                self._images[key] = found
        self._wanted.add(key)
        return found[1]

    def around(self, program, images, render):
        """What a world's or a lamp's program makes of these images, rendered or as it was."""
        key = (program, *map(id, images))
        if key not in self._around:
            self._around[key] = render(), images  # which keep their ids then
        self._wanted.add(key)
        return self._around[key][0]


class _Recording:
    """A table of materials that remembers which were asked for."""

    def __init__(self, table, slots):
        self._table, self._slots, self.asked = table, list(slots) or [None], []

    def index(self, material, *way):
        number = self._table.index(material, *way)
        self.asked.append((self._slots.index(material), way, number))
        return number

    def __getattr__(self, name):
        return getattr(self._table, name)


def _told(asked, table):
    indices = [number for _slot, _way, number in asked]
    return table.uv_maps(indices), table.layers_of(indices), table.textured(indices), table.measured(indices)


def _fits(found, shape, table):
    """Do its materials still have the same numbers, and want the same of it? What warnings name has its name still?"""
    slots = list(shape.slots) or [None]
    named = not found.mesh or not found.messages.warnings or found.mesh["name"] == shape.owner
    return (named and all([table.index(slots[slot], *way) == number for slot, way, number in found.asked])
            and _told(found.asked, table) == found.told)


def _address(of):
    if isinstance(of, tuple):
        return tuple(map(_address, of))
    return of.as_pointer() if isinstance(of, bpy.types.bpy_struct) else of


def owners_of(item, depsgraph):
    """Those of an instance of a depsgraph."""
    ob = item.object
    data, owner = ob.original.data, ob.original.as_pointer()
    whole = (ob, ob.data, data, item.parent, item.instance_object if item.is_instance else None)
    shared = data is not None and data.evaluated_get(depsgraph) == ob.data
    return Owners(frozenset(one.original.as_pointer() for one in whole if one), data.as_pointer() if data else 0,
                  0 if shared else owner)


def _about(image, path):
    """What tells that a file is another one."""
    file = path if isinstance(path, str) else os.path.normpath(bpy.path.abspath(image.filepath, library=image.library))
    try:
        written = os.stat(file).st_mtime_ns
    except OSError:
        written = 0
    generated = (image.generated_type, tuple(image.generated_color)) if image.source == "GENERATED" else ()
    return (file, written, image.source, bool(image.packed_file), tuple(image.size), image.channels, image.is_float,
            image.colorspace_settings.name, image.alpha_mode, generated, len(image.tiles) if image.source == "TILED" else 0)


@bpy.app.handlers.persistent
def _forget(*_arguments):
    _undone[0] += 1


_HANDLERS = ("undo_post", "redo_post", "load_post")


def register():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).append(_forget)


def unregister():
    for name in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(_forget)
