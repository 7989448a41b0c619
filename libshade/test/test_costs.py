# SPDX-License-Identifier: Apache-2.0
"""What the tests cost, as their files say (setup/costs.py), is no more than a person waits for."""
import importlib.util
from types import SimpleNamespace

import costs
import pytest

COST = 0.24
# What the sum was when it was taken, and a little: it keeps `make check` from growing. Files were measured beside other
# jobs, which makes them dearer; those of native modules are the release build's, their run under sanitizers stands in
# test_native_build.py.
LIMIT = 1830


def test_each_file_says_its_cost():
    for file in costs.files():
        assert costs.said(file, "COST", 0) > 0, f"{file}: a line COST = … is missing, of its seconds of a processor"


def test_the_sum_is_bounded():
    assert sum(map(costs.cost, costs.files())) <= LIMIT, "run setup/costs.py: what costs most and finds least goes to make soak"


def test_what_goes_apart_costs_as_well():
    for file in costs.files():
        assert costs.cost(file) == sum([costs.said(file, "COST", 0), *costs.said(file, "ALONE", {}).values()]), file
    assert costs.cost("blender_addon_c/tests/test_native_build.py") > 2 * costs.said("blender_addon_c/tests/test_native_build.py", "COST", 0) > 0


def test_what_takes_longest_begins_first():
    """By what a worker keeps together: a file, some files, or a test that goes apart."""
    spec = importlib.util.spec_from_file_location("the_order_of_tests", costs.ROOT / "conftest.py")
    order = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(order)
    items = [SimpleNamespace(nodeid=f"{file}::test_it") for file in costs.files() if file.endswith(".py")]
    build = "blender_addon_c/tests/test_native_build.py"
    alone = {f"{build}::{test}[x]": seconds for test, seconds in costs.said(build, "ALONE", {}).items()}
    items += [SimpleNamespace(nodeid=name) for name in alone]
    order.pytest_collection_modifyitems(items)
    together = {}
    for item in items:
        file = item.nodeid.split("::")[0]
        together.setdefault(order.scope(item.nodeid), {})[file] = alone.get(item.nodeid, costs.said(file, "COST", 0))
    spent = [sum(together[order.scope(item.nodeid)].values()) for item in items]
    assert spent == sorted(spent, reverse=True) and spent[0] > 50 * spent[-1] and all(order.scope(name) == name for name in alone)


def test_workers_take_whole_files(monkeypatch):
    """The dearest first; where tests are not dealt out by files xdist keeps its own way."""
    scheduling = pytest.importorskip("xdist.scheduler")
    spec = importlib.util.spec_from_file_location("the_order_of_tests", costs.ROOT / "conftest.py")
    order = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(order)
    monkeypatch.setattr(scheduling, "LoadFileScheduling", type("Scheduling", (), {"__init__": lambda self, config, log: None}))
    config = SimpleNamespace(option=SimpleNamespace(), getvalue=lambda name: {"dist": "load"}[name])
    assert order.pytest_xdist_make_scheduler(config, None) is None and not vars(config.option)
    config.getvalue = lambda name: {"dist": "loadfile"}[name]
    made = order.pytest_xdist_make_scheduler(config, None)
    assert config.option.loadscopereorder is False
    build = "blender_addon_c/tests/test_native_build.py"
    test = next(iter(costs.said(build, "ALONE", {})))
    assert made._split_scope(f"{build}::{test}[x]") == f"{build}::{test}[x]" and made._split_scope(f"{build}::test_x") == build
    assert made._split_scope("compare/tests/test_report_page.py::test_x") == "report" and made._split_scope("compare/tests/test_flip.py::test_x[a]") == "compare/tests/test_flip.py"
