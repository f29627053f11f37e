"""A short sample of the campaign in the default run; all of it: ``python -m tests.campaigns.faults --full``."""

from __future__ import annotations

from functools import cache

import pytest

from sim.faults import Injection
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultTime
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tests.campaigns.faults import every_scan, late_scans, second_stops
from tests.campaigns.faults.__main__ import main
from tests.campaigns.faults.campaign import Tally, all_cases, conduct, faults_of_campaign, pairs, sample
from tests.campaigns.faults.hardware import (
    HARDWARE_MUST_HOLD,
    PRESS_RELEASE,
    UNEXPOSED,
    UNLIFTED,
    held_by_hardware,
    press_must_lift,
)
from tests.campaigns.faults.judge import JUDGED, Case, Verdict
from tests.campaigns.faults.moments import Moment, rehearse
from tests.campaigns.faults.mutants import MUTANTS, ROOT
from tests.campaigns.faults.recipes import RECIPES
from tests.campaigns.faults.stage import Stage

FEW = 16


@cache
def moments() -> tuple[Moment, ...]:
    return tuple(rehearse("short")[0])


def failures(tally: Tally) -> list[str]:
    return [f"{verdict.case}: {text}" for verdict in tally.failed for text in verdict.failures]


def test_the_recipe_runs_to_its_end_without_harm_and_without_a_trip():
    found, stage = rehearse("short")
    assert stage.run.outcome.value == "done"
    assert not stage.observer.found and not stage.invariants.broken and not stage.ledger.trips
    assert {moment.phase for moment in found} == {"begin", "middle", "end"}


@pytest.mark.parametrize("fault", ["load cell line unplugged", "CAN frames late", "belt drive emergency storm"])
def test_after_a_fault_ticks_come_no_quicker_than_scans_and_arrivals(fault: str):
    stage = Stage(RECIPES["short"])
    while not stage.running:
        stage.tick()
    stage.inject(Injection(FaultTime(at_s=stage.next_s), CATALOGUE[fault]))
    began_s, ticks = stage.next_s, stage.ticks
    while stage.next_s < began_s + 3.0:
        stage.tick()
    assert stage.ticks - ticks < 3.0 * 400


def test_a_run_spares_the_memory_of_the_jackets_controller():
    wear = rehearse("short")[1].rig.jacket.wear
    assert wear and max(wear.values()) <= 20, "100 000 writes are 5 000 such runs and more"


@pytest.mark.parametrize("fault", ["wheel runs away", "belt runs away"])
def test_an_axis_that_runs_away_while_connecting_loses_its_power(fault: str):
    connecting = [moment for moment in moments() if moment.place.startswith("0 connect")]
    assert failures(conduct("connecting", [(moment, (fault,)) for moment in connecting])) == []


def test_a_few_faults_at_a_few_moments_end_safely_and_in_time():
    cases = sample(all_cases(moments(), faults_of_campaign(everything=True)), FEW)
    tally = conduct("few", cases)
    assert len(tally.verdicts) == FEW
    assert failures(tally) == []


def test_a_few_pairs_end_safely():
    tally = conduct("few pairs", pairs(moments(), faults_of_campaign(everything=False), 4), budgets=False)
    assert [str(v.case) for v in tally.unsafe if held_by_hardware(v.case.faults) is None] == []


def test_stops_and_kills_at_a_few_scans_end_safely():
    for tally in every_scan.conduct((450, 3000, 6000)).values():
        assert failures(tally) == []


def test_a_late_scan_is_the_first_cause_where_no_drive_trips_before():
    tally = late_scans.conduct()
    assert len(tally.verdicts) >= 25 and failures(tally) == []


def test_a_sample_has_every_fault_once_before_any_twice():
    cases = all_cases(moments(), ["operator stop", "guard opened", "belt jammed"])
    assert {names for _, names in sample(cases, 6)} == {("operator stop",), ("guard opened",), ("belt jammed",)}


def test_the_sample_is_always_the_same():
    cases = all_cases(moments(), faults_of_campaign(everything=True))
    assert sample(cases, 50) == sample(cases, 50)


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.name)
def test_every_mutant_still_fits_the_code(mutant):
    assert (ROOT / mutant.path).read_text(encoding="utf-8").count(mutant.old) == 1


@pytest.mark.campaign
def test_the_sample_of_the_command_meets_every_figure():
    assert main(["--sample"]) == 0


def test_the_safety_page_lists_what_hardware_must_hold():
    page = (ROOT / "docs" / "kinds" / "wheel-on-belt.md").read_text(encoding="utf-8")
    shown = page.split("<!-- double faults: begin -->")[1].split("<!-- double faults: end -->")[0]
    for row in HARDWARE_MUST_HOLD:
        assert f"| {row.one} + {' or '.join(row.others)} | {row.device} | {row.why} |" in shown
    assert len(shown.splitlines()) == len(HARDWARE_MUST_HOLD) + 3


def test_what_hardware_must_hold_are_faults_of_the_catalogue():
    assert {name for row in HARDWARE_MUST_HOLD for pair in row.pairs for name in pair} <= CATALOGUE.keys()
    assert UNEXPOSED.keys() <= CATALOGUE.keys()


@pytest.mark.parametrize("kind", [k for k in CATALOGUE.values() if k.reaction is Expected.MAY], ids=lambda k: k.phrase)
def test_of_a_fault_that_may_trip_nothing_is_asked_and_the_reason_is_written(kind: FaultKind):
    assert kind.note and kind.budget_s == 0.0


def test_a_fault_of_which_something_is_asked_has_a_budget():
    judged = [kind for kind in CATALOGUE.values() if kind.reaction in JUDGED]
    assert len(judged) >= 130 and all(kind.budget_s > 0.0 for kind in judged)


def test_a_second_stop_in_the_cool_down_ends_safely():
    tally = second_stops.conduct(("operator stop", "operator fast stop", "process killed", "wheel drive fault"))
    assert len(tally.verdicts) == 4 and failures(tally) == []


def test_the_safety_page_lists_after_which_faults_a_press_without_spring_is_not_lifted():
    page = (ROOT / "docs" / "kinds" / "wheel-on-belt.md").read_text(encoding="utf-8")
    shown = page.split("<!-- unlifted: begin -->")[1].split("<!-- unlifted: end -->")[0]
    assert PRESS_RELEASE in " ".join(page.split())
    assert shown.splitlines()[3:] == [f"| {fault} | {why} |" for fault, why in UNLIFTED]


@pytest.mark.parametrize(
    ("fault", "failures", "missing", "held"),
    [
        ("press drive fault", ["not safe"], ["force 200 N"], True),
        ("press drive fault", ["not safe"], ["force 200 N", "wheel 0.1 m/s"], False),
        ("press drive fault", ["not safe", "harm: force, 501 N"], ["force 200 N"], False),
        ("press drive fault", ["missed budget of 0.07 s"], [], False),
        ("hub sensor open", ["not safe"], ["force 200 N"], False),
    ],
)
def test_only_a_load_that_stays_on_is_left_to_hardware_and_only_after_a_listed_fault(fault, failures, missing, held):
    verdict = Verdict(Case("short", 1, "", (fault,)), failures, missing)
    assert press_must_lift(verdict) is held


def test_the_full_grid_has_at_least_seven_thousand_cases_of_forty_faults():
    faults = faults_of_campaign(everything=False)
    assert len(faults) >= 40
    assert 160 * len(faults) >= 9000  # the four recipes have 203 moments
