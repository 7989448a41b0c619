# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's graph as a program for the native module: nodes that read and write registers."""

import math

_REGISTERS = range(3, 256)  # those that a node of the native module may write


class Register:
    """What a node writes: one number a point. Its index is found once all uses are known."""


class TooLarge(Exception):
    """A graph that would need more registers than there are."""


class Program:
    """`emit` takes nodes; `finish` lists them, and what reads them, with indices."""

    def __init__(self):
        self._nodes, self._makers = [], {}

    def emit(self, kind, out=3, more=None, **given):
        """A node; returns the registers of its `out`, and of `more`, a second output of one."""
        return [register for part in self.emit_each(kind, {"out": out, **({more: 1} if more else {})}, **given)
                for register in part]

    def emit_each(self, kind, outputs, **given):
        """A node; returns the registers of each of its outputs, by name how many."""
        made = {name: [Register() for _ in range(count)] for name, count in outputs.items()}
        self._nodes.append(({"type": kind, **given}, made))
        self._makers.update((register, self._nodes[-1][0]) for part in made.values() for register in part)
        return list(made.values())

    def math(self, operation, a, b=0.0, c=0.0):
        """One operation of the native module's MATH; what is known is worked out here."""
        known = _known(operation, a, b, c)
        if known is not None:
            return known
        return self.emit("MATH", 1, operation=operation, a=[a], b=[b], c=[c])[0]

    def reads(self, parts, kinds):
        """Does some node of these kinds stand behind one of these registers?"""
        left, seen = list(_registers(parts)), set()
        while left:
            node = self._makers[left.pop()]
            if node["type"] in kinds:
                return True
            new = set(_registers(node)) - seen
            seen |= new
            left += new
        return False

    def range_of(self, part, range_of_image):
        """(least, most) of a number or register, as far as that is known, else infinite. range_of_image: of an image by its
        index."""
        ranges = {}

        def of(part, steps):
            if is_known(part):
                return part, part
            if part not in ranges:
                ranges[part] = _EVERYTHING  # deep graphs: who knows
                if steps:
                    ranges[part] = _range_of(self._makers[part], lambda other: of(other, steps - 1), range_of_image)
            return ranges[part]

        return of(part, 100)

    def finish(self, closures):
        """(nodes, closures) as the native module reads them."""
        self._keep_averages(closures)
        try:
            return self._finish(closures)
        except TooLarge:  # averages need coordinates of neighbours
            for index in range(len(self._nodes)):
                self._look_at_points(index)
            return self._finish(closures)

    def _used(self, closures):
        """Nodes, and by register the last one that reads it."""
        last = {register: len(self._nodes) for register in _registers(closures)}
        kept = []
        for index in range(len(self._nodes) - 1, -1, -1):
            node, outputs = self._nodes[index]
            if any(register in last for part in outputs.values() for register in part):
                kept.insert(0, index)
                for register in _registers(node):
                    last.setdefault(register, index)
        return kept, last

    def _keep_averages(self, closures):
        """Images are averaged where light is, too, by what follows: the mean of what is made of them is
        then what is made of the mean. What only passes of colour read makes no difference."""
        seen = [{k: v for k, v in closure.items() if k != "pass_color"} for closure in closures]
        bent = set()
        for closure in seen:
            bent.update(_registers({k: v for k, v in closure.items() if k not in _LINEAR_OF_CLOSURES}))
        for index in reversed(self._used(seen)[0]):
            node, outputs = self._nodes[index]
            through = any(register in bent for part in outputs.values() for register in part)
            straight = () if through else _linear_operands(node)
            bent.update(_registers({k: v for k, v in node.items() if k not in straight}))
            if through:
                self._look_at_points(index)

    def _look_at_points(self, index):
        node, outputs = self._nodes[index]
        self._nodes[index] = ({k: v for k, v in node.items() if k not in ("averaged", "near", "step")}
                              if node.get("averaged") else node, outputs)

    def _finish(self, closures):
        kept, last = self._used(closures)
        free, place, nodes = list(_REGISTERS), {}, []
        for index in kept:
            node, outputs = self._nodes[index]
            written = [register for part in outputs.values() for register in part]
            read = {register for register in _registers(node) if last[register] == index}
            if len(written) == 1:  # may take the place of what it reads
                free = sorted(free + [place[register] for register in read])
            if len(free) < len(written):
                raise TooLarge
            for register in written:
                place[register] = free.pop(0)
            nodes.append(_placed({**node, **outputs}, place))
            done = [r for r in written if last.get(r, index) == index]
            done += [] if len(written) == 1 else read
            free = sorted(free + [place[register] for register in done])
        return nodes, _placed(closures, place)


