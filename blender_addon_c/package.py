# SPDX-License-Identifier: GPL-3.0-or-later
"""Zip an unpacked add-on so that the same files give the same bytes.

usage: package.py ZIP FOLDER FILE...
The files lie in FOLDER, which is the one folder at the zip's top: so it installs in
Blender 3.4 as an add-on and in 4.2 and later as an extension.
"""

import os
import sys
import zipfile

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can hold


def package(target, folder, files):
    parent = os.path.dirname(os.path.normpath(folder))
    part = f"{target}.{os.getpid()}.part"
    try:
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
            # by it Blender 3.4 knows which folder to remove before it installs a newer one
            archive.writestr(zipfile.ZipInfo(os.path.basename(os.path.normpath(folder)) + "/", _DATE), b"")
            for path in sorted(files):
                entry = zipfile.ZipInfo(os.path.relpath(path, parent), _DATE)
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = 0o100644 << 16
                with open(path, "rb") as file:
                    archive.writestr(entry, file.read())
        os.replace(part, target)
    finally:  # also after Ctrl-C
        if os.path.exists(part):
            os.unlink(part)


if __name__ == "__main__":
    if len(sys.argv) < 4 or not os.path.isdir(sys.argv[2]):
        sys.exit(__doc__)
    package(sys.argv[1], sys.argv[2], sys.argv[3:])
