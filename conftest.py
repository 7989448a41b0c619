# SPDX-License-Identifier: Apache-2.0
"""The order of the tests: what takes longest begins first, or one worker is left with it at the end.

A file stays with one worker, which starts its Blender once; but tests that run all others anew go apart, and
those of the quick report's rows go to the worker that has made it.
"""

from pathlib import PurePath

import pytest

ALONE = ("test_all_tests_under_sanitizers", "test_all_tests_compiled_by_clang")
OF_THE_REPORT = ("test_report_page", "test_study_truth", "test_study_atlas")
# Files by the seconds of a processor that they took, where more than some; in no order beyond that.
LONGEST = """test_report_page test_check test_study_truth test_blender_scratches test_blender_lights
test_blender_nodes test_end_to_end test_cloth test_source test_blender_closures test_blender_sky test_examples
test_blender_paths test_blender_window test_blender_groove test_blender_holes_and_hair test_blender_passes test_bench
test_study_atlas test_blender_hostile test_parse test_tangents test_bump_image test_check_pair test_horizon
test_native_cloth_moved test_native_stages test_reflection test_blender_node test_dump test_blender_bad_input
test_slopes test_blender_leaks test_swatch""".split()


def rank(item):
    if item.originalname in ALONE:
        return -1
    name = PurePath(item.location[0]).stem
    return LONGEST.index(name) if name in LONGEST else len(LONGEST)


def pytest_collection_modifyitems(config, items):
    if hasattr(config, "workerinput"):
        items.sort(key=rank)


@pytest.hookimpl(optionalhook=True)  # of xdist, which may be absent
def pytest_xdist_make_scheduler(config, log):
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class FilesButForSome(LoadFileScheduling):
        def _split_scope(self, nodeid):
            if any(name in nodeid for name in ALONE):
                return nodeid
            file = super()._split_scope(nodeid)
            return "report" if PurePath(file).stem in OF_THE_REPORT else file

    return FilesButForSome(config, log)
