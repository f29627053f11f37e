"""Rows of any machine: safety chain, wires and their masters, the scan's own clock, guard, Modbus devices in
general.
"""

from __future__ import annotations

from math import nan
from typing import Any, Final, TypeAlias

from tester.inputs.rig.parameter import AT_LEAST_ONE, NOT_NEGATIVE, SHARE, Parameter
from tester.machine.row import ACK, CONTROLLED, EMERGENCY, SELDOM, WARN, Interlock
from tester.machine.watches import at_least, at_most, condition

Row: TypeAlias = Interlock[Any]
"""A row over any kind's inputs: ``ScanInputs`` with readings, demand, and limits that contain ``heartbeat_s``."""

SAFETY_CHAIN: Final[Row] = Interlock(
    name="safety chain",
    cause="emergency stop circuit open (drive input)",
    watch=condition("input 0x60FD bit 16 = 0", lambda v: not v.readings.safety_chain),
    when=SELDOM,
    reaction=EMERGENCY,
    reset=ACK,
)


SILENT_CAN_SCANS: Final = Parameter(
    "silent_can_scans", "1", "2.5", "nothing heard over CAN for this many scan periods ...", AT_LEAST_ONE,
    hardest="5", because="as stale_can_scans",
)  # fmt: skip
SILENT_CAN_HEARTBEATS: Final = Parameter(
    "silent_can_heartbeats", "1", "1.5", "... or, if that is less, for this many heartbeats of a drive [A]",
    AT_LEAST_ONE, hardest="3", because="after three each drive counts as lost by itself",
)  # fmt: skip


SILENT_SCANS: Final = 1.2
"""Scan periods since the last frame after which no drive has answered the last SYNC [A]: an answer takes a tenth."""


def _bus_silent(v: Any) -> bool:
    r, p = v.readings, v.parameters
    allowed_s = p[SILENT_CAN_HEARTBEATS] * v.limits.heartbeat_s
    # Enabled drives answer every scan's SYNC; without power they only send their heartbeats.
    if r.drives_enabled:
        scans_s = p[SILENT_CAN_SCANS] * v.scan_s + v.slower_before_s
        allowed_s = scans_s if scans_s < allowed_s else allowed_s
    # A late scan has not received frames in the meantime ("scan late" judges that), and drives have not yet answered
    # the scan after it.
    late_s = v.late_before_s + (v.late_s if v.late_s > 0.0 else 0.0)
    silent_s = r.now_s - late_s - r.can_heard_s
    if not (silent_s <= allowed_s):
        return True
    # A plug that is pulled between two drives' answers makes the data of the later drive old one scan before the whole
    # bus counts as silent. The alarm must name the cable: not one drive has answered the last SYNC. Where data are old
    # because this computer was late, it must not: the answers to its last SYNC have arrived meanwhile. After a
    # longer pause, or a jump of the clock, data are old in any case: "scan late" judges that.
    if not (silent_s > SILENT_SCANS * v.scan_s and r.can_heard_s <= v.last_s) or v.late_s > p[STALE_CAN_S]:
        return False
    return r.drives_enabled and v.demand.enabled and drive_data_old(v)


CAN_SILENT: Final[Row] = Interlock(
    name="CAN silent",
    cause="CAN cable, its terminators or the drives' supply: no drive sends",
    watch=condition("no frame for silent_can_scans periods (drives on), or silent_can_heartbeats", _bus_silent),
    parameters=(SILENT_CAN_SCANS, SILENT_CAN_HEARTBEATS),
    reset=ACK,
)


DRIVE_FAULT: Final[Row] = Interlock(
    name="drive fault",
    cause="drive in fault, lost, rebooted or with an emergency message",
    watch=condition(
        "state FAULT, heartbeat missing 3 x 50 ms, boot-up, or EMCY", lambda v: v.readings.drive_fault != ""
    ),
    when=SELDOM,
    reset="drive reset by the acknowledgement",
)


BUS_LOST: Final[Row] = Interlock(
    name="bus lost",
    cause="CAN adapter or serial line gone, bus-off",
    watch=condition("the wire's port is lost: it is never reopened", lambda v: v.readings.bus_fault != ""),
    when=SELDOM,
    reset="started anew",
)


SECOND_MASTER: Final[Row] = Interlock(
    name="second master",
    cause="another master on the CAN bus",
    watch=condition("a frame only a master sends", lambda v: v.readings.foreign_master != ""),
    when=SELDOM,
    reset="other master gone, started anew",
)


CLOCK_JUMP: Final[Row] = Interlock(
    name="clock jump",
    cause="the scan's clock went back",
    watch=at_least("now < last scan", lambda v: v.readings.now_s - v.last_s, 0.0, "s"),
    reset=ACK,
)

LATE_WARN_S: Final = Parameter("late_warn_s", "s", "50 ms", "a scan this late is a warning ...", because="a warning")
LATE_SCAN_S: Final = Parameter(
    "late_scan_s", "s", "150 ms", "... this late a trip",
    hardest="200 ms", because="the drives stop by themselves 200 ms after the PC's last heartbeat or setpoint",
)  # fmt: skip