_EVERYTHING = (-math.inf, math.inf)
_RANGES = {
    "ADD": lambda a, b, c: [x + y for x in a for y in b],
    "SUBTRACT": lambda a, b, c: [x - y for x in a for y in b],
    "MULTIPLY": lambda a, b, c: [x * y for x in a for y in b],
    "MULTIPLY_ADD": lambda a, b, c: [x * y + z for x in a for y in b for z in c],
    "MINIMUM": lambda a, b, c: [min(x, y) for x in a for y in b],
    "MAXIMUM": lambda a, b, c: [max(x, y) for x in a for y in b],
    "CLAMP": lambda a, b, c: [min(max(x, y), z) for x in a for y in b for z in c],
    "MIX": lambda a, b, c: [x + z * (y - x) for x in a for y in b for z in c],
}


# Of colours from 0 to 1 these make none above 1.
_WITHIN = {"DARKEN", "MULTIPLY", "BURN", "LIGHTEN", "SCREEN", "DODGE", "OVERLAY", "SOFT_LIGHT", "DIFFERENCE", "SUBTRACT"}


def _range_of(node, of, range_of_image):
    if node["type"] == "IMAGE":
        return range_of_image(node["image"])
    if node["type"] == "RAMP":
        return min(node["table"]), max(node["table"])
    if node["type"] == "MIX" and node["mode"] in _WITHIN:
        parts = [of(node[key][0]) for key in ("factor", "a", "b")]
        return (-1.0, 1.0) if all(low >= 0 and high <= 1 for low, high in parts) else _EVERYTHING
    if node["type"] != "MATH" or node["operation"] not in _RANGES:
        return _EVERYTHING
    made = _RANGES[node["operation"]](*(of(node[key][0]) for key in "abc"))
    return _EVERYTHING if any(math.isnan(x) for x in made) else (min(made), max(made))


def is_known(*operands):
    return not any(isinstance(operand, Register) for operand in operands)


# Of closures what their light is proportional to, and of MATH what the result is, of each by itself.
_LINEAR_OF_CLOSURES = {"weight", "color", "tint", "f0_from", "kd_from", "warp_from", "weft_from"}
_LINEAR = {"ADD": "ab", "SUBTRACT": "ab", "MULTIPLY": "ab", "MULTIPLY_ADD": "abc", "MIX": "abc",
           "DIVIDE": "a", "CLAMP": "a"}
_LINEAR_MODES = {"MIX", "ADD", "SUBTRACT", "MULTIPLY", "SCREEN", "LINEAR_LIGHT"}


def _linear_operands(node):
    """Keys of what a node's result changes with in proportion; nothing twice."""
    keys = ()
    if node["type"] == "MATH":
        keys = tuple(_LINEAR.get(node["operation"], ""))
    elif node["type"] == "MIX" and node["mode"] in _LINEAR_MODES:
        keys = ("factor", "a", "b")
    read = [register for key in keys for register in _registers(node[key])]
    return keys if len(read) == len(set(read)) else ()


def _registers(thing):
    if isinstance(thing, Register):
        yield thing
    elif isinstance(thing, dict):
        for part in thing.values():
            yield from _registers(part)
    elif isinstance(thing, (list, tuple)):
        for part in thing:
            yield from _registers(part)


def _placed(thing, place):
    if isinstance(thing, Register):
        return (place[thing],)
    if isinstance(thing, dict):
        return {key: _placed(part, place) for key, part in thing.items()}
    if isinstance(thing, (list, tuple)):
        return [_placed(part, place) for part in thing]
    return thing


_FOLDED = {
    "ADD": lambda a, b, c: a + b,
    "SUBTRACT": lambda a, b, c: a - b,
    "MULTIPLY": lambda a, b, c: a * b,
    "DIVIDE": lambda a, b, c: a / b if b else 0.0,
    "MULTIPLY_ADD": lambda a, b, c: a * b + c,
    "MINIMUM": lambda a, b, c: min(a, b),
    "MAXIMUM": lambda a, b, c: max(a, b),
    "MIX": lambda a, b, c: a + c * (b - a),
    "CLAMP": lambda a, b, c: min(max(a, b), c),
    "SQRT": lambda a, b, c: math.sqrt(max(a, 0.0)),
    "ABSOLUTE": lambda a, b, c: abs(a),
    "COSINE": lambda a, b, c: math.cos(a),
    "SINE": lambda a, b, c: math.sin(a),
}


def _known(operation, a, b, c):
    """The result where it needs no node: of numbers, and of what changes nothing."""
    if operation in _FOLDED and is_known(a, b, c):
        return float(_FOLDED[operation](a, b, c))
    if operation == "MULTIPLY":
        for one, other in ((a, b), (b, a)):
            if is_known(one) and one in (0, 1):
                return other if one else 0.0
    if operation == "ADD" and is_known(a) and a == 0:
        return b
    if operation in ("ADD", "SUBTRACT") and is_known(b) and b == 0:
        return a
    if operation == "MIX" and is_known(c) and c in (0, 1):
        return b if c else a
    return None
