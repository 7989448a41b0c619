# SPDX-License-Identifier: Apache-2.0
"""What the tests cost, as their files say (setup/costs.py), is no more than a person waits for."""
import pytest

import costs

COST = 0.1
# What the sum was when it was first taken, and a little: it keeps `make check` from growing, and does not show that it
# takes 40 minutes (that wants about 1800). Files were measured beside other jobs; what test_native_*.py say is an
# estimate, .35 of a record that holds their run under sanitizers too.
LIMIT = 2000


@pytest.mark.parametrize("file", costs.files())
def test_each_file_says_its_cost(file):
    assert costs.said(file, "COST", 0) > 0, f"{file}: a line COST = … is missing, of its seconds of a processor"


def test_the_sum_is_bounded():
    assert sum(map(costs.cost, costs.files())) <= LIMIT, "run setup/costs.py: what costs most and finds least goes to make soak"
