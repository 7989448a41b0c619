# SPDX-License-Identifier: Apache-2.0
"""A made-up dump: half of a sphere seen from above, one light."""
import json

import numpy as np
import OpenImageIO as oiio


def planes(size=64):
    """{channel: plane} of a unit sphere under an orthographic camera."""
    side = (np.arange(size) + 0.5) / size * 2.4 - 1.2
    x, y = np.meshgrid(side, side[::-1])
    inside = x**2 + y**2 < 0.98
    z = np.sqrt(np.where(inside, 1.0 - x**2 - y**2, 1.0))
    normal = np.stack([x, y, z], axis=-1)
    tangent = np.stack([z, np.zeros_like(x), -x], axis=-1)
    tangent /= np.linalg.norm(tangent, axis=-1, keepdims=True)
    up = np.broadcast_to([0.0, 0.0, 1.0], normal.shape)
    light = np.broadcast_to(np.array([0.6, 0.0, 0.8]), normal.shape)
    vectors = {"P": normal, "N": normal, "T": tangent, "Ns": normal, "V": up, "light0.L": light}
    result = {f"{n}.{c}": v[..., i] for n, v in vectors.items() for i, c in enumerate("XYZ")}
    for i, c in enumerate("RGB"):
        result[f"light0.E.{c}"] = np.full_like(x, 1.0 + i)
        result[f"light0.S.{c}"] = np.full_like(x, 0.1)
    result["uv.U"], result["uv.V"] = x, y
    result = {name: np.where(inside, plane, 0.0) for name, plane in result.items()}
    result["material.ID"] = np.where(inside, 0.0, -1.0)
    return result


EMPTY_HEADER = {"version": "0", "materials": []}


def write(path, channels, header=EMPTY_HEADER):
    """Write planes as a dump; `header` as JSON, None leaves the attribute out."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    spec = oiio.ImageSpec(width, height, len(names), oiio.FLOAT)
    spec.channelnames = names
    if header is not None:
        spec.attribute("libshade", json.dumps(header))
    target = oiio.ImageOutput.create(str(path))
    assert target.open(str(path), spec), oiio.geterror()
    assert target.write_image(np.stack([channels[n] for n in names], -1).astype(np.float32))
    target.close()
    return path
