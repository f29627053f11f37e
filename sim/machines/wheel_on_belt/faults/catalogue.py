"""The catalogue of faults: one row each. Language and campaign know only faults with a row.

Budgets are those of docs/kinds/wheel-on-belt.md, up to the safe commands, from the onset (or from the time when the
fault can be noticed), with one scan of 50 ms at the slow rate added; [A] if that page gives none. A row that MAY trip
has no budget, and the reason why no trip is required.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from enum import Enum
from functools import partial

from drivers.canopen import objects as o
from drivers.canopen.objects import NmtCommand
from sim.faults import cabinet as p
from sim.faults import can as c
from sim.faults import common
from sim.faults import drives as d
from sim.faults import modbus as m
from sim.faults.common import ALWAYS, CONNECTING, DRIVES, ENABLED, MAY, RIDE, SCAN_S, TRIP, device_rows, rows_of
from sim.faults.kinds import FaultKind
from sim.faults.language import FaultLanguage
from sim.faults.scene import Effect
from sim.faults.sensors import CROSSED, SensorFault, controller_output
from sim.machines.wheel_on_belt.faults import heat as h
from sim.machines.wheel_on_belt.faults import mechanics as k
from sim.machines.wheel_on_belt.mechanics import FORCES


class WheelExposure(Enum):
    """Further times from which a fault of this machine can be noticed."""

    RUNNING = "at once, where it begins in a run and no wheel was just changed"
    TURNING = "while the wheel turns"
    LOADED = "in contact"
    PRESSING = "while a load is held"
    SLIDING = "in contact, with slip"
    RUBBING = "while a load is held, with slip"
    ASTRAY = "while a drive shows another speed than its command"
    HEATING = "while the jacket heats"
    MISWEIGHED = "while the press is further than the load shown can need"
    MISREAD = "while the thermometer is off by more than the model allows, turning"
    STARVED = "while full heat is asked for and the hub stays cold"
    UNASKED = "while heat flows that the controller does not give"
    HIDDEN = "while full heat is given and the hub is far hotter than shown"
    OVERHEATED = "while the hub is hotter than it was ever told to be"
    HOT = "while the hub is far hotter than any recipe needs"
    WELDED = "while the contactor is closed without request"


VELOCITY_AXES = ("wheel", "belt", "press")
"""Drives without torque at once after an emergency stop (stop category 0 [A])."""
AXES = (*VELOCITY_AXES, "sideslip", "camber")
STEPS = ("connect", "install", "pre-grind", "rest", "heat", "soak", "tare", "roll", "measure", "lift", "cool", "prompt")
"""Names of steps that a fault can wait for."""
OVERHEATING, FOLLOWING_ERROR, CAN_OVERRUN = 0x4310, 0x8611, 0x8110
CELL, SURFACE, HUB = (partial(SensorFault, device) for device in ("load cell", "thermometer", "jacket"))
OUTPUT = partial(controller_output, "jacket")

POLL_S = 0.2 + SCAN_S
"""Time to judge a temperature, s: it is polled at 5 Hz and judged by the next scan."""
HUB_S = 0.2 + 0.125 + 2.0 * SCAN_S
"""Time to judge the hub's temperature, s: its controller samples it every 125 ms."""
FOLLOW_S = 0.1 + 1.1 + SCAN_S
"""Time to judge a speed, s: it may lag behind a ramp of 0.3 of the rig's (0.6 m/s2), by 0.54 m/s, and 50 mm/s more."""
SHOWS_S = 40.0
"""Time without a hub reading before its heat is missed, s: the range of delays is 40 s."""

(
    RUNNING, TURNING, LOADED, PRESSING, SLIDING, RUBBING, ASTRAY, HEATING, MISWEIGHED, MISREAD, STARVED, UNASKED,
    HIDDEN, OVERHEATED, HOT, WELDED,
) = WheelExposure  # fmt: skip

_NMT_STOP_ALL = bytes((NmtCommand.STOP, 0))
_ENABLE_AND_GO = b"\x0f\x00" + (50_000).to_bytes(4, "little", signed=True)
"""A stranger's RPDO: enable operation, 0.5 m/s for the packaged rig's belt."""


