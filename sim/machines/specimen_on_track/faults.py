"""Faults of a specimen on a track: the catalogue, its effects, and the language of its scripts.

Budgets count up to the safe commands, from the onset or from the time when the fault can be noticed, with one scan of
50 ms at the slow rate added; all are [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import partial
from typing import Final

from sim.faults import cabinet, can, common, drives, modbus
from sim.faults.common import ALWAYS, DRIVES, ENABLED, MAY, RIDE, SCAN_S, TRIP, device_rows, rows_of
from sim.faults.kinds import FaultKind
from sim.faults.language import FaultLanguage
from sim.faults.scene import Scene, switched
from sim.faults.sensors import QuantityFault, SensorFault, controller_output
from sim.machines.specimen_on_track.plant import IN_HOLDER
from sim.machines.specimen_on_track.rig import TrackRig
from sim.nodes.motion import VelocityAxis

STEPS: Final = ("connect", "install", "temper", "settle", "tare", "lower", "slide", "lift", "prompt")
"""Names of steps that a fault can wait for."""
AXES: Final = ("track", "lift")


class TrackExposure(Enum):
    """Further times from which a fault of this machine can be noticed."""

    MOVING = "while the track moves"
    SLIDING = "in contact, while the track moves"
    SLID = "in contact, once the arm's spring is drawn"
    LIFTING = "while the arm has a command to move"
    TEMPERED = "while the chamber has a command to run"
    ASTRAY = "while the track runs at another speed than its command"
    NEAR_THE_END = "where the track comes to the end of its travel"


MOVING, SLIDING, SLID, LIFTING, TEMPERED, ASTRAY, NEAR_THE_END = TrackExposure


class TrackOverspeeds(drives.Runaway):
    """The track moves by itself whenever its power stage is on, whatever the command."""

    __slots__ = ()

    def __init__(self, mm_s: float) -> None:
        """Take the speed, mm/s."""
        super().__init__("track", mm_s)

    def renew(self, scene: Scene, now: float) -> None:
        """Override the command, in the track's own unit."""
        rig = scene.machine(TrackRig)
        axis = rig.axes["track"].axis
        if rig.axes["track"].energised and isinstance(axis, VelocityAxis):
            axis.aim(1e-3 * self.speed / rig.metres)


@switched
def track_rubs_otherwise(scene: Scene, on: bool, now: float, percent: float) -> None:
    """The track has ``percent`` of its original friction: another place on it, dust."""
    scene.machine(TrackRig).plant.grip = max(0.01 * percent, 0.0) if on else 1.0


@switched
def cell_deaf(scene: Scene, on: bool, now: float) -> None:
    """The arm's force passes the cell by: it shows its zero and its noise."""
    scene.machine(TrackRig).plant.deaf = on


@switched
def specimen_lost(scene: Scene, on: bool, now: float, holder_mu: float) -> None:
    """The specimen leaves its holder, which then grinds on the track with this coefficient."""
    scene.machine(TrackRig).plant.lose(max(holder_mu, 0.0) if on else IN_HOLDER)


@switched
def end_switch_dead(scene: Scene, on: bool, now: float) -> None:
    """The end switches no longer open the safety chain."""
    scene.machine(TrackRig).switches_work = not on


_DEVICES: Final = {"load cell": (SLIDING, 0.2 + SCAN_S), "chamber": (TEMPERED, 3.0 + SCAN_S)}
"""For each device: when its readings are needed, and the age at which they are stale plus the row's delay, s."""
HEIGHT: Final = "height sensor"
_CELL: Final = partial(SensorFault, "load cell", force="fx")


def _drive_rows() -> Iterator[FaultKind]:
    for axis in AXES:
        yield from rows_of(axis, (*common.DRIVE, *common.LEFT_OPERATION, *common.AT_CONNECTION, *common.FROZEN))
        yield FaultKind(f"{axis} drive feedback frozen", partial(can.data_frozen, axis), ENABLED, MAY,
                        note="seen once another speed or place is commanded; the track's travel ends at its switches")
    yield from rows_of("track", (common.FROZEN_INPUTS,))
    yield FaultKind("track stalls", partial(drives.Jammed, "track"), MOVING, TRIP, 1.2 + SCAN_S)
    yield FaultKind("track overspeeds", TrackOverspeeds, ASTRAY, TRIP, 1.2 + SCAN_S, "mm/s", 10.0)
    yield FaultKind("lift stuck", partial(drives.Jammed, "lift"), LIFTING, TRIP, 5.0,
                    note="a move that does not arrive within its time")
    yield FaultKind("end switch dead", end_switch_dead, NEAR_THE_END, MAY,
                    note="a second line: the track turns back before it")


