"""The part of the process image that every machine has: drives, wires, safety inputs, a person near the machine.

A kind's readings, demand and setpoints inherit from these and add its own signals. One instance of each exists per
rig, overwritten in place at fixed places of a scan.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

NEVER: Final = float("-inf")
"""Time stamp of a source that has not reported yet: older than anything, hence stale."""

NAN: Final = float("nan")
"""Value of a source that has not reported yet, or of a demand that is not made."""


@dataclass(slots=True)
class BaseReadings:
    """What is known of any machine, with time stamps in seconds of the scan's clock."""

    now_s: float = 0.0

    drives_enabled: bool = False
    """Every drive that takes part is in OPERATION_ENABLED."""
    drives_disabled: bool = True
    """No drive applies torque."""
    drive_fault: str = ""
    """First drive fault, loss or emergency, as text; empty while all are healthy."""
    bus_fault: str = ""
    """Which wire is gone (CAN adapter, serial line), as text; empty while all are there."""
    can_heard_s: float = NEVER
    """When a frame last came in over CAN."""
    unheard: str = ""
    """Drives of which nothing new has come although others are heard, as text; empty where all are alike."""
    line_silent: str = ""
    """Modbus lines on which no device answers, as text; empty = none."""
    foreign_master: str = ""
    """First frame on the CAN bus that only another master sends, as text; empty while we are alone."""
    device_fault: str = ""
    """First Modbus device that refuses what it is asked or says that our commands do not come; empty = none."""
    line_errors: float = 0.0
    """Largest share of failed requests among the Modbus devices, of the last few seconds, 0..1."""
    line_fault: str = ""
    """The device of which that is, and how many of its requests failed, in words; empty while few do."""
    safety_chain: bool = False
    guard_closed: bool = False
    inputs_at_s: float = NEVER
    """When the drive with the safety inputs last said how these two are."""
    channels: list[float] = field(default_factory=list[float])
    """What the rig's further sensors measure, in the order of the rig file; NaN = not fresh and valid."""

    def faults(self) -> list[str]:
        """Return what drives, wires and devices say is wrong with them, in words."""
        wires = (self.bus_fault, self.line_silent, self.foreign_master)
        said = (self.drive_fault, self.unheard, *wires, self.device_fault, self.line_fault)
        return [one for one in said if one]


@dataclass(slots=True)
class BaseDemand:
    """What a step of any machine wants; control bounds it and may refuse it."""

    enabled: bool = False
    """Drives powered."""
    attended: bool = False
    """A person has been asked to come near: hands are where they would be hurt."""


@dataclass(slots=True)
class BaseSetpoints:
    """What goes to the drives of any machine at the end of a scan."""

    enable: bool = False
    quick_stop: bool = False
    power_off: bool = False
    """Every power stage off at once: what is left when a stop does not work."""
