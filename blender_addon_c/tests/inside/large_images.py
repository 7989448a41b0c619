# SPDX-License-Identifier: GPL-3.0-or-later
"""What a render of eight large images takes beside Blender's own copies of them.

Arguments: a folder, a side in texels. Prints "MEMORY <own> <beyond> <after>", all in MiB: what is resident
once Blender has loaded all images, how much more it was at most in the render, and how much more it is after it.
"""

import os
import re
import sys

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(__file__))
import common  # noqa: E402

IMAGES = 8
MEGABYTE = 1 << 20


def resident(name):
    """MiB; VmRSS now, VmHWM at most since `forget`."""
    with open("/proc/self/status", encoding="ascii") as status:
        return int(re.search(rf"^{name}:\s*(\d+) kB", status.read(), re.M).group(1)) / 1024


def forget():
    """The most is what is there now."""
    with open("/proc/self/clear_refs", "w", encoding="ascii") as refs:
        refs.write("5")


def write_image(path, side):
    """Bytes of four channels as a Targa file, which is as large as they are."""
    noise = np.random.default_rng(1).integers(0, 256, (256, side, 4), np.uint8)
    with open(path, "wb") as file:
        file.write(bytes([0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, side % 256, side // 256, side % 256, side // 256, 32, 8]))
        for _ in range(side // len(noise)):
            file.write(noise.tobytes())


def wall(scene, folder, side):
    """Eight planes beside each other, an image each: as data, which is looked up at points, in all of its texels."""
    first = os.path.join(folder, "0.tga")
    write_image(first, side)
    for k in range(IMAGES):
        path = os.path.join(folder, f"{k}.tga")
        if k:
            os.link(first, path)
        image = bpy.data.images.load(path)
        image.colorspace_settings.name = "Non-Color"
        material = bpy.data.materials.new(f"wall {k}")
        tree = common.tree_of(material)
        tree.links.new(common.image_node(tree, image).outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
        common.plane(material, 1.0).location = k % 4 - 1.5, k // 4 - 0.5, 0.0
        assert image.pixels[0] >= 0.0 and tuple(image.size) == (side, side)
    common.camera(scene, (0, 0, 4), type="ORTHO", ortho_scale=4.0)
    common.light(scene)


def main():
    folder, side = common.arguments()
    scene = common.empty_scene(960, 480, 16)
    wall(scene, folder, int(side))
    forget()
    own = resident("VmRSS")
    common.render(os.path.join(folder, "picture.exr"))
    print(f"MEMORY {own:.0f} {resident('VmHWM') - own:.0f} {resident('VmRSS') - own:.0f}")
    common.finish()


if __name__ == "__main__":
    sys.exit(main())
