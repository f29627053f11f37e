"""The interlocks: one table, one row a cause. Every row is a level, evaluated in every scan; unknown is tripped.

A row says what is watched and what follows; its level is computed in ``levels`` (one comparison a row, no row hides
another, written so that NaN and missing data fall on the tripped side) and its bit is its place in this table. A
level that has stood for its delay trips; the first to trip is kept as the cause, the others are journalled. The page
docs/safety.md shows this table.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from tester.control.state import Reaction
from tester.rig import InterlocksConfig, RigConfig


@dataclass(frozen=True, slots=True)
class Interlock:
    """One row: what it is called, its cause, the level, how long that must stand, what follows, how it is reset."""

    name: str
    cause: str
    level: str
    delay: Callable[[InterlocksConfig], float]
    reaction: Reaction
    reset: str

    def delay_s(self, rig: RigConfig) -> float:
        """Return how long the level must stand on a rig, s."""
        return self.delay(rig.interlocks)


WARN: Final = Reaction.WARN
CONTROLLED: Final = Reaction.CONTROLLED
FAST: Final = Reaction.FAST
REFUSE: Final = Reaction.REFUSE
POWER_OFF: Final = Reaction.POWER_OFF
EMERGENCY: Final = Reaction.EMERGENCY

ACK: Final = "cause gone, acknowledged"
REPAIR: Final = "repaired, acknowledged"
DRIVE: Final = "drive reset by the acknowledgement"
ALONE: Final = "other master gone, started anew"
SELF: Final = "by itself"


def _now(_: InterlocksConfig) -> float:
    return 0.0


INTERLOCKS: Final[tuple[Interlock, ...]] = (
    # What takes effect at once
    Interlock("safety chain", "emergency stop circuit open (drive input)", "input 0x60FD bit 16 = 0",
              _now, EMERGENCY, ACK),
    Interlock("drive fault", "drive in fault, lost, rebooted or with an emergency message",
              "state FAULT, heartbeat missing 3 x 50 ms, boot-up, or EMCY", _now, FAST, DRIVE),
    Interlock("bus lost", "CAN adapter or serial line gone, bus-off", "the wire's port is lost: it is never reopened",
              _now, FAST, "started anew"),
    Interlock("second master", "another master on the CAN bus", "a frame only a master sends", _now, FAST, ALONE),
    Interlock("clock jump", "the scan's clock went back", "now < last scan", _now, FAST, ACK),
    Interlock("scan late", "the controlling process was late", "scan later than late_scan", _now, FAST, ACK),
    Interlock("guard open", "guard open with drives on", "input 0x60FD bit 17 = 0, drives wanted", _now, FAST, ACK),
    # Motion
    Interlock("drive data stale", "no fresh drive data", "age > stale_can_scans periods, or > stale_can",
              _now, FAST, ACK),
    Interlock("inputs stale", "no fresh input word from the drive with the safety inputs", "age > stale_inputs",
              _now, FAST, ACK),
    Interlock("drive dropped out", "a drive left operation by itself (local control, torque off)",
              "not OPERATION_ENABLED although wanted", lambda c: c.dropped_delay_s, FAST, ACK),
    Interlock("overspeed", "wheel or belt above its limit", "speed > limit + overspeed_share",
              lambda c: c.overspeed_delay_s, FAST, ACK),
    Interlock("wheel speed", "wheel not at its speed: jammed, slipping coupling, wrong scale",
              "off what its ramp allows by > speed_error", lambda c: c.speed_error_delay_s, FAST, ACK),
    Interlock("belt speed", "belt not at its speed: jammed, wrong scale",
              "off what its ramp allows by > speed_error", lambda c: c.speed_error_delay_s, FAST, ACK),
    Interlock("press speed", "press comes on its own: broken velocity loop, setpoints lost",
              "further towards the contact than its ramp allows by > press_error", _now, FAST, REPAIR),
    Interlock("press travel", "press outside its travel: ran past its end, or its zero is wrong",
              "position outside axes.press.software_limits", _now, FAST, ACK),
    Interlock("drive standing under load", "wheel on a stopped belt, or belt under a stopped wheel",
              "load > 20 N, one stands, the other above 0.1 m/s", lambda c: c.standing_delay_s, FAST, ACK),
    Interlock("belt torn", "friction and drive torque collapsed while sliding under load",
              "both < torn_share of the load at slip > torn_slip", lambda c: c.torn_delay_s, FAST, REPAIR),
    # Load
    Interlock("load cell stale", "load unknown while in contact", "age > stale_cell",
              lambda c: c.stale_cell_delay_s, FAST, ACK),
    Interlock("load cell saturated", "a channel at 98 % of its range, or the transmitter reports an error",
              "reading not valid", lambda c: c.stale_cell_delay_s, FAST, ACK),
    Interlock("load cell frozen", "the cell repeats itself",
              "identical raw counts for frozen_cell, loaded and turning; or no force 1.5 mm beyond the contact",
              _now, FAST, REPAIR),
    Interlock("overload", "normal force above the rig's limit", "Fz > limits.load", _now, FAST, ACK),
    Interlock("load overshoot", "normal force above its target",
              "Fz > overload_factor x target + overload_margin; or 50 N more while none is wanted",
              lambda c: c.overload_delay_s, FAST, ACK),
    Interlock("contact too deep", "the cell reads too little: the press is further than its load needs",
              "depth > depth_factor x that of Fz (loops.load.stiffness) + depth_margin",
              lambda c: c.depth_delay_s, FAST, REPAIR),
    Interlock("contact lost", "normal force far below target", "Fz < contact_share of a target of 50 N or more",
              lambda c: c.contact_delay_s, FAST, ACK),
    Interlock("slip power", "friction power above the rig's limit", "friction x slip > limits.slip_power",
              lambda c: c.slip_power_delay_s, FAST, ACK),
    # Heat
    Interlock("surface hot", "rubber surface above its limit", "surface > limits.surface",
              lambda c: c.surface_delay_s, CONTROLLED, ACK),
    Interlock("jacket hot", "hub above its limit", "hub > limits.jacket + jacket_margin",
              lambda c: c.jacket_delay_s, CONTROLLED, ACK),
    Interlock("jacket runaway", "hub above every setpoint of the last ten minutes",
              "hub > highest setpoint + runaway; without output: > the coolest since, or the rubber, + runaway",
              lambda c: c.runaway_delay_s, CONTROLLED, ACK),
    Interlock("heater stuck", "the hub heats although no output is given",
              "rate > stuck_rate, no output for stuck_off", lambda c: c.stuck_delay_s, CONTROLLED, REPAIR),
    Interlock("heater line open", "full output and the hub does not warm: slip ring or heater open",
              "output > open_output for open, rise < open_rise", _now, CONTROLLED, REPAIR),
    Interlock("heating at standstill", "jacket heating with the wheel not turning", "output > 0, wheel stands",
              lambda c: c.standstill_heat_delay_s, CONTROLLED, ACK),
    Interlock("hub sensor jump", "hub sensor's line noisy (slip ring)", "two readings apart by > jump",
              _now, CONTROLLED, ACK),
    Interlock("surface sensor jump", "thermometer moved, covered or disturbed", "two readings apart by > jump",
              _now, CONTROLLED, ACK),
    Interlock("thermometer frozen", "the thermometer repeats itself",
              "unchanged for frozen_surface, or while the model moved by frozen_model, turning",
              lambda c: c.frozen_delay_s, CONTROLLED, REPAIR),
    Interlock("surface off model", "thermometer misaligned, dirty or wrong emissivity",
              "surface off the thermal observer by > model, turning", lambda c: c.model_delay_s, CONTROLLED, REPAIR),
    Interlock("surface data stale", "no fresh surface temperature", "age > stale_ir, or not valid, and wanted",
              lambda c: c.stale_delay_s, CONTROLLED, ACK),
    Interlock("jacket data stale", "no fresh hub temperature, sensor broken", "age > stale_jacket, or not valid",
              lambda c: c.stale_delay_s, CONTROLLED, ACK),
    # Devices and process
    Interlock("device refused", "a Modbus device refuses a request, or misses our commands",
              "exception 01 to 03, or its lease ran out", _now, CONTROLLED, REPAIR),
    Interlock("line noisy", "a Modbus device answers badly (CRC, time-outs, late replies)",
              "failed requests > line_errors", lambda c: c.line_errors_delay_s, CONTROLLED, ACK),
    Interlock("wheel worn", "wheel diameter below its least", "diameter < least_diameter", _now, CONTROLLED,
              "new wheel, acknowledged"),
    # Stops that do not work
    Interlock("not lifted", "still loaded after a stop or in a hold", "Fz >= 20 N at lift_late after it began",
              _now, FAST, REPAIR),
    Interlock("lift failed", "still loaded after the quick stop, or the press goes on",
              "Fz >= 20 N at lift_failed after it began; or the press 0.3 mm beyond its ramp",
              _now, POWER_OFF, REPAIR),
    Interlock("not stopping", "a drive turns longer than its ramp allows", "turning at v / deceleration + stop_margin",
              _now, FAST, REPAIR),
    Interlock("quick stop failed", "a drive turns longer than its quick stop allows",
              "turning at v / quick-stop deceleration + stop_margin", _now, POWER_OFF, REPAIR),
    Interlock("heat not off", "the jacket heats after a stop", "output and contactor on at heat_off after the stop",
              _now, FAST, REPAIR),
    Interlock("output not off", "the jacket's controller gives output after a stop, whatever the contactor does",
              "output on at heat_off after the stop, or at rest", _now, CONTROLLED, REPAIR),
    Interlock("stop not ended", "a stop has not come to its end: standing, lifted, unloaded, without heat",
              "10 s after it began, and once more after the power was taken", _now, POWER_OFF, REPAIR),
    Interlock("contactor welded", "the contactor is closed without request", "feedback closed, request off",
              lambda c: c.contactor_delay_s, CONTROLLED, REPAIR),
    # At rest: in idle, armed and latched, and in a run that has its drives off
    Interlock("moving at rest", "a drive turns, has power or comes although everything is to rest",
              "a speed >= 0.02 m/s or unknown, or the press 0.3 mm further; in a run: power that is not wanted",
              lambda c: c.dropped_delay_s, POWER_OFF, REPAIR),
    Interlock("loaded at rest", "the wheel is pressed although everything is to rest",
              "Fz >= 20 N, or unknown and the press not clear of the contact", _now, REFUSE, "cause gone"),
    # Only said
    Interlock("scan delayed", "the controlling process was late, but not dangerously", "scan later than late_warn",
              _now, WARN, SELF),
)  # fmt: skip

_PLACES: Final = {row.name: i for i, row in enumerate(INTERLOCKS)}


def bit(name: str) -> int:
    """Return the bit of a row; raises KeyError for a name that is not in the table."""
    return 1 << _PLACES[name]


AT_REST: Final = bit("moving at rest") | bit("contactor welded") | bit("heating at standstill")
"""Rows that trip in idle, too: there is nothing to stop by then, but something to take the power off."""
WARNINGS: Final = sum(bit(row.name) for row in INTERLOCKS if row.reaction is WARN)
"""Rows that stop nothing: they do not stand in the way of arming or acknowledging."""
