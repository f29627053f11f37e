"""What software cannot hold, and which device of the rig must.

Pairs of faults in which harm is possible whatever the software does, each with the device that has to prevent it.
docs/safety.md shows the same list to users; a pair outside of it that does harm fails the campaign.
"""

from __future__ import annotations

from dataclasses import dataclass


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


def held_by_hardware(faults: tuple[str, ...]) -> MustHold | None:
    """Return the row that covers a pair, or None."""
    return next((row for row in HARDWARE_MUST_HOLD if row.covers(faults)), None)
