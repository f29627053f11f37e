"""What software cannot hold, and which device of the rig must.

Pairs of faults in which harm is possible whatever the software does, each with the device that has to prevent it.
And single faults after which the load stays on where the press holds its place without power. docs/safety.md shows both
lists to users; whatever else does harm fails the campaign.
"""

from __future__ import annotations

from dataclasses import dataclass

from tests.faults.judge import Verdict


@dataclass(frozen=True, slots=True)
class MustHold:
    """Two faults (phrases of the catalogue, or beginnings of them), the device that must hold, and why."""

    one: str
    other: str
    device: str
    why: str

    def covers(self, faults: tuple[str, ...]) -> bool:
        """Tell whether a pair is this one."""
        if len(faults) != 2:
            return False
        first, second = faults
        straight = first.startswith(self.one) and second.startswith(self.other)
        return straight or (second.startswith(self.one) and first.startswith(self.other))


HARDWARE_MUST_HOLD: tuple[MustHold, ...] = (
    MustHold("contactor welded", "jacket relay shorted", "thermal cut-out on the hub, in the heater's supply",
             "both switches of the heater stay closed"),
    MustHold("contactor welded", "jacket output stuck on", "thermal cut-out on the hub, in the heater's supply",
             "output and contactor stay on; the controller's limiter does not act on a stuck output"),
    MustHold("press stuck", "", "mechanical stop of the press, and the safe-torque-off of both drives",
             "a jammed press cannot be lifted: whatever else fails happens under load"),
    MustHold("press runs away", "", "mechanical stop or slipping clutch of the press at 480 N",
             "with a second fault in cell, bus or process nobody sees the force rise in time"),
)  # fmt: skip


PRESS_RELEASE = "spring or counterweight that lifts the press without power, or a second release of it"
"""The device that must hold where `press.on_power_loss` is `hold`."""

UNLIFTED: tuple[tuple[str, str], ...] = (
    ("press drive fault", "the drive in fault has no power"),
    ("press drive following error", "the drive in fault has no power"),
    ("press drive heartbeat lost", "a drive that may be dead is not commanded"),
    ("press drive reboots", "the drive comes back without power and takes no commands"),
    ("press drive off the bus", "no command reaches the drive"),
    ("press drive without supply", "the drive is off"),
    ("press drive setpoints lost", "no command reaches the drive"),
    ("press drive in local mode", "the drive takes no commands"),
    ("press drive torque off", "the drive has no power"),
    ("press runs away", "its power is taken away, as it obeys no command"),
    ("CAN adapter gone", "no command reaches any drive"),
    ("CAN bus off", "no command reaches any drive"),
    ("CAN bus busy", "commands and positions come too late to lift by"),
    ("second master stops nodes", "no command reaches a stopped node"),
    ("scan stalled", "every drive has stopped by itself without our heartbeat, and none starts by itself"),
    ("clock jump", "every drive's heartbeat looks lost: a drive that may be dead is not commanded"),
    ("process killed", "nobody is left to command"),
    ("safety chain opened", "every command is zero while the emergency stop is mirrored"),
    ("emergency stop pressed", "the hardware has taken the drives' power"),
)
"""(beginning of a fault's phrase, why no command lifts the press): those that take its power or its commands away."""


def press_must_lift(verdict: Verdict) -> bool:
    """Tell whether a single fault has left nothing but the load, because it takes the press's power or commands."""
    faults = verdict.case.faults
    return len(faults) == 1 and verdict.only_force and any(faults[0].startswith(row[0]) for row in UNLIFTED)


def held_by_hardware(faults: tuple[str, ...]) -> MustHold | None:
    """Return the row that covers a pair, or None."""
    return next((row for row in HARDWARE_MUST_HOLD if row.covers(faults)), None)
