"""Conversations with a device in many steps: each is a generator that the master runs.

A conversation yields one request at a time and receives the reply: the value read (SdoRead), True or False
(Until: whether the condition came true in time), else None. A failed SDO request raises RequestError in it.
Generators cannot be copied: a conversation has ended before the drivers are copied.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass
from enum import Enum, auto
from typing import Protocol

from drivers.canopen import objects as o
from drivers.canopen.dictionary import KNOWN, describe
from drivers.canopen.messages import encode_nmt
from drivers.canopen.objects import DataType, NmtCommand
from drivers.canopen.sdo import SdoClient, SdoError

POLL_S = 0.002
"""Longest time until the master wants to be served again while an SDO reply is outstanding: a pair of frames takes
0.54 ms on the wire at 500 kbit/s, 2.2 ms at 125 kbit/s."""


class AwaitedCondition(Enum):
    """Conditions that a conversation can wait for; the drive answers whether one holds."""

    BOOTED = auto()              # boot-up message received since the reset
    OPERATIONAL = auto()         # heartbeat reports OPERATIONAL
    DISABLED = auto()            # SWITCH_ON_DISABLED or a fault: power is off
    ENABLED = auto()             # OPERATION_ENABLED
    HOMING_ENDED = auto()        # homing done, failed or interrupted


@dataclass(frozen=True, slots=True)
class SdoRead:
    """Read an object; ``type`` is needed only for objects outside the dictionary."""

    index: int
    sub: int = 0
    type: DataType | None = None


@dataclass(frozen=True, slots=True)
class SdoWrite:
    """Write an object; ``type`` is needed only for objects outside the dictionary."""

    index: int
    sub: int
    value: int | str
    type: DataType | None = None


@dataclass(frozen=True, slots=True)
class SendNmt:
    """Send an NMT command to this drive alone."""

    command: NmtCommand


@dataclass(frozen=True, slots=True)
class Until:
    """Wait until a condition holds, ``timeout_s`` at most."""

    condition: AwaitedCondition
    timeout_s: float


@dataclass(frozen=True, slots=True)
class Pause:
    """Let ``seconds`` pass."""

    seconds: float


Request = SdoRead | SdoWrite | SendNmt | Until | Pause
Reply = int | str | bool | None
Conversation = Generator[Request, Reply, None]


class RequestError(Exception):
    """An SDO request failed; the text names object, value and reason. ``code`` is the abort code."""

    def __init__(self, text: str, code: int) -> None:
        super().__init__(text)
        self.code = code


class Peer(Protocol):
    """The interface of a device that a conversation needs."""

    @property
    def node_id(self) -> int:
        """CANopen node id, 1..127."""
        ...

    def holds(self, condition: AwaitedCondition) -> bool:
        """Whether a condition is true now."""
        ...


Send = Callable[[int, bytes], None]


def _type_of(request: SdoRead | SdoWrite) -> DataType:
    if request.type is not None:
        return request.type
    return KNOWN[(request.index, request.sub)].type


class Dialogue:
    """One conversation with one device: turns its requests into frames and replies into results.

    ``due`` is the latest time (s) of the next call of ``step``.
    """

    def __init__(self, peer: Peer, conversation: Conversation, sdo_timeout_s: float) -> None:
        self._peer = peer
        self._conversation = conversation
        self._sdo = SdoClient(sdo_timeout_s)
        self._inbox: list[bytes] = []
        self._request: Request | None = None     # None: not begun
        self._until = math.inf
        self.due = -math.inf
        self.ended = False

    def receive(self, data: bytes) -> None:
        """Take one SDO reply that arrived for this device."""
        self._inbox.append(data)

    def step(self, now: float, send: Send) -> None:
        """Continue as far as the replies allow; ``send`` takes identifier and data."""
        if self._request is None:
            self._resume(None, now, send)
        while not self.ended and self._advance(now, send):
            pass

    def close(self) -> None:
        """End the conversation at its present step."""
        self.ended = True
        self._conversation.close()

    def _advance(self, now: float, send: Send) -> bool:
        """Handle the pending request; False where something must arrive or time pass first."""
        request = self._request
        if isinstance(request, SdoRead | SdoWrite):
            return self._advance_sdo(request, now, send)
        if isinstance(request, Until):
            holds = self._peer.holds(request.condition)
            if not holds and now < self._until:
                self.due = self._until
                return False
            self._resume(holds, now, send)
            return True
        if isinstance(request, Pause) and now < self._until:
            self.due = self._until
            return False
        self._resume(None, now, send)
        return True

    def _advance_sdo(self, request: SdoRead | SdoWrite, now: float, send: Send) -> bool:
        sdo = self._sdo
        frame = sdo.feed(self._inbox.pop(0), now) if self._inbox else sdo.expire(now)
        if frame is not None:
            send(o.SDO_REQUEST_BASE + self._peer.node_id, frame)
        if sdo.busy:
            self.due = min(sdo.due, now + POLL_S)
            return bool(self._inbox)
        if sdo.error is not None:
            self._fail(request, sdo.error, now, send)
        elif isinstance(request, SdoWrite):
            self._resume(None, now, send)
        else:
            try:
                value = o.decode(_type_of(request), sdo.result)
            except ValueError as error:
                self._fail(request, SdoError(0, str(error)), now, send)
            else:
                self._resume(value, now, send)
        return True

    def _fail(self, request: SdoRead | SdoWrite, error: SdoError, now: float, send: Send) -> None:
        action = f"write of {request.value}" if isinstance(request, SdoWrite) else "read"
        text = f"{describe(request.index, request.sub)}: {action} failed: {error}"
        try:
            following = self._conversation.throw(RequestError(text, error.code))
        except StopIteration:
            self.ended = True
        else:
            self._begin(following, now, send)

    def _resume(self, reply: Reply, now: float, send: Send) -> None:
        try:
            following = self._conversation.send(reply)
        except StopIteration:
            self.ended = True
        else:
            self._begin(following, now, send)

    def _begin(self, request: Request, now: float, send: Send) -> None:
        self._request = request
        self._inbox.clear()      # a message from before the request is no reply to it
        if isinstance(request, SdoRead):
            send(o.SDO_REQUEST_BASE + self._peer.node_id, self._sdo.upload(request.index, request.sub, now))
        elif isinstance(request, SdoWrite):
            data = o.encode(_type_of(request), request.value)
            frame = self._sdo.download(request.index, request.sub, data, now)
            send(o.SDO_REQUEST_BASE + self._peer.node_id, frame)
        elif isinstance(request, SendNmt):
            send(o.NMT_ID, encode_nmt(request.command, self._peer.node_id))
        elif isinstance(request, Until):
            self._until = now + request.timeout_s
        else:
            self._until = now + request.seconds


def read_number(index: int, sub: int = 0, kind: DataType | None = None) -> Generator[Request, Reply, int]:
    """Read an integer object, of type ``kind`` where it is not in the dictionary; raises RequestError."""
    value = yield SdoRead(index, sub, kind)
    if not isinstance(value, int):
        raise RequestError(f"{describe(index, sub)}: a number was expected, {value!r} was read", 0)
    return value
