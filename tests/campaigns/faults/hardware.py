"""What software cannot prevent, and which device of the rig must.

Pairs of faults that can do harm in spite of any software, each with the device that must prevent it. Single faults
after which the load stays on if the press holds its position without power. docs/kinds/wheel-on-belt.md shows both
lists to users; any other harm fails the campaign.
"""

from __future__ import annotations

from dataclasses import dataclass

from tests.campaigns.faults.judge import Verdict


@dataclass(frozen=True, slots=True)
class MustHold:
    """A fault with any of some others (phrases of the catalogue), the device that must prevent harm, and why."""

    one: str
    others: tuple[str, ...]
    device: str
    why: str

    def covers(self, faults: tuple[str, ...]) -> bool:
        """Return whether a pair is one of these."""
        if len(faults) != 2:
            return False
        first, second = faults
        return (first == self.one and second in self.others) or (second == self.one and first in self.others)

    @property
    def pairs(self) -> tuple[tuple[str, str], ...]:
        """Return its pairs."""
        return tuple((self.one, other) for other in self.others)


_CUT_OUT = "thermal cut-out on the hub, in the heater's supply"
_CLUTCH = "mechanical stop or slipping clutch of the press at 480 N"
_TORQUE_OFF = "emergency stop circuit with safe torque off"
_DEAF = ("fault", "following error", "heartbeat lost", "off the bus", "setpoints lost", "in local mode")
_UNHEARD = (
    "CAN adapter gone", "CAN bus off", "CAN bus busy", "process killed", "second master stops nodes", "clock jump",
    "scan stalled",
)  # fmt: skip

HARDWARE_MUST_HOLD: tuple[MustHold, ...] = (
    MustHold("contactor welded", ("jacket relay shorted",), _CUT_OUT, "both switches of the heater stay closed"),
    MustHold("contactor welded", ("jacket output stuck on",), _CUT_OUT,
             "output and contactor stay on; the controller's limiter does not act on a stuck output"),
    MustHold("press runs away",
             ("press drive in local mode", "press drive following error", "press drive fault",
              "press drive feedback frozen", "press drive off the bus", "press drive data lost",
              "press drive heartbeat lost", "press drive setpoints lost"),
             _CLUTCH, "its own drive does not receive the order to lose its power, or does not report its position"),
    MustHold("press runs away", _UNHEARD, _CLUTCH, "no order to lose its power reaches its drive"),
    MustHold("press runs away",
             ("load cell frozen", "load cell silent", "load cell exception", "load cell replies cut short",
              "load cell replies merged"),
             _CLUTCH, "the force rises unseen"),
    MustHold("press runs away", ("operator hold", "wheel drive off the bus"), _CLUTCH,
             "the press comes while the drives are being stopped, or one of them no longer is"),
    *(MustHold(f"{axis} runs away",
               (*(f"{axis} drive {what}" for what in _DEAF), "CAN adapter gone", "CAN bus off", "CAN frames lost",
                "process killed", "second master stops nodes", "clock jump"),
               _TORQUE_OFF, "its own drive does not receive the order to lose its power")
      for axis in ("wheel", "belt")),
    *(MustHold(f"{axis} runs away", ("press drive in local mode", "press stuck"), _TORQUE_OFF,
               "it rubs until its power is gone, as the contact does not open sooner")
      for axis in ("wheel", "belt")),
)  # fmt: skip


UNEXPOSED: dict[str, str] = {
    "contactor welded": "it is to open when a run ends: tests/campaigns/faults/first_up.py shows it there",
    "hub sensor reads low": "it takes longer than a case is watched: tests/campaigns/faults/first_up.py waits for it",
}
"""Faults with a budget that cannot show in any case of the grid, and where they are tested instead."""

PRESS_RELEASE = "spring or counterweight that lifts the press without power, or a second release of it"
"""The device that must prevent harm if `press.on_power_loss` is `hold`."""

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
    ("CAN frames lost", "a drive that gets no setpoints for its deadline stops by itself, the press too"),
    ("second master stops nodes", "no command reaches a stopped node"),
    ("scan stalled", "every drive has stopped by itself without our heartbeat, and none starts by itself"),
    ("clock jump", "every drive's heartbeat looks lost: a drive that may be dead is not commanded"),
    ("process killed", "no program is left to command"),
    ("safety chain opened", "every command is zero while the emergency stop is mirrored"),
    ("emergency stop pressed", "the hardware has taken the drives' power"),
)
"""(beginning of a fault's phrase, why no command lifts the press): those that take its power or its commands away."""


def press_must_lift(verdict: Verdict) -> bool:
    """Return whether a single fault left only the load on, because it takes the press's power or commands."""
    faults = verdict.case.faults
    return len(faults) == 1 and verdict.only_force and any(faults[0].startswith(row[0]) for row in UNLIFTED)


def held_by_hardware(
    faults: tuple[str, ...], rows: tuple[MustHold, ...] = HARDWARE_MUST_HOLD
) -> MustHold | None:
    """Return the row that covers a pair, or None."""
    return next((row for row in rows if row.covers(faults)), None)
