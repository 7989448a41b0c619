# SPDX-License-Identifier: Apache-2.0
"""The order of the tests: what takes longest begins first, or one worker is left with it at the end.

A file stays with one worker, which starts its Blender once, unless it says otherwise: setup/costs.py.
"""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent / "setup"))
import costs


def scope(nodeid):
    """What stays with one worker."""
    file, test = nodeid.split("::", 1)
    if test.split("[")[0] in costs.said(file, "ALONE", {}):
        return nodeid
    return costs.said(file, "TOGETHER", file)


def seconds(nodeid):
    file, test = nodeid.split("::", 1)
    return costs.said(file, "ALONE", {}).get(test.split("[")[0]) or costs.said(file, "COST", 0)


def pytest_collection_modifyitems(items):
    spent = {}  # scope: {file: its seconds}
    for item in items:
        spent.setdefault(scope(item.nodeid), {})[item.nodeid.split("::")[0]] = seconds(item.nodeid)
    items.sort(key=lambda item: -sum(spent[scope(item.nodeid)].values()))


@pytest.hookimpl(optionalhook=True)  # of xdist, which may be absent
def pytest_xdist_make_scheduler(config, log):
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class DearestFirst(LoadFileScheduling):
        def _split_scope(self, nodeid):
            return scope(nodeid)

    config.option.loadscopereorder = False  # by the number of tests
    return DearestFirst(config, log)