def _device_rows() -> Iterator[FaultKind]:
    for device, (needed, stale_s) in _DEVICES.items():
        yield from device_rows(device, needed, stale_s, (*common.SILENCES, "reset", "replies late"))
    yield FaultKind("chamber runs away", partial(controller_output, "chamber"), TEMPERED, TRIP, 600.0, "%", 100.0,
                    slow=True, note="seen by its reading, 10 K from the setpoint after it was there, or at its range")
    yield FaultKind("chamber sensor open", partial(SensorFault, "chamber", "open"), TEMPERED, TRIP, 3.0 + SCAN_S)
    yield FaultKind("chamber sensor frozen", partial(SensorFault, "chamber", "frozen"), TEMPERED, MAY, slow=True,
                    note="seen by output without effect: at its setpoint it asks for none")
    yield FaultKind("chamber sensor offset", partial(SensorFault, "chamber", "offset"), TEMPERED, MAY, unit="K",
                    value=-10.0, slow=True, note="one sensor alone: nothing in the chamber contradicts it")
    yield FaultKind("load cell frozen", partial(_CELL, "frozen"), SLIDING, TRIP, 2.0 + SCAN_S,
                    note="not one count changes")
    yield FaultKind("load cell open", partial(_CELL, "open"), ALWAYS, TRIP, 0.2 + SCAN_S)
    yield FaultKind("load cell offset", partial(_CELL, "offset"), SLIDING, MAY, unit="N", value=5.0,
                    note="seen by the next tare")
    yield FaultKind("load cell drift", partial(_CELL, "drift"), SLIDING, MAY, unit="N/s", value=0.01,
                    note="seen by the next tare")
    yield FaultKind("load cell gain", partial(_CELL, "gain"), SLIDING, MAY, unit="%", value=70.0,
                    note="one channel alone: nothing on the rig contradicts it")
    yield FaultKind("friction", track_rubs_otherwise, SLIDING, MAY, unit="%", value=115.0,
                    note="rubber and track, no fault of the machine: results carry a doubt")
    for name in ("pyrometer", "thermometer"):
        yield FaultKind(f"{name} silent", partial(modbus.Impaired, name, "silence"), ALWAYS, TRIP, 3.0,
                        note="on a rig that has one")
        yield FaultKind(f"{name} offset", partial(SensorFault, name, "offset"), ALWAYS, MAY, unit="K", value=10.0,
                        note="recorded, not controlled by")


def _contact_rows() -> Iterator[FaultKind]:
    """Yield a specimen that is lost, a cell that is deaf, and the faults of the sensor of the arm's height."""
    yield FaultKind("specimen lost", specimen_lost, SLID, TRIP, 0.5 + SCAN_S, "", 0.02,
                    note="its holder slides on a film with this coefficient")
    yield FaultKind("holder grinds", specimen_lost, SLID, TRIP, 0.5 + SCAN_S, "", 0.4,
                    note="with friction like rubber's: only the arm's height shows it")
    yield FaultKind("load cell deaf", cell_deaf, SLID, TRIP, 0.5 + SCAN_S,
                    note="it shows its noise, and no force")
    yield from device_rows(HEIGHT, SLIDING, 0.25 + SCAN_S, (*common.SILENCES, "reset"))
    yield FaultKind(f"{HEIGHT} frozen", partial(SensorFault, HEIGHT, "frozen"), SLIDING, TRIP, 1.2 + SCAN_S)
    yield FaultKind(f"{HEIGHT} open", partial(QuantityFault, HEIGHT, "height", "open"), SLIDING, TRIP, 0.3 + SCAN_S)
    yield FaultKind(f"{HEIGHT} offset", partial(QuantityFault, HEIGHT, "height", "offset"), SLIDING, TRIP,
                    0.3 + SCAN_S, "mm", 2.0)
    yield FaultKind(f"{HEIGHT} drift", partial(QuantityFault, HEIGHT, "height", "drift"), SLIDING, TRIP,
                    3.0, "mm/s", 0.5)


def _rows() -> Iterator[FaultKind]:
    yield from _drive_rows()
    yield from common.BUS
    yield FaultKind("CAN frames repeated", can.frames_repeated, ALWAYS, RIDE)
    yield FaultKind("emergency stop pressed", partial(cabinet.emergency_stop, ("track",)), DRIVES, TRIP, SCAN_S)
    yield from _device_rows()
    yield from _contact_rows()
    yield from common.COMPUTER


CATALOGUE: dict[str, FaultKind] = {row.phrase: row for row in _rows()}
"""Every fault by its phrase."""
LANGUAGE = FaultLanguage(CATALOGUE, STEPS)
