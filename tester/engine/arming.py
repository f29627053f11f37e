"""What is shown before every run: both drives follow, brake alike, and every drive stops without our heartbeat.

CiA 301 starts watching a heartbeat only with the first one it hears, and a wrong parameter shows only when it is
needed: so the watchdog is tried out, unloaded (``tester.engine.unloaded`` has seen to
that, and goes on watching) and at creep speed.
"""

from __future__ import annotations

from enum import Enum
from math import inf

from drivers.canopen import objects as o
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tester.engine.devices import Devices
from tester.engine.unloaded import ENABLE_S
from tester.rig import RigConfig
from tester.rig.checks import EQUAL_DECELERATIONS

HEARTBEAT_LOST = 0x8130
"""EMCY code of a heartbeat that stays away (CiA 301, table 26)."""
BUMP_S = 0.3
"""Ramp and lag are over by then: 25 ms at 2 m/s2 to 0.05 m/s [A]."""
BUMP_SHARE = 0.3
"""A speed within this share of its target follows; the other drive stands below the same speed [A]."""
PRESS_BUMP_MM_S = 2.0
PRESS_BUMP_MM = 0.2
"""The press moves by at least this in the bump, away from rest and back [A]."""
STILL_S = 1.5
"""From the end of the withheld heartbeat to standstill, at most [A]."""
RESTORE_S = 3.0
"""Faults are reset and every drive is off by then [A]."""
RESET_EVERY_S = 0.2


class Stage(Enum):
    """Where the proof is."""

    ENABLE = "enable the drives"
    BUMP_WHEEL = "turn the wheel"
    BUMP_BELT = "turn the belt"
    BUMP_PRESS = "move the press"
    WITHHOLD = "withhold the heartbeat"
    STILL = "wait for standstill"
    RESTORE = "reset and switch off"
    DONE = "done"


