# SPDX-License-Identifier: GPL-3.0-or-later
"""What is seen: the region of the picture, and cameras."""

import math

from .messages import SceneError


def region_of(scene, width, height):
    """Pixels to render, (x0, y0, x1, y1), y up from the bottom, rounded as Blender does."""
    render = scene.render
    if not render.use_border:
        return 0, 0, width, height
    return (int(render.border_min_x * width), int(render.border_min_y * height),
            int(render.border_max_x * width), int(render.border_max_y * height))


def camera_of(ob, depsgraph, size, messages):
    """A camera object, as a render of that size sees through it."""
    if ob is None or ob.type != "CAMERA":
        raise SceneError("the scene has no camera")
    ob = ob.evaluated_get(depsgraph)
    data, render = ob.data, depsgraph.scene_eval.render
    if data.type == "PANO":
        raise SceneError(f"camera '{ob.name}' is panoramic: use Perspective or Orthographic")
    # The projection holds lens, sensor fit, shift and aspect.
    projection = ob.calc_matrix_camera(depsgraph, x=size[0], y=size[1],
                                       scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    if not all(math.isfinite(projection[i][i]) and projection[i][i] for i in (0, 1)):
        raise SceneError(f"camera '{ob.name}' sees nothing: its view is of no size")
    view = camera_by(projection, ob.matrix_world, (data.clip_start, data.clip_end))
    return {**view, **_lens(ob, data, depsgraph, messages)} if data.dof.use_dof else view


def _lens(ob, data, depsgraph, messages):
    """Aperture and plane of focus. An orthographic camera has no focal length: as Cycles, 1 m."""
    dof = data.dof
    radius = (data.lens * 1e-3 if data.type == "PERSP" else 1.0) / (2.0 * max(dof.aperture_fstop, 1e-5))
    distance = _focus_distance(ob, dof, depsgraph)
    if distance < 1e-6:
        messages.warning(f"camera '{ob.name}': its focus is on the camera itself; all is sharp")
        return {}
    return {"lens": (radius / max(dof.aperture_ratio, 1e-5), radius), "focus": min(distance, 1e18),
            "blades": min(dof.aperture_blades, 1024), "turn": dof.aperture_rotation}


def _focus_distance(ob, dof, depsgraph):
    """Along the view; of an object that is where its origin is, or that of one of its bones."""
    if not dof.focus_object:
        return dof.focus_distance
    focus = dof.focus_object.evaluated_get(depsgraph)
    matrix = focus.matrix_world
    bone = focus.pose.bones.get(dof.focus_subtarget) if focus.pose else None
    if bone:
        matrix = matrix @ bone.matrix
    back = ob.matrix_world.to_3x3().col[2].normalized()
    return abs(back.dot(ob.matrix_world.translation - matrix.translation))


def camera_by(projection, to_world, clip):
    """A camera by its projection, turned back into the part of the view plane that it spans."""
    p = projection
    perspective = p[3][2] != 0
    frame = [((p[i][2] + side) if perspective else (side - p[i][3])) / p[i][i]
             for i in (0, 1) for side in (-1.0, 1.0)]
    place, turn, _scale = to_world.decompose()
    matrix = turn.to_matrix().to_4x4()
    matrix.translation = place
    return {"type": "PERSP" if perspective else "ORTHO", "matrix": rows(matrix),
            "frame": tuple(frame), "clip": clip}


def rows(matrix):
    return [value for row in matrix for value in row]
