# SPDX-License-Identifier: GPL-3.0-or-later
"""Zip the unpacked add-on so that the same files give the same bytes.

usage: package.py FOLDER ZIP
Installs in Blender 3.4 as an add-on and in 4.2 and later as an extension.
"""

import os
import sys
import zipfile

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can hold


def package(folder, target):
    parent = os.path.dirname(os.path.abspath(folder))
    files = sorted(
        os.path.join(at, name) for at, _folders, names in os.walk(folder) for name in names
        if "__pycache__" not in at and not name.endswith(".pyc"))
    part = target + ".part"
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in files:
            entry = zipfile.ZipInfo(os.path.relpath(os.path.abspath(path), parent), _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o100644 << 16
            with open(path, "rb") as file:
                archive.writestr(entry, file.read())
    os.replace(part, target)


if __name__ == "__main__":
    if len(sys.argv) != 3 or not os.path.isdir(sys.argv[1]):
        sys.exit(__doc__)
    package(*sys.argv[1:])
