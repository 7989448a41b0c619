# SPDX-License-Identifier: Apache-2.0
"""What the tests cost, as their files say (setup/costs.py), is no more than a person waits for."""
import pytest

import costs

COST = 0.1
# `make check` is to take at most 40 minutes on two cores of which a second is worth .6 of those that files count in; a
# third of it goes to compilers. What files say was measured beside other jobs and so is rather too much.
LIMIT = 2000


@pytest.mark.parametrize("file", costs.files())
def test_each_file_says_its_cost(file):
    assert costs.said(file, "COST", 0) > 0, f"{file}: a line COST = … is missing, of its seconds of a processor"


def test_the_sum_is_bounded():
    assert sum(map(costs.cost, costs.files())) <= LIMIT, "run setup/costs.py: what costs most and finds least goes to make soak"
