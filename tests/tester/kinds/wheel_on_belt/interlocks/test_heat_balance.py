"""Heat that the temperatures do not show: parameters off by 30 % never trip, larger sensor errors do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from math import inf

import pytest

from sim.physics.thermal import ThermalModel
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.control.observer import ThermalObserver
from tester.kinds.wheel_on_belt.interlocks.heat_balance import (
    FIRST,
    LEAST_SHARE,
    NEWEST,
    NO_HISTORY,
    HeatBalance,
    KnownRatio,
    known_ratio,
)
from tester.kinds.wheel_on_belt.rig import RigConfig

DT = 0.05
SETPOINT_C = 112.0


@pytest.fixture(scope="module")
def rig() -> RigConfig:
    return load_rig("sim")


def balance_of(rig: RigConfig, share: float) -> HeatBalance:
    thermal = rig.observer.thermal
    return HeatBalance(
        thermal.hub_capacity, thermal.hub_to_shaft, thermal.jacket_power, rig.ambient_c, share,
        rig.interlocks.heat_leak_w,
    )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Wheel:
    """A wheel's heat capacities, losses and friction's heat as shares of those assumed, in air off by some kelvin."""

    capacity: float = 1.0
    losses: float = 1.0
    friction: float = 1.0
    air_k: float = 0.0

    def model(self, rig: RigConfig) -> ThermalModel:
        sim, t = rig.sim, rig.sim.thermal
        thermal = replace(
            t, hub_capacity=self.capacity * t.hub_capacity, heat_capacity=self.capacity * t.heat_capacity,
            film_rotating=self.losses * t.film_rotating, film_sides=self.losses * t.film_sides,
            hub_to_shaft=self.losses * t.hub_to_shaft,
        )  # fmt: skip
        friction, belt = self.friction * sim.friction_heat_fraction, self.losses * sim.belt_conductance
        return ThermalModel(sim.wheel, thermal, friction, belt)


def heat_up(
    rig: RigConfig, wheel: Wheel, shows: Callable[[float], float], *, share: float = 0.3, told_k: float = inf
) -> tuple[float, float]:
    """Heat for 40 min, with bursts of friction; ``shows``: kelvin above ambient shown, for those there are.

    Return the greatest unseen heat in K, and the hub's true temperature in degC once it is above ``told_k``.
    """
    air_c = rig.ambient_c + wheel.air_k
    plant, observer, balance = wheel.model(rig), ThermalObserver(rig), balance_of(rig, share)
    state = plant.state(air_c)
    most_k = output = integral = 0.0
    for i in range(round(2400.0 / DT)):
        now = i * DT
        shown_c = air_c + shows(state.hub_c - air_c)
        error = SETPOINT_C - shown_c
        if 0.0 < output < 100.0:
            integral += error * DT / 60.0
        output = min(max(40.0 * (error + integral), 0.0), 100.0)
        friction_w = 300.0 if now % 60.0 < 10.0 and now > 600.0 else 0.0
        heater_w = 0.01 * output * rig.sim.thermal.jacket_power
        plant.step(state, DT, heater_w, friction_w, air_c, 1.0, True)
        observer.rub(friction_w, DT)
        if now >= observer.due_s:
            observer.step(now, shown_c, 0.8, state.surface_c)
            balance.update(now, shown_c, output, observer.given_j)
            most_k = max(most_k, balance.unseen_k)
            if most_k > told_k:
                break
    return most_k, state.hub_c


def gain(share: float) -> Callable[[float], float]:
    return lambda true_k: share * true_k


@pytest.mark.parametrize(
    "wheel", [Wheel(), *(Wheel(*off, air_k=-8.0) for off in product((0.7, 1.3), repeat=3)), Wheel(1.3, 1.3, 0.7, 7.0)]
)
def test_beliefs_off_by_30_percent_do_not_add_up(rig: RigConfig, wheel: Wheel) -> None:
    assert heat_up(rig, wheel, gain(1.0))[0] < 0.25 * rig.interlocks.unseen_heat_k


@pytest.mark.parametrize(("low", "told_c"), [(0.6, 50.0), (0.7, 90.0)])
def test_a_sensor_that_reads_30_percent_low_is_detected_long_before_the_hub_is_hot(
    rig: RigConfig, low: float, told_c: float
) -> None:
    most_k, hub_c = heat_up(rig, Wheel(), gain(low), told_k=rig.interlocks.unseen_heat_k)
    assert most_k > rig.interlocks.unseen_heat_k and hub_c < told_c


def test_with_measured_parameters_a_share_of_12_percent_detects_a_sensor_20_percent_low(rig: RigConfig) -> None:
    most_k, hub_c = heat_up(rig, Wheel(), gain(0.8), share=0.12, told_k=rig.interlocks.unseen_heat_k)
    assert most_k > rig.interlocks.unseen_heat_k and hub_c < 90.0


def test_beliefs_off_by_8_percent_do_not_add_up_where_the_share_is_12_percent(rig: RigConfig) -> None:
    assert heat_up(rig, Wheel(1.08, 1.08, 0.92), gain(1.0), share=0.12)[0] < 0.25 * rig.interlocks.unseen_heat_k


def test_a_sensor_late_by_20_s_hides_the_heat_given_meanwhile(rig: RigConfig) -> None:
    past = [0.0] * round(20.0 / DT)

    def late(true_k: float) -> float:
        past.append(true_k)
        return past.pop(0)

    assert heat_up(rig, Wheel(), late, told_k=rig.interlocks.unseen_heat_k)[0] > rig.interlocks.unseen_heat_k


def test_nothing_is_compared_across_a_gap_or_with_a_reading_that_is_none(rig: RigConfig) -> None:
    balance = balance_of(rig, 0.3)
    for now_s, hub_c in ((0.0, 60.0), (30.0, 60.0), (30.5, float("nan")), (31.0, 60.0)):
        balance.update(now_s, hub_c, 100.0, 0.0)
    assert balance.unseen_k == 0.0


def test_earlier_work_on_the_wheel_is_forgotten(rig: RigConfig) -> None:
    balance = balance_of(rig, 0.3)
    for i in range(20):
        balance.update(0.5 * i, 60.0, 100.0, 0.0)
    assert balance.unseen_k > 3.0
    balance.forget()
    balance.update(60.0, 20.0, 100.0, 0.0)
    assert balance.unseen_k == 0.0


def lack(rig: RigConfig, drift_k_s: float, ratio: float = 1.0) -> float:
    """Hold a reading at 110 degC for 20 min that lags the hub by ``drift_k_s``; return the missing heat."""
    balance = balance_of(rig, 0.12)
    balance.ratio, balance.spread = ratio, 0.12
    lost_w = balance.shaft_w_k * (110.0 - balance.ambient_c)
    put_w = ratio * (lost_w + balance.capacity_j_k * drift_k_s)
    for i in range(2400):
        balance.update(0.5 * i, 110.0, 100.0 * put_w / balance.power_w, 0.0)
    return balance.lack


@pytest.mark.parametrize("ratio", [0.9, 1.0, 1.1])
def test_heat_is_missing_where_a_reading_drifts_and_not_where_the_history_explains_it(
    rig: RigConfig, ratio: float
) -> None:
    assert lack(rig, 0.0, ratio) < 0.01
    assert lack(rig, 2.0 / 60.0, ratio) > 1.0
    assert lack(rig, -2.0 / 60.0, ratio) == 0.0


def test_heat_that_the_output_does_not_explain_adds_up(rig: RigConfig) -> None:
    balance = balance_of(rig, 0.3)
    for i in range(120):
        balance.update(0.5 * i, 60.0 + 0.1 * i, 0.0, 0.0)
    assert balance.ungiven_k > rig.interlocks.ungiven_heat_k and balance.unseen_k == 0.0


def stands(rig: RigConfig, hub_k: float, percent: Callable[[float], float]) -> float:
    """Hold the reading at 110 degC, ``hub_k`` to and fro, for 4 min; return the greatest heat that did not move it."""
    balance, most_k = balance_of(rig, 0.3), 0.0
    for i in range(480):
        at_s = 0.5 * i
        balance.update(at_s, 110.0 + hub_k * (i // 20 % 2), percent(at_s), 10.0)
        most_k = max(most_k, balance.still_k)
    return most_k


def test_a_constant_reading_while_the_output_rises_adds_up(rig: RigConfig) -> None:
    assert stands(rig, 0.1, lambda at_s: 15.0 + 0.2 * at_s) > 5.0


def test_a_reading_that_moves_with_the_output_does_not(rig: RigConfig) -> None:
    assert stands(rig, 0.3, lambda at_s: 15.0 + 0.2 * at_s) < 0.1


def test_a_steady_output_adds_nothing_up_however_far_beliefs_are_off(rig: RigConfig) -> None:
    assert stands(rig, 0.0, lambda at_s: 90.0) == 0.0


WIDEST, KNOWN = 0.3, 0.12


def share(*ratios: float) -> float:
    return known_ratio(ratios, WIDEST, KNOWN).share(WIDEST, KNOWN)


def test_without_a_history_the_widest_share_is_used() -> None:
    assert NO_HISTORY.share(WIDEST, KNOWN) == WIDEST
    assert share(1.0, 1.0) == WIDEST


def test_three_heatings_tighten_to_the_known_share_beyond_their_ratio() -> None:
    assert share(1.02, 1.0, 1.04) == pytest.approx(1.02 * 1.12 - 1.0)


@pytest.mark.parametrize("ratio", [1.2, 1.29])
def test_a_history_never_widens(ratio: float) -> None:
    assert share(*[ratio] * FIRST) == WIDEST


@pytest.mark.parametrize("ratio", [0.71, 0.8, 0.9])
def test_a_ratio_below_one_leaves_the_least_share(ratio: float) -> None:
    assert share(*[ratio] * FIRST) == LEAST_SHARE


def test_a_ratio_beyond_the_range_of_the_parameters_is_no_evidence() -> None:
    assert share(1.5, 0.5, 1.0, 1.0) == WIDEST
    assert known_ratio((1.5, 1.0, 1.0, 0.5, 1.0), WIDEST, KNOWN).heatings == 3


def test_heatings_that_do_not_agree_make_no_history() -> None:
    assert share(0.9, 1.1, 0.9, 1.1) == WIDEST


def test_the_first_that_agree_begin_the_history() -> None:
    assert known_ratio((0.8, 1.1, 1.0, 1.0, 1.02), WIDEST, KNOWN).ratio == 1.0


@pytest.mark.parametrize(
    ("ratio", "share"), [(1.0, KNOWN), (0.9, 1.0 - 0.9 * (1.0 - KNOWN)), (0.75, WIDEST), (1.2, LEAST_SHARE)]
)
def test_a_history_moves_the_share_of_heat_not_given_the_other_way(ratio: float, share: float) -> None:
    assert known_ratio((ratio,) * 3, WIDEST, KNOWN).ungiven_share(WIDEST, KNOWN) == pytest.approx(share)


def test_without_a_history_heat_not_given_has_the_widest_share() -> None:
    assert NO_HISTORY.ungiven_share(WIDEST, KNOWN) == WIDEST


def test_a_supply_that_drifts_does_not_take_the_share_along() -> None:
    drifting = [1.0 + 0.01 * run for run in range(3 * NEWEST)]
    shares = [share(*drifting[:runs]) for runs in range(FIRST, len(drifting))]
    assert max(shares) <= 1.01 * 1.12 - 1.0 + 1e-9


def test_a_ratio_that_falls_tightens() -> None:
    assert share(*[1.08] * FIRST, *[1.0] * NEWEST) == pytest.approx(KNOWN)


def test_known_heat_is_reported_with_the_threshold_of_the_row() -> None:
    assert NO_HISTORY.words(WIDEST, KNOWN) == "no history yet; a row tells from 30 %"
    assert KnownRatio(4, 1.02, 0.03).words(WIDEST, KNOWN) == (
        "known from 4 heatings, ratio 1.02, 0.03 apart; a row tells from 14 %"
    )


def test_a_history_that_tightens_nothing_asks_for_a_measurement() -> None:
    text = KnownRatio(4, 1.25).words(WIDEST, KNOWN)
    assert text.endswith("from 30 %: measure observer.thermal, or check the sensors")
