# SPDX-License-Identifier: Apache-2.0
"""How all tests, those of the other folders too, are dealt to the processes of pytest-xdist.

A file stays with one process, which starts its Blender once. The longest go first: one that begins when the
others are done leaves processors idle.
"""
import re

# seconds of a processor, measured (`--durations` says what a test takes); what is not named takes less
LONGEST = {
    "test_native_build.py::test_all_tests_under_sanitizers": 60,
    "test_source.py::test_no_existing_scene_changes": 60,
    "test_check.py": 110,
    "test_blender_lights.py": 65,
    "test_end_to_end.py": 60,
    "test_native_build.py::test_all_tests_compiled_by_clang": 30,
    "test_blender_nodes.py": 30,
    "test_blender_closures.py": 30,
}
# these need nothing that their file has made ready
ALONE = re.compile("test_all_tests_|test_no_existing_scene_changes")


def seconds(nodeid):
    name = nodeid.split("/")[-1].split("[")[0]
    return LONGEST.get(name) or LONGEST.get(name.split("::")[0], 0)


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: -seconds(item.nodeid))


def pytest_xdist_make_scheduler(config, log):
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class LongestFirst(LoadFileScheduling):
        def _split_scope(self, nodeid):
            return nodeid if ALONE.search(nodeid) else super()._split_scope(nodeid)

    config.option.loadscopereorder = False  # by number of tests
    return LongestFirst(config, log)
