"""Kills and power cuts: the short form; the long one is ``python -m tests.campaigns.crash``."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.campaigns.crash import kills, powercuts


def missed(figures: list[str]) -> list[str]:
    return [figure for figure in figures if figure.startswith("MISS")]


def test_a_power_cut_loses_no_committed_repeat_and_leaves_the_run_readable(tmp_path: Path) -> None:
    figures = [str(figure) for figure in powercuts.measure(tmp_path, 150)]
    assert not missed(figures), figures
    if "skipped" in figures[0]:
        pytest.skip(figures[0])


@pytest.mark.campaign  # same as `python -m tests.campaigns.crash --sample`
@pytest.mark.skipif(os.name != "posix", reason="kills by POSIX signals")
def test_a_killed_run_is_resumed_where_it_was_and_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    figures = [str(figure) for figure in kills.measure(tmp_path, 5)]
    assert not missed(figures), figures


@pytest.mark.campaign
@pytest.mark.skipif(os.name != "posix", reason="kills by POSIX signals")
def test_two_hundred_kills_and_a_thousand_power_cuts(tmp_path: Path) -> None:
    for folder in ("cuts", "kills"):
        (tmp_path / folder).mkdir()
    figures = [str(figure) for figure in powercuts.measure(tmp_path / "cuts", 1000)]
    figures += [str(figure) for figure in kills.measure(tmp_path / "kills", 200)]
    assert not missed(figures), figures
