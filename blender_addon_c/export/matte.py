# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of objects, materials and assets as the numbers that stand for them in Cryptomatte's passes,
and the lists of these names that a file carries."""

import json
import struct

# Kinds as in the native module, and what Cycles calls their passes.
_LAYERS = {"OBJECT": "CryptoObject", "MATERIAL": "CryptoMaterial", "ASSET": "CryptoAsset"}
_MASK = 0xFFFFFFFF


def _turned(x, bits):
    return (x << bits | x >> (32 - bits)) & _MASK


def _mixed(k):
    return _turned(k * 0xCC9E2D51 & _MASK, 15) * 0x1B873593 & _MASK


def _bytes(name):
    """In UTF-8; Blender hands those that are no text through as they are."""
    return name.encode("utf-8", "surrogateescape")


def hash_of(name):
    """MurmurHash3 of the name's bytes, 32 bits, from 0 on."""
    data = _bytes(name)
    whole = len(data) // 4 * 4
    h = 0
    for (k,) in struct.iter_unpack("<I", data[:whole]):
        h = (_turned(h ^ _mixed(k), 13) * 5 + 0xE6546B64) & _MASK
    h ^= _mixed(int.from_bytes(data[whole:], "little")) ^ len(data)
    h = (h ^ h >> 16) * 0x85EBCA6B & _MASK
    h = (h ^ h >> 13) * 0xC2B2AE35 & _MASK
    return h ^ h >> 16


def number_of(name_hash):
    """The float of these bits, its exponent kept where floats are finite and normal."""
    exponent = min(max(name_hash >> 23 & 255, 1), 254)
    return struct.unpack("<f", struct.pack("<I", name_hash & 0x807FFFFF | exponent << 23))[0]


def _topmost(ob):
    while ob.parent:
        ob = ob.parent
    return ob


class Mattes:
    """What is wanted of them, and the names that are met."""

    def __init__(self, passes):
        words = [p.plane.split("_MATTE") for p in passes if "_MATTE" in p.plane]
        self.kinds = [kind for kind in _LAYERS if kind in {kind for kind, _ in words}]
        self._slots = 2 * len({layer for _, layer in words})
        self._hashes = {kind: {} for kind in _LAYERS}  # by name

    def wanted(self):
        """What the native module reads for them."""
        kinds = [{"type": kind} for kind in self.kinds]
        return {"mattes": kinds, "matte_slots": self._slots} if kinds else {}

    def _number(self, kind, name):
        hashes = self._hashes[kind]
        if name not in hashes:
            hashes[name] = hash_of(name)
        return number_of(hashes[name])

    def of_object(self, ob):
        """Its own number and its asset's, {} where none is wanted."""
        if not self.kinds:
            return {}
        return {"matte": (self._number("OBJECT", ob.name), self._number("ASSET", _topmost(ob).name))}

    def of_material(self, name):
        """A material's; of an empty slot what Cycles calls it."""
        return {"matte": (self._number("MATERIAL", name or "default_surface"),)} if self.kinds else {}

    def fields(self, view_layer):
        """Pairs of key and text for a file's header: what Cryptomatte's readers look for."""
        for kind in self.kinds:
            name = f"{view_layer}.{_LAYERS[kind]}"
            begin = f"cryptomatte/{hash_of(name):08x}"[:19] + "/"
            manifest = {_bytes(name).decode("utf-8", "replace"): f"{number:08x}"
                        for name, number in self._hashes[kind].items()}
            yield begin + "name", name
            yield begin + "hash", "MurmurHash3_32"
            yield begin + "conversion", "uint32_to_float32"
            yield begin + "manifest", json.dumps(manifest, ensure_ascii=False, separators=(",", ":"))
