# SPDX-License-Identifier: Apache-2.0
"""The scripts under test are plain files beside each other, not a package."""
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "compare"), str(ROOT / "examples" / "blender" / "suzanne")]


@pytest.fixture(scope="session")
def report_folder(tmp_path_factory):
    """Of the quick report, which test_report_page makes."""
    return tmp_path_factory.mktemp("report")


@pytest.fixture(scope="session")
def quick_rows(report_folder):
    """Rows of tasks of a study's quick run: the report's, where this process has made it, or made now."""
    import report_page

    def rows(module, tasks, folder):
        found = []
        for task in tasks:
            made = report_folder / "data" / module.NAME / f"{task.key}.csv"
            found += report_page.read_rows(made)[0] if made.is_file() else task.run(folder, lambda _text: None)
        return found

    return rows
