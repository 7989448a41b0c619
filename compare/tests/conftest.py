# SPDX-License-Identifier: Apache-2.0
"""The scripts under test are plain files beside each other, not a package."""
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "compare"), str(ROOT / "examples" / "blender" / "suzanne")]
