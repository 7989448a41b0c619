# SPDX-License-Identifier: Apache-2.0
"""fronts.py: which of a few points with known times and errors are ties, and which are on the front."""
import pytest

import fronts
from fronts import Point

COST = 0.1


def one(word, ns, error):
    return Point(word, [ns, ns, ns], error)


def words(points, floor=0.0):
    return [point.word for point in fronts.front(points, floor)]


def test_what_is_better_in_one_and_worse_in_none():
    slow, quick = one("slow", 20.0, 0.1), one("quick", 10.0, 0.1)
    assert fronts.beats(quick, slow) and not fronts.beats(slow, quick)
    exact = one("exact", 20.0, 0.01)
    assert fronts.beats(exact, slow) and not fronts.beats(exact, quick) and not fronts.beats(quick, exact)


def test_a_tie_beats_nothing():
    """In time within 3 %, or where the quartiles of the runs' ratios lie about 1; in error within 2 %."""
    a = one("a", 10.0, 0.1)
    near = one("near", 10.2, 0.1015)
    assert fronts.as_fast(a, near) and fronts.as_exact(a, near)
    assert not fronts.beats(a, near) and not fronts.beats(near, a)
    noisy = [Point("first", [9.5, 10.0, 12.0, 14.0], 0.1), Point("second", [10.0, 10.0, 10.0, 10.0], 0.1)]
    assert fronts.as_fast(*noisy) and not any(fronts.beats(x, y) for x, y in (noisy, noisy[::-1]))
    assert not fronts.as_fast(a, one("far", 10.4, 0.1)) and not fronts.as_exact(a, one("far", 10.0, 0.103))


def test_the_front_is_by_time_and_names_ties():
    points = [one("c", 30.0, 0.001), one("a", 10.0, 0.1), one("worse", 31.0, 0.05), one("b", 20.0, 0.01), one("as a", 10.1, 0.1)]
    assert words(points) == ["a", "as a", "b", "c"]
    assert [point.also for point in points] == [[], ["as a"], [], [], ["a"]]


def test_below_the_floor_all_are_as_exact():
    points = [one("quick", 10.0, 1e-9), one("slow", 20.0, 1e-12)]
    assert words(points) == ["quick", "slow"] and words(points, floor=1e-8) == ["quick"]


def test_ratios_are_of_the_same_run():
    assert fronts.ratio([2.0, 40.0, 6.0], [1.0, 10.0, 2.0]) == pytest.approx((3.0, 2.5, 3.5))
    assert fronts.times([{"ns": 2.0, "run": 1}, {"ns": 1.0, "run": 0}]) == [1.0, 2.0]
    with pytest.raises(ValueError, match="2 rows"):
        fronts.one([{"a": 1}, {"a": 1}], a=1)
