# SPDX-License-Identifier: Apache-2.0
"""What the tests cost, as their files say (setup/costs.py), is no more than a person waits for."""
import costs

COST = 0.24
# What the sum was when it was taken, and a little: it keeps `make check` from growing. Files were measured beside other
# jobs, which makes them dearer; those of native modules are the release build's, their run under sanitizers stands in
# test_native_build.py.
LIMIT = 1800


def test_each_file_says_its_cost():
    for file in costs.files():
        assert costs.said(file, "COST", 0) > 0, f"{file}: a line COST = … is missing, of its seconds of a processor"


def test_the_sum_is_bounded():
    assert sum(map(costs.cost, costs.files())) <= LIMIT, "run setup/costs.py: what costs most and finds least goes to make soak"


def test_what_goes_apart_costs_as_well():
    for file in costs.files():
        assert costs.cost(file) == sum([costs.said(file, "COST", 0), *costs.said(file, "ALONE", {}).values()]), file
    assert costs.cost("blender_addon_c/tests/test_native_build.py") > 2 * costs.said("blender_addon_c/tests/test_native_build.py", "COST", 0) > 0
