# SPDX-License-Identifier: Apache-2.0
"""Copy a DLL that looks for others by other names.

usage: own_dll.py FROM TO [OLD=NEW...]
Windows knows a DLL by the name of its file alone: two of one name in a process are the first of them to both who ask.
Each NEW takes the place of OLD in the table of imports, and so may not be longer.
"""

import os
import struct
import sys


def imports(data):
    """{name: where it lies in the file} of the DLLs that a DLL for x86-64 needs."""
    header, = struct.unpack_from("<I", data, 0x3C)
    if data[:2] != b"MZ" or data[header:header + 6] != b"PE\0\0\x64\x86":
        raise ValueError("no DLL for x86-64")
    sections, optional = struct.unpack_from("<H", data, header + 6)[0], struct.unpack_from("<H", data, header + 20)[0]
    table = [struct.unpack_from("<IIII", data, header + 24 + optional + 40 * k + 8) for k in range(sections)]

    def place(address):
        for size, begin, stored, at in table:
            if begin <= address < begin + max(size, stored):
                return at + address - begin
        raise ValueError(f"address {address:#x} is in no section")

    found = {}
    at = place(struct.unpack_from("<I", data, header + 24 + 112 + 8)[0])  # the second of its directories
    while name := struct.unpack_from("<I", data, at + 12)[0]:
        begin = place(name)
        found[data[begin:data.index(b"\0", begin)].decode()] = begin
        at += 20
    return found


def rename(data, names):
    data, there = bytearray(data), imports(data)
    for old, new in names.items():
        if old not in there or len(new) > len(old):
            raise ValueError(f"{new} cannot take the place of {old}: it needs {', '.join(there)}")
        data[there[old]:there[old] + len(old)] = new.encode().ljust(len(old), b"\0")
    return bytes(data)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    with open(sys.argv[1], "rb") as file:
        made = file.read()
    try:
        made = rename(made, dict(word.split("=") for word in sys.argv[3:]))
    except ValueError as wrong:
        sys.exit(f"own_dll.py: {sys.argv[1]}: {wrong}")
    with open(sys.argv[2] + ".part", "wb") as part:
        part.write(made)
    os.replace(sys.argv[2] + ".part", sys.argv[2])
