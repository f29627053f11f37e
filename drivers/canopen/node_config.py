"""Configuration of a CANopen node that measures: a rig file's section ``can.nodes``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

SIZES: dict[str, int] = {"bit": 1, "u8": 1, "i8": 1, "u16": 2, "i16": 2, "u32": 4, "i32": 4, "f32": 4}
"""Size in bytes of each data type that a value in a PDO can have."""


@dataclass(frozen=True, slots=True)
class NodeChannel:
    """One number in a node's first transmit PDO; raises ValueError where it does not fit into the 8 bytes."""

    byte: int
    """Its first byte in the PDO, from 0; low byte first."""
    type: Literal["bit", "u8", "i8", "u16", "i16", "u32", "i32", "f32"]
    scale: float
    """Value of one count, in ``unit``."""
    unit: str
    simulated: float = 0.0
    """Value that the simulated node sends, in ``unit``."""
    bit: int = 0
    """Place of a ``bit`` in its byte, 0 = the lowest: an input of a CiA 401 node."""

    @property
    def place(self) -> int:
        """Place of the bit in its byte; -1 for a number."""
        return self.bit if self.type == "bit" else -1

    def __post_init__(self) -> None:
        """Check place and scale."""
        if not 0 <= self.byte <= 8 - SIZES[self.type]:
            raise ValueError(f"byte {self.byte}: {self.type} does not fit into the 8 bytes of a PDO")
        if self.scale == 0.0:
            raise ValueError("scale must not be 0")
        if not 0 <= self.bit <= (7 if self.type == "bit" else 0):
            raise ValueError(f"bit {self.bit} (expected 0 to 7, with type bit)")


@dataclass(frozen=True, slots=True)
class NodeConfig:
    """A node that measures: it sends TPDO1 by itself, as set by its maker or with its set-up tool.

    ``vendor_id`` and ``product_code`` are compared with 0x1018 at connect; 0 = not compared.
    """

    name: str
    node_id: int                                     # 1..126; 127 is the PC
    channels: Mapping[str, NodeChannel]
    period_s: Annotated[float, "s"] = 0.1            # how often its TPDO1 comes
    vendor_id: int = 0
    product_code: int = 0
    heartbeat_s: Annotated[float, "s"] = 0.05        # 0x1017, written at connect
