"""The common part of every machine's process image: drives, wires, safety inputs, a person near the machine.

A kind's readings, demand and setpoints inherit from these classes and add their own signals. Each rig has one instance
of each, which is overwritten in place at fixed places of a scan.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from tester.base.deriving import mypyc_attr

NEVER: Final = float("-inf")
"""Time stamp of a source that has not reported: older than any real one, hence stale."""

NAN: Final = float("nan")
"""Value of a source that has not reported, or of a missing demand."""


@mypyc_attr(allow_interpreted_subclasses=True)
@dataclass(slots=True)
class BaseReadings:
    """The readings of any machine, with time stamps in seconds of the scan's clock."""

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
    """Arrival time of the last CAN frame."""
    silences: Callable[[], tuple[str, str]] | None = None
    """Names the drives that send no new data while others do, and the Modbus lines on which no device answers
    (``DeviceList.silences``): asked only after a trip.
    """
    foreign_master: str = ""
    """First CAN frame that only another master can have sent, as text; empty = none."""
    device_fault: str = ""
    """First Modbus device that refuses a request or does not receive our commands; empty = none."""
    line_errors: float = 0.0
    """Largest share of failed requests of any Modbus device in the last few seconds, 0..1."""
    line_fault: str = ""
    """The device with that share, and its number of failed requests, in words; empty while few fail."""
    safety_chain: bool = False
    guard_closed: bool = False
    inputs_at_s: float = NEVER
    """Time stamp of the two safety inputs, from the drive that reads them."""
    channels: list[float] = field(default_factory=list[float])
    """Readings of the rig's further sensors, in the order of the rig file; NaN = not fresh and valid."""

    def later(self, seconds: float) -> None:
        """Move every time stamp by the rig time that was leapt (``tester.machine.leaps``), from the wires' clock."""
        self.now_s += seconds
        self.can_heard_s += seconds
        self.inputs_at_s += seconds

    def drive_stamps_s(self) -> tuple[float, ...]:
        """Return the time stamps of the drives' data, s; the kind knows its drives."""
        return ()

    def faults(self) -> list[str]:
        """Return the faults of drives, wires and devices, in words."""
        unheard, line_silent = self.silences() if self.silences is not None else ("", "")
        wires = (self.bus_fault, line_silent, self.foreign_master)
        texts = (self.drive_fault, unheard, *wires, self.device_fault, self.line_fault)
        return [text for text in texts if text]


@mypyc_attr(allow_interpreted_subclasses=True)
@dataclass(slots=True)
class BaseDemand:
    """The demand of a step on any machine; control bounds it and may refuse it."""

    enabled: bool = False
    """Whether the drives are to be powered."""
    attended: bool = False
    """A person was asked to come near: hands may be in danger."""


@mypyc_attr(allow_interpreted_subclasses=True)
@dataclass(slots=True)
class BaseSetpoints:
    """Setpoints for the drives of any machine at the end of a scan."""

    enable: bool = False
    quick_stop: bool = False
    power_off: bool = False
    """Switch every power stage off at once: the last resort when a stop fails."""
    voltage_off: bool = False
    """Disable the voltage of every drive, whatever it reports: its ramp after the last command is over."""
    creeps: bool = False
    """Only the drive that turns in a cool-down keeps its power; every other drive has its voltage disabled."""
