"""Faults of the drives, of the mechanics that they move, and of their service data (SDO)."""

from __future__ import annotations

from typing import Literal

from drivers.canopen import objects as o
from drivers.canopen import sdo
from drivers.canopen.messages import encode_emergency
from sim.faults.scene import Effect, Scene, switched
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.drive_power import ENERGISED
from sim.nodes.motion import VelocityAxis
from sim.nodes.object_store import ObjectStore, SdoAbortError
from sim.nodes.sdo_server import SdoServer

MOTOR_BLOCKED = 0x7121
BLOCKED_S = 0.5
"""Time at its torque limit after which a drive reports its motor blocked, s [A]."""
SdoFault = Literal["abort", "toggle", "other object"]
_INITIATES = (1, 2)
"""Commands that begin a download and an upload: they contain an address (CiA 301, 7.2.4.3)."""
_OTHER = 0x2000
"""Object in the answers of a confused server: the first object of the manufacturer's range."""


@switched
def drive_fault(scene: Scene, on: bool, now: float, axis: str, code: int) -> None:
    """The drive enters its fault reaction with this emergency code; the fault outlasts its cause until it is reset."""
    drive = scene.rig.axes[axis]
    if on:
        drive.fault(code, persistent=True)
    else:
        drive.clear_cause(code)


@switched
def reported(scene: Scene, on: bool, now: float, axis: str, code: int) -> None:
    """The drive reports an error with this emergency code and continues."""
    drive = scene.rig.axes[axis]
    if on:
        drive.error(code, now)
    else:
        drive.recovered(code, now)


@switched
def short_emergency(scene: Scene, on: bool, now: float, axis: str, code: int, length: int) -> None:
    """The drive reports an error, once, in a frame of its first ``length`` bytes; it does not store the error."""
    drive = scene.rig.axes[axis]
    if on:
        drive.wire.transmit(o.EMERGENCY_BASE + drive.node_id, encode_emergency(code, 1)[:length], now, True)


@switched
def heartbeat_lost(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The drive's heartbeat is not sent; everything else is."""
    scene.rig.axes[axis].withhold_heartbeat(on)


@switched
def unpowered(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The drive has lost its control supply; when it comes back the drive boots."""
    scene.rig.axes[axis].power(not on)


@switched
def reboot(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The drive restarts (a dip in its supply): one boot-up message in the middle of a run."""
    if on:
        scene.rig.axes[axis].power(False)
        scene.rig.axes[axis].power(True)


@switched
def torque_off(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The drive's safe-torque-off input opens: no supply for its power stage."""
    scene.rig.axes[axis].set_torque_off(on)


@switched
def local(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The drive is operated at its keypad: it stops by itself [A] and ignores the bus."""
    drive = scene.rig.axes[axis]
    drive.set_local(on)
    if on and isinstance(drive.axis, VelocityAxis):
        drive.axis.aim(0.0, deceleration=drive.config.deceleration)


@switched
def wrong_identity(scene: Scene, on: bool, now: float, axis: str) -> None:
    """Another product answers at the drive's address: noticed at the next connection."""
    drive = scene.rig.axes[axis]
    drive.store.values[(o.IDENTITY, 2)] = drive.config.product_code + on


class _OnAxis(Effect):
    """A fault of one axis."""

    def __init__(self, axis: str) -> None:
        self.axis = axis

    def drive(self, scene: Scene) -> Cia402Slave:
        """Return the axis' drive."""
        return scene.rig.axes[self.axis]


class Jammed(_OnAxis):
    """The shaft is blocked; a drive that was moving pushes, and after a while reports its motor blocked."""

    every_step = True

    def begin(self, scene: Scene, now: float) -> None:
        """Hold the shaft."""
        self._since_s = now
        self.drive(scene).block(True)

    def end(self, scene: Scene, now: float) -> None:
        """Free the shaft."""
        self.drive(scene).block(False)

    def renew(self, scene: Scene, now: float) -> None:
        """Count how long the drive has pushed."""
        drive = self.drive(scene)
        pushing = drive.state in ENERGISED and abs(drive.axis.demand) > 0.02 * drive.config.max_speed
        if not (pushing and isinstance(drive.axis, VelocityAxis)):
            self._since_s = now
        elif now - self._since_s >= BLOCKED_S:
            drive.fault(MOTOR_BLOCKED)


class Runaway(_OnAxis):
    """The axis moves by itself whenever its power stage is on, whatever is commanded (a broken velocity loop)."""

    every_step = True

    def __init__(self, axis: str, speed: float) -> None:
        """Take the speed of the fault (unit of the axis per s)."""
        super().__init__(axis)
        self.speed = speed

    def renew(self, scene: Scene, now: float) -> None:
        """Override the command; without power the axis moves as it does without power."""
        drive = self.drive(scene)
        if drive.state in ENERGISED and isinstance(drive.axis, VelocityAxis):
            drive.axis.aim(self.speed)


class SpoiledSdoServer(SdoServer):
    """A server that refuses everything, does not toggle, or answers about another object."""

    def __init__(self, objects: ObjectStore, kind: SdoFault) -> None:
        """Serve ``objects`` badly."""
        super().__init__(objects)
        self._kind: SdoFault = kind

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
        """Begin an upload; one with a missing toggle goes in segments, as every device may choose to."""
        if self._kind != "toggle":
            return super()._start_upload(data)
        self.reset()
        self._address(data)
        return self._begin_segments(self._objects.upload(self._index, self._sub))

    def _upload_segment(self, data: bytes) -> bytes:
        """Return a segment; its toggle bit is wrong in an upload with a missing toggle."""
        reply = super()._upload_segment(data)
        return bytes((reply[0] ^ 0x10,)) + reply[1:] if self._kind == "toggle" else reply


@switched
def sdo_spoiled(scene: Scene, on: bool, now: float, axis: str, kind: SdoFault) -> None:
    """The drive's SDO server has this fault."""
    drive = scene.rig.axes[axis]
    drive.serve_with(SpoiledSdoServer(drive.store, kind) if on else SdoServer(drive.store))


class ModeRefused(_OnAxis):
    """A drive refuses every mode of operation: a wrong firmware, or a drive that wrongly considers itself in motion."""

    def refuse(self, sub: int, value: int) -> None:
        """Refuse a write to 0x6060."""
        raise SdoAbortError(sdo.DEVICE_STATE)

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to refuse."""
        guards = self.drive(scene).store.guards
        self._guard = guards[o.MODE]
        guards[o.MODE] = self.refuse

    def end(self, scene: Scene, now: float) -> None:
        """Accept the modes that the drive has."""
        self.drive(scene).store.guards[o.MODE] = self._guard


class BrakesWeakly(_OnAxis):
    """The drive brakes with a share of its decelerations: its brake resistor is open, or its current is limited."""

    every_step = True

    def __init__(self, axis: str, percent: float) -> None:
        """Take the share of every deceleration that is left, percent."""
        super().__init__(axis)
        self.share = max(0.01 * percent, 1e-3)

    def renew(self, scene: Scene, now: float) -> None:
        """Weaken the deceleration of the last command, once."""
        axis = self.drive(scene).axis
        if isinstance(axis, VelocityAxis) and axis.deceleration != self._weak:
            axis.deceleration = self._weak = self.share * axis.deceleration

    _weak = 0.0
