"""Swings of friction within a revolution, from samples."""

from __future__ import annotations

from math import exp, isnan, pi, sin, sqrt
from random import Random

import pytest

from sim.noise import NormalStream, StickSlip
from tester.analysis.blocks import BlockCounter
from tester.analysis.results import Swing
from tester.analysis.swing import LIMIT_PERCENT, UNKNOWN, swing_of
from tester.analysis.trace import Trace
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tests.tester.analysis.series import sample

TURN_HZ = 2.83
"""Of a 90 mm wheel at 0.8 m/s."""
RUNOUT = 0.05


def trace(
    share: float = 0.0,
    hz: float = 4.0,
    *,
    seed: int = 1,
    contacts: int = 3,
    contact_s: float = 5.3,
    rate_hz: float = 100.0,
    of_order: float = 0.0,
    sine: bool = False,
) -> Trace:
    """Return the trace of contacts with AR(1) noise of 1 %, stick-slip, and friction that varies with the angle."""
    random = Random(seed)
    counter, made = BlockCounter(QUANTITIES), StickSlip(share, hz, NormalStream(seed, "periods"))
    dt = 1.0 / rate_hz
    keep = exp(-dt / 0.3)
    noise, t = random.gauss(0.0, 0.01), 0.0
    for contact in range(contacts):
        t += 20.0
        for _ in range(round(contact_s * rate_hz)):
            t += dt
            noise = keep * noise + random.gauss(0.0, 0.01 * sqrt(1.0 - keep * keep))
            turn = TURN_HZ * t
            wave = 1.0 + share * sin(2.0 * pi * hz * t) if sine else made.factor(dt)
            mu = 0.7 * (1.0 + noise) * wave * (1.0 + of_order * sin(2.0 * pi * turn))
            load = 200.0 * (1.0 + RUNOUT * sin(2.0 * pi * turn + 1.0))
            counter.add(
                sample(
                    time_s=t,
                    wheel_angle_rev=turn,
                    force_x_n=mu * load + random.gauss(0.0, 0.25),
                    force_z_n=load,
                    burst=float(contact + 1),
                )
            )
    return counter.trace


@pytest.mark.parametrize("hz", [1.0, 2.4, 3.2, 4.0, 6.3, 8.0])
def test_stick_slip_is_found_with_its_frequency(hz: float) -> None:
    found = swing_of(trace(0.10, hz))
    assert found.hz == pytest.approx(hz, rel=0.05)
    # A saw-tooth's amplitude reads 18 % low, more where its multiples lie beyond the examined range.
    assert LIMIT_PERCENT < found.percent < 10.0


def test_the_amplitude_of_a_sine_is_as_it_is() -> None:
    assert swing_of(trace(0.10, 4.3, sine=True)).percent == pytest.approx(10.0, rel=0.05)


def test_a_saw_tooth_is_skew_and_a_vibration_is_not() -> None:
    assert swing_of(trace(0.10, 4.3)).skewness < -1.0
    assert abs(swing_of(trace(0.10, 4.3, sine=True)).skewness) < 0.3


@pytest.mark.parametrize("seed", range(20))
def test_steady_friction_does_not_swing(seed: int) -> None:
    assert swing_of(trace(seed=seed)).percent == 0.0


def test_a_variation_with_the_angle_of_the_wheel_is_no_swing() -> None:
    assert swing_of(trace(of_order=0.03)).percent == 0.0


def test_much_that_goes_with_the_turning_may_hide_a_swing() -> None:
    assert isnan(swing_of(trace(of_order=0.10)).percent)


def test_a_swing_beside_a_variation_with_the_angle_is_found() -> None:
    found = swing_of(trace(0.10, 4.3, of_order=0.10))
    assert found.hz == pytest.approx(4.3, rel=0.05) and found.percent > LIMIT_PERCENT


def test_contacts_that_are_too_short_give_no_result() -> None:
    assert isnan(swing_of(trace(0.10, contacts=10, contact_s=2.0)).percent)


def test_a_swing_that_is_fast_for_its_samples_has_a_frequency_and_no_amplitude() -> None:
    found = swing_of(trace(0.10, 4.3, rate_hz=20.0, contact_s=8.0))
    assert isnan(found.percent) and found.hz == pytest.approx(4.3, rel=0.05)
    assert LIMIT_PERCENT < found.seen_percent < 10.0


@pytest.mark.filterwarnings("error")
def test_a_swing_whose_multiples_lie_beyond_the_sampled_range_is_found() -> None:
    found = swing_of(trace(0.10, 8.0, rate_hz=20.0, contact_s=8.0))
    assert found.hz == pytest.approx(8.0, rel=0.05) and found.seen_percent > LIMIT_PERCENT


def test_samples_that_come_too_slowly_give_no_result() -> None:
    assert swing_of(trace(0.10, 1.0, rate_hz=3.0, contact_s=8.0)) == UNKNOWN


def test_no_samples_give_no_result() -> None:
    assert isnan(swing_of(Trace(QUANTITIES)).percent)


def test_long_contacts_are_looked_at_in_stretches() -> None:
    found = swing_of(trace(0.10, 4.3, contacts=1, contact_s=400.0))
    assert found.hz == pytest.approx(4.3, rel=0.05)


def test_a_swing_is_unknown_by_default() -> None:
    assert isnan(Swing().percent)
