# SPDX-License-Identifier: GPL-3.0-or-later
"""At which times a scene is evaluated while the shutter is open, and which it is left at. Without Blender."""

import importlib.util
import sys
from types import ModuleType
from types import SimpleNamespace as Made

import pytest

from native_scenes import ROOT

COST = 0.16


@pytest.fixture(scope="module")
def motion():
    add_on, package = ModuleType("exported"), ModuleType("exported.export")
    add_on._native, package.__path__ = None, [str(ROOT / "blender_addon_c/export")]
    sys.modules.update({"exported": add_on, "exported.export": package})
    try:
        spec = importlib.util.spec_from_file_location("exported.export.motion", ROOT / "blender_addon_c/export/motion.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        yield module
    finally:
        for name in [name for name in sys.modules if name.split(".")[0] == "exported"]:
            del sys.modules[name]


class Engine:
    """Takes down what frames it is set to."""

    def __init__(self, left_early=False):
        self.frames, self.left_early, self.camera_override = [], left_early, Made(parent=None)

    def test_break(self):
        return self.left_early

    def frame_set(self, frame, subframe):
        assert isinstance(frame, int) and 0 <= subframe < 1
        self.frames.append(frame + subframe)


def scene_at(frame, subframe, position, shutter=0.5):
    render = Made(motion_blur_shutter=shutter, motion_blur_position=position)
    return Made(scene=Made(frame_current=frame, frame_subframe=subframe, render=render), object_instances=[])


@pytest.mark.parametrize("subframe", [0.0, 0.375])
@pytest.mark.parametrize("position, middle", [("START", 0.25), ("CENTER", 0.0), ("END", -0.25)])
def test_the_shutter_opens_about_the_frame_with_its_part(motion, position, middle, subframe):
    """Three times half a frame: from where it opens to where it closes; then the middle is rendered, the end is as
    before."""
    engine = Engine()
    now = -3 + subframe
    with motion.Motion(engine, scene_at(-3, subframe, position), dict, True, None):
        rendered = [now, *engine.frames][-1]
        seen = set(engine.frames)
    assert rendered == pytest.approx(now + middle)
    assert {now + middle - 0.25, now + middle + 0.25} <= seen
    assert min(seen) == now + middle - 0.25 and max(seen) == now + middle + 0.25
    assert engine.frames[-1] == now


@pytest.mark.parametrize("subframe", [0.0, 0.5])
def test_vectors_go_from_a_frame_before_to_one_after(motion, subframe):
    engine = Engine()
    with motion.Motion(engine, scene_at(7, subframe, "END"), dict, False, None):
        assert sorted({*engine.frames}) == [6 + subframe, 7 + subframe, 8 + subframe]
    assert engine.frames[-1] == 7 + subframe


def test_what_is_broken_off_is_left_as_it_was(motion):
    engine = Engine(left_early=True)
    with motion.Motion(engine, scene_at(7, 0.25, "START"), dict, True, None):
        assert engine.frames == [7.5]
    assert engine.frames == [7.5, 7.25]


@pytest.mark.parametrize("own, parents, times", [(None, None, 3), (1, None, 3), (3, None, 9), (2, 4, 17), (99, None, 129)])
def test_times_double_with_each_step_as_in_cycles(motion, own, parents, times):
    """2 << (steps - 1), and one more; of an instance and what instances it the more. None where one is not blurred."""
    def thing(steps, blurred=True):
        return Made(cycles=Made(use_motion_blur=blurred, motion_steps=steps)) if steps else Made()

    instancer = thing(parents) if parents else None
    assert motion._steps(thing(own), instancer) == times
    assert motion._times(times) == pytest.approx([2 * k / (times - 1) - 1 for k in range(times)])
    assert motion._steps(thing(own), thing(1, blurred=False)) == 0


class Vectors(list):
    """A collection of Blender's."""

    def foreach_get(self, attribute, values):
        values[:] = [number for vector in self for number in vector]


def test_a_mesh_without_faces_has_places_and_no_normals_at_corners(motion):
    """From 4.1 on it has no list of what vertices its corners are at."""
    places = Vectors([(1, 2, 3), (4, 5, 6)])
    mesh = Made(vertices=places, vertex_normals=Vectors([(0, 0, 1), (0, 0, 1)]), corner_normals=Vectors(), normals_domain="POINT",
                attributes={})
    positions, normals = motion._shape(mesh)
    assert positions.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert normals.shape == (0, 3)