class Proof:
    """Goes through the stages, one call of ``step`` a scan. ``failure`` says what was not shown; "" while all is."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Nothing moves before the first ``step``."""
        self.devices = devices
        self.rig = rig
        self.failure = ""
        arming = rig.arming
        self.wanted = arming.bump_test or arming.watchdog_proof
        self.stage = Stage.ENABLE if self.wanted else Stage.RESTORE
        self.since_s = float("nan")
        self.pressed_from_mm = 0.0
        self.reset_s = -inf
        self.reported: set[str] = set()
        radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
        self.radius_m = radius_m
        self.failure = unequal_decelerations(devices, radius_m)

    @property
    def done(self) -> bool:
        """Everything has been shown, or something has not."""
        return self.stage is Stage.DONE or bool(self.failure)

    @property
    def provokes(self) -> bool:
        """Drives are made to stop by themselves, or have not been reset yet after that."""
        if self.stage is Stage.RESTORE:
            return self.rig.arming.watchdog_proof
        return self.stage in (Stage.WITHHOLD, Stage.STILL)

    def proven(self) -> str:
        """Return a line for the journal: what was shown, and what was not because the rig file says so."""
        arming = self.rig.arming
        shown = ["lifted and unloaded", "decelerations equal"]
        left_out: list[str] = []
        (shown if arming.bump_test else left_out).append("drives follow")
        for drive in self.devices.drives:
            proven = drive.config.name in self.reported
            (shown if proven else left_out).append(f"{drive.config.name} stops without our heartbeat")
        lease = self.devices.jacket.has_lease
        (shown if lease else left_out).append("jacket's lease set and read back")
        text = "shown: " + ", ".join(shown)
        return f"{text}; NOT shown: {', '.join(left_out)}" if left_out else text

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""
        if self.since_s != self.since_s:
            self.since_s = now
        for drive in self.devices.drives:
            for emergency in drive.take_emergencies():
                if emergency.code == HEARTBEAT_LOST and self.stage in (Stage.WITHHOLD, Stage.STILL):
                    self.reported.add(drive.config.name)
        if not self.failure:
            self._stage(now, now - self.since_s)
        if self.failure:
            self.stop()

    def stop(self) -> None:
        """Bring every drive to standstill and power off; our heartbeat is there again."""
        self.devices.master.withhold_heartbeat = False
        axes = self.devices.axes
        for drive in self.devices.drives:
            drive.goal = Goal.DISABLED
        axes.wheel.target = axes.belt.target = axes.press.target = 0.0

    def _stage(self, now: float, elapsed: float) -> None:
        stage = self.stage
        if stage is Stage.ENABLE:
            self._enable(now, elapsed)
        elif stage is Stage.BUMP_WHEEL or stage is Stage.BUMP_BELT:
            self._bump(now, elapsed)
        elif stage is Stage.BUMP_PRESS:
            self._bump_press(now, elapsed)
        elif stage is Stage.WITHHOLD:
            self._withhold(now, elapsed)
        elif stage is Stage.STILL:
            self._still(now, elapsed)
        elif stage is Stage.RESTORE:
            self._restore(now, elapsed)

    def _enter(self, stage: Stage, now: float) -> None:
        self.stage = stage
        self.since_s = now

    def _enable(self, now: float, elapsed: float) -> None:
        late: list[str] = []
        for drive in self.devices.drives:
            drive.goal = Goal.ENABLED
            if drive.state is not State.OPERATION_ENABLED:
                late.append(drive.config.name)
        if not late:
            self._enter(Stage.BUMP_WHEEL, now)
            self._creep(wheel=True, belt=not self.rig.arming.bump_test)
        elif elapsed > ENABLE_S:
            self.failure = f"not enabled after {ENABLE_S:g} s: {', '.join(late)}"

    def _creep(self, *, wheel: bool, belt: bool) -> None:
        axes, creep = self.devices.axes, self.rig.arming.creep_m_s
        axes.wheel.target = creep / self.radius_m if wheel else 0.0
        axes.belt.target = creep if belt else 0.0

    def _bump(self, now: float, elapsed: float) -> None:
        if elapsed < BUMP_S:
            return
        axes, creep = self.devices.axes, self.rig.arming.creep_m_s
        wheel, belt = axes.wheel.actual * self.radius_m, axes.belt.actual
        second = self.stage is Stage.BUMP_BELT or not self.rig.arming.bump_test
        near = BUMP_SHARE * creep
        if not abs(wheel - creep) <= near:
            self.failure = f"the wheel turns at {wheel:.3f} m/s, asked for {creep:g} m/s"
        elif not abs(belt - (creep if second else 0.0)) <= near:
            asked = f"{creep:g} m/s" if second else "standstill"
            self.failure = f"the belt runs at {belt:.3f} m/s, asked for {asked}"
        elif not second:
            self._creep(wheel=True, belt=True)
            self._enter(Stage.BUMP_BELT, now)
        elif self.rig.arming.bump_test:
            self.pressed_from_mm = axes.press.actual
            axes.press.target = PRESS_BUMP_MM_S
            self._enter(Stage.BUMP_PRESS, now)
        else:
            self._begin_withholding(now)

    def _bump_press(self, now: float, elapsed: float) -> None:
        if elapsed < BUMP_S:
            return
        press = self.devices.axes.press
        moved = press.actual - self.pressed_from_mm
        press.target = 0.0
        if not moved >= PRESS_BUMP_MM:
            self.failure = f"the press moved by {moved:.2f} mm, asked for {BUMP_S * PRESS_BUMP_MM_S:.2f} mm"
        elif self.rig.arming.watchdog_proof:
            self._begin_withholding(now)
        else:
            self._enter(Stage.RESTORE, now)

    def _begin_withholding(self, now: float) -> None:
        self.reported.clear()
        self.devices.master.withhold_heartbeat = True
        self._enter(Stage.WITHHOLD, now)

    def _withhold(self, now: float, elapsed: float) -> None:
        if elapsed < self.rig.arming.withhold_s:
            return
        self.devices.master.withhold_heartbeat = False
        for drive in self._watched():
            if drive.config.name not in self.reported or drive.state is State.OPERATION_ENABLED:
                self.failure = (
                    f"the {drive.config.name} drive did not stop with EMCY 0x8130 when our heartbeat was missing"
                    f" for {self.rig.arming.withhold_s * 1000:g} ms (0x1016, 0x6007)"
                )
                return
        self.stop()
        self._enter(Stage.STILL, now)

    def _watched(self) -> list[ServoDrive]:
        return [drive for drive in self.devices.drives if drive.config.proves_watchdog]

    def _still(self, now: float, elapsed: float) -> None:
        axes, least = self.devices.axes, 0.1 * self.rig.arming.creep_m_s
        if abs(axes.wheel.actual) * self.radius_m < least and abs(axes.belt.actual) < least:
            self._enter(Stage.RESTORE, now)
        elif elapsed > STILL_S:
            self.failure = "a drive still turns after it lost our heartbeat"

    def _restore(self, now: float, elapsed: float) -> None:
        self.stop()
        devices = self.devices
        waiting = [
            drive.config.name
            for drive in devices.drives
            if drive.emergency is not None or not drive.online or drive.state > State.READY_TO_SWITCH_ON
        ]
        if not waiting:
            self._enter(Stage.DONE, now)
        elif elapsed > RESTORE_S:
            self.failure = f"not reset after the proof: {', '.join(waiting)}"
        elif self.provokes and elapsed > RESET_EVERY_S and now - self.reset_s > RESET_EVERY_S:
            self.reset_s = now
            for drive in devices.drives:
                drive.reset_fault()


def unequal_decelerations(devices: Devices, radius_m: float) -> str:
    """Return "" or how the ramps read back from wheel and belt differ, in m/s2."""
    wheel, belt = devices.axes.wheel, devices.axes.belt
    for index, name in ((o.PROFILE_DECELERATION, "deceleration"), (o.QUICK_STOP_DECELERATION, "quick stop")):
        at_rim = wheel.parameters.get((index, 0), 0) / wheel.config.velocity_increments * radius_m
        of_belt = belt.parameters.get((index, 0), 0) / belt.config.velocity_increments
        if not abs(at_rim - of_belt) <= EQUAL_DECELERATIONS * of_belt:
            return f"{name}: wheel {at_rim:.3g} m/s2 at the rim, belt {of_belt:.3g} m/s2: must be equal within 5 %"
    return ""
