"""Records of live wires, replayed to the drivers: ports whose other side repeats its recorded answers.

A record is a folder as `tester bus record` and `tester run --bus-log` write it: ``can.log`` (candump) and
``modbus-NAME.log``. Requests (SDO, Modbus) are answered when they are made again, after the time that the answer took
then; a request that the record does not have is noted in ``unknown`` and stays without an answer. Everything else comes
at the times of the record.
"""

from __future__ import annotations

from collections import defaultdict, deque
from pathlib import Path

import can

from drivers.ports import CanFrame, FrameByFrame, WatchedLine

_SDO_REQUEST, _SDO_REPLY, _FUNCTION, _NODE = 0x600, 0x580, 0x780, 0x7F


class RecordedCan(FrameByFrame):
    """A recorded CAN bus."""

    def __init__(self, path: Path) -> None:
        """Read a candump log."""
        super().__init__()
        self.unknown: list[tuple[int, bytes]] = []
        self._answers: dict[tuple[int, bytes], deque[tuple[float, bytes]]] = defaultdict(deque)
        self._frames: list[CanFrame] = []
        asked: dict[int, tuple[float, tuple[int, bytes]]] = {}
        for message in can.CanutilsLogReader(path):
            t, can_id, data = message.timestamp, message.arbitration_id, bytes(message.data)
            node = can_id & _NODE
            if can_id & _FUNCTION == _SDO_REQUEST:
                asked[node] = (t, (can_id, data))
            elif can_id & _FUNCTION == _SDO_REPLY and node in asked:
                then, request = asked.pop(node)
                self._answers[request].append((t - then, data))
            elif message.is_rx:
                self._frames.append((t, can_id, data))
        self._frames.sort()

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Take a frame: an SDO request gets its recorded answer."""
        self.tell_sent(can_id, data, now)
        if can_id & _FUNCTION != _SDO_REQUEST:
            return
        answers = self._answers.get((can_id, bytes(data)))
        if not answers:
            self.unknown.append((can_id, bytes(data)))
            return
        took_s, answer = answers.popleft() if len(answers) > 1 else answers[0]
        self._frames.append((now + took_s, _SDO_REPLY | can_id & _NODE, answer))
        self._frames.sort()

    def receive(self, now: float) -> list[CanFrame]:
        """Return what arrived up to ``now`` s."""
        arrived = [frame for frame in self._frames if frame[0] <= now]
        self._frames = self._frames[len(arrived) :]
        self.tell_received(arrived)
        return arrived


class RecordedLine(WatchedLine):
    """A recorded Modbus line."""

    def __init__(self, path: Path) -> None:
        """Read a log of one line."""
        super().__init__()
        self.unknown: list[bytes] = []
        self._answers: dict[bytes, deque[tuple[float, bytes]]] = defaultdict(deque)
        self._arriving: list[tuple[float, bytes]] = []
        asked: tuple[float, bytes] | None = None
        for line in path.read_text(encoding="utf-8").splitlines():
            stamp, direction, text = line.split(" ", 2)
            t, data = float(stamp.strip("()")), bytes.fromhex(text)
            if direction == "TX":
                asked = (t, data)
            elif asked is not None:
                self._answers[asked[1]].append((t - asked[0], data))

    def write(self, data: bytes, now: float) -> None:
        """Take a request: it gets its recorded answer; the last answer repeats."""
        self.tell(now, data, True)
        answers = self._answers.get(data)
        if not answers:
            self.unknown.append(data)
            return
        took_s, answer = answers.popleft() if len(answers) > 1 else answers[0]
        self._arriving.append((now + took_s, answer))

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return what arrived up to ``now`` s."""
        arrived = [chunk for chunk in self._arriving if chunk[0] <= now]
        self._arriving = [chunk for chunk in self._arriving if chunk[0] > now]
        return arrived
