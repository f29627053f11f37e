"""Corners, the faults tried in them, search in magnitude (``python -m tests.campaigns.faults --limits``)."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.loader import check
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.campaigns.faults import limits, magnitudes
from tests.campaigns.faults.campaign import all_cases
from tests.campaigns.faults.corners import LOAD_STEP_N, SLIP_STEP_MM_S, TEMPERATURE_STEP_K, Corner, corners
from tests.campaigns.faults.judge import fault_of
from tests.campaigns.faults.magnitudes import Found, Trial, Written, search, written
from tests.campaigns.faults.moments import Moment
from tests.campaigns.faults.mutants import ROOT
from tests.campaigns.faults.parametric import ASSEMBLY, CATALOGUE, PARAMETRIC

ALLOWED = {
    "common temperature supply gain": (65.0, 88.0),
    "hub sensor gain": (82.0, 87.0),
    "hub sensor drift": (-0.1, -0.04),
    "common force supply drift": (-10.0, -0.1),
    "load cell gain": (50.0, 150.0),
}
"""What the written table may hold, and how far: temperatures 12 to 35 % low, a rig without a history;
load cell and press torque that drift together; the gain of the cell."""


def test_there_is_a_corner_for_every_compound_stiffness_and_heat() -> None:
    found = corners().values()
    assert len(found) == 12
    assert len({(one.compound, one.stiffness, one.heat) for one in found}) == 12


@pytest.mark.parametrize("corner", list(corners().values())[::4], ids=lambda corner: corner.compound)
def test_a_corner_passes_the_check_and_nothing_beyond_does(corner: Corner) -> None:
    rig = load_rig("sim")
    assert check(corner.text, rig, PART, "corner.yaml") == []
    for beyond in (
        replace(corner, load_n=corner.load_n + LOAD_STEP_N),
        replace(corner, slip_mm_s=corner.slip_mm_s + SLIP_STEP_MM_S),
        replace(corner, temperature_c=corner.temperature_c + TEMPERATURE_STEP_K),
    ):
        assert check(beyond.text, rig, PART, "corner.yaml")


def test_corners_follow_the_rig_file() -> None:
    weak = load_rig("sim", ["limits.load=300 N", "limits.surface=60 degC"])
    corner = next(iter(corners().values()))
    assert len(check(corner.text, weak, PART, "corner.yaml")) >= 2


def test_every_fault_is_tried_and_one_with_a_range_to_both_sides() -> None:
    tried = [fault_of(text) for text in limits.faults()]
    for name, row in PARAMETRIC.items():
        assert sum(one.kind.phrase == name for one in tried) == len(row.ends)
    assert {one.kind.phrase for one in tried} <= CATALOGUE.keys()


def test_faults_of_assembly_begin_with_the_run() -> None:
    moments = [Moment("r", 1, "0 connect connect", "begin"), Moment("r", 2, "4 3#, measure", "begin")]
    cases = all_cases(moments, ["wheel drive reversed", "belt jammed"])
    assert [(moment.tick, names[0]) for moment, names in cases if names[0].startswith(ASSEMBLY)] == [
        (1, "wheel drive reversed")
    ]
    assert len(cases) == 3


def test_bisection_finds_the_greatest_unnoticed_magnitude_and_the_least_that_harms(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def attempt(row: object, value: float, corner: str, place: tuple[str, str]) -> Trial:
        seen = "contact too deep" if value <= -80.0 else ""
        return Trial(value, seen, ("harm: force",) if value <= -60.0 else (), 430.0 - value, 0.0, 0.0, 0.0, 0.0)

    monkeypatch.setattr(magnitudes, "attempt", attempt)
    every = {place: None for places in magnitudes._PLACES.values() for place in places}
    monkeypatch.setattr(magnitudes, "places", lambda corner: every)
    found = search(PARAMETRIC["load cell offset"], -200.0)
    assert found.unnoticed is not None and -80.0 < found.unnoticed.value < -76.0
    assert found.noticed_by == "contact too deep"
    assert found.harming is not None and -80.0 < found.harming.value <= -60.0
    assert "HARM" in found.text


def _found(value: float) -> Found:
    harming = Trial(value, "", ("harm: force",), 520.0, 0.0, 0.0, 0.0, 0.0)
    return Found(PARAMETRIC["load cell gain"], 50.0, "somewhere", harming, (harming,), "")


def test_a_row_of_rigs_without_a_history_covers_nothing_of_a_search() -> None:
    row = Written("load cell gain", 70.0, 90.0, "%", "", "", "", "without a history")
    assert not row.covers(_found(80.0))


@pytest.mark.parametrize(("value", "covered"), [(80.0, True), (60.0, False), (95.0, False)])
def test_the_written_table_covers_only_its_magnitudes(value: float, covered: bool) -> None:
    row = Written("load cell gain", 70.0, 90.0, "%", "", "", "")
    assert row.covers(_found(value)) is covered


def test_the_written_table_holds_only_what_it_may_and_the_safety_page_shows_it() -> None:
    page = (ROOT / "docs" / "kinds" / "wheel-on-belt.md").read_text(encoding="utf-8")
    shown = page.split("<!-- magnitudes: begin -->")[1].split("<!-- magnitudes: end -->")[0].splitlines()[3:]
    assert shown == [
        f"| {row.range} | {row.does} | {row.device} | {row.why} |"
        for row in written()
    ]
    for row in written():
        least, most = ALLOWED[row.fault]
        assert least <= row.least < row.most <= most
