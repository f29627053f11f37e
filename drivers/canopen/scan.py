"""Read objects of many nodes at once, without a clock or a port of its own: the base of a survey of a bus.

Nothing is written and no NMT command is sent. Nodes are asked by SDO alone, because every state but STOPPED answers it
(CiA 301, table 37).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from drivers.canopen import objects as o
from drivers.canopen.dictionary import KNOWN, describe
from drivers.canopen.sdo import NO_OBJECT, NO_SUB_INDEX, TIMED_OUT, SdoClient
from drivers.ports import CanFrame, CanPort

Key = tuple[int, int]
"""Index and sub-index."""

ANSWER_S: Final = 0.1
"""A node without an answer after this time is absent, s: servers answer within some milliseconds [A]."""
PATIENCE_S: Final = 0.5
"""Longest wait for a node that should be present, s: a busy computer may see an answer 0.1 s late."""
AT_ONCE: Final = 4
"""Nodes asked at the same time: a SocketCAN interface queues ten frames by default (txqueuelen)."""
_FUNCTION: Final = 0x780
_NODE: Final = 0x07F


@dataclass(frozen=True, slots=True)
class ObjectAnswer:
    """A node's answer to the upload of an object: its bytes, or the reason for none (``code``: of the abort)."""

    key: Key
    data: bytes = b""
    error: str = ""
    code: int = 0

    @property
    def ok(self) -> bool:
        """Whether the value came."""
        return not self.error

    @property
    def silent(self) -> bool:
        """Whether no reply came in time."""
        return self.code == TIMED_OUT

    @property
    def missing(self) -> bool:
        """Whether the node reports that it has no such object."""
        return self.code in (NO_OBJECT, NO_SUB_INDEX)

    @property
    def number(self) -> int | None:
        """The value as a number: by its type in the dictionary, else unsigned; None if it is no number."""
        if self.error or not 1 <= len(self.data) <= 4:
            return None
        entry = KNOWN.get(self.key)
        if entry is not None and entry.type in o.CODEC and len(self.data) == o.CODEC[entry.type].size:
            value = o.decode(entry.type, self.data)
            return value if isinstance(value, int) else None
        return int.from_bytes(self.data, "little")

    @property
    def text(self) -> str:
        """The value for people: a text, a number, or bytes."""
        entry = KNOWN.get(self.key)
        if entry is not None and entry.type is o.DataType.TEXT:
            return self.data.rstrip(b"\0").decode("latin-1")
        number = self.number
        return self.data.hex(" ") if number is None else str(number)

    def describe(self) -> str:
        """Return the object's name."""
        return describe(*self.key) if self.key in KNOWN else f"0x{self.key[0]:04X}:{self.key[1]:02X}"


class _Node:
    """The questions to one node, in order."""

    def __init__(self, wanted: Sequence[Key], timeout_s: float) -> None:
        self.wanted = list(wanted)
        self.client = SdoClient(timeout_s)
        self.answers: dict[Key, ObjectAnswer] = {}
        self.surplus = 0
        self.timeouts = 0


class SdoScan:
    """Uploads objects from nodes: pass arrivals to ``feed`` and call ``service`` until ``done``.

    A node that does not answer the first question is not asked the others. ``surplus`` counts unexpected
    answers: two nodes of one number answer every question twice.
    """

    def __init__(self, wanted: Mapping[int, Sequence[Key]], timeout_s: float = ANSWER_S) -> None:
        """Plan the uploads: ``wanted`` holds objects by node id (1..127); ``timeout_s`` is for each answer."""
        self._nodes = {node: _Node(keys, timeout_s) for node, keys in wanted.items()}
        self._waiting = [node for node, keys in wanted.items() if keys]
        self._asked: list[int] = []

    @property
    def done(self) -> bool:
        """Whether every question has its answer."""
        return not self._waiting and not self._asked

    @property
    def answers(self) -> dict[int, dict[Key, ObjectAnswer]]:
        """The answers by node, of the nodes that gave any."""
        return {
            number: node.answers
            for number, node in self._nodes.items()
            if any(not answer.silent for answer in node.answers.values())
        }

    @property
    def surplus(self) -> dict[int, int]:
        """Number of surplus answers by node, of the nodes that sent any; an answer that came late does not count."""
        found = {number: node.surplus - node.timeouts for number, node in self._nodes.items()}
        return {number: times for number, times in found.items() if times > 0}

    def feed(self, frames: Sequence[CanFrame], port: CanPort, now: float) -> None:
        """Take the frames that arrived up to ``now`` s; raises BusLost."""
        for _, can_id, data in frames:
            if can_id & _FUNCTION == o.SDO_REPLY_BASE and (node := self._nodes.get(can_id & _NODE)) is not None:
                before = node.client.ignored
                following = node.client.feed(data, now)
                node.surplus += node.client.ignored - before
                if following is not None:
                    port.send(o.SDO_REQUEST_BASE + (can_id & _NODE), following, now)
                self._go_on(can_id & _NODE, port, now)

    def service(self, port: CanPort, now: float) -> None:
        """Send the next requests; abort those that are overdue at ``now`` s. Raises BusLost."""
        for number in list(self._asked):
            abort = self._nodes[number].client.expire(now)
            if abort is not None:
                port.send(o.SDO_REQUEST_BASE + number, abort, now)
            self._go_on(number, port, now)
        while self._waiting and len(self._asked) < AT_ONCE:
            number = self._waiting.pop(0)
            self._asked.append(number)
            self._ask(number, port, now)

    def _ask(self, number: int, port: CanPort, now: float) -> None:
        node = self._nodes[number]
        port.send(o.SDO_REQUEST_BASE + number, node.client.upload(*node.wanted[0], now), now)

    def _go_on(self, number: int, port: CanPort, now: float) -> None:
        """Take the answer of a node, if it is complete, and ask the next question."""
        node = self._nodes[number]
        if number not in self._asked or node.client.busy:
            return
        key = node.wanted.pop(0)
        error = node.client.error
        if error is None:
            answer = ObjectAnswer(key, node.client.result)
        else:
            answer = ObjectAnswer(key, b"", str(error), error.code)
        node.timeouts += answer.silent
        first = not node.answers
        node.answers[key] = answer
        if not node.wanted or (first and answer.silent):
            self._asked.remove(number)
        else:
            self._ask(number, port, now)
