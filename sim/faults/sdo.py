"""Faults of a drive's service data: refusals, toggle errors, answers about something else, refused modes."""

from __future__ import annotations

from typing import Literal

from drivers.canopen import objects as o
from sim.faults.scene import Effect, Scene
from sim.nodes import sdo_server as sdo
from sim.nodes.sdo_server import ObjectAccess, SdoAbortError, SdoServer

Kind = Literal["abort", "toggle", "other object"]
_INITIATES = (1, 2)
"""Commands that begin a download and an upload: they carry an address (CiA 301, 7.2.4.3)."""
_OTHER = 0x2000
"""The object a confused server speaks of: the first of the manufacturer's."""


class SpoiledSdoServer(SdoServer):
    """A server that refuses everything, forgets to toggle, or answers about another object."""

    __slots__ = ("_kind",)

    def __init__(self, objects: ObjectAccess, kind: Kind) -> None:
        """Serve ``objects`` badly."""
        super().__init__(objects)
        self._kind: Kind = kind

    def request(self, data: bytes) -> bytes | None:
        """Return the reply to a request."""
        initiates = len(data) == 8 and data[0] >> 5 in _INITIATES
        if self._kind == "abort" and initiates:
            return b"\x80" + data[1:4] + sdo.DEVICE_STATE.to_bytes(4, "little")
        reply = super().request(data)
        if reply is None or self._kind != "other object" or not initiates:
            return reply
        return reply[:1] + _OTHER.to_bytes(2, "little") + reply[3:]

    def _start_upload(self, data: bytes) -> bytes:
        """Begin an upload; one that will forget to toggle goes in segments, as every device may choose to."""
        if self._kind != "toggle":
            return super()._start_upload(data)
        self.reset()
        self._address(data)
        return self._begin_segments(self._objects.upload(self._index, self._sub))

    def _upload_segment(self, data: bytes) -> bytes:
        """Return a segment, with the wrong toggle bit if so."""
        reply = super()._upload_segment(data)
        return bytes((reply[0] ^ 0x10,)) + reply[1:] if self._kind == "toggle" else reply


class SdoSpoiled(Effect):
    """A drive's SDO server is out of order."""

    __slots__ = ("axis", "kind")

    def __init__(self, axis: str, kind: Kind) -> None:
        """Of this axis, in this way."""
        self.axis = axis
        self.kind: Kind = kind

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to answer badly."""
        drive = scene.rig.axes[self.axis]
        drive.serve_with(SpoiledSdoServer(drive.store, self.kind))

    def end(self, scene: Scene, now: float) -> None:
        """Answer as it should."""
        drive = scene.rig.axes[self.axis]
        drive.serve_with(SdoServer(drive.store))


class ModeRefused(Effect):
    """A drive refuses every mode of operation: a wrong firmware, or one that thinks it moves."""

    __slots__ = ("_guard", "axis")

    def __init__(self, axis: str) -> None:
        """Of this axis."""
        self.axis = axis
        self._guard = self.refuse

    def refuse(self, sub: int, value: int) -> None:
        """Refuse a write to 0x6060."""
        raise SdoAbortError(sdo.DEVICE_STATE)

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to refuse."""
        guards = scene.rig.axes[self.axis].store.guards
        self._guard = guards[o.MODE]
        guards[o.MODE] = self.refuse

    def end(self, scene: Scene, now: float) -> None:
        """Accept what the drive can do."""
        scene.rig.axes[self.axis].store.guards[o.MODE] = self._guard
