"""Faults of the CAN bus: lost, late or repeated frames, nodes that are cut off, frames of strangers."""

from __future__ import annotations

from bisect import insort
from typing import Final

from drivers.canopen import objects as o
from drivers.canopen.messages import encode_emergency
from sim.faults.scene import Effect, Scene, switched
from sim.wires.can_traffic import Listener, SyncFollower
from sim.wires.can_wire import CanWire

_NODE: Final = 0x7F
_FUNCTION: Final = 0x780


def unseen(t: float, can_id: int, data: bytes, sent: bool) -> None:
    """Ignore a frame: a watcher that only forces the bus to pass on every frame."""


class FaultyCanWire(CanWire):
    """A bus with faults of frames. Without a fault it behaves, frame by frame, as the plain bus.

    ``lost`` are identifiers that reach no node; ``late_s`` delays the frames of a function code (identifier without
    the node) by s; ``loss`` is the share of all frames lost, evenly spread; ``frozen`` repeats the last
    bytes of an identifier from one place to another; ``repeated`` doubles every frame; ``silent`` loses every frame
    without an error.
    """

    __slots__ = ("_counted", "_cut", "frozen", "late_s", "loss", "lost", "repeated", "silent", "spoiled")

    def __init__(self, bitrate: int = 500_000) -> None:
        """Create an idle bus without faults; ``bitrate`` in bit/s."""
        self._cut: frozenset[int] = frozenset()
        super().__init__(bitrate)
        self.spoiled = False
        self.lost: frozenset[int] = frozenset()
        self.frozen: dict[tuple[int, int, int], bytes] = {}
        self.late_s = 0.0
        self.loss = 0.0
        self.repeated = False
        self.silent = False
        self._counted = 0.0

    def note_faults(self) -> None:
        """Update the bus after a change of its faults. A bus without faults does not inspect frames."""
        self.spoiled = bool(
            self.lost or self.frozen or self.late_s or self.loss or self.repeated or self.silent or self._cut
        )
        # A watched bus takes no short cuts: each of its frames passes through ``send`` or ``transmit``.
        if self.spoiled and unseen not in self.watchers:
            self.watchers.append(unseen)
        elif not self.spoiled and unseen in self.watchers:
            self.watchers.remove(unseen)
        self.forget_cycle()

    def cut(self, node_id: int, off: bool) -> None:
        """Take a node off the bus (True), or put it on again: it neither receives nor reaches others."""
        self._cut = self._cut | {node_id} if off else self._cut - {node_id}
        self.note_faults()
        for can_id, ranked in self._ranked.items():
            self._route(can_id, ranked)
        self._adopt_followers(self._ranked_followers)

    def occupy(self, now: float, seconds: float) -> None:
        """Occupy the wire for this long with a stranger's frames of high priority."""
        self._busy_s = max(self._busy_s, now) + seconds
        self.occupied_s += seconds

    def lose_on_way(self, now: float) -> None:
        """Lose the frames that have not arrived by ``now`` s; the times of the answers to a SYNC are known before."""
        self._inbox = [frame for frame in self._inbox if frame[0] <= now]

    def _route(self, can_id: int, ranked: list[tuple[int, Listener]]) -> None:
        super()._route(can_id, [entry for entry in ranked if entry[0] not in self._cut])

    def _adopt_followers(self, ranked: list[tuple[int, SyncFollower]]) -> None:
        super()._adopt_followers([entry for entry in ranked if entry[0] not in self._cut])

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Send a frame of the computer, unless a fault drops it; raises BusLost when the adapter is gone."""
        if self.spoiled and self.connected:
            if self._loses(can_id):
                self._busy_s = max(self._busy_s, now) + self._frame_s[len(data)]
                return
            if self.repeated:
                super().send(can_id, data, now)
        super().send(can_id, data, now)

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Send the frames of a bus cycle; with a fault each frame is checked."""
        if self.spoiled:
            for can_id, data in zip(can_ids, payloads, strict=True):
                self.send(can_id, data, now)
        else:
            super().send_cycle(can_ids, payloads, now)

    def transmit(self, can_id: int, data: bytes, t: float, urgent: bool = False) -> None:
        """Send a node's frame, unless a fault drops it."""
        if self.spoiled:
            if can_id & _NODE in self._cut or self._loses(can_id):
                return
            for part, old in self.frozen.items():
                frozen_id, begin, end = part
                if frozen_id == can_id:
                    self.frozen[part] = old = old or data[begin:end]
                    data = data[:begin] + old + data[end:]
            if self.late_s and can_id & _FUNCTION == o.TPDO1_BASE:
                self._late(can_id, data, t + self.late_s, urgent)
                return
            if self.repeated:
                super().transmit(can_id, data, t, urgent)
        super().transmit(can_id, data, t, urgent)

    def _late(self, can_id: int, data: bytes, t: float, urgent: bool) -> None:
        """Queue a frame for later; a frame that passes ``transmit`` again must not be delayed twice."""
        arrival = t + self._frame_s[len(data)]
        if self.connected:
            insort(self._inbox, (arrival, can_id, data))
            if urgent:
                self._note_urgent(arrival)

    def _loses(self, can_id: int) -> bool:
        if self.silent or can_id in self.lost:
            return True
        if self.loss:
            self._counted += self.loss
            if self._counted >= 1.0:
                self._counted -= 1.0
                return True
        return False


