# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie in the same place: which is seen is chance, in Cycles too."""

import numpy as np

_MOST = 100_000  # triangles; in larger scenes boxes alone are looked at: it takes .1 s for these
_MOST_STANDING = 50  # objects of glass
_FACES = 0.05  # of an object's, from which on it is worth a word


def name_twins(meshes, instances, messages):
    """Names objects of which many faces lie where others, or others of their own, do."""
    if not instances:
        return
    with np.errstate(invalid="ignore", over="ignore"):  # of places that are no numbers, which are said elsewhere
        boxes = _boxes(meshes, instances)
    size = np.ptp(boxes, axis=1).max()
    if not (np.isfinite(boxes).all() and size > 0):
        return
    step = size * 2.0**-18
    if sum(len(meshes[i["mesh"]]["corner_position"]) for i in instances) <= 3 * _MOST:
        parts = _shared(list(map(_middles, [meshes[i["mesh"]] for i in instances], instances)), step)
        if (parts > _FACES).any():
            _say(parts, "faces lie where others do; which of them are seen is chance, in Cycles too", meshes, instances, messages)
            return
    _say(_boxed(boxes, step), "they fill one box; where their faces lie in one place, chance says which are seen, in Cycles too",
         meshes, instances, messages)


def name_standing(meshes, instances, materials, messages):
    """Names objects of glass whose flat bottom lies in a face of another: which of them is met within is chance."""
    clear = [any(closure["closure"] == "GLASS" and closure["refracts"] for closure in made.get("closures", (made,))) for made in materials]
    if not any(clear) or sum(len(meshes[i["mesh"]]["corner_position"]) for i in instances) > 3 * _MOST:
        return
    is_clear = [np.array(clear)[meshes[one["mesh"]]["material"]] for one in instances]
    standing = [number for number, part in enumerate(is_clear) if part.any()][:_MOST_STANDING]
    places = list(map(_corners, [meshes[one["mesh"]] for one in instances], instances)) if standing else []
    for number in standing:
        own = places[number][is_clear[number]]
        if not np.isfinite(own).all():
            continue
        step = np.ptp(own, axis=(0, 1)).max() * 2.0**-18
        height = own[..., 2].min()
        bottom = own[_lie_at(own, height, step)][..., :2]
        low, high = (bottom.min((0, 1)), bottom.max((0, 1))) if len(bottom) else (np.inf, -np.inf)
        for other, place in enumerate(places):
            flat = place[_lie_at(place, height, step)][..., :2] if other != number else place[:0, :, :2]
            if ((flat.max(1) > low + step) & (flat.min(1) < high - step)).all(1).any():
                messages.warning(f"{meshes[instances[number]['mesh']]['name']}: its bottom lies in faces of another object; what is seen "
                                 "there through glass is chance")
                return


def _lie_at(places, height, step):
    return (np.abs(places[..., 2] - height) < step).all(1)


def _corners(mesh, instance):
    """Of an instance's triangles."""
    matrix = np.array(instance["matrix"], float).reshape(-1, 4)[:3]
    with np.errstate(invalid="ignore", over="ignore"):
        placed = mesh["positions"].reshape(-1, 3) @ matrix[:, :3].T + matrix[:, 3]
    return placed[mesh["corner_position"].reshape(-1, 3)]


def _middles(mesh, instance):
    """Of an instance's faces."""
    return _corners(mesh, instance).mean(1)


def _say(parts, what, meshes, instances, messages):
    names = {meshes[instance["mesh"]]["name"]: part for instance, part in zip(instances, parts) if part > _FACES}
    if names:
        rest = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
        messages.warning(f"{max(names, key=names.get)}{rest}: {what}")


def _boxes(meshes, instances):
    """Low and high corner of the boxes round those of the meshes where the instances stand."""
    own = [(np.min(p, 0), np.max(p, 0)) if len(p) else (np.zeros(3), np.zeros(3))
           for p in (mesh["positions"].reshape(-1, 3) for mesh in meshes)]
    low, high = np.array(own, float)[[i["mesh"] for i in instances]].transpose(1, 0, 2)
    matrices = np.array([i["matrix"] for i in instances], float).reshape(len(instances), -1, 4)[:, :3]
    middle = np.einsum("nij,nj->ni", matrices[:, :, :3], (low + high) / 2) + matrices[:, :, 3]
    half = np.einsum("nij,nj->ni", abs(matrices[:, :, :3]), (high - low) / 2)
    return np.stack([middle - half, middle + half], 1)


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
