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


def camera_of(ob, depsgraph, size, messages, eye=None):
    """A camera object, as a render of that size sees through it. eye: where it stands and what shifts it sideways, where
    it is one of several."""
    if ob is None or ob.type != "CAMERA":
        raise SceneError("the scene has no camera")
    ob = ob.evaluated_get(depsgraph)
    data, render = ob.data, depsgraph.scene_eval.render
    matrix, shift = eye or (ob.matrix_world, data.shift_x)
    if data.type == "PANO":
        view = _panorama(ob, data, render, size, (matrix, shift), messages)
        return {**view, **_lens(ob, data, depsgraph, messages)} if data.dof.use_dof else view
    if data.type not in {"PERSP", "ORTHO"}:
        messages.warning(f"camera '{ob.name}': {_KINDS.get(data.type, data.type.lower())} cameras are not supported; seen in perspective")
    # The projection holds lens, sensor fit, shift and aspect.
    projection = ob.calc_matrix_camera(depsgraph, x=size[0], y=size[1],
                                       scale_x=render.pixel_aspect_x, scale_y=render.pixel_aspect_y)
    if not all(math.isfinite(projection[i][i]) and projection[i][i] for i in (0, 1)):
        raise SceneError(f"camera '{ob.name}' sees nothing: its view is of no size")
    view = camera_by(projection, matrix, (data.clip_start, data.clip_end))
    if shift != data.shift_x:  # by which part of the picture
        left, right, *rest = view["frame"]
        width, height = size[0] * render.pixel_aspect_x, size[1] * render.pixel_aspect_y
        longest = height / width if _fit(data, width, height) == "VERTICAL" else 1.0
        aside = (right - left) * longest * (shift - data.shift_x)
        view["frame"] = left + aside, right + aside, *rest
    return {**view, **_lens(ob, data, depsgraph, messages)} if data.dof.use_dof else view


_KINDS = {"CUSTOM": "custom (OSL)"}
_PANORAMAS = ("EQUIRECTANGULAR", "EQUIANGULAR_CUBEMAP_FACE", "MIRRORBALL", "FISHEYE_EQUIDISTANT",
              "FISHEYE_EQUISOLID", "FISHEYE_LENS_POLYNOMIAL", "CENTRAL_CYLINDRICAL")  # as in the native module


def _fit(data, width, height):
    """Which side the size of the sensor is that of."""
    return data.sensor_fit if data.sensor_fit != "AUTO" else "HORIZONTAL" if width >= height else "VERTICAL"


def _panorama(ob, data, render, size, eye, messages):
    """A camera that sees around it. Its settings are Cycles' until 4.5, then its own."""
    matrix, shift = eye
    if render.use_multiview and render.views_format == "STEREO_3D" and data.stereo.use_spherical_stereo:
        messages.warning(f"camera '{ob.name}': Spherical Stereo is not supported; its eyes stand still")
    settings = data if hasattr(data, "panorama_type") else getattr(data, "cycles", None)
    kind = getattr(settings, "panorama_type", "EQUIRECTANGULAR")
    if kind not in _PANORAMAS:
        messages.warning(f"camera '{ob.name}': panoramas of type {kind.lower()} are not supported; equirectangular")
        kind = "EQUIRECTANGULAR"

    def value(name, otherwise):
        return getattr(settings, name, otherwise)

    if kind == "CENTRAL_CYLINDRICAL":
        radius = max(value("central_cylindrical_radius", 1.0), 1e-6)
        low, high = (value(f"central_cylindrical_range_v_{end}", 1.0) / radius for end in ("min", "max"))
        sides = *(value(f"central_cylindrical_range_u_{end}", 0.0) for end in ("min", "max")), low, high
    else:
        sides = [value(f"{name}_{end}", sign * most) for name, most in
                 (("longitude", math.pi), ("latitude", math.pi / 2)) for end, sign in (("min", -1), ("max", 1))]
    width, height = size[0] * render.pixel_aspect_x, size[1] * render.pixel_aspect_y
    fit = _fit(data, width, height)
    measure = data.sensor_height if data.sensor_fit == "VERTICAL" else data.sensor_width
    unit = measure / (width if fit == "HORIZONTAL" else height)
    frame = shift, 1.0 + shift, data.shift_y, 1.0 + data.shift_y  # of the picture, whatever its shape
    view = _placed(matrix)
    return {**view, "type": "PANO", "panorama": kind, "frame": frame, "range": sides,
            "clip": (data.clip_start, data.clip_end), "fov": value("fisheye_fov", math.pi),
            "focal": max(value("fisheye_lens", 10.5), 1e-6), "sensor": (width * unit, height * unit),
            "polynomial": [value(f"fisheye_polynomial_k{k}", 0.0) for k in range(5)]}


def _lens(ob, data, depsgraph, messages):
    """Aperture and plane of focus. An orthographic camera has no focal length: as Cycles, 1 m."""
    dof = data.dof
    radius = (data.lens * 1e-3 if data.type != "ORTHO" else 1.0) / (2.0 * max(dof.aperture_fstop, 1e-5))
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
    return {**_placed(to_world), "type": "PERSP" if perspective else "ORTHO", "frame": tuple(frame), "clip": clip}


def _placed(to_world):
    """Where it stands, whatever its size."""
    place, turn, _scale = to_world.decompose()
    matrix = turn.to_matrix().to_4x4()
    matrix.translation = place
    return {"matrix": rows(matrix)}


def rows(matrix):
    return [value for row in matrix for value in row]
