# SPDX-License-Identifier: Apache-2.0
"""The manual: `make manual` writes build/manual/html."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

project = "libshade"
author = "the authors of libshade"
copyright = author
release = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text(encoding="utf-8"))[1]
version = release

sys.dont_write_bytecode = True  # docs/ holds sources alone
sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(1, str(ROOT / "libshade/python"))
extensions = ["myst_parser", "hawkmoth", "c_comments", "sphinx.ext.autodoc"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nitpicky = True
nitpick_ignore = [("c:identifier", name) for name in ("size_t", "uint32_t", "uint64_t")]

# the headers, which libclang reads with the C library's own as `cc` finds them
hawkmoth_root = str(ROOT / "libshade/include/shade")
hawkmoth_compiler = "cc"
hawkmoth_clang = [f"-I{ROOT}/libshade/include"]

# the Python module, on the library in build/: docstrings say what types say
autodoc_typehints = "none"
default_role = "literal"

html_theme = "furo"
html_title = f"libshade {release}"
html_static_path = ["_static"]
html_css_files = ["libshade.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
