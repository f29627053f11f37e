"""The edge to real CAN adapters: a python-can bus as a CanPort.

It owns its receive loop (python-can's own Notifier loses errors, hardbyte/python-can#1865), stamps the frames that
come in, never blocks the caller, and turns any end of reception into BusLost, for good. After bus-off
old set-points may still be in the queues of a bus: so it is opened anew, deliberately,
and never restarted.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from threading import Thread
from typing import TYPE_CHECKING, Any, Final

from drivers.canopen import objects as o
from drivers.ports import BusLost, CanFrame, FrameByFrame
from drivers.transports import slcan, socketcand
from drivers.transports.own_frames import OwnFrames

if TYPE_CHECKING:
    import can

POLL_S = 0.1
"""Time that the receive thread waits for a frame before it checks whether the port was closed, s."""
MAX_WAITING = 20_000
"""Frames kept until the caller reads them: over 2 s of a full bus at 1 Mbit/s. More means that no caller reads."""
BUS_OFF: Final = 0x40
"""Class bit of a SocketCAN error frame (linux/can/error.h, CAN_ERR_BUSOFF)."""
_CLASSES: Final = {
    0x001: "transmit time-out", 0x002: "lost arbitration", 0x004: "controller", 0x008: "protocol violation",
    0x010: "transceiver", 0x020: "no acknowledgement", BUS_OFF: "bus-off", 0x080: "bus error", 0x100: "restarted",
    0x200: "error counters",
}  # fmt: skip
"""Class bits of a SocketCAN error frame (linux/can/error.h)."""
_BY_CLASS: Final = ("socketcan", socketcand.INTERFACE)
"""Interfaces whose error frames have these bits; in those of others the bits depend on the maker."""
_FUNCTION = 0x780
_BOOT_UP = bytes((o.NmtState.BOOT_UP,))
_STATE_LOW, _STATE_HIGH = 0x7F, 0x22
"""Statusword bits of a drive's state, voltage, remote control and deviation, by bytes (CiA 402-2)."""


