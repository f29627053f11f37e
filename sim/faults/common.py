"""Faults that any machine on these wires can have: of a drive, of a Modbus device, of the bus, of the computer.

``DRIVE`` and its like are rows without the name of a part. A machine's catalogue lists its parts and takes the rows for
each of them (``rows_of``, ``device_rows``). Budgets are those of docs/safety.md, with one scan at the slow rate added.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from dataclasses import replace
from enum import Enum
from functools import partial
from typing import Final

from drivers.canopen import objects as o
from drivers.canopen.node_config import NodeConfig
from sim.faults import cabinet, can, drives, modbus, sensors
from sim.faults.kinds import Expected, Exposure, FaultKind
from sim.faults.language import FaultLanguage
from sim.faults.scene import Effect
from sim.faults.shares import share_rows
from sim.rig import DeviceSpec, RigSpec, title_of

OVERCURRENT: Final = 0x2310
SCAN_S: Final = 0.05
"""Period of the slow scan, s: the greatest delay until a scan notices a fault."""
NOISY_S: Final = 2.0 + 3.0 + 1.0
"""Time to judge a noisy line, s: it counts failures over 2 s, may fail for 3 s, and asks a slow device each 1 s [A]."""

ALWAYS, DRIVES, CONNECTING, ENABLED, MOVING = Exposure
TRIP, STOP, HOLD, RIDE, MAY, DEVICES = Expected

DRIVE: Final = (
    FaultKind("drive fault", partial(drives.drive_fault, code=OVERCURRENT), DRIVES, TRIP, 0.02 + SCAN_S),
    FaultKind("drive heartbeat lost", drives.heartbeat_lost, DRIVES, TRIP, 0.2 + SCAN_S),
    FaultKind("drive off the bus", can.node_cut, DRIVES, TRIP, 0.2 + SCAN_S),
    FaultKind("drive without supply", drives.unpowered, DRIVES, TRIP, 0.2 + SCAN_S),
    FaultKind("drive reboots", drives.reboot, DRIVES, TRIP, 0.25 + SCAN_S, lasts_s=1.0,
              note="its boot-up message comes after 0.2 s"),
    FaultKind("drive data lost", partial(can.frames_lost, base=o.TPDO1_BASE), ENABLED, TRIP, 0.15 + SCAN_S),
)  # fmt: skip
"""Faults of any drive."""
LEFT_OPERATION: Final = (
    FaultKind("drive in local mode", drives.local, ENABLED, TRIP, 0.1 + SCAN_S),
    FaultKind("drive torque off", drives.torque_off, ENABLED, TRIP, 0.1 + SCAN_S),
)
"""Ways in which a drive leaves operation without a fault."""
FROZEN: Final = tuple(
    FaultKind(f"drive {what} frozen", partial(can.data_frozen, part=part), ENABLED, MAY,
              note="seen once it contradicts a command, else without effect; after a stop the drive loses its voltage")
    for what, part in (("statusword", can.STATUSWORD), ("reading", can.ACTUAL), ("torque", can.TORQUE))
)  # fmt: skip
"""One process datum of a drive is repeated for ever."""
FROZEN_INPUTS: Final = FaultKind(
    "drive inputs frozen", partial(can.data_frozen, base=o.TPDO2_BASE), ENABLED, MAY,
    note="no command changes them: a guard switch and an emergency stop in the hardware's circuit act without them",
)  # fmt: skip
"""The drive with the safety inputs repeats its input word for ever."""
AT_CONNECTION: Final = (
    FaultKind("drive of another make", drives.wrong_identity, CONNECTING, TRIP, 3.0),
    FaultKind("drive SDO abort", partial(drives.sdo_spoiled, kind="abort"), CONNECTING, TRIP, 3.0),
)
"""Faults of a drive that the next connection finds."""


def rows_of(part: str, faults: Iterable[FaultKind]) -> Iterator[FaultKind]:
    """Yield faults as those of a part: its name comes first in the phrase, and as the first argument of ``make``."""
    for fault in faults:
        yield replace(fault, phrase=f"{part} {fault.phrase}", make=partial(fault.make, part))


SILENCES: Final = ("silent", "CRC errors", "replies cut short", "without supply")
"""The usual ways in which a Modbus device stops answering."""


def device_rows(
    device: str, needed: Enum, stale_s: float, which: Sequence[str] = SILENCES, note: str = ""
) -> Iterator[FaultKind]:
    """Yield the faults ``which`` of a Modbus device, all those known for ().

    ``needed``: when its readings begin to be needed; ``stale_s``: the age at which they trip. ``note``: of those that
    have none.
    """
    known = (
        FaultKind("silent", partial(modbus.Impaired, kind="silence"), needed, TRIP, stale_s),
        FaultKind("without supply", modbus.device_off, needed, TRIP, stale_s),
        FaultKind("reset", modbus.DeviceReset, needed, TRIP, stale_s, lasts_s=modbus.REBOOT_S),
        FaultKind("CRC errors", partial(modbus.Impaired, kind="corrupt"), needed, TRIP, stale_s),
        FaultKind("garbage", partial(modbus.Impaired, kind="noise"), needed, TRIP, NOISY_S,
                  note="bytes before a reply: its time is over before the driver can tell it from them"),
        FaultKind("replies cut short", partial(modbus.Impaired, kind="truncate"), needed, TRIP, stale_s),
        FaultKind("replies of another address", partial(modbus.Impaired, kind="wrong_id"), needed, TRIP, stale_s),
        FaultKind("replies split", partial(modbus.Impaired, kind="split", delay_s=0.005), needed, MAY,
                  note="the second half comes 5 ms later, a gateway's way: a reply like any other"),
        FaultKind("replies merged", partial(modbus.Impaired, kind="merged"), needed, TRIP, NOISY_S,
                  note="a gateway keeps every second reply and sends it with the next, in one piece"),
        FaultKind("replies late", modbus.late_reply, needed, TRIP, stale_s + 0.5, "ms", 1.5),
        FaultKind("reply late once", partial(modbus.Impaired, kind="late", count=1, delay_s=0.02), ALWAYS, RIDE),
        FaultKind("CRC error once", partial(modbus.Impaired, kind="corrupt", count=1), ALWAYS, RIDE),
        FaultKind("exception", modbus.exception_reply, needed, TRIP, stale_s, "", 4.0),
        FaultKind("line unplugged", modbus.line_gone, DRIVES, TRIP, 0.2 + SCAN_S),
    )  # fmt: skip
    by_phrase = {row.phrase: row for row in known}
    for row in rows_of(device, (by_phrase[phrase] for phrase in which or by_phrase)):
        yield replace(row, note=row.note or note)


_OWN_ROWS: Final = "nothing trips without a row of a laboratory's own that looks at it"


INPUT_S: Final = 0.25 + SCAN_S
"""Time to notice a safety input that opened, or whose device fell silent, s."""


def further_rows(sensor: str, device: DeviceSpec, inputs: Container[str] = ()) -> Iterator[FaultKind]:
    """Yield the faults of a further sensor; ``sensor``: its name for people, ``inputs``: channels that must stay
    closed.
    """
    names = {name: device.channels.get(name, name) in inputs for name in device.profile.channels}
    for row in device_rows(sensor, DRIVES if any(names.values()) else ALWAYS, INPUT_S):
        yield row if any(names.values()) else replace(row, reaction=MAY, budget_s=0.0, note=_OWN_ROWS)
    for name, is_input in names.items():
        yield _shows(sensor, name, partial(sensors.Shows, sensor, name), is_input, device.profile.signal(name).greatest)


def _shows(part: str, channel: str, make: Callable[[float], Effect], is_input: bool, value: float) -> FaultKind:
    """Return the fault of a channel that shows another number: a safety input opens."""
    phrase = f"{part} shows {channel}"
    if is_input:
        return FaultKind(phrase, make, DRIVES, TRIP, INPUT_S, unit="", value=0.0)
    return FaultKind(phrase, make, ALWAYS, MAY, unit="", value=value, note=_OWN_ROWS)


def node_rows(node: NodeConfig, inputs: Container[str]) -> Iterator[FaultKind]:
    """Yield the faults of a further CANopen node."""
    title = title_of(node.name)
    known = [name in inputs for name in node.channels]
    lost = FaultKind(f"{title} without supply", partial(sensors.node_off, title), DRIVES, TRIP, INPUT_S)
    yield lost if any(known) else replace(lost, exposure=ALWAYS, reaction=MAY, budget_s=0.0, note=_OWN_ROWS)
    for name, is_input in zip(node.channels, known, strict=True):
        yield _shows(title, name, partial(sensors.NodeShows, title, name), is_input, node.channels[name].simulated)


def with_sensors(language: FaultLanguage, spec: RigSpec) -> FaultLanguage:
    """Return a machine's language with the faults of a wiring's further sensors and nodes, and of its shares."""
    rows = [row for name in spec.further for row in further_rows(title_of(name), spec.devices[name], spec.inputs)]
    rows += [row for node in spec.nodes for row in node_rows(node, spec.inputs)]
    rows += share_rows(spec)
    return replace(language, catalogue={row.phrase: row for row in rows} | dict(language.catalogue))


BUS: Final = (
    FaultKind("CAN adapter gone", can.adapter_gone, DRIVES, TRIP, SCAN_S),
    FaultKind("CAN bus off", can.bus_silent, DRIVES, TRIP, 0.2 + SCAN_S),
    FaultKind("safety chain opened", cabinet.chain_open, DRIVES, TRIP, SCAN_S),
    FaultKind("guard opened", cabinet.guard_open, ENABLED, TRIP, SCAN_S),
)
"""Faults of the bus and of the safety inputs."""
COMPUTER: Final = (
    FaultKind("scan stalled", cabinet.stalled, ENABLED, TRIP, 0.4 + SCAN_S, "ms", 0.4, lasts_s=0.5,
              note="tripped by the first scan after it; a drive stops by itself after 0.2 s"),
    FaultKind("process killed", cabinet.killed, ALWAYS, DEVICES, 0.25),
    FaultKind("operator hold", partial(cabinet.operator, "hold"), DRIVES, HOLD, SCAN_S),
    FaultKind("operator release", partial(cabinet.operator, "release"), ALWAYS, RIDE),
    *(FaultKind(f"operator {action}", partial(cabinet.operator, action), DRIVES, STOP, SCAN_S)
      for action in ("abort", "stop", "fast stop")),
)  # fmt: skip
"""Faults of the computer, and requests of its operator."""

PLAIN_STEPS: Final = ("connect", "mount", "settle", "slide")
"""Names of steps that a fault can wait for."""


def plain_language(axes: Iterable[str], sensors: Iterable[str], *own: FaultKind) -> FaultLanguage:
    """Return the language of a plain machine's fault scripts; ``sensors``: their names for people."""
    jammed = FaultKind("drive jammed", drives.Jammed, MOVING, TRIP, 1.2 + SCAN_S)
    rows = [*own, *BUS, *COMPUTER]
    rows += [row for axis in axes for row in rows_of(axis, (*DRIVE, *LEFT_OPERATION, jammed))]
    rows += [row for sensor in sensors for row in device_rows(sensor, ENABLED, 0.3 + SCAN_S)]
    return FaultLanguage({row.phrase: row for row in rows}, PLAIN_STEPS)
