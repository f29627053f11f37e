"""Network management frames (CiA 301, 7.2.8.2) and emergency messages (7.2.7)."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.canopen import objects as o
from drivers.canopen.objects import NmtCommand, NmtState


def encode_nmt(command: NmtCommand, node_id: int) -> bytes:
    """Return the data of an NMT frame for one node (1..127; 0: all)."""
    return bytes((command, node_id))


def state_name(state: int) -> str:
    """Return the name of a heartbeat's state byte."""
    try:
        return NmtState(state).name.replace("_", "-")
    except ValueError:
        return f"unknown state {state}"


@dataclass(frozen=True, slots=True)
class Emergency:
    """One EMCY frame: error code, error register (0x1001), vendor bytes, text, arrival time in s.

    Code 0x0000 means that an error has gone.
    """

    code: int
    register: int
    vendor: bytes
    text: str
    t: float

    @property
    def is_reset(self) -> bool:
        """Whether the device reports that an error has gone (codes 0x00xx)."""
        return self.code >> 8 == 0


def encode_emergency(code: int, register: int, vendor: bytes = b"") -> bytes:
    """Return the eight bytes of an EMCY frame; ``vendor`` is cut or padded to five."""
    return code.to_bytes(2, "little") + bytes((register,)) + vendor[:5].ljust(5, b"\0")


def decode_emergency(data: bytes, t: float) -> Emergency:
    """Return the emergency in a frame that arrived at ``t``.

    A frame shorter than eight bytes is accepted: the missing bytes make it an unknown error of that
    device.
    """
    code = int.from_bytes(data[:2], "little") if len(data) >= 2 else 0x1000
    register = data[2] if len(data) > 2 else 0
    text = o.emergency_text(code)
    if len(data) < 8:
        text += f" (short EMCY of {len(data)} bytes)"
    return Emergency(code, register, bytes(data[3:8]), text, t)


def register_text(register: int) -> str:
    """Return the set bits of an error register (0x1001) by name, "none" for 0."""
    names = [name for bit, name in enumerate(o.ERROR_REGISTER_BITS) if register >> bit & 1]
    return ", ".join(names) or "none"
