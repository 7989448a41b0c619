# SPDX-License-Identifier: Apache-2.0
"""From numpy's arrays of any shape to the library's, one contiguous array a component, and back."""
import ctypes
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]  # of no axes: a number

STATUS = {1: "clamped parameter", 2: "clamped normal", 4: "bad input", 8: "bad choice", 16: "no sample"}


class Status:
    """Gathers what had to be mended. Hand it to calls as `status=`, then look at its truth, its `bits` or its text.

    >>> said = shade.Status()
    >>> peak = shade.D(shade.Material(), [0, 0, -1], [0, 0, 1], status=said)
    >>> print(said, "clamped normal" in said)
    clamped normal True
    """

    __slots__ = ("bits",)

    def __init__(self) -> None:
        self.bits = 0

    def __bool__(self) -> bool:
        return self.bits != 0

    def __contains__(self, words: str) -> bool:
        return any(bit & self.bits for bit, name in STATUS.items() if name == words)

    def __str__(self) -> str:
        return ", ".join(name for bit, name in STATUS.items() if bit & self.bits) or "ok"

    def __repr__(self) -> str:
        return f"<shade.Status: {self}>"


def gather(status, bits):
    if status is not None:
        status.bits |= bits


class Call:
    """Arrays on their way into one call: all are broadcast together, float32 where every numpy array is
    (or shorter), else float64."""

    def __init__(self):
        self.given = []  # (name, array, members)
        self.kept = []  # what the structures point to

    def add(self, name, value, *members):
        """`value`: an array whose last axis is as long as there are members, or with one member any array.
        None adds nothing."""
        if value is None:
            return self
        try:
            array = np.asarray(value)
            if array.dtype.kind not in "fiub":
                array = array.astype(np.float64, casting="no" if array.dtype.kind == "c" else "unsafe")
        except (TypeError, ValueError):
            raise ValueError(f"{name}: {value!r:.80} given; expected numbers") from None
        if array.dtype.kind == "u":
            raise ValueError(f"{name}: an array of {array.dtype} given; expected numbers as they are: of a picture "
                             f"divide by {np.iinfo(array.dtype).max}, and undo the curve of its colours")
        if len(members) > 1 and (array.ndim == 0 or array.shape[-1] != len(members)):
            raise ValueError(f"{name}: an array of shape {array.shape} given; expected (…, {len(members)})")
        strong = isinstance(value, (np.ndarray, np.generic))
        self.given.append((name, array, members, strong))
        return self

    def prepare(self):
        """Settle dtype, shape and count."""
        strong = [array.dtype for _, array, _, is_strong in self.given if is_strong]
        short = bool(strong) and all(dtype in (np.float32, np.float16) for dtype in strong)
        self.dtype = np.dtype(np.float32 if short else np.float64)
        shapes = {name: array.shape[:-1] if len(members) > 1 else array.shape
                  for name, array, members, _ in self.given}
        try:
            self.shape = np.broadcast_shapes(*shapes.values())
        except ValueError:
            raise ValueError("shapes that do not fit each other, vectors' last axes left out: "
                             + ", ".join(f"{name} {shape}" for name, shape in shapes.items())) from None
        self.count = int(np.prod(self.shape, dtype=np.int64))
        return self

    @property
    def ending(self):
        """Of the names of functions of this precision."""
        return "f" if self.dtype == np.float32 else ""

    def columns(self):
        """{member: contiguous array of `count`}."""
        made = {}
        for _, array, members, _ in self.given:
            several = len(members) > 1
            whole = np.broadcast_to(array, self.shape + array.shape[-1:] if several else self.shape)
            for k, member in enumerate(members):
                part = whole[..., k] if several else whole
                made[member] = np.ascontiguousarray(part, self.dtype).reshape(-1)
        self.kept.extend(made.values())
        return made

    def lanes(self, structure, **more):
        lanes = structure(size=ctypes.sizeof(structure), **more)
        for member, column in self.columns().items():
            setattr(lanes, member, column.ctypes.data)
        return lanes

    def results(self, structure, **groups):
        """The structure of results, and {group: array of shape (…) or (…, members)}, filled by the call."""
        result, made = structure(size=ctypes.sizeof(structure)), {}
        for group, members in groups.items():
            members = members.split()
            block = np.zeros((len(members), self.count), self.dtype)
            self.kept.append(block)
            for member, row in zip(members, block):
                setattr(result, member, row.ctypes.data)
            made[group] = (np.moveaxis(block.reshape(len(members), *self.shape), 0, -1)
                           if len(members) > 1 else block.reshape(self.shape))
        return result, made
