# SPDX-License-Identifier: Apache-2.0
"""The manual: `make manual` writes build/manual/html."""
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

project = "libshade"
author = "the authors of libshade"
copyright = author
release = re.search(r'SHADE_VERSION "(.*)"', (ROOT / "libshade/include/shade/shade.h").read_text(encoding="utf-8"))[1]
version = release

extensions = ["myst_parser"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nitpicky = True

html_theme = "furo"
html_title = f"libshade {release}"
html_static_path = ["_static"]
html_css_files = ["libshade.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