_DRIVE = (
    *common.DRIVE,
    *common.AT_CONNECTION,
    FaultKind("drive mode refused", d.ModeRefused, CONNECTING, TRIP, 5.0),
    FaultKind("drive SDO toggle error", partial(d.sdo_spoiled, kind="toggle"), CONNECTING, TRIP, 10.0,
              note="in segmented uploads, which a device may choose for any object"),
    FaultKind("drive SDO of another object", partial(d.sdo_spoiled, kind="other object"), CONNECTING, TRIP, 10.0,
              note="a reply that is not believed counts as none: tried again"),
    FaultKind("drive SDO silent", partial(c.frames_lost, base=o.SDO_REPLY_BASE), CONNECTING, TRIP, 10.0,
              note="every request is tried again before a drive is given up"),
)  # fmt: skip
_VELOCITY_DRIVE = (
    FaultKind("drive following error", partial(d.drive_fault, code=FOLLOWING_ERROR), DRIVES, TRIP, 0.02 + SCAN_S),
    FaultKind("drive reports overheating", partial(d.reported, code=OVERHEATING), RUNNING, TRIP, 0.02 + SCAN_S),
    FaultKind("drive setpoints lost", partial(c.frames_lost, base=o.RPDO1_BASE), ENABLED, TRIP, 0.2 + SCAN_S,
              note="the drive's own deadline (0x1400:05), or sooner a speed or load error"),
)  # fmt: skip


def _drive_rows() -> Iterator[FaultKind]:
    for axis in AXES:
        yield from rows_of(axis, (*_DRIVE, *common.FROZEN))
    for axis in VELOCITY_AXES:
        yield from rows_of(axis, _VELOCITY_DRIVE)
        yield _frozen_feedback(axis)
        yield from rows_of(axis, common.LEFT_OPERATION)
    yield FaultKind("press drive inputs lost", partial(c.frames_lost, "press", o.TPDO2_BASE), DRIVES, TRIP,
                    0.25 + 2.0 * SCAN_S, note="safety chain, guard and contactor are not known any more; idle at 10 Hz")
    yield from rows_of("press", (common.FROZEN_INPUTS,))
    yield FaultKind("press drive outputs lost shortly", partial(c.frames_lost, "press", o.RPDO2_BASE), ALWAYS, RIDE,
                    lasts_s=0.3, note="the request for the contactor is repeated until its feedback answers")


def _frozen_feedback(axis: str) -> FaultKind:
    """Return the row of a drive that repeats its last speed, or its last position."""
    name, make = f"{axis} drive feedback frozen", partial(c.data_frozen, axis)
    if axis == "press":
        return FaultKind(name, make, ENABLED, MAY,
                         note="its position tells only where to slow down: the force ends pressing and lifting")
    return FaultKind(name, make, ASTRAY, TRIP, FOLLOW_S, axis=axis,
                     note="seen when another speed is commanded: a slow ramp (0.3 of the rig's) is waited for")


def _bus_rows() -> Iterator[FaultKind]:
    yield from common.BUS
    yield FaultKind("CAN frames lost", c.frame_loss, ENABLED, TRIP, 10.0, "%", 20.0,
                    note="by chance: three frames of a drive in a row at 20 Hz")
    yield FaultKind("CAN frames late", c.frames_late, ENABLED, MAY, 0.0, "ms", 0.1,
                    note="all are late alike and count as fresh: a drive does not say when it measured")
    yield FaultKind("CAN frames repeated", c.frames_repeated, ALWAYS, RIDE)
    yield FaultKind("CAN bus busy", c.BusBusy, ALWAYS, MAY, 0.0, "%", 95.0,
                    note="the higher-ranking frames of the drives still get through at the slower scans")
    yield FaultKind("second master SYNC", partial(c.SecondMaster, o.SYNC_ID, b""), DRIVES, TRIP, 0.1 + SCAN_S)
    yield FaultKind("second master setpoint", partial(c.SecondMaster, o.RPDO1_BASE, _ENABLE_AND_GO, "belt"), DRIVES,
                    TRIP, 0.1 + SCAN_S)
    yield FaultKind("second master stops nodes", partial(c.SecondMaster, o.NMT_ID, _NMT_STOP_ALL), DRIVES, TRIP,
                    0.2 + SCAN_S)
    yield FaultKind("belt drive short emergency", partial(d.short_emergency, "belt", OVERHEATING, 3), ALWAYS, TRIP,
                    0.02 + SCAN_S, lasts_s=0.3, note="what is missing of it counts as an unknown error")
    yield FaultKind("belt drive emergency storm", partial(c.EmergencyStorm, "belt", CAN_OVERRUN), ALWAYS, TRIP,
                    0.02 + SCAN_S)


