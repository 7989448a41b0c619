# SPDX-License-Identifier: GPL-3.0-or-later
"""Light groups: what lamps, objects that shine and the world of one name light, each a picture of its own."""

import numpy as np

from .aov import BLACK

_BESIDE = ("planes", "mattes", "matte_slots", "mist", "use_denoising", "denoiser")  # of the picture alone
_WORLD = ("sky", "looks", "backdrop", "backdrop_sky")


def names_of(view_layer):
    """Those that a view layer asks for."""
    return [one.name for one in getattr(view_layer, "lightgroups", ())]


def pass_of(name):
    return f"Combined_{name}"


def view(scene, name):
    """The scene with the light of that group alone."""
    kept = {key: value for key, value in scene.items() if key not in _BESIDE}
    if scene["group"] != name:
        kept = {key: value for key, value in kept.items() if key not in _WORLD} | {"background": (0.0,) * 3}
    materials, meshes = _Dark(scene["materials"]), list(scene["meshes"])
    known, instances = {}, []
    for one in scene["instances"]:
        mesh = one["mesh"]
        if one["group"] != name and mesh not in known:
            known[mesh] = mesh
            dark = materials.of(meshes[mesh])
            if dark is not None:
                known[mesh] = len(meshes)
                meshes.append({**meshes[mesh], "material": dark})
        instances.append(one if one["group"] == name or known[mesh] == mesh else {**one, "mesh": known[mesh]})
    return {**kept, "lights": [one for one in scene["lights"] if one["group"] == name], "materials": materials.listed,
            "meshes": meshes, "instances": instances, "dump": ""}


class _Dark:
    """Materials, and the same without what shines in them. `listed`: all of them."""

    def __init__(self, materials):
        self.listed, self._of = list(materials), {}

    def of(self, mesh):
        """Indices of those of a mesh's triangles, none of which shines; None where none did."""
        used = {int(index): self._dark(int(index)) for index in np.unique(mesh["material"])}
        if all(index == dark for index, dark in used.items()):
            return None
        indices = mesh["material"].copy()
        for index, dark in used.items():
            indices[mesh["material"] == index] = dark
        return indices

    def _dark(self, index):
        if index not in self._of:
            self._of[index] = index
            made = self.listed[index]
            closures = made.get("closures", [made])
            left = [one for one in closures if one["closure"] != "EMISSION" or one.get("holds")]
            if len(left) < len(closures):
                self._of[index] = len(self.listed)
                if "closures" in made:
                    made = {**made, "closures": left or [BLACK]}
                else:
                    made = {**made, **BLACK}
                self.listed.append(made)
        return self._of[index]
