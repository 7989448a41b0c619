# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie in the same place: which is seen is chance, in Cycles too."""

import numpy as np

_MOST = 100_000  # triangles; in larger scenes nothing is looked for: it takes .1 s for these
_FACES = 0.05  # of an object's, from which on it is worth a word


def name_twins(meshes, instances, messages):
    """Names objects of which many faces lie where others, or others of their own, do."""
    if sum(len(meshes[i["mesh"]]["corner_position"]) for i in instances) > 3 * _MOST:
        return
    middles = []
    for instance in instances:
        mesh, matrix = meshes[instance["mesh"]], np.array(instance["matrix"], float).reshape(-1, 4)[:3]
        placed = mesh["positions"].reshape(-1, 3) @ matrix[:, :3].T + matrix[:, 3]
        middles.append(placed[mesh["corner_position"].reshape(-1, 3)].mean(1))
    size = max((np.ptp(part, axis=0).max() for part in middles if len(part)), default=0.0)
    if not (np.isfinite(size) and size > 0) or not all(np.isfinite(part).all() for part in middles):
        return
    step = size * 2.0**-18
    parts = _shared(middles, step)
    names = {meshes[instance["mesh"]]["name"]: part for instance, part in zip(instances, parts) if part > _FACES}
    if names:
        rest = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
        messages.warning(f"{max(names, key=names.get)}{rest}: faces lie where others do; "
                         "which of them are seen is chance, in Cycles too")


def _shared(places, step):
    """By owner: which part of its places is there twice."""
    owners = np.repeat(np.arange(len(places)), [len(part) for part in places])
    whole = np.rint(np.concatenate(places) / step).astype(np.int64)
    order = np.lexsort(whole.T)
    same = (np.diff(whole[order], axis=0) == 0).all(1)
    twin = np.zeros(len(whole), bool)
    twin[order[1:]] |= same
    twin[order[:-1]] |= same
    return np.bincount(owners, twin, len(places)) / np.maximum(np.bincount(owners, minlength=len(places)), 1)
