"""Process data on CAN: encode and decode beside PyPI canopen, and a cycle of five axes beside the raw transport."""

from __future__ import annotations

import struct
from collections.abc import Callable
from importlib import import_module
from typing import Any

from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most, ratio, unavailable
from bench.live import SLIDING_RECIPE, LiveRun, live_run
from bench.stopwatch import cpu_us_per
from drivers.canopen import objects as o
from drivers.canopen.pdo import RPDO1_VELOCITY, TPDO1_VELOCITY
from drivers.ports import CanFrame, FrameByFrame

PDO_LIMIT = 0.2
"""Limit for encoding and decoding process data, beside PyPI canopen."""

NODE = 5
STATUSWORD = 0x1637
TPDO1 = struct.Struct("<Hih").pack
CHANNEL = "bench"


def measure(effort: Effort) -> list[Figure]:
    """Return us for one RPDO and one TPDO of an axis, ours and canopen's, and for a cycle of five axes."""
    count = effort.pick(50_000, 5_000)
    with live_run(SLIDING_RECIPE) as live:
        live.slide(0.0)
        figures = _pdo(live, count, effort.runs)
        return figures + _cycle(live, effort.pick(20_000, 2_000), effort.runs)


# One axis ------------------------------------------------------------------------------------------------------


def _pdo(live: LiveRun, count: int, runs: int) -> list[Figure]:
    codec = [cpu_us_per(_codec, count) for _ in range(runs)]
    name = "PDO encode + decode"
    figures = [Figure(f"{name}: codec", "us", tuple(codec))]
    peer = canopen_pdo()
    drive = _axis(live)
    driver: list[float] = []
    theirs: list[float] = []
    for _ in range(runs):
        driver.append(cpu_us_per(drive, count))
        if peer is not None:
            theirs.append(cpu_us_per(peer, count // 10))
    figures.append(Figure(f"{name}: driver", "us", tuple(driver), note="engineering units, limits, state machine"))
    if peer is None:
        return [*figures, unavailable(f"{name}: driver / canopen", "x", "canopen is not installed")]
    return [
        *figures,
        Figure(f"{name}: canopen", "us", tuple(theirs), note="PyPI canopen, variables by name"),
        ratio(f"{name}: codec / canopen", codec, theirs, at_most(PDO_LIMIT)),
        ratio(f"{name}: driver / canopen", driver, theirs, at_most(PDO_LIMIT)),
    ]


def _codec(count: int) -> None:
    pack, unpack = RPDO1_VELOCITY.pack, TPDO1_VELOCITY.unpack
    data = TPDO1(STATUSWORD, 1000, 100)
    for i in range(count):
        pack(0x0F, i)
        unpack(data)


def _axis(live: LiveRun) -> Callable[[int], None]:
    """Return a loop in which one axis' target changes, its RPDO leaves, and a TPDO with another speed comes."""
    drive = live.engine.devices.axes.wheel
    replies = [TPDO1(drive.statusword, 1000 + i, 100) for i in range(2)]
    speed = drive.target

    def loop(count: int) -> None:
        t = drive.stamp_s
        for i in range(count):
            drive.target = speed + (i & 7) * 1e-3
            drive.emit(True)
            drive.on_tpdo1(t, replies[i & 1])

    return loop


def canopen_pdo() -> Callable[[int], None] | None:
    """Return the same with PyPI canopen: variables of its PDO maps set and read; None where it is not installed."""
    try:
        canopen: Any = import_module("canopen")
    except ImportError:
        return None
    from importlib.resources import files

    eds = files("drivers.profiles") / "cia402_servo.eds"
    node = canopen.RemoteNode(NODE, str(eds))
    network = canopen.Network()
    network.add_node(node)
    rpdo, tpdo = node.rpdo[1], node.tpdo[1]
    rpdo.clear()
    for index in (o.CONTROLWORD, o.TARGET_VELOCITY):
        rpdo.add_variable(index)
    tpdo.clear()
    for index in (o.STATUSWORD, o.VELOCITY_ACTUAL, o.TORQUE_ACTUAL):
        tpdo.add_variable(index)
    tpdo.cob_id = o.TPDO1_BASE + NODE
    command, target = rpdo.map
    status, speed, torque = tpdo.map
    replies = [TPDO1(STATUSWORD, 1000 + i, 100) for i in range(2)]

    def loop(count: int) -> None:
        for i in range(count):
            command.raw = 0x0F
            target.raw = i
            bytes(rpdo.data)
            tpdo.on_message(tpdo.cob_id, bytearray(replies[i & 1]), 0.0)
            _ = status.raw, speed.raw, torque.raw

    loop(1)
    if (status.raw, speed.raw, torque.raw) != (STATUSWORD, 1000, 100):
        raise TopicFailedError("canopen decodes something else")
    return loop


# Five axes -----------------------------------------------------------------------------------------------------


class MemoryPort(FrameByFrame):
    """A CAN port without a wire: the drives' answers are ready when the computer asks."""

    def __init__(self, answers: list[list[CanFrame]]) -> None:
        """Answer with these, in turn."""
        self.answers = answers
        self.turn = 0
        self.sent = 0

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Count a frame."""
        self.sent += 1

    def receive(self, now: float) -> list[CanFrame]:
        """Return the next answers."""
        self.turn ^= 1
        return self.answers[self.turn]


def _cycle(live: LiveRun, count: int, runs: int) -> list[Figure]:
    master = live.engine.devices.master
    drives = live.engine.devices.drives
    t = live.now
    answers = [
        [(t, o.TPDO1_BASE + drive.node_id, TPDO1(drive.statusword, 1000 + change, 100)) for drive in drives]
        for change in range(2)
    ]
    moving = [drive for drive in drives if drive.config.mode == "velocity"]
    targets = [drive.target for drive in moving]

    def ours(port: Any) -> Callable[[int], None]:
        def loop(times: int) -> None:
            for i in range(times):
                for drive, target in zip(moving, targets, strict=True):
                    drive.target = target + (i & 7) * 1e-3
                master.scan(port, t)
                master.feed(port.receive(t), t)

        return loop

    def raw(port: Any) -> Callable[[int], None]:
        ids = [(drive.rpdo1_id, b"\x0f\x00\x00\x00\x00\x00") for drive in drives] + [(o.SYNC_ID, b"")]

        def loop(times: int) -> None:
            for _ in range(times):
                for can_id, data in ids:
                    port.send(can_id, data, t)
                port.receive(t)

        return loop

    memory = MemoryPort(answers)
    figures = _compared("cycle of five axes, in memory", ours(memory), raw(memory), count, runs)
    with _VirtualBus(answers) as bus:
        figures += _compared("cycle of five axes, python-can virtual bus", ours(bus), raw(bus), count // 10, runs)
    return figures


def _compared(
    name: str, ours: Callable[[int], None], raw: Callable[[int], None], count: int, runs: int
) -> list[Figure]:
    driven: list[float] = []
    bare: list[float] = []
    for _ in range(runs):
        driven.append(cpu_us_per(ours, count))
        bare.append(cpu_us_per(raw, count))
    return [
        Figure(f"{name}: our drivers", "us", tuple(driven), note="6 frames out, 5 in"),
        Figure(f"{name}: raw frames", "us", tuple(bare)),
        ratio(f"{name}: drivers / raw", driven, bare),
    ]


class _VirtualBus(FrameByFrame):
    """python-can's bus in this process: the computer's frames are read from it, the drives' answers written to it."""

    def __init__(self, answers: list[list[CanFrame]]) -> None:
        import can

        self.turn = 0
        self.message = can.Message
        self.pc = can.Bus(interface="virtual", channel=CHANNEL, ignore_config=True)
        self.rig = can.Bus(interface="virtual", channel=CHANNEL, ignore_config=True)
        self.answers = [
            [can.Message(arbitration_id=can_id, data=data, is_extended_id=False) for _, can_id, data in one]
            for one in answers
        ]

    def __enter__(self) -> _VirtualBus:
        return self

    def __exit__(self, *_: object) -> None:
        self.pc.shutdown()
        self.rig.shutdown()

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Send a frame, and receive it at the rig's end."""
        self.pc.send(self.message(arbitration_id=can_id, data=data, is_extended_id=False, check=False))
        self.rig.recv(0.0)

    def receive(self, now: float) -> list[CanFrame]:
        """Let the drives answer, and receive the answers."""
        self.turn ^= 1
        found: list[CanFrame] = []
        for message in self.answers[self.turn]:
            self.rig.send(message)
        for _ in self.answers[self.turn]:
            message = self.pc.recv(0.0)
            if message is None:
                raise TopicFailedError("the virtual bus lost a frame")
            found.append((now, message.arbitration_id, bytes(message.data)))
        return found