_WATCHED = {
    "load cell": (LOADED, 0.1 + SCAN_S),
    "thermometer": (HEATING, 1.2 + SCAN_S),
    "jacket": (ALWAYS, 1.2 + SCAN_S),
}
"""For each device: when its readings are needed, and the age at which they are stale plus the row's delay, s."""


def _modbus_rows() -> Iterator[FaultKind]:
    for device, (needed, stale_s) in _WATCHED.items():
        yield from device_rows(device, needed, stale_s, ())
    for force in FORCES:
        yield from device_rows(f"load cell {force}", *_WATCHED["load cell"], ("silent", "without supply", "CRC errors"),
                               "of the transmitter that measures it, which may measure all")
    yield FaultKind("load cell words swapped", partial(m.Impaired, "load cell", "swapped"), LOADED, TRIP, 0.1 + SCAN_S,
                    note="the order of the words of its 32-bit values was changed at the device")
    yield FaultKind("load cell half updated", partial(m.Impaired, "load cell", "torn"), LOADED, MAY,
                    note="a value of 32 bits is read while the device writes it: off by 3277 N where its sign changes")
    yield FaultKind("slip ring worn", h.WornSector, ALWAYS, MAY, 0.0, "", 90.0,
                    note="requests fail within 20 degrees of this angle of the wheel: one in nine, asked for again")
    yield FaultKind("jacket memory worn out", partial(m.memory_worn, "jacket"), ALWAYS, MAY,
                    note="what it keeps without supply, standby among it, cannot be changed any more (exception 04):"
                    " seen when that is written, at the end")


def _sensor_rows() -> Iterator[FaultKind]:
    yield FaultKind("load cell frozen", partial(CELL, "frozen"), PRESSING, TRIP, 0.5 + 0.1)
    yield FaultKind("load cell open", partial(CELL, "open"), LOADED, TRIP, 0.1 + SCAN_S)
    yield FaultKind("load cell saturated", partial(CELL, "saturated"), LOADED, TRIP, 0.1 + SCAN_S)
    yield FaultKind("load cell offset", partial(CELL, "offset"), PRESSING, MAY, 0.0, "N", 30.0,
                    note="seen at the next check of the zero; the force stays inside its limit")
    yield FaultKind("load cell jumps", partial(CELL, "offset"), PRESSING, TRIP, 0.05 + 2.0 * SCAN_S, "N", 150.0,
                    lasts_s=0.3,
                    note="a bolt gives way, an amplifier changes its range: the load reads above its target")
    yield FaultKind("load cell reads low", partial(CELL, "low"), MISWEIGHED, TRIP, 0.05 + 2.0 * SCAN_S, "%",
                    50.0, note="the press moves beyond the depth for the load shown")
    yield FaultKind("load cell drift", partial(CELL, "drift"), PRESSING, MAY, 0.0, "N/s", 2.0,
                    note="seen at the next check of the zero, before each repeat")
    yield FaultKind("load cell noisy", partial(CELL, "noise"), PRESSING, MAY, 0.0, "N", 40.0,
                    note="no reading stays beyond a limit for its delay; the load itself hardly moves")
    yield FaultKind("thermometer frozen", partial(SURFACE, "frozen"), TURNING, TRIP, 62.0 + POLL_S, slow=True)
    yield FaultKind("thermometer open", partial(SURFACE, "open"), HEATING, TRIP, 1.2 + SCAN_S)
    yield FaultKind("thermometer jumps", partial(SURFACE, "offset"), HEATING, TRIP, POLL_S, "K", -10.0,
                    lasts_s=0.6, note="moved, covered or disturbed")
    yield FaultKind("thermometer offset", partial(SURFACE, "offset"), MISREAD, TRIP, 30.0 + POLL_S, "K", -15.0,
                    slow=True, note="seen as a jump where a temperature is wanted")
    yield FaultKind("thermometer reads low", partial(SURFACE, "low"), MISREAD, TRIP, 30.0 + POLL_S, "%", 60.0,
                    slow=True, note="misaligned or dirty")
    yield FaultKind("thermometer drift", partial(SURFACE, "drift"), MISREAD, TRIP, 30.0 + POLL_S, "K/s", -0.2,
                    slow=True)
    yield FaultKind("thermometer noisy", partial(SURFACE, "noise"), HEATING, TRIP, 3.0, "K", 5.0,
                    note="by chance: two readings in a row 5 K apart")
    yield FaultKind("hub sensor open", partial(HUB, "open"), ALWAYS, TRIP, 1.2 + SCAN_S)
    yield FaultKind("hub sensor frozen", partial(HUB, "frozen"), STARVED, TRIP, 61.0 + POLL_S, slow=True,
                    note="seen where the controller asks for heat; at its setpoint it only stops controlling")
    yield FaultKind("hub sensor jumps", partial(HUB, "offset"), RUNNING, TRIP, HUB_S, "K", -10.0, lasts_s=0.6,
                    note="slip ring chatter, once")
    yield FaultKind("hub sensor offset", partial(HUB, "offset"), RUNNING, TRIP, HUB_S, "K", -20.0)
    yield FaultKind("hub sensor reads low", partial(HUB, "low"), HOT, TRIP, 10.0, "%", 80.0, slow=True,
                    note="shorted towards ambient: the controller heats what it does not see; by the surface, in time")
    yield FaultKind("hub sensor noisy", partial(HUB, "noise"), ALWAYS, TRIP, 3.0, "K", 8.0,
                    note="slip ring chatter")


