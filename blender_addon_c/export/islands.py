# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles' Geometry node tells of a mesh as a whole: in which of its islands a point is, as a number by chance,
and how pointed it is there. Both are Cycles' own numbers, so that a file looks the same.
"""

import numpy as np

from .. import _native

_EPSILON = float(np.finfo(np.float32).eps)
# As in Cycles, vertices are one whose squared distance is below the first, and whose sums of coordinates differ by
# no more than the second.
_NEAR, _SUMS = _EPSILON, 3 * _EPSILON
_MOST = 100  # vertices in one cell that each is compared with, of meshes smaller than a cell


def mixed(a, b, c):
    """The last step of lookup3 [Jenkins2006], of arrays of 32-bit numbers."""
    numbers = [np.asarray(x, np.uint32) for x in (a, b, c)]
    for step, shift in enumerate((14, 11, 25, 16, 4, 14, 24)):
        to, of = ((2, 1), (0, 2), (1, 0))[step % 3]
        x, y = numbers[to], numbers[of]
        numbers[to] = (x ^ y) - (y << np.uint32(shift) | y >> np.uint32(32 - shift))
    return numbers[2]


def random_of_islands(edges, count):
    """By vertex, of so many, 0 to 1: the hash of the vertex that stands for its island in Cycles' disjoint sets. edges:
    pairs of vertices, in the mesh's order."""
    roots = _native.roots(edges, count)
    start = np.uint32(0xdeadbeef + 4 + 13 & 0xffffffff)
    numbers = np.frombuffer(roots, np.uint32) + start
    return (mixed(numbers, np.full(count, start), np.full(count, start)) / np.float32(0xffffffff)).astype(np.float32)


def pointiness(at, normals, edges):
    """By vertex, 0 (a hole) over .5 (flat) to 1 (a tip): the angle of its normal and the mean of its edges' directions,
    over pi, then the mean of it and its neighbours'. at, normals: three numbers a vertex."""
    one, count = _welded(at), len(at)
    normals = _sums(one, normals, count)
    pairs = np.unique(np.sort(one[edges], axis=1), axis=0)
    a, b = pairs[pairs[:, 0] != pairs[:, 1]].T
    along = np.nan_to_num(at[b].astype(float) - at[a])
    along /= np.maximum(np.linalg.norm(along, axis=1), 1e-30)[:, None]
    both, edges = np.concatenate([a, b]), _sums(np.concatenate([a, b]), np.concatenate([along, -along]), count)
    neighbours = np.bincount(both, minlength=count)
    cosine = (normals * edges).sum(1) / np.maximum(np.linalg.norm(normals, axis=1) * neighbours, 1e-30)
    angle = np.where(neighbours > 0, np.arccos(np.clip(np.nan_to_num(cosine), -1, 1)) / np.pi, 0)
    around = np.bincount(both, np.concatenate([angle[b], angle[a]]), count)
    return ((angle + around) / (neighbours + 1))[one].astype(np.float32)


def _sums(index, vectors, count):
    return np.stack([np.bincount(index, vectors[:, axis], count) for axis in range(3)], 1)


def _welded(at):
    """By vertex the number of one that stands for all in its place."""
    at = np.clip(np.nan_to_num(at), -1e18, 1e18).astype(np.float32) + np.float32(0)  # no -0
    pairs = []
    order = np.lexsort(at.T)
    same = (at[order[1:]] == at[order[:-1]]).all(1)
    pairs.append(np.stack([order[1:][same], order[:-1][same]], 1))
    first = np.append(True, ~same)
    pairs += _close(at, order[first])
    joined = np.ascontiguousarray(np.concatenate(pairs), np.int32)
    return np.frombuffer(_native.roots(joined, len(at)), np.uint32).astype(np.int64)


def _close(at, of):
    """Pairs of vertices, of these numbers, that are near each other. Each pair is in one cell of eight grids, of cells
    twice as wide as they may be apart, at least."""
    wide = 2 * _NEAR**0.5
    sums = at[of].sum(1, dtype=np.float32)
    pairs = []
    for shift in np.ndindex(2, 2, 2):
        cell = np.floor(np.clip(at[of], -1e9, 1e9) / wide + np.array(shift) / 2).astype(np.int64)
        key = (cell * np.array([73856093, 19349669, 83492791])).sum(1)
        order = np.lexsort((sums, key))
        key, total, number = key[order], sums[order], of[order]
        left = np.arange(len(of))
        for step in range(1, _MOST):
            left = left[left + step < len(of)]
            other = left + step
            left = left[(key[left] == key[other]) & (total[other] - total[left] <= _SUMS)]
            if not len(left):
                break
            a, b = number[left], number[left + step]
            near = ((at[a] - at[b]) ** 2).sum(1) < _NEAR
            pairs.append(np.stack([a[near], b[near]], 1))
    return pairs
