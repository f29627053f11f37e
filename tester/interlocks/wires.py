"""What takes effect at once: the safety chain, the wires and their masters, the scan's own clock, the guard."""

from __future__ import annotations

from typing import Final

from tester.interlocks.inputs import Inputs
from tester.interlocks.parameter import AT_LEAST_ONE, Direction, Parameter
from tester.interlocks.row import ACK, EMERGENCY, FAST, WARN, Interlock


def _chain_open(v: Inputs) -> bool:
    return not v.readings.safety_chain


SAFETY_CHAIN: Final = Interlock(
    name="safety chain",
    cause="emergency stop circuit open (drive input)",
    level="input 0x60FD bit 16 = 0",
    condition=_chain_open,
    reaction=EMERGENCY,
    reset=ACK,
)


SILENT_CAN_SCANS: Final = Parameter(
    "silent_can_scans", "1", "2.5", "nothing heard over CAN for this many scan periods ...", AT_LEAST_ONE,
    direction=Direction.LOWER, hardest="5",
    because="as stale_can_scans",
)  # fmt: skip
SILENT_CAN_HEARTBEATS: Final = Parameter(
    "silent_can_heartbeats", "1", "1.5", "... or, if that is less, for this many heartbeats of a drive [A]",
    AT_LEAST_ONE, direction=Direction.LOWER, hardest="3",
    because="after three each drive counts as lost by itself",
)  # fmt: skip


def _nobody_heard(v: Inputs) -> bool:
    r, p = v.readings, v.parameters
    allowed_s = p[SILENT_CAN_HEARTBEATS] * v.limits.heartbeat_s
    # Enabled drives answer every scan's SYNC; without power they only send their heartbeats.
    if r.drives_enabled:
        scans_s = p[SILENT_CAN_SCANS] * v.scan_s
        allowed_s = scans_s if scans_s < allowed_s else allowed_s
    # A scan that comes late has not listened meanwhile: that is for "scan late" to judge.
    late_s = v.late_s if v.late_s > 0.0 else 0.0
    return not (r.now_s - late_s - r.can_heard_s <= allowed_s)


CAN_SILENT: Final = Interlock(
    name="CAN silent",
    cause="CAN cable, its terminators or the drives' supply: no drive is heard",
    level="no frame for silent_can_scans periods (drives on), or silent_can_heartbeats",
    condition=_nobody_heard,
    parameters=(SILENT_CAN_SCANS, SILENT_CAN_HEARTBEATS),
    reaction=FAST,
    reset=ACK,
)


def _drive_faulty(v: Inputs) -> bool:
    return v.readings.drive_fault != ""


DRIVE_FAULT: Final = Interlock(
    name="drive fault",
    cause="drive in fault, lost, rebooted or with an emergency message",
    level="state FAULT, heartbeat missing 3 x 50 ms, boot-up, or EMCY",
    condition=_drive_faulty,
    reaction=FAST,
    reset="drive reset by the acknowledgement",
)


def _bus_gone(v: Inputs) -> bool:
    return v.readings.bus_fault != ""


BUS_LOST: Final = Interlock(
    name="bus lost",
    cause="CAN adapter or serial line gone, bus-off",
    level="the wire's port is lost: it is never reopened",
    condition=_bus_gone,
    reaction=FAST,
    reset="started anew",
)


def _other_master(v: Inputs) -> bool:
    return v.readings.foreign_master != ""


SECOND_MASTER: Final = Interlock(
    name="second master",
    cause="another master on the CAN bus",
    level="a frame only a master sends",
    condition=_other_master,
    reaction=FAST,
    reset="other master gone, started anew",
)


def _clock_back(v: Inputs) -> bool:
    return not (v.readings.now_s >= v.last_s)


CLOCK_JUMP: Final = Interlock(
    name="clock jump",
    cause="the scan's clock went back",
    level="now < last scan",
    condition=_clock_back,
    reaction=FAST,
    reset=ACK,
)

LATE_WARN_S: Final = Parameter("late_warn_s", "s", "50 ms", "a scan this late is a warning ...")
LATE_SCAN_S: Final = Parameter(
    "late_scan_s", "s", "150 ms", "... this late a trip",
    direction=Direction.LOWER, hardest="200 ms",
    because="the drives stop by themselves 200 ms after the PC's last heartbeat or setpoint",
)  # fmt: skip


def _late(v: Inputs) -> bool:
    return not (v.late_s <= v.parameters[LATE_SCAN_S])


SCAN_LATE: Final = Interlock(
    name="scan late",
    cause="the controlling process was late",
    level="scan later than late_scan",
    condition=_late,
    parameters=(LATE_WARN_S, LATE_SCAN_S),
    reaction=FAST,
    reset=ACK,
)


def _guard_open(v: Inputs) -> bool:
    return v.demand.enabled and not v.readings.guard_closed


def _guard_still_open(v: Inputs) -> bool:
    return not v.readings.guard_closed


GUARD_OPEN: Final = Interlock(
    name="guard open",
    cause="guard open with drives on",
    level="input 0x60FD bit 17 = 0, drives wanted",
    condition=_guard_open,
    unseen=_guard_still_open,
    reaction=FAST,
    reset=ACK,
)


def _delayed(v: Inputs) -> bool:
    return not (v.late_s <= v.parameters[LATE_WARN_S])


SCAN_DELAYED: Final = Interlock(
    name="scan delayed",
    cause="the controlling process was late, but not dangerously",
    level="scan later than late_warn",
    condition=_delayed,
    parameters=(LATE_WARN_S,),
    reaction=WARN,
    reset="by itself",
)

ROWS: Final[tuple[Interlock, ...]] = (
    SAFETY_CHAIN, CAN_SILENT, DRIVE_FAULT, BUS_LOST, SECOND_MASTER, CLOCK_JUMP, SCAN_LATE, GUARD_OPEN,
)  # fmt: skip
WARNINGS: Final[tuple[Interlock, ...]] = (SCAN_DELAYED,)
"""Only said: they stand last in the table."""