def _actuator_rows() -> Iterator[FaultKind]:
    yield FaultKind("jacket output stuck on", partial(OUTPUT, 100.0), OVERHEATED, TRIP, 2.0 + 1.0 + POLL_S,
                    slow=True, note="its sensor follows within a second")
    yield FaultKind("jacket output stuck off", partial(OUTPUT, 0.0), HEATING, MAY,
                    note="the wheel gets colder than wanted: the recipe's waits notice, nothing is harmed")
    yield FaultKind("jacket relay shorted", partial(h.heater_element, 100.0), UNASKED, TRIP, 16.0, slow=True,
                    note="the rate is known 3 s after the output has gone, over 4 to 8 s; 5 and 2 s of the row")
    yield FaultKind("jacket relay sticks", h.RelaySticks, ALWAYS, MAY, 0.0, "ms", 3.0, slow=True,
                    note="of every eight seconds; the controller gives so much less while it can")
    yield FaultKind("heater line open", partial(h.heater_element, 0.0), STARVED, TRIP, 61.0 + POLL_S, slow=True)
    yield FaultKind("jacket limiter dead", h.limiter_dead, ALWAYS, MAY,
                    note="a second line: nothing shows that it is gone before it is needed")
    yield FaultKind("contactor welded", p.contactor_welded, WELDED, TRIP, 0.5 + 2.0 * SCAN_S,
                    note="seen when it is to open")
    yield FaultKind("contactor dead", p.contactor_dead, STARVED, TRIP, 61.0 + POLL_S, slow=True)
    yield FaultKind("press runs away", partial(d.Runaway, "press"), LOADED, TRIP, 0.5, "mm/s", 5.0)
    yield FaultKind("wheel runs away", partial(d.Runaway, "wheel"), ASTRAY, TRIP, FOLLOW_S, "rad/s", 12.0,
                    axis="wheel", note="0.54 m/s; seen where that is not its command")
    yield FaultKind("belt runs away", partial(d.Runaway, "belt"), ASTRAY, TRIP, FOLLOW_S, "m/s", 0.4,
                    axis="belt", note="seen where that is not its command")
    yield FaultKind("press stuck", partial(d.Jammed, "press"), PRESSING, MAY, force_stays=True,
                    note="it holds the load it held: seen when it is to lift, and freed by hand; the rig is at rest")
    yield FaultKind("belt jammed", partial(d.Jammed, "belt"), LOADED, TRIP, 0.1 + SCAN_S)
    yield FaultKind("wheel jammed", partial(d.Jammed, "wheel"), LOADED, TRIP, 0.1 + SCAN_S)
    yield FaultKind("belt torn", k.BeltTorn, RUBBING, TRIP, 0.1 + 2.0 * SCAN_S,
                    note="friction and the wheel's torque are gone")
    yield FaultKind("belt slips on its roller", k.BeltSlips, LOADED, TRIP, 0.05 + 2.0 * SCAN_S, "%", 40.0,
                    note="there is no encoder on the belt itself: by the drive's torque, beyond elastic creep (2 %)")
    yield FaultKind("wheel slips on its shaft", k.WheelSlipsOnShaft, SLIDING, MAY,
                    note="the shaft's encoder turns on, and friction does not vanish: held by the clamping")
    yield FaultKind("emergency stop pressed", partial(p.emergency_stop, VELOCITY_AXES), DRIVES, TRIP, SCAN_S)


