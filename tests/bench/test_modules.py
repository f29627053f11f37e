"""Shares of the compiled modules: base, modules on the wrong side of the threshold, contents of the lists."""

from __future__ import annotations

import pytest

from bench.figures import Verdict
from bench.modules import astray, folders, greatest, shares_of, together
from compiling.modules import BUSIEST, HOT, NEEDED, PAYING, THRESHOLD


def test_a_share_is_of_the_time_in_this_projects_python() -> None:
    assert shares_of({"tester/a.py": 3.0, "sim/b.py": 1.0, "others": 96.0}) == {"tester/a.py": 75.0, "sim/b.py": 25.0}


def test_the_greatest_of_the_recipes_counts() -> None:
    assert greatest({"one": {"a": 1.0, "b": 2.0}, "two": {"a": 3.0}}) == {"a": 3.0, "b": 2.0}


def test_a_paying_module_that_brings_nothing_is_a_miss_with_its_name() -> None:
    shares = dict.fromkeys(PAYING, THRESHOLD)
    assert astray([shares], partial=False)[0].verdict is Verdict.HOLDS
    idle, _ = astray([shares | {PAYING[0]: THRESHOLD / 3}], partial=False)
    assert (idle.verdict, idle.note) == (Verdict.MISSED, PAYING[0])


def test_a_busy_module_that_stays_python_is_named() -> None:
    _, busy = astray([dict.fromkeys(PAYING, THRESHOLD) | {"tester/base/words.py": 2 * THRESHOLD}], partial=False)
    assert (busy.runs, busy.note) == ((1.0,), "tester/base/words.py")


def test_the_folders_together_have_the_share_of_all() -> None:
    shares = dict.fromkeys(HOT, 0.5)
    figures = folders([{"one": shares}], dict.fromkeys(HOT, 2.0))
    assert sum(one.median for one in figures) == pytest.approx(together("one", [shares]).median) == 0.5 * len(HOT)
    assert all("kB of C" in one.note for one in figures)


def test_a_module_is_in_one_list() -> None:
    assert len(set(HOT)) == len(HOT) == len(PAYING) + len(NEEDED) and set(BUSIEST) <= set(PAYING)
