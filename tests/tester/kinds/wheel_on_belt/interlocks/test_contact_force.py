"""The force expected from the press's movement: a step of either sign is detected, whatever rubber and press do."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.interlocks.contact_force import ForceObserver, depth_mm, force_n
from tester.kinds.wheel_on_belt.interlocks.witness import (
    FORCE_STEP_CROSS_SHARE,
    FORCE_STEP_DELAY_S,
    FORCE_STEP_N,
    FORCE_STEP_SEEN_SHARE,
    FORCE_STEP_UNSEEN_SHARE,
)

STIFFNESS = 145.0
DT_S = 0.01
TURN_S = 0.353
"""A turn of the wheel at 0.8 m/s."""
RAMP_MM_S2 = 50.0
"""Of the press: axes.press.acceleration."""


@dataclass
class Rubber:
    """A contact under a press that moves at a speed, with runout; the cell shows it 10 ms late."""

    stiffness: float = STIFFNESS
    wanted_mm_s: float = 0.0
    speed_mm_s: float = 0.0
    depth_mm: float = 0.0
    runout_n: float = 0.045
    """Peak to peak, as mm of the tread."""
    step_n: float = 0.0
    friction_n: float = 0.0
    now_s: float = 0.0
    held_n: float = math.nan

    def __post_init__(self) -> None:
        self.observer = ForceObserver(
            STIFFNESS, FORCE_STEP_UNSEEN_SHARE.value, FORCE_STEP_SEEN_SHARE.value, FORCE_STEP_CROSS_SHARE.value
        )

    def scan(self, phase: float = 0.0, lost_n_s: float = 0.0) -> float:
        """Do a scan; return the error of the force."""
        self.now_s += DT_S
        missing = self.wanted_mm_s - self.speed_mm_s
        self.speed_mm_s += max(-RAMP_MM_S2 * DT_S, min(RAMP_MM_S2 * DT_S, missing))
        self.depth_mm += self.speed_mm_s * DT_S
        swing = 0.5 * self.runout_n * math.sin(2.0 * math.pi * (self.now_s / TURN_S + phase))
        force = force_n(self.depth_mm + swing, self.stiffness)
        shown = force if math.isnan(self.held_n) else self.held_n
        self.held_n = force
        shown -= lost_n_s * self.now_s
        self.observer.update(
            Readings(
                now_s=self.now_s,
                cell_at_s=self.now_s,
                force_z_n=shown + self.step_n + 0.015 * self.friction_n,
                force_x_n=self.friction_n,
                press_mm=10.0 + self.depth_mm,
            )
        )
        return self.observer.off_n

    def told_after_s(self, within_s: float, phase: float = 0.0) -> float:
        """Return the time until the row trips; infinity: it does not."""
        began_s, since_s = self.now_s, math.inf
        while self.now_s < began_s + within_s:
            since_s = min(since_s, self.now_s + DT_S) if self.scan(phase) > FORCE_STEP_N.value else math.inf
            if self.now_s - since_s >= FORCE_STEP_DELAY_S.value - 1e-9:
                return self.now_s - began_s
        return math.inf


def held(force: float, phase: float = 0.0) -> Rubber:
    rubber = Rubber(depth_mm=depth_mm(force, STIFFNESS))
    for _ in range(50):
        assert rubber.scan(phase) <= FORCE_STEP_N.value
    return rubber


def test_force_and_depth_are_inverse() -> None:
    for force in (1.0, 20.0, 200.0, 440.0):
        assert force_n(depth_mm(force, STIFFNESS), STIFFNESS) == pytest.approx(force)
    assert force_n(0.0, STIFFNESS) == force_n(-1.0, STIFFNESS) == 0.0


@pytest.mark.parametrize("step_n", [30.0, -30.0])
@pytest.mark.parametrize("force", [100.0, 200.0, 400.0])
def test_a_step_of_30_n_on_a_held_load_is_detected_within_200_ms(force: float, step_n: float) -> None:
    for i in range(12):
        rubber = held(force, i / 12.0)
        rubber.step_n = step_n
        assert rubber.told_after_s(0.3, i / 12.0) <= 0.2


@pytest.mark.parametrize("step_n", [30.0, -30.0])
@pytest.mark.parametrize("share", [0.7, 1.0, 1.3])
def test_a_step_of_30_n_while_loading_is_detected_within_200_ms(share: float, step_n: float) -> None:
    for i in range(6):
        rubber = Rubber(stiffness=share * STIFFNESS, wanted_mm_s=2.0)
        while rubber.held_n != rubber.held_n or rubber.held_n < 200.0:
            assert rubber.scan(i / 6.0) <= FORCE_STEP_N.value
        rubber.step_n = step_n
        assert rubber.told_after_s(0.3, i / 6.0) <= 0.2


@pytest.mark.parametrize("share", [0.7, 1.0, 1.3])
@pytest.mark.parametrize("speed_mm_s", [2.0, 1.0, 0.2])
def test_loading_a_rubber_of_another_stiffness_is_no_step(share: float, speed_mm_s: float) -> None:
    for i in range(4):
        rubber = Rubber(stiffness=share * STIFFNESS, wanted_mm_s=speed_mm_s)
        off: list[bool] = []
        while not rubber.held_n >= 430.0:
            off.append(rubber.scan(i / 4.0) > FORCE_STEP_N.value)
        rubber.wanted_mm_s = -0.5 * speed_mm_s
        while rubber.held_n > 60.0:
            off.append(rubber.scan(i / 4.0) > FORCE_STEP_N.value)
        scans = round(FORCE_STEP_DELAY_S.value / DT_S)
        assert not any(all(off[k : k + scans]) for k in range(len(off) - scans))


@pytest.mark.parametrize("lost_n_s", [5.0, -5.0])
def test_wear_and_relaxation_are_no_step(lost_n_s: float) -> None:
    rubber = held(400.0)
    for _ in range(1000):
        assert rubber.scan(lost_n_s=lost_n_s) <= FORCE_STEP_N.value


@pytest.mark.parametrize("friction_n", [640.0, -640.0])
def test_friction_that_comes_shows_in_the_normal_force_and_is_no_step(friction_n: float) -> None:
    rubber = held(400.0)
    rubber.friction_n = friction_n
    assert rubber.told_after_s(0.3) == math.inf


def test_a_contact_that_opens_does_not_affect_the_next_one() -> None:
    rubber = held(200.0)
    rubber.observer.forget()
    rubber.step_n = 100.0
    assert rubber.told_after_s(0.1) == math.inf
