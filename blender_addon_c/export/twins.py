# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces that lie in the same place: which is seen is chance, in Cycles too."""

import numpy as np

_MOST = 100_000  # triangles; in larger scenes boxes alone are looked at: it takes .1 s for these
_MOST_STANDING = 50  # objects of glass
_FACES = 0.05  # of an object's, from which on it is worth a word
_MOST_SHELLS, _APART = 1000, 0.02  # objects that are compared; of their sizes: facets of a ball of 16 segments are as far below it


def name_twins(meshes, instances, messages, lifted=False):
    """Names objects of which many faces lie where others, or others of their own, do; where shadows are lifted, shells too."""
    if not instances:
        return
    with np.errstate(invalid="ignore", over="ignore"):  # of places that are no numbers, which are said elsewhere
        boxes = _boxes(meshes, instances)
    size = np.ptp(boxes, axis=1).max()
    if not (np.isfinite(boxes).all() and size > 0):
        return
    step = size * 2.0**-18
    places = None
    if sum(len(meshes[i["mesh"]]["corner_position"]) for i in instances) <= 3 * _MOST:
        places = list(map(_corners, [meshes[i["mesh"]] for i in instances], instances))
        parts = _shared([corners.mean(1) for corners in places], step)
        if (parts > _FACES).any():
            _say(parts, "faces lie where others do; which of them are seen is chance, in Cycles too", meshes, instances, messages)
            return
    boxed = _boxed(boxes, step)
    _say(boxed, "they fill one box; where their faces lie in one place, chance says which are seen, in Cycles too",
         meshes, instances, messages)
    if lifted and places and not boxed.any():
        _say(_shells(places, meshes, instances), "they fill nearly one box; where smooth faces of one lie closer to the other than Soft "
             "Terminator lifts the start of shadows, light goes through (switch it off under Light Paths)", meshes, instances, messages)


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


def _shells(places, meshes, instances):
    """By owner: is another nearly as large and in nearly the same place, both of smooth faces?"""
    found = np.zeros(len(places), bool)
    at = [number for number, corners in enumerate(places) if len(corners)]
    if not 1 < len(at) <= _MOST_SHELLS:
        return found
    low, high = (np.array([limit(places[number], axis=(0, 1)) for number in at]) for limit in (np.min, np.max))
    apart = np.maximum(abs(low[:, None] - low), abs(high[:, None] - high)).max(-1)
    near = apart < _APART * (high - low).min(-1)
    np.fill_diagonal(near, False)
    own = [instances[number]["mesh"] for number in at]
    smooth = {mesh: _is_smooth(meshes[mesh]) for mesh in {own[k] for k in np.flatnonzero(near.any(1))}}
    is_smooth = np.array([smooth.get(mesh, False) for mesh in own])
    found[at] = (near & is_smooth).any(1) & is_smooth
    return found


def _is_smooth(mesh):
    normals = mesh["corner_normals"].reshape(-1, 3, 3)
    return bool((normals[:, :1] != normals[:, 1:]).any())


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
