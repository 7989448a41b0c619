# SPDX-License-Identifier: Apache-2.0
"""Linear pictures: reading, comparing, and writing them for the eye."""
import numpy as np
import OpenImageIO as oiio

import whole


def read(path):
    """RGB of a picture as float64, shape (height, width, 3), rows from the top."""
    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    try:
        names = source.spec().channelnames
        pixels = source.read_image(format=oiio.FLOAT)
    finally:
        source.close()
    if pixels is None:
        raise OSError(f"{path}: the pixels cannot be read")
    order = [names.index(c) for c in "RGB"] if set("RGB") <= set(names) else [0, 0, 0]
    return np.asarray(pixels, np.float64)[..., order]


def write_float(path, rgb):
    """Write RGB as a 32-bit float OpenEXR."""
    spec = oiio.ImageSpec(rgb.shape[1], rgb.shape[0], 3, oiio.FLOAT)
    spec.attribute("compression", "zip")
    _write(path, spec, np.asarray(rgb, np.float32))


def encode(rgb):
    """Linear light to sRGB, as 8-bit numbers."""
    clipped = np.clip(rgb, 0.0, 1.0)
    encoded = np.where(
        clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1.0 / 2.4) - 0.055
    )
    return np.round(255.0 * encoded).astype(np.uint8)


def write_png(path, rgb):
    """Write linear RGB as an 8-bit sRGB PNG."""
    spec = oiio.ImageSpec(rgb.shape[1], rgb.shape[0], 3, oiio.UINT8)
    _write(path, spec, encode(rgb))


def _write(path, spec, pixels):
    with whole.place(path) as part:
        target = oiio.ImageOutput.create(str(part))
        if target is None or not target.open(str(part), spec):
            raise OSError(f"{path}: {oiio.geterror()}")
        written = target.write_image(np.ascontiguousarray(pixels))
        if not target.close() or not written:
            raise OSError(f"{path}: {target.geterror()}")


def _check_pair(image, truth):
    if image.shape != truth.shape:
        raise ValueError(f"pictures of different size: {image.shape} and {truth.shape}")
    if not (np.isfinite(image).all() and np.isfinite(truth).all()):
        raise ValueError("a picture holds values that are not finite")
    if not np.mean(truth) > 0.0:
        raise ValueError("the picture to compare with is black")


def relative_difference(image, truth):
    """Mean absolute difference over the mean of `truth`."""
    _check_pair(image, truth)
    return float(np.mean(np.abs(image - truth)) / np.mean(truth))


def worst_channel(image, truth):
    """The same of each channel over its own mean, the largest. A channel darker than a tenth of
    the picture's mean counts as that bright."""
    _check_pair(image, truth)
    off = np.abs(image - truth).mean(axis=(0, 1))
    return float(np.max(off / np.maximum(truth.mean(axis=(0, 1)), 0.1 * np.mean(truth))))
