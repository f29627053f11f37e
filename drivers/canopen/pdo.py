"""Process data objects: the place of each object in eight bytes.

A map is fixed while a device is OPERATIONAL, so its codec is one precompiled ``struct`` call.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

from drivers.canopen import objects as o
from drivers.canopen.dictionary import KNOWN, mapping
from drivers.canopen.sdo import NOT_MAPPABLE, PDO_TOO_LONG

MAX_BITS = 64
"""Eight data bytes of a classic CAN frame."""


class PdoMapError(ValueError):
    """An impossible mapping; ``abort_code`` is the SDO abort that a device answers (CiA 301, table 22)."""

    def __init__(self, abort_code: int, text: str) -> None:
        super().__init__(text)
        self.abort_code = abort_code


class PdoMap:
    """An ordered list of objects in one PDO, with its codec.

    ``fields`` holds (index, sub-index, bits) in wire order; ``size`` is the length in bytes. Equal maps
    compare equal. Immutable: a deep copy is the map itself.
    """

    def __init__(self, fields: Sequence[tuple[int, int, int]]) -> None:
        code = "<"
        total = 0
        for index, sub, bits in fields:
            entry = KNOWN.get((index, sub))
            if entry is None or not entry.mappable or entry.bits != bits:
                text = f"0x{index:04X}:{sub:02X} ({bits} bits) cannot be mapped"
                raise PdoMapError(NOT_MAPPABLE, text)
            code += o.STRUCT_CODE[entry.type]
            total += bits
        if total > MAX_BITS:
            raise PdoMapError(PDO_TOO_LONG, f"{total} bits do not fit the {MAX_BITS} of a PDO")
        self.fields = tuple(fields)
        self.size = total // 8
        codec = struct.Struct(code)
        self.pack = codec.pack
        self.unpack = codec.unpack

    @classmethod
    def of(cls, *objects: tuple[int, int]) -> PdoMap:
        """Return the map of these (index, sub-index) in this order; raises PdoMapError."""
        return cls([(index, sub, KNOWN[(index, sub)].bits) for index, sub in objects])

    @classmethod
    def from_parameters(cls, values: Sequence[int]) -> PdoMap:
        """Return the map of U32 entries (index << 16 | sub << 8 | bits); raises PdoMapError."""
        return cls([(value >> 16, value >> 8 & 0xFF, value & 0xFF) for value in values])

    def parameters(self) -> tuple[int, ...]:
        """Return the U32 mapping entries, sub-index 1 first."""
        return tuple(mapping(index, sub, bits) for index, sub, bits in self.fields)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PdoMap) and other.fields == self.fields

    def __hash__(self) -> int:
        return hash(self.fields)

    def __repr__(self) -> str:
        return f"PdoMap({self.fields!r})"

    def __copy__(self) -> PdoMap:
        return self

    def __deepcopy__(self, memo: dict[int, object]) -> PdoMap:
        return self


RPDO1_VELOCITY = PdoMap.of((o.CONTROLWORD, 0), (o.TARGET_VELOCITY, 0))
RPDO1_POSITION = PdoMap.of((o.CONTROLWORD, 0), (o.TARGET_POSITION, 0))
RPDO1_INVERTER = PdoMap.of((o.CONTROLWORD, 0), (o.VL_TARGET_VELOCITY, 0))
TPDO1_VELOCITY = PdoMap.of((o.STATUSWORD, 0), (o.VELOCITY_ACTUAL, 0), (o.TORQUE_ACTUAL, 0))
TPDO1_POSITION = PdoMap.of((o.STATUSWORD, 0), (o.POSITION_ACTUAL, 0), (o.TORQUE_ACTUAL, 0))
TPDO1_INVERTER = PdoMap.of((o.STATUSWORD, 0), (o.VL_VELOCITY_ACTUAL, 0), (o.TORQUE_ACTUAL, 0))
TPDO1_NO_TORQUE = PdoMap.of((o.STATUSWORD, 0), (o.VL_VELOCITY_ACTUAL, 0))
RPDO2_OUTPUTS = PdoMap.of((o.DIGITAL_OUTPUTS, 1))
TPDO2_INPUTS = PdoMap.of((o.DIGITAL_INPUTS, 0))
TPDO2_STATUS = PdoMap.of((o.STATUSWORD, 0))

SYNCHRONOUS = 1
"""Transmission type: with every SYNC."""
EVENT_DRIVEN = 255
"""Transmission type: when a mapped value changes (device profile specific)."""