SCAN_LATE: Final[Row] = Interlock(
    name="scan late",
    cause="the controlling process was late",
    watch=at_most("scan later than {}", lambda v: v.late_s, LATE_SCAN_S),
    parameters=(LATE_WARN_S, LATE_SCAN_S),
    reset=ACK,
)


GUARD_OPEN: Final[Row] = Interlock(
    name="guard open",
    cause="guard open with drives on",
    watch=condition("input 0x60FD bit 17 = 0, drives wanted", lambda v: not v.readings.guard_closed),
    applies=lambda v: v.demand.enabled,
    when=SELDOM,
    unseen=True,
    reset=ACK,
)


STALE_INPUTS_S: Final = Parameter(
    "stale_inputs_s", "s", "250 ms", "age of the inputs (safety chain, guard): one in a row may be lost [A]",
    hardest="500 ms",
    because="after five periods of its input word a drive no longer sends it",
)  # fmt: skip

INPUTS_STALE: Final[Row] = Interlock(
    name="inputs stale",
    cause="no fresh input word from the drive with the safety inputs",
    watch=at_most("age > {}", lambda v: v.readings.now_s - v.readings.inputs_at_s, STALE_INPUTS_S),
    reset=ACK,
)


STALE_CAN_SCANS: Final = Parameter(
    "stale_can_scans", "1", "2.5", "age of the drives' data in scan periods ...", AT_LEAST_ONE,
    hardest="5",
    because="at 100 Hz a quarter of the 200 ms after which a drive stops without setpoints",
)  # fmt: skip
STALE_CAN_S: Final = Parameter(
    "stale_can_s", "s", "150 ms", "... and never more than this",
    hardest="200 ms",
    because="a drive without setpoints stops by itself after 200 ms; its older data do not count",
)  # fmt: skip


def drive_data_old(v: Any) -> bool:
    """Return whether the data of a drive are too old."""
    since_s = v.readings.now_s - drive_data_allowed_s(v)
    for at_s in v.readings.drive_stamps_s():  # noqa: SIM110 - a generator costs twice as much in every scan
        if not (at_s >= since_s):
            return True
    return False


def drive_data_allowed_s(v: Any) -> float:
    """Return the greatest permitted age of the drives' data, s."""
    # Drives answer a scan's SYNC. The data seen in a scan answer the scan before, or, where that answer was lost, the
    # one before that. So the lateness of these two scans adds to the data's age ("scan late" limits it), and in the
    # first fast scan after slow ones, so does the longer period.
    p = v.parameters
    late_s = v.late_before_s + (v.late_s if v.late_s > 0.0 else 0.0)
    allowed = p[STALE_CAN_SCANS] * v.scan_s + v.slower_before_s + late_s
    most = p[STALE_CAN_S]
    return allowed if allowed < most else most


DEVICE_REFUSED: Final[Row] = Interlock(
    name="device refused",
    cause="a Modbus device refuses a request, or misses our commands",
    watch=condition("exception 01 to 03, or its lease ran out", lambda v: v.readings.device_fault != ""),
    when=SELDOM,
    reaction=CONTROLLED,
)

LINE_ERRORS: Final = Parameter(
    "line_errors", "1", "0.3", "share of failed requests to a Modbus device over 2 s or more ... [A]", SHARE,
    hardest="0.5",
    because="its devices are then read half as often as planned",
)  # fmt: skip
LINE_ERRORS_DELAY_S: Final = Parameter(
    "line_errors_delay_s", "s", "3 s", "... for this long [A]", NOT_NEGATIVE,
    hardest="10 s", because="the values' own ages are watched besides: this row only names the line",
)  # fmt: skip

LINE_NOISY: Final[Row] = Interlock(
    name="line noisy",
    cause="a Modbus device answers badly (CRC, time-outs, late replies)",
    watch=at_most("failed requests > {}", lambda v: v.readings.line_errors, LINE_ERRORS),
    delay=LINE_ERRORS_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)

SCAN_DELAYED: Final[Row] = Interlock(
    name="scan delayed",
    cause="the controlling process was late, but not dangerously",
    watch=at_most("scan later than {}", lambda v: v.late_s, LATE_WARN_S),
    reaction=WARN,
    reset="by itself",
)

ROWS: Final[tuple[Row, ...]] = (
    SAFETY_CHAIN, BUS_LOST, CAN_SILENT, DRIVE_FAULT, SECOND_MASTER, CLOCK_JUMP, SCAN_LATE, GUARD_OPEN,
)  # fmt: skip
WARNINGS: Final[tuple[Row, ...]] = (SCAN_DELAYED,)
"""Rows that only warn: the last of the table."""


def answered_s(silent: bool, now_s: float, at_s: float) -> float:
    """Return the time since a device last answered, s; NaN after several unanswered requests in a row."""
    return nan if silent else now_s - at_s
