"""The heat in a contact with one part at rest: its law, refusals of `check` without the relay, warnings of runs."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from tester.inputs.recipe.loader import check
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt import stopped_contact
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.stopped_contact import (
    HARMFUL_J,
    PlannedContact,
    Stopping,
    contact,
    counted_on,
    remedy,
    stop_s,
    stopping,
    unheld,
)
from tests.campaigns.faults.stage import plan_of
from tests.tester.kinds.wheel_on_belt.bench import SHORT

NO_RELAY = "arming.standstill_relay=false"


def rig(*overrides: str) -> RigConfig:
    return RigConfig.of(load_rig("sim", overrides, accept_risk="a test"))


def test_without_a_press_that_lifts_a_stop_takes_half_of_the_braking_time() -> None:
    believed = rig()
    slow = replace(believed, axes=replace(believed.axes, press=replace(believed.axes.press, acceleration=1e-3)))
    assert stop_s(slow, 200.0, 0.8) == pytest.approx(0.5 * 0.8 / 10.0, rel=0.03)


def test_brakes_shorten_a_stop() -> None:
    assert stop_s(rig(), 200.0, 0.8) < stop_s(rig(), 200.0, 0.8, brakes=False)


def test_a_later_scan_adds_its_lateness() -> None:
    late, later = (stopping(rig(f"interlocks.late_scan={ms} ms"), 200.0, 0.8).late_s for ms in (60, 100))
    assert later - late == pytest.approx(0.04)


def test_a_drive_that_does_not_report_standstill_costs_a_scan_more() -> None:
    told, asked = (stopping(rig(f"axes.belt.speed_zero={zero}"), 200.0, 0.8).late_s for zero in (0.01, 0))
    assert asked - told == pytest.approx(0.05)


def test_torque_limits_bound_the_friction_of_any_rubber() -> None:
    weak = rig("axes.wheel.max_torque_per_mille=500", "axes.belt.max_torque_per_mille=500")
    least_m = 0.5e-3 * weak.interlocks.least_diameter_mm
    for compound in ("3#", "rubber that nobody knows"):
        assert contact(weak, compound, 430.0, 0.8, 90.0).friction_n == pytest.approx(8.0 / least_m)


def test_a_rig_without_the_relay_refuses_heat_that_the_program_cannot_limit() -> None:
    text = SHORT.replace('"1#"', '"3#"')
    assert not check(text, rig(), PART, "x.yaml")
    (problem, *_) = check(text, rig(NO_RELAY), PART, "x.yaml")
    assert "harm begins at 40 J" in problem.message and "standstill_relay: true" in problem.message


def test_the_lateness_of_the_advice_is_enough() -> None:
    quick = rig(NO_RELAY, "scan.enabled=100 Hz")
    one = contact(quick, "1#", 200.0, 0.8, 40.0)
    assert unheld(quick, one)
    late_ms = remedy(quick, one).partition("at most ")[2].partition(" ms")[0]
    held = rig(NO_RELAY, "scan.enabled=100 Hz", f"interlocks.late_scan={late_ms} ms", "interlocks.late_warn=30 ms")
    assert one.power_w * stopping(held, 200.0, 0.8).worst_s <= 1.01 * HARMFUL_J


@pytest.mark.parametrize(("compound", "named"), [("1#", False), ("3#", True)])
def test_a_run_names_its_assumptions(compound: str, named: bool) -> None:
    text = SHORT.replace('"1#"', f'"{compound}"').replace("200 N", "60 N").replace("100 N", "60 N")
    (line,) = counted_on(rig(), plan_of(text, ()))
    assert ("COUNTED ON" in line) is named


def test_the_contact_with_the_most_heat_is_found_without_a_sum_for_each(monkeypatch: pytest.MonkeyPatch) -> None:
    quick, made = rig(), Random(3)
    contacts = [
        PlannedContact("1#", made.uniform(20.0, 400.0), made.uniform(0.1, 2.0), made.uniform(10.0, 500.0))
        for _ in range(200)
    ]
    longest = max(contacts, key=lambda one: one.power_w * stopping(quick, one.load_n, one.speed_m_s).worst_s)
    sums: list[float] = []

    def counted(rig: RigConfig, load_n: float, speed_m_s: float) -> Stopping:
        sums.append(load_n)
        return stopping(rig, load_n, speed_m_s)

    monkeypatch.setattr(stopped_contact, "stopping", counted)
    assert stopped_contact._worst(quick, contacts) == longest  # pyright: ignore[reportPrivateUsage]
    assert len(sums) < len(contacts) // 4
