# SPDX-License-Identifier: GPL-3.0-or-later
"""Where things are while the shutter is open: the scene is evaluated at each of these times, as Cycles does."""

import math

import numpy as np

from . import normals
from .layers import read

_SHUTTER_STEPS = 256  # as in the native module
_MOST_STEPS = 7       # 129 times


class Still:
    """Nothing moves."""

    blurs = False

    def __enter__(self):
        return self

    def __exit__(self, *_error):
        pass

    def place(self, _item):
        return None

    def shape(self, _ob, _mesh, _corners, _corner_positions):
        return {}

    def bends(self, _ob):
        return False

    def camera(self):
        return {}

    def scene(self):
        return {}


class Motion(Still):
    """Evaluates the scene at other times and then at the one to be rendered; at the end it is as it was. blurs: else
    a pass says how it moves."""

    def __init__(self, engine, depsgraph, camera, blurs, messages):
        self.blurs = blurs
        self._engine, self._depsgraph, self._messages = engine, depsgraph, messages
        self._camera = camera  # makes one of the scene as it is
        scene = depsgraph.scene
        self._frame = scene.frame_current + scene.frame_subframe
        self._shutter = scene.render.motion_blur_shutter if blurs else 2.0  # from a frame before to one after
        position = getattr(blur_settings(scene), "motion_blur_position", "CENTER")
        shift = {"START": 0.5, "CENTER": 0.0, "END": -0.5}[position]
        self._middle = self._frame + (shift * self._shutter if blurs else 0.0)
        self._places, self._shapes, self._cameras, self._wanted = {}, {}, {}, {}

    def __enter__(self):
        try:
            self._at(self._middle)
            self._find()
            for time in sorted({t for steps in self._wanted.values() for t in _times(steps)} - {0.0}):
                if self._engine.test_break():  # what was not seen at all times is not blurred
                    break
                self._at(self._middle + 0.5 * time * self._shutter)
                self._keep(time)
            self._at(self._middle)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_error):
        if self._now != self._frame:
            self._at(self._frame)

    _now = None

    def _at(self, frame):
        if frame == (self._frame if self._now is None else self._now):
            self._now = frame
            return
        self._now = frame
        whole = math.floor(frame)
        self._engine.frame_set(whole, subframe=frame - whole)

    def _find(self):
        """What may move, at how many times, and where it is in the middle."""
        scene = self._depsgraph.scene
        self._camera_owner = self._engine.camera_override
        self._wanted["camera"] = self._steps(self._camera_owner, None)
        bends = {}
        for item in self._depsgraph.object_instances:
            steps = self._steps(item.object, item.parent)
            if not steps or not (item.show_self or item.show_particles):
                continue
            self._wanted[_key(item)] = steps
            ob = item.object.original
            if not self._is_own(item.object):
                continue
            if ob not in bends:
                bends[ob] = item.object.type == "MESH" and ob.is_deform_modified(scene, "RENDER")
            if bends[ob] and (not self.blurs or (_may_bend(item.object) and _may_bend(item.parent))):
                self._wanted["shape", ob] = max(steps, self._wanted.get(("shape", ob), 0))
        self._keep(0.0)

    def _steps(self, ob, parent):
        return _steps(ob, parent) if self.blurs else 3

    def _keep(self, time):
        """All that is wanted, as it is now."""
        if time in _times(self._wanted["camera"]):
            self._cameras[time] = self._camera()
        shapes = set()
        for item in self._depsgraph.object_instances:
            key, ob = _key(item), item.object.original
            if time in _times(self._wanted.get(key, 0)):
                self._places.setdefault(key, {})[time] = np.array(item.matrix_world, np.float32)[:3]
            if ob not in shapes and self._is_own(item.object) and time in _times(self._wanted.get(("shape", ob), 0)):
                shapes.add(ob)
                self._shapes.setdefault(ob, {})[time] = _shape(item.object.data)

    def place(self, item):
        """Matrices of what moves, by time; else None."""
        steps, places = self._wanted.get(_key(item), 0), self._places.get(_key(item), {})
        if len(places) < max(2, steps):  # it is not there at all times
            return None
        matrices = np.stack([places[time] for time in _times(steps)])
        if not np.isfinite(matrices).all():
            self._messages.warning(f"object '{item.object.name}': its place is not always a number; it is not blurred")
            return None
        return None if (matrices == matrices[0]).all() else np.ascontiguousarray(matrices)

    def _is_own(self, ob):
        """Is its mesh its own, and not one of those that its geometry nodes show?"""
        return ob.original.evaluated_get(self._depsgraph).data == ob.data

    def bends(self, ob):
        """Does its mesh change its shape, and can that be told?"""
        if not self._is_own(ob):
            return False
        shapes = self._shapes.get(ob.original, ())
        if len(shapes) < max(2, self._wanted.get(("shape", ob.original), 0)):  # it is not there at all times
            return False
        first, *rest = shapes.values()
        if all(np.array_equal(first[0], other[0]) for other in rest):
            return False
        same = all(first[k].shape == other[k].shape for other in rest for k in (0, 1))
        if not same or not all(np.isfinite(shape[0]).all() for shape in shapes.values()):
            self._messages.warning(f"object '{ob.name}': its mesh is not of the same points while the shutter is open; "
                                   "its shape is not blurred")
            return False
        return True

    def shape(self, ob, mesh, corners, corner_positions):
        """Positions and normals at the corners of triangles, by time."""
        if not self.bends(ob):
            return {}
        shapes = [self._shapes[ob.original][time] for time in _times(self._wanted["shape", ob.original])]
        if corners.max() >= len(shapes[0][1]):
            return {}
        moved, flat = [made[corners] for _, made in shapes], normals.flat(mesh)
        for (positions, _), made in zip(shapes, moved):
            normals.flatten(made, flat, positions, corner_positions)
        return {"moved_positions": np.stack([positions for positions, _ in shapes]), "moved_normals": np.stack(moved)}

    def camera(self):
        """Where it stands and how wide it sees, by time."""
        steps = self._wanted["camera"]
        if len(self._cameras) < max(2, steps):
            return {}
        views = [self._cameras[time] for time in _times(steps)]
        matrices = np.array([view["matrix"][:12] for view in views], np.float32)
        frames = np.array([view["frame"] for view in views], np.float32)
        wide = {} if (frames == frames[0]).all() else {"frames": frames}
        if not np.isfinite(matrices).all() or (not wide and (matrices == matrices[0]).all()):
            return {}
        return {"motion": matrices, **wide}

    def scene(self):
        """When the shutter is open: times by an even number, where it does not open all at once; how long for each
        line, where they see one after another."""
        if not self.blurs:
            return {"vectors": True}
        return {**self._curve(), **self._lines()}

    def _lines(self):
        cycles = getattr(self._depsgraph.scene, "cycles", None)
        if getattr(cycles, "rolling_shutter_type", "NONE") == "NONE":
            return {}
        return {"line_time": cycles.rolling_shutter_duration}

    def _curve(self):
        curve = self._depsgraph.scene.render.motion_blur_shutter_curve
        curve.initialize()
        x = np.linspace(0.0, 1.0, _SHUTTER_STEPS + 1)
        open_ = np.array([max(curve.evaluate(curve.curves[0], float(v)), 0.0) for v in x])
        whole = np.concatenate(([0.0], np.cumsum(0.5 * (open_[1:] + open_[:-1]))))
        if not whole[-1] > 0 or np.ptp(open_) < 1e-4 * open_.max():
            return {}
        return {"shutter": np.float32(np.interp(x, whole / whole[-1], x))}


