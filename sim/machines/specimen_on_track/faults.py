"""Faults of a specimen on a track: the catalogue, its effects, and the language of its scripts.

Budgets count up to the safe commands, from the onset or from the time when the fault can be noticed, with one scan of
50 ms at the slow rate added; all are [A].
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import partial
from typing import Final

from sim.faults import cabinet, can, drives, modbus
from sim.faults.common import (
    SCAN_S,
    bus_rows,
    computer_rows,
    connecting_rows,
    device_rows,
    drive_rows,
    left_operation_rows,
)
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultLanguage
from sim.faults.scene import Scene, switched
from sim.faults.sensors import SensorFault, controller_output
from sim.machines.specimen_on_track.rig import TrackRig
from sim.nodes.motion import VelocityAxis

STEPS: Final = ("connect", "install", "temper", "settle", "tare", "lower", "slide", "lift", "prompt")
"""Names of steps that a fault can wait for."""
AXES: Final = ("track", "lift")


class Onset(Enum):
    """The earliest time at which a fault of this machine can be noticed: its budget counts from then on."""

    ALWAYS = "at once, once the run has begun"
    DRIVES = "at once, once every drive is configured"
    CONNECTING = "at the next connection"
    ENABLED = "while the drives are on"
    MOVING = "while the track moves"
    SLIDING = "in contact, while the track moves"
    LIFTING = "while the arm has a command to move"
    TEMPERED = "while the chamber has a command to run"
    NEAR_THE_END = "where the track comes to the end of its travel"


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
def end_switch_dead(scene: Scene, on: bool, now: float) -> None:
    """The end switches no longer open the safety chain."""
    scene.machine(TrackRig).switches_work = not on


def _drive_rows() -> Iterator[FaultKind]:
    trip = Expected.TRIP
    for axis in AXES:
        yield from drive_rows(axis, Onset.DRIVES, Onset.ENABLED)
        yield from left_operation_rows(axis, Onset.ENABLED)
        yield from connecting_rows(axis, Onset.CONNECTING)
    yield FaultKind("track stalls", partial(drives.Jammed, "track"), Onset.MOVING, trip, 1.2 + SCAN_S)
    yield FaultKind("track overspeeds", TrackOverspeeds, Onset.ENABLED, trip, 1.2 + SCAN_S, "mm/s", 10.0)
    yield FaultKind("lift stuck", partial(drives.Jammed, "lift"), Onset.LIFTING, trip, 5.0,
                    note="a move that does not arrive within its time")
    yield FaultKind("end switch dead", end_switch_dead, Onset.NEAR_THE_END, Expected.MAY, 0.0,
                    note="a second line: the track turns back before it")


_SILENT_S: Final = {"load cell": (Onset.SLIDING, 0.2 + SCAN_S), "chamber": (Onset.TEMPERED, 3.0 + SCAN_S)}
"""For each device: when its readings are needed, and the age at which they are stale plus the row's delay, s."""


_CELL: Final = partial(SensorFault, "load cell", force="fx")


def _device_rows() -> Iterator[FaultKind]:
    for device, (when, budget_s) in _SILENT_S.items():
        yield from device_rows(device, when, budget_s)
        yield FaultKind(f"{device} reset", partial(modbus.DeviceReset, device), when, Expected.TRIP, budget_s,
                        lasts_s=modbus.REBOOT_S)
        yield FaultKind(f"{device} replies late", partial(modbus.late_reply, device), when, Expected.TRIP,
                        budget_s + 0.5, "ms", 1.5)
    yield FaultKind("chamber runs away", partial(controller_output, "chamber"), Onset.TEMPERED, Expected.TRIP, 600.0,
                    "%", 100.0, slow=True,
                    note="seen by its reading, 10 K from the setpoint after it was there, or at its range")
    yield FaultKind("chamber sensor open", partial(SensorFault, "chamber", "open"), Onset.TEMPERED, Expected.TRIP,
                    3.0 + SCAN_S)
    yield FaultKind("chamber sensor offset", partial(SensorFault, "chamber", "offset"), Onset.TEMPERED,
                    Expected.MAY, 0.0, "K", -10.0, slow=True,
                    note="one sensor alone: nothing in the chamber contradicts it")
    yield FaultKind("load cell frozen", partial(_CELL, "frozen"), Onset.SLIDING, Expected.TRIP,
                    2.0 + SCAN_S, note="not one count changes")
    yield FaultKind("load cell open", partial(_CELL, "open"), Onset.ALWAYS, Expected.TRIP,
                    0.2 + SCAN_S)
    yield FaultKind("load cell offset", partial(_CELL, "offset"), Onset.SLIDING, Expected.MAY,
                    0.0, "N", 5.0, note="seen by the next tare")
    yield FaultKind("load cell drift", partial(_CELL, "drift"), Onset.SLIDING, Expected.MAY, 0.0,
                    "N/s", 0.01, note="seen by the next tare")
    yield FaultKind("load cell gain", partial(_CELL, "gain"), Onset.SLIDING, Expected.MAY, 0.0,
                    "%", 70.0, note="one channel alone: nothing on the rig contradicts it")
    yield FaultKind("friction", track_rubs_otherwise, Onset.SLIDING, Expected.MAY, 0.0, "%", 115.0,
                    note="rubber and track, no fault of the machine: results carry a doubt")
    for name in ("pyrometer", "thermometer"):
        yield FaultKind(f"{name} silent", partial(modbus.Impaired, name, "silence"), Onset.ALWAYS, Expected.TRIP,
                        3.0, note="on a rig that has one")
        yield FaultKind(f"{name} offset", partial(SensorFault, name, "offset"), Onset.ALWAYS, Expected.MAY, 0.0, "K",
                        10.0, note="recorded, not controlled by")


def _rows() -> Iterator[FaultKind]:
    yield from _drive_rows()
    yield from bus_rows(Onset.DRIVES, Onset.ENABLED)
    yield FaultKind("CAN frames repeated", can.frames_repeated, Onset.ALWAYS, Expected.RIDE, 0.0)
    yield FaultKind("emergency stop pressed", partial(cabinet.emergency_stop, ("track",)), Onset.DRIVES,
                    Expected.TRIP, SCAN_S)
    yield from _device_rows()
    yield from computer_rows(Onset.ALWAYS, Onset.DRIVES, Onset.ENABLED)


CATALOGUE: dict[str, FaultKind] = {row.phrase: row for row in _rows()}
"""Every fault by its phrase."""
LANGUAGE = FaultLanguage(CATALOGUE, STEPS)
