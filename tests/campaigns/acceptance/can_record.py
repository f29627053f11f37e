"""A run's CAN log, read by python-can and decoded with the drive's EDS by PyPI canopen."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import can
import canopen
import numpy as np
from canopen.objectdictionary import ODVariable, datatypes

import drivers.profiles

EDS = Path(drivers.profiles.__file__).parent / "cia402_servo.eds"
LAYOUTS = {
    datatypes.UNSIGNED8: "u1", datatypes.UNSIGNED16: "<u2", datatypes.UNSIGNED32: "<u4",
    datatypes.INTEGER8: "i1", datatypes.INTEGER16: "<i2", datatypes.INTEGER32: "<i4",
}  # fmt: skip

UPLOADED = {0x4F: 1, 0x4B: 2, 0x47: 3, 0x43: 4}
DOWNLOAD = {0x2F: 1, 0x2B: 2, 0x27: 3, 0x23: 4}
"""Expedited SDO commands with the bytes that count (CiA 301, 7.2.4.3)."""


@dataclass(frozen=True, slots=True)
class Axis:
    """A drive as axes.json describes it."""

    name: str
    node: int
    unit: str
    mode: str
    velocity_counts: float
    position_counts: float
    tpdo1: tuple[str, ...]
    rpdo1: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Transfer:
    """An expedited SDO transfer, confirmed by its drive at ``t`` s."""

    t: float
    written: bool
    index: int
    sub: int
    value: Any


class CanRecord:
    """Every frame of a run."""

    def __init__(self, folder: Path) -> None:
        """Read can.log and axes.json."""
        self.dictionary = canopen.import_od(str(EDS))
        axes: dict[str, dict[str, Any]] = json.loads((folder / "axes.json").read_text(encoding="utf-8"))
        self.axes = {name: _axis(name, entry) for name, entry in axes.items()}
        self.frames: dict[int, list[tuple[float, bytes]]] = defaultdict(list)
        self.extended = 0
        self.backward = 0
        """Frames whose wire time is earlier than the previous frame's."""
        last = 0.0
        for message in can.CanutilsLogReader(folder / "can.log"):
            t = message.timestamp
            self.backward += t < last
            last = t
            self.extended += message.is_extended_id
            self.frames[message.arbitration_id].append((t, message.data))
        self.end_s = last
        self.count = sum(map(len, self.frames.values()))

    def known_ids(self) -> set[int]:
        """Return the identifiers of the predefined connection set for these drives and the PC (CiA 301)."""
        bases = (0x080, 0x180, 0x200, 0x280, 0x300, 0x580, 0x600, 0x700)
        return {0x000, 0x080, 0x700 + 127} | {base + axis.node for base in bases for axis in self.axes.values()}

    def times(self, can_id: int) -> np.ndarray[Any, Any]:
        """Return the wire times of one identifier in s."""
        return np.array([t for t, _ in self.frames[can_id]])

    def variable(self, index: int, sub: int) -> ODVariable:
        """Return an entry of the EDS."""
        found = self.dictionary[index]
        return found if isinstance(found, ODVariable) else found[sub]

    def pdo(self, can_id: int, entries: tuple[str, ...]) -> np.ndarray[Any, Any]:
        """Return a PDO's values, a field for each entry, named by its index in hexadecimal.

        The widths come from the EDS. Raises ValueError if a frame has another length.
        """
        names = [entry.split()[0] for entry in entries]
        layout = np.dtype([(name, LAYOUTS[self.variable(int(name, 16), 0).data_type]) for name in names])
        wrong = sum(len(data) != layout.itemsize for _, data in self.frames[can_id])
        if wrong:
            raise ValueError(f"{wrong} frames {can_id:03X} are not {layout.itemsize} bytes long")
        return np.frombuffer(b"".join(data for _, data in self.frames[can_id]), layout)

    def commands(self, axis: Axis) -> np.ndarray[Any, Any]:
        """Return an axis' RPDO1: fields 6040 and 60FF or 607A."""
        return self.pdo(0x200 + axis.node, axis.rpdo1)

    def readings(self, axis: Axis) -> np.ndarray[Any, Any]:
        """Return an axis' TPDO1: fields 6041, 606C or 6064, 6077."""
        return self.pdo(0x180 + axis.node, axis.tpdo1)

    def transfers(self, node: int) -> Iterator[Transfer]:
        """Yield a drive's confirmed expedited transfers in order."""
        both = [(t, data, True) for t, data in self.frames[0x600 + node]]
        both += [(t, data, False) for t, data in self.frames[0x580 + node]]
        asked = b""
        for t, data, from_pc in sorted(both, key=lambda frame: frame[0]):
            if from_pc:
                asked = data
            elif asked[1:4] == data[1:4]:
                index, sub = int.from_bytes(data[1:3], "little"), data[3]
                if data[0] == 0x60 and asked[0] in DOWNLOAD:
                    yield Transfer(t, True, index, sub, self._value(index, sub, asked[4 : 4 + DOWNLOAD[asked[0]]]))
                elif data[0] in UPLOADED:
                    yield Transfer(t, False, index, sub, self._value(index, sub, data[4 : 4 + UPLOADED[data[0]]]))

    def nmt(self, node: int) -> list[tuple[float, int]]:
        """Return the NMT commands to one node: time, command."""
        return [(t, data[0]) for t, data in self.frames[0x000] if data[1] == node]

    def heartbeats(self, node: int) -> list[tuple[float, int]]:
        """Return a node's boot-ups (0) and heartbeats: time, state."""
        return [(t, data[0]) for t, data in self.frames[0x700 + node]]

    def _value(self, index: int, sub: int, data: bytes) -> Any:
        return self.variable(index, sub).decode_raw(bytes(data))


def _axis(name: str, entry: dict[str, Any]) -> Axis:
    return Axis(
        name, entry["node"], entry["unit"], entry["mode"], entry["velocity_counts_per_unit"],
        entry["position_counts_per_unit"], tuple(entry["tpdo1"]), tuple(entry["rpdo1"]),
    )  # fmt: skip
