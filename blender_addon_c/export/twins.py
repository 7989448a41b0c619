# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie in the same place: which is seen is chance, in Cycles too."""

import numpy as np

_MOST = 100_000  # triangles; in larger scenes boxes alone are looked at: it takes .1 s for these
_FACES = 0.05  # of an object's, from which on it is worth a word


def name_twins(meshes, instances, messages):
    """Names objects of which many faces lie where others, or others of their own, do."""
    whole = sum(len(meshes[i["mesh"]]["corner_position"]) for i in instances) <= 3 * _MOST
    if not whole and len(instances) > _MOST:
        return
    middles, boxes, known = [], [], {}
    for instance in instances:
        mesh, matrix = meshes[instance["mesh"]], np.array(instance["matrix"], float).reshape(-1, 4)[:3]
        places = mesh["positions"].reshape(-1, 3)
        if not whole:
            places = _box(mesh, places, known)
        placed = places @ matrix[:, :3].T + matrix[:, 3]
        middles.append(placed[mesh["corner_position"].reshape(-1, 3)].mean(1) if whole else placed)
        boxes.append(np.array([placed.min(0), placed.max(0)]) if len(placed) else np.zeros((2, 3)))
    size = max((np.ptp(part, axis=0).max() for part in middles if len(part)), default=0.0)
    if not (np.isfinite(size) and size > 0) or not all(np.isfinite(part).all() for part in middles):
        return
    step = size * 2.0**-18
    parts = _shared(middles, step) if whole else np.zeros(len(middles))
    _say(parts, "faces lie where others do; which of them are seen is chance, in Cycles too", meshes, instances, messages)
    if not (parts > _FACES).any():
        _say(_boxed(np.array(boxes), step), "they fill one box; where their faces lie in one place, chance says which are seen, "
             "in Cycles too", meshes, instances, messages)


def _say(parts, what, meshes, instances, messages):
    names = {meshes[instance["mesh"]]["name"]: part for instance, part in zip(instances, parts) if part > _FACES}
    if names:
        rest = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
        messages.warning(f"{max(names, key=names.get)}{rest}: {what}")


def _box(mesh, places, known):
    """Corners of the box round a mesh, each once."""
    if id(mesh) not in known:
        low, high = (places.min(0), places.max(0)) if len(places) else (np.zeros(3), np.zeros(3))
        known[id(mesh)] = np.array([[(low, high)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)])
    return known[id(mesh)]


def _boxed(boxes, step):
    """By owner: does another fill the same box? Its faces may be others and lie there all the same."""
    whole = np.rint(boxes.reshape(-1, 6) / step).astype(np.int64)
    _unique, which, counts = np.unique(whole, axis=0, return_inverse=True, return_counts=True)
    return (counts[which.ravel()] > 1) & (boxes[:, 1] > boxes[:, 0]).any(1)


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