def wire_of(scene: Scene) -> FaultyCanWire:
    """Return the rig's bus. Raises TypeError for a rig that was built without a faulty bus."""
    wire = scene.rig.can
    if not isinstance(wire, FaultyCanWire):
        raise TypeError("bus faults need a rig that was built with FaultyCanWire")
    return wire


@switched
def adapter_gone(scene: Scene, on: bool, now: float) -> None:
    """The computer's CAN adapter is unplugged: every call fails."""
    if on:
        scene.rig.can.disconnect()
    else:
        scene.rig.can.reconnect()


@switched
def bus_silent(scene: Scene, on: bool, now: float) -> None:
    """The bus is off, or cut at the computer: frames vanish and no call fails."""
    wire = wire_of(scene)
    wire.silent = on
    if on:
        wire.lose_on_way(now)
    wire.note_faults()


@switched
def frame_loss(scene: Scene, on: bool, now: float, percent: float) -> None:
    """``percent`` of all frames are lost."""
    wire = wire_of(scene)
    wire.loss = 0.01 * percent if on else 0.0
    wire.note_faults()


@switched
def frames_late(scene: Scene, on: bool, now: float, seconds: float) -> None:
    """The drives' process data reach the computer later by this time, s."""
    wire = wire_of(scene)
    wire.late_s = seconds if on else 0.0
    wire.note_faults()


@switched
def frames_repeated(scene: Scene, on: bool, now: float) -> None:
    """Every frame comes twice."""
    wire = wire_of(scene)
    wire.repeated = on
    wire.note_faults()


@switched
def node_cut(scene: Scene, on: bool, now: float, axis: str) -> None:
    """One drive's bus plug is pulled: it neither receives nor reaches any other node."""
    wire_of(scene).cut(scene.rig.axes[axis].node_id, on)


@switched
def frames_lost(scene: Scene, on: bool, now: float, axis: str, base: int) -> None:
    """Frames to or from one drive are lost: those with the identifier base + node."""
    wire = wire_of(scene)
    lost = {base + scene.rig.axes[axis].node_id}
    wire.lost = wire.lost | lost if on else wire.lost - lost
    wire.note_faults()


ALL: Final = (0, 8)
STATUSWORD, ACTUAL, TORQUE = (0, 2), (2, 6), (6, 8)
"""Bytes of TPDO1 (``drivers.servo_axis``): all of them, and those of each of its data."""


@switched
def data_frozen(
    scene: Scene, on: bool, now: float, axis: str, part: tuple[int, int] = ALL, base: int = o.TPDO1_BASE
) -> None:
    """A drive repeats its last process data, or these bytes of them, for ever."""
    wire = wire_of(scene)
    frozen = (base + scene.rig.axes[axis].node_id, *part)
    if on:
        wire.frozen[frozen] = b""
    else:
        wire.frozen.pop(frozen, None)
    wire.note_faults()


class BusBusy(Effect):
    """A babbling node fills a share of the bus with frames of high priority."""

    __slots__ = ("_at_s", "share")

    every_step = True

    def __init__(self, percent: float) -> None:
        """Take ``percent`` of the time."""
        self.share = 0.01 * percent
        self._at_s = -1.0

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to babble."""
        self._at_s = now

    def renew(self, scene: Scene, now: float) -> None:
        """Take the share of the time since the last step."""
        if now > self._at_s:
            wire_of(scene).occupy(now, self.share * (now - self._at_s))
            self._at_s = now


class SecondMaster(Effect):
    """Another master on the bus sends the same frame again and again."""

    __slots__ = ("_at_s", "axis", "base", "data")

    every_step = True
    PERIOD_S = 0.1

    def __init__(self, base: int, data: bytes, axis: str = "") -> None:
        """Send ``data`` with identifier ``base`` (plus the node of ``axis``)."""
        self.base, self.data, self.axis = base, data, axis

    def begin(self, scene: Scene, now: float) -> None:
        """Send at once."""
        self._at_s = now

    def renew(self, scene: Scene, now: float) -> None:
        """Send the frame when its period has passed."""
        if now >= self._at_s and scene.rig.can.connected:
            self._at_s = now + self.PERIOD_S
            node_id = scene.rig.axes[self.axis].node_id if self.axis else 0
            self.send(scene.rig.can, self.base + node_id, now)

    def send(self, wire: CanWire, can_id: int, now: float) -> None:
        """Put the frame on the wire."""
        wire.inject(can_id, self.data, now)


class EmergencyStorm(SecondMaster):
    """A drive sends the same emergency a hundred times a second."""

    __slots__ = ()

    PERIOD_S = 0.01

    def __init__(self, axis: str, code: int) -> None:
        """Send ``code`` from the drive of ``axis``."""
        super().__init__(o.EMERGENCY_BASE, encode_emergency(code, 1), axis)

    def send(self, wire: CanWire, can_id: int, now: float) -> None:
        """Put the frame on the wire as the drive's own."""
        wire.transmit(can_id, self.data, now, True)
