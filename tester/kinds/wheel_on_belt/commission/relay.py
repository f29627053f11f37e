"""The standstill relay, provoked: wheel and belt turn slowly, lifted and unloaded, and one of them is halted.

A run counts on the relay where the program alone does not hold a contact (``stopped_contact``). It has a speed sensor
on each part, so each part is halted once.
"""

from __future__ import annotations

from functools import partial
from math import isfinite, nan
from typing import Final

from drivers.cia402 import State
from tester.kinds.wheel_on_belt.commission.watchdogs import TrialSeat
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import BUMP_SHARE
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.stopped_contact import RELAY_S
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused, choose, press
from tester.machine.commission.stages import Stage, in_stages
from tester.machine.proof import ProofStage, WatchdogProof

TURNS_M_S: Final = 0.2
"""Speed of wheel and belt, m/s [A]: the relay acts from 0.15 on, and ISO 10218-1 allows 0.25 near a person."""
SPIN_S: Final = 1.0
"""Time to get there, s [A]."""
STANDS_SHARE: Final = 0.1
"""Share of that speed below which a part counts as halted [A]."""
MORE_S: Final = 0.03
"""Time until standstill and torque off are read, s [A]: two readings and the ramp's end."""
WATCHED_S: Final = 0.5
"""Time for which a relay that does not act is waited for, s [A]."""
PARTS: Final = ("belt", "wheel")


class RelayTrial(WatchdogProof):
    """Lets wheel and belt turn, and halts one of them; both drives must lose their torque."""

    def __init__(self, devices: Devices, rig: RigConfig, halted: str) -> None:
        """Move nothing before the first ``step``; ``halted``: "wheel" or "belt"."""
        super().__init__(devices, follow=True, watchdog=True, withhold_s=WATCHED_S)
        self.axes, self.halted = devices.axes, halted
        self.radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
        self.stood_s = nan
        """When it stood: until then a failure is not the relay's."""

    @property
    def speeds_m_s(self) -> dict[str, float]:
        """Speeds of tread and belt."""
        return {"wheel": self.axes.wheel.actual * self.radius_m, "belt": self.axes.belt.actual}

    def begin(self, now: float) -> None:
        """Turn both."""
        self.axes.wheel.target, self.axes.belt.target = TURNS_M_S / self.radius_m, TURNS_M_S

    def move(self, now: float, elapsed: float) -> bool:
        """Check that both turn; then halt one."""
        if elapsed < SPIN_S:
            return False
        for name, speed_m_s in self.speeds_m_s.items():
            if not abs(speed_m_s - TURNS_M_S) <= BUMP_SHARE * TURNS_M_S:
                self.failure = f"the {name} turns at {speed_m_s:.3f} m/s, asked for {TURNS_M_S:g} m/s"
        return True

    def withhold(self, withheld: bool) -> None:
        """Halt the part, or leave both as they are."""
        if withheld:
            (self.axes.belt if self.halted == "belt" else self.axes.wheel).target = 0.0

    def still(self) -> bool:
        """Return whether wheel and belt stand."""
        return all(abs(speed) < STANDS_SHARE * TURNS_M_S for speed in self.speeds_m_s.values())

    def _withhold(self, now: float, elapsed: float) -> None:
        if self.stood_s != self.stood_s:
            if abs(self.speeds_m_s[self.halted]) < STANDS_SHARE * TURNS_M_S:
                self.stood_s = now
            elif elapsed > WATCHED_S:
                self.failure = f"the {self.halted} was not halted within {WATCHED_S:g} s"
            return
        for drive in (self.axes.wheel, self.axes.belt):
            if drive.state is not State.OPERATION_ENABLED:
                self.reported.setdefault(drive.config.name, now - self.stood_s)
        if len(self.reported) == len(PARTS):
            self.stop()
            self.enter(ProofStage.STILL, now)
        elif now - self.stood_s > WATCHED_S:
            self.failure = self.ran_on(self.halted)

    def ran_on(self, name: str) -> str:
        """Return the failure text of a relay that has left a drive its torque; ``name``: the part at rest."""
        left = " and ".join(part for part in PARTS if part not in self.reported)
        return f"the {name} stood, the other turned at {TURNS_M_S:g} m/s, and the torque of the {left} drive was on"


def provoke(seat: TrialSeat, notes: Notes) -> Dialogue:
    """Halt the belt, then the wheel; raises StepRefused for a relay that does not take the torque off in time."""
    if not seat.rig.arming.standstill_relay:
        notes.text = "the rig file has no standstill relay: loads that it would have to hold are refused"
        return

    def conclude() -> Dialogue:
        seen = yield from choose("relay seen", "did the relay itself show each time that it acted?", "yes", "no")
        if seen != "yes":
            raise _unconfirmed("the drives lost their torque, but a person did not see the relay act")
        after = ", ".join(f"{notes.values[part]['after_ms']} ms after the {part} stood" for part in PARTS)
        notes.text = f"the standstill relay takes the torque off wheel and belt {after}"

    stages: list[Stage] = [partial(_halted, seat, notes, part) for part in PARTS]
    yield from in_stages(notes, *stages, conclude)


def _halted(seat: TrialSeat, notes: Notes, part: str) -> Dialogue:
    text = f"hands off, guard closed; wheel and belt turn at {TURNS_M_S:g} m/s, unloaded, and the {part} is halted"
    yield from press(f"relay {part}", text, seat.guarded)
    trial = RelayTrial(seat.devices, seat.rig, part)
    seat.trials.proof = trial
    yield lambda now_s: trial.done
    if trial.failure:
        missed = StepRefused(f"standstill relay not provoked: {trial.failure}")
        raise _unconfirmed(trial.failure) if isfinite(trial.stood_s) else missed
    after_s = max(trial.reported.values())
    if not after_s <= RELAY_S + MORE_S:
        raise _unconfirmed(f"it took {1e3 * after_s:.0f} ms after the {part} stood, {1e3 * RELAY_S:.0f} ms are allowed")
    notes.values[part] = {"after_ms": round(1e3 * after_s)}
    notes.read(f"{part} halted: torque off", notes.values[part])


def _unconfirmed(why: str) -> StepRefused:
    return StepRefused(
        f"standstill relay: {why}. arming.standstill_relay: true is not confirmed: repair the relay, or in the rig"
        " file: arming.standstill_relay: false"
    )
