# SPDX-License-Identifier: GPL-3.0-or-later
"""Exit 0 when the process is as a test of the libraries needs it.

arguments: global NAME... (symbols that any library finds) | missing FILE... (cannot be loaded)
"""

import ctypes
import sys

what, *names = sys.argv[sys.argv.index("--") + 1:]
if what == "global":
    everything = ctypes.CDLL(None)
    for name in names:
        getattr(everything, name)
else:
    for name in names:
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        sys.exit(f"{name} is still there")
