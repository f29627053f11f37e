"""The steps of a stored run, from its journal."""

from __future__ import annotations

from tester.service.protocol import Event
from tester.service.recorded_steps import left_of, plan_of, recorded_steps


def event(t_s: float, kind: str, text: str) -> Event:
    return Event(1, t_s, "2026-11-25T00:00:00Z", kind, "info", text, "run")


def test_each_step_lasts_until_the_next_begins_and_the_last_until_the_end() -> None:
    steps = recorded_steps([event(2.0, "step", "install"), event(12.0, "step", "pre-grind")], 250.0)
    assert [(step.title, step.began_s, step.ended_s) for step in steps] == [
        ("install", 2.0, 12.0),
        ("pre-grind", 12.0, 250.0),
    ]


def test_the_way_to_standstill_is_a_step_of_its_own() -> None:
    steps = recorded_steps([event(2.0, "step", "install"), event(9.0, "mode", "run -> stopping (trip)")], 10.0)
    assert [(step.title, step.took_s) for step in steps] == [("install", 7.0), ("to standstill", 1.0)]


def test_a_run_without_a_journal_has_no_steps_and_nothing_left() -> None:
    steps = recorded_steps([], 250.0)
    assert steps == () and left_of(steps, 100.0) == (0.0, 0.0) and plan_of("run", steps, 100.0).steps == ()
