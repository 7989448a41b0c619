# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers of objects, of what makes instances of them, and of view layers, that Attribute nodes ask for by name: where
Cycles looks for them, and as four numbers, as it has them.
"""

import numpy as np

from .strands import by_chance

NOTHING = (0.0,) * 4
_OF_PARTICLES = {"Lifetime": "lifetime", "Location": "location", "Size": "size", "Velocity": "velocity",
                 "Angular Velocity": "angular_velocity"}
ABSENT = (0.0, 0.0, 0.0, 1.0)  # of a surface that has none


class Attributes:
    """Those of a render, each once: `listed`, (kind, name), kind OBJECT, INSTANCER, INSTANCE (coordinates on the instancer),
    PARTICLE or POINT (of a cloud)."""

    def __init__(self, messages, frame):
        self.listed, self._messages, self._frame = [], messages, frame
        self._made = {}  # by object

    def number(self, kind, name):
        if (kind, name) not in self.listed:
            self.listed.append((kind, name))
        return self.listed.index((kind, name))

    def of_item(self, item):
        """What an instance of a depsgraph says of each of them."""
        return [self._found(item, kind, name) for kind, name in self.listed]

    def array(self, told):
        """As the native module takes what of_item said, of as many as were known then."""
        made = np.zeros((len(self.listed), 4), np.float32)
        rows = np.reshape(told, (-1, 4))
        made[:len(rows)] = np.clip(np.nan_to_num(rows), -3e38, 3e38)
        return made.ravel()

    def _found(self, item, kind, name):
        ob, owners = item.object, []
        if kind == "POINT":
            return NOTHING  # until it is known which
        if kind == "INSTANCE":
            return _place_on_instancer(item, name)
        if kind == "PARTICLE":
            return self._of_particle(item, name)
        if kind == "INSTANCER" and item.is_instance:
            system = item.particle_system
            owners = [lambda: _property(system and system.settings, name), lambda: self._of_nodes(item, name),
                      lambda: _property(item.parent, name)]
        owners += [lambda: _property(ob, name), lambda: _property(ob.data, name)]
        return next((told for told in (look() for look in owners) if told), NOTHING)

    def _of_particle(self, item, name):
        """Of the one that shows an instance, as Cycles numbers them; of none it is what a first one at nought says."""
        system = item.particle_system if item.is_instance else None
        number = item.persistent_id[0] if system and system.settings.type == "EMITTER" else 0
        if name == "Index":
            return four(number)
        if name == "Random":
            return four(float(by_chance(number)))
        if not system or system.settings.type != "EMITTER" or not 0 <= number < len(system.particles):
            return NOTHING
        particle = system.particles[number]
        if name == "Age":
            return four(self._frame - particle.birth_time)
        return four(getattr(particle, _OF_PARTICLES[name]))

    def _of_nodes(self, item, name):
        """Of an instance that geometry nodes made."""
        maker = item.parent
        if not maker or not any(modifier.type == "NODES" for modifier in maker.modifiers):
            return None
        if not hasattr(maker, "evaluated_geometry"):  # from 5.0 on
            self._messages.warning(f"object '{maker.name}': what its geometry nodes say of instances ('{name}') is not "
                                   "known to Python in this Blender; left out")
            return None
        key = maker.as_pointer()
        if key not in self._made:
            self._made[key] = _Made(maker.evaluated_geometry())
        return four(self._made[key].value(item.persistent_id, name))


_NO_ID = 0x7fffffff  # past the end of Blender's lists of ids


class _Made:
    """What nodes made of an object: instances, of what may be made of instances in turn."""

    def __init__(self, geometry):
        self._inside = {}  # by number of what is shown
        self._geometry, self._cloud = geometry, geometry.instances_pointcloud()
        ids = self._cloud.attributes.get("id") if self._cloud else None
        numbers = [one.value for one in ids.data] if ids else range(len(self._cloud.points) if self._cloud else 0)
        self._by_id = {}
        for index, number in enumerate(numbers):
            self._by_id.setdefault(number, index)

    def value(self, ids, name):
        """Of one instance, or of what it is in. ids: its own in what made it, then of that in what made that, ..."""
        ids = [number for number in ids if number != _NO_ID]
        index = self._by_id.get(ids[-1]) if ids else None
        if index is None:
            return None
        shown = self._cloud.attributes[".reference_index"].data[index].value
        if shown not in self._inside:
            inside = self._geometry.instance_references()[shown]
            self._inside[shown] = _Made(inside) if hasattr(inside, "instances_pointcloud") else None
        within = self._inside[shown] and self._inside[shown].value(ids[:-1], name)
        attribute = self._cloud.attributes.get(name) if within is None else None
        if not attribute:
            return within
        item = attribute.data[index]
        return next((getattr(item, member) for member in ("color", "vector", "value") if hasattr(item, member)), None)


def _place_on_instancer(item, name):
    """Where an instance is: of a particle or a face that shows it. Generated is scaled as in Cycles."""
    if not item.is_instance:
        return NOTHING
    return (*item.uv, 0.0, 1.0) if name == "UV" else (*(0.5 * part - 0.5 for part in item.orco), 1.0)


def four(value):
    """A number three times and 1; of up to four what is there, 0 and for the last 1; None of anything else."""
    if isinstance(value, (bool, int, float)):
        return (float(value),) * 3 + (1.0,)
    if isinstance(value, (str, bytes)) or hasattr(value, "keys") or not hasattr(value, "__len__") or len(value) > 4:
        return None
    try:
        numbers = tuple(float(part) for part in value)
    except (TypeError, ValueError):
        return None
    return numbers + (0.0, 0.0, 0.0, 1.0)[len(numbers):]


def _property(owner, name):
    """A custom one, else one of Blender's by its path; None where there is none that is numbers."""
    if owner is None or not name:
        return None
    if name in owner.keys():
        return four(owner[name])
    try:
        return four(owner.path_resolve(name))
    except (ValueError, TypeError):
        return None


def of_view_layer(depsgraph, name):
    """Of the view layer, else the scene, else its world."""
    scene = depsgraph.scene_eval
    found = (_property(owner, name) for owner in (depsgraph.view_layer_eval, scene, scene.world))
    return next((told for told in found if told), NOTHING)