class PythonCanPort(FrameByFrame):
    """A CanPort over an open python-can bus.

    ``clock`` returns the arrival times, in seconds of the caller's clock; the receive thread calls it.
    Without a clock a frame's arrival is the ``now`` of the ``receive`` that returns it. The receive thread also calls
    ``on_urgent`` when a scan should not wait for an arrived frame: an emergency, a boot-up, changed
    inputs (TPDO2), or a TPDO1 whose first word, the statusword, shows another state than before. ``ignored``
    counts frames of foreign kinds: remote, 29-bit and FD frames; ``errors`` counts error frames by kind. Frames
    of other programs on this computer count as frames from the wire (``local`` counts those that the interface marks as
    sent here). Our own frames, which some interfaces return, do not count (``own`` finds out whether this one does).
    """

    def __init__(
        self,
        bus: can.BusABC,
        clock: Callable[[], float] | None = None,
        on_urgent: Callable[[], None] | None = None,
        name: str = "the interface",
    ) -> None:
        import can

        super().__init__()
        self.name = name
        self._interface = name.partition(" ")[0]
        self._bus = bus
        self._clock = clock
        self._on_urgent = on_urgent
        self._states: dict[int, tuple[int, int]] = {}
        self._inputs: dict[int, bytes] = {}
        self._message = can.Message
        self._errors = (can.CanError, OSError, ValueError)
        self._frames: deque[CanFrame] = deque()
        self._lost: str | None = None
        self._closing = False
        self.ignored = 0
        self.errors: dict[str, int] = {}
        self.local = 0
        self.own = OwnFrames(b"echo" + os.urandom(4))
        self._thread = Thread(target=self._run, name="can-receive", daemon=True)
        self._thread.start()

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Hand one data frame to the adapter; raises BusLost, also if its transmit queue is full."""
        self._check()
        if self.own.probe is not None:
            self._hand_over(*self.own.probe, now)
        self._hand_over(can_id, data, now)

    def _hand_over(self, can_id: int, data: bytes, now: float) -> None:
        message = self._message(arbitration_id=can_id, data=data, is_extended_id=False, check=False)
        try:
            self._bus.send(message, timeout=0)
        except self._errors as error:
            self._lose(f"sending failed: {error}")
            self._check()
        self.own.sent(can_id, data, now)
        self.tell_sent(can_id, data, now)

    def receive(self, now: float) -> list[CanFrame]:
        """Return the frames that arrived up to ``now``, oldest first; raises BusLost once none are left."""
        frames = self._frames
        taken: list[CanFrame] = []
        stamped = self._clock is not None
        while frames and (not stamped or frames[0][0] <= now):
            t, can_id, data = frames.popleft()
            taken.append((t if stamped else now, can_id, data))
        if not taken:
            self._check()
        if self.own.echoes is not False or taken:
            taken = self.own.others(taken, now)
            if self.own.trouble:
                self._lose(f"{self.name} cannot be used: {self.own.trouble}")
                self._check()
        self.tell_received(taken)
        return taken

    @property
    def state(self) -> str:
        """State of the adapter: active, passive or error; "" if its interface does not report it."""
        return adapter_state(self._bus)

    def close(self) -> None:
        """Stop receiving and close the adapter; the port is lost afterwards."""
        self._closing = True
        self._thread.join(timeout=10 * POLL_S)
        with suppress(*self._errors):  # an adapter that is gone cannot close its channel
            self._bus.shutdown()
        self._lose("closed")

    def _check(self) -> None:
        if self._lost is not None:
            raise BusLost(f"CAN bus lost: {self._lost}")

    def _lose(self, reason: str) -> None:
        if self._lost is None:
            self._lost = reason

    def _run(self) -> None:
        """Receive until closed; however the loop ends, the bus is lost afterwards."""
        reason = "the receive thread failed"     # default, for undocumented exceptions of an adapter's driver
        try:
            while not self._closing:
                message = self._bus.recv(POLL_S)
                if message is None:
                    if socketcand.ended(self._bus):
                        reason = "the other side closed the connection"
                        return
                elif not self._accept(message):
                    reason = "bus-off" if message.is_error_frame else "received frames are not collected"
                    return
            reason = "closed"
        except self._errors as error:
            reason = f"receiving failed: {error}"
        finally:
            self._lose(reason)
            if self._on_urgent is not None:
                self._on_urgent()

    def _accept(self, message: can.Message) -> bool:
        """Queue a data frame; return False if the bus can no longer be used."""
        if message.is_error_frame:
            for kind in error_kinds(self._interface, message.arbitration_id):
                self.errors[kind] = self.errors.get(kind, 0) + 1
            return not message.arbitration_id & BUS_OFF
        if message.is_extended_id or message.is_remote_frame or message.is_fd:
            self.ignored += 1
            return True
        self.local += not message.is_rx
        t = self._clock() if self._clock is not None else 0.0
        can_id, data = message.arbitration_id, bytes(message.data)
        self._frames.append((t, can_id, data))
        if self._on_urgent is not None and self._is_urgent(can_id, data):
            self._on_urgent()
        return len(self._frames) <= MAX_WAITING

    def _is_urgent(self, can_id: int, data: bytes) -> bool:
        function = can_id & _FUNCTION
        if function == o.TPDO1_BASE and len(data) >= 2:
            state = (data[0] & _STATE_LOW, data[1] & _STATE_HIGH)
            changed = self._states.get(can_id) != state
            self._states[can_id] = state
            return changed
        if function == o.HEARTBEAT_BASE:
            return data == _BOOT_UP
        if function == o.TPDO2_BASE:
            known = self._inputs.get(can_id) == data      # repeated by its timer
            self._inputs[can_id] = data
            return not known
        return function == o.EMERGENCY_BASE and can_id != o.SYNC_ID


def open_can(interface: str, channel: str, bitrate: int, clock: Callable[[], float] | None = None,
             on_urgent: Callable[[], None] | None = None) -> PythonCanPort:
    """Open an adapter by python-can's interface and channel names, ``bitrate`` in bit/s; raises BusLost.

    The channel of a socketcand server is ``bus@host:port``. ``clock`` and ``on_urgent``: see PythonCanPort.
    """
    import can

    settings: dict[str, Any] = {"channel": channel, "bitrate": bitrate}
    try:
        if interface == socketcand.INTERFACE:
            settings |= socketcand.settings_of(channel)
        elif interface == slcan.INTERFACE:
            settings |= slcan.settings()
        bus = can.Bus(interface=interface, ignore_config=True, **settings)
    except (can.CanError, OSError, ValueError, ImportError, NotImplementedError) as error:
        raise BusLost(f"cannot open {interface} {channel}: {error}") from error
    socketcand.tune(bus)
    slcan.tune(bus)
    return PythonCanPort(bus, clock, on_urgent, f"{interface} {channel}")


def error_kinds(interface: str, can_id: int) -> tuple[str, ...]:
    """Return the kinds of error that an error frame with this identifier reports."""
    found = tuple(text for bit, text in _CLASSES.items() if can_id & bit) if interface in _BY_CLASS else ()
    return found or ("error",)


def adapter_state(bus: can.BusABC) -> str:
    """Return an adapter's state in lower case: active, passive or error; "" if its interface does not report it."""
    import can

    if type(bus).state is can.BusABC.state:  # the base class always reports ACTIVE
        return ""
    try:
        return bus.state.name.lower()
    except (can.CanError, OSError, NotImplementedError, ValueError, AttributeError):
        return ""