def blur_settings(scene):
    """Whose the position of the shutter is: until 4.1 that of Cycles, which may be switched off; then the render's."""
    return scene.render if hasattr(scene.render, "motion_blur_position") else getattr(scene, "cycles", None)


def motion_of(engine, depsgraph, camera, dump, messages):
    """A context in which the scene is as it is to be rendered, and that knows what moves."""
    render = depsgraph.scene.render
    blurs = render.use_motion_blur and getattr(depsgraph.view_layer, "use_motion_blur", True)
    vectors = depsgraph.view_layer.use_pass_vector
    if vectors and blurs:
        messages.warning("the Vector pass is empty where motion is blurred, as in Cycles")
    if vectors and not blurs:
        return Motion(engine, depsgraph, camera, False, messages)
    if not blurs or not render.motion_blur_shutter > 0:
        return Still()
    if dump:
        messages.warning("a dump has no motion blur: all is as it is at the frame")
        return Still()
    return Motion(engine, depsgraph, camera, True, messages)


def _key(item):
    """The same at all times."""
    return item.object.original, item.parent and item.parent.original, tuple(item.persistent_id)


def _steps(ob, parent):
    """At how many times; 0: it is not blurred. What instances it has a say, as in Cycles."""
    owners = [getattr(owner, "cycles", None) for owner in (ob, parent) if owner]
    if not all(getattr(owner, "use_motion_blur", True) for owner in owners):
        return 0
    most = max((getattr(owner, "motion_steps", 1) for owner in owners), default=1)
    return (2 << min(max(most, 1), _MOST_STEPS) - 1) + 1


def _may_bend(ob):
    return not ob or getattr(getattr(ob, "cycles", None), "use_deform_motion", True)


def _times(steps):
    """Of so many, -1 when the shutter opens and 1 when it closes."""
    return [2.0 * k / (steps - 1) - 1.0 for k in range(steps)] if steps > 1 else []


def _shape(mesh):
    """Positions, and normals by loop."""
    positions = read(mesh.vertices, "co", 3).reshape(-1, 3)
    if hasattr(mesh, "corner_normals"):  # from 4.1 on
        return positions, normals.of_loops(mesh)
    mesh.calc_normals_split()
    made = normals.of_loops(mesh)
    mesh.free_normals_split()
    return positions, made