def _computer_rows() -> Iterator[FaultKind]:
    stalled, killed, hold, *asked = common.COMPUTER
    yield FaultKind("scan stalled shortly", partial(p.stalled, 0.03), ALWAYS, RIDE)
    yield stalled
    yield FaultKind("scan stalled while sliding", partial(p.stalled, 0.165), SLIDING, TRIP, 0.2 + SCAN_S, lasts_s=0.3,
                    note="later than a scan may be, sooner than most drives stop by themselves")
    yield killed
    yield FaultKind("clock jump", p.clock_jump, ENABLED, TRIP, SCAN_S, "ms", 2.0, lasts_s=0.5)
    yield replace(hold, exposure=ALWAYS)
    yield from asked


_UNASKED = "python -m tests.campaigns.faults --magnitudes prints how much of it goes unnoticed, and its effect"


def _may(phrase: str, make: Callable[..., Effect], unit: str | None = None, value: float = 0.0,
         *, slow: bool = False) -> FaultKind:  # fmt: skip
    return FaultKind(phrase, make, ALWAYS, MAY, 0.0, unit, value, slow=slow, note=_UNASKED)


def _hides(phrase: str, make: Callable[..., Effect], unit: str, value: float) -> FaultKind:
    """Return the row of a fault that makes the controller overheat unseen; a small one stays unnoticed."""
    return FaultKind(phrase, make, HIDDEN, TRIP, SHOWS_S, unit, value, slow=True, note=_UNASKED)


def _misread_rows() -> Iterator[FaultKind]:
    """Yield sensors with a wrong reading: by a share, late, from another channel or with the wrong sign."""
    yield _may("load cell gain", partial(CELL, "gain"), "%", 70.0)
    for channels in CROSSED:
        what, _, which = channels.partition(" ")
        named = " and ".join(f"F{one}" for one in which.split())
        yield _may(f"load cell {named} {what}", partial(CELL, channels))
    yield _hides("hub sensor gain", partial(HUB, "gain"), "%", 60.0)
    yield _hides("hub sensor partly detached", h.hub_detached, "%", 60.0)
    yield _may("hub sensor drift", partial(HUB, "drift"), "K/s", -0.02, slow=True)
    yield _may("thermometer gain", partial(SURFACE, "gain"), "%", 80.0, slow=True)
    for name, lag_s in (("load cell", 1.0), ("thermometer", 1.5)):
        slow = name != "load cell"
        yield _may(f"{name} lag", partial(SensorFault, name, "lag"), "ms", lag_s, slow=slow)
        yield _may(f"{name} delay", partial(SensorFault, name, "delay"), "ms", 0.5 * lag_s, slow=slow)
    yield _hides("hub sensor lag", partial(HUB, "lag"), "ms", 20.0)
    yield _hides("hub sensor delay", partial(HUB, "delay"), "ms", 20.0)


def _machine_rows() -> Iterator[FaultKind]:
    """Yield faults of the machine's assembly, and of the rubber on its hub."""
    for axis in ("wheel", "belt"):
        yield _may(f"{axis} drive reversed", partial(k.reversed_shaft, axis), slow=True)
        yield _may(f"{axis} speed scale", partial(k.speed_scale, axis), "%", 110.0, slow=True)
        yield _may(f"{axis} speed doubled", partial(k.speed_scale, axis, 200.0), slow=True)
    yield _may("wheel and belt drives swapped", k.drives_swapped, slow=True)
    yield _may("wheel diameter", k.DiameterOff, "%", 110.0, slow=True)
    yield _may("rubber detached", k.rubber_detached, "mm", 0.3)
    yield _may("rubber relaxation", k.rubber_relaxes, "%", 10.0)
    yield _may("friction", k.belt_rubs_otherwise, "%", 115.0)


def _rows() -> Iterator[FaultKind]:
    yield from _drive_rows()
    yield from _bus_rows()
    yield from _modbus_rows()
    yield from _sensor_rows()
    yield from _actuator_rows()
    yield from _computer_rows()
    yield from _misread_rows()
    yield from _machine_rows()


CATALOGUE: dict[str, FaultKind] = {row.phrase: row for row in _rows()}
"""Every fault by its phrase."""
LANGUAGE = FaultLanguage(CATALOGUE, STEPS)
