"""A CANopen node that measures: its channels are numbers in its first transmit PDO."""

from __future__ import annotations

import struct
from collections.abc import Generator
from math import inf, nan
from typing import Final

from drivers.canopen import objects as o
from drivers.canopen.conversation import (
    AwaitedCondition,
    Conversation,
    Reply,
    Request,
    RequestError,
    SdoWrite,
    SendNmt,
    Until,
    read_number,
)
from drivers.canopen.dictionary import describe
from drivers.canopen.node import CanNode
from drivers.canopen.node_config import SIZES, NodeConfig
from drivers.canopen.objects import NmtCommand

BOOT_TIMEOUT_S: Final = 2.0
"""Longest restart of its communication, s: well under a second is usual [A]."""
START_TIMEOUT_S: Final = 1.0
"""Longest time from NMT start to the first OPERATIONAL heartbeat, s [A]."""
STALE_PERIODS: Final = 3.0
"""Number of frames that may be missing before the last one is stale [A]."""
STALE_LEAST_S: Final = 0.5
"""Least age at which a frame is stale, s [A]."""
STALE_INPUTS_S: Final = 0.25
"""The same for a node with digital inputs, s [A]: as that of the drive with the safety inputs."""
CODES: Final = {"bit": "B", "u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f"}


class SensorNode(CanNode):
    """Reads channels: ``values`` in the order of the configuration, in its units; NaN before the first frame."""

    def __init__(self, config: NodeConfig) -> None:
        """Know nothing of the node yet."""
        super().__init__(config.name, config.node_id, config.heartbeat_s)
        self.config = config
        self._fields = [
            (struct.Struct("<" + CODES[one.type]).unpack_from, one.byte, one.scale, one.place)
            for one in config.channels.values()
        ]
        self._least_bytes = max((one.byte + SIZES[one.type] for one in config.channels.values()), default=0)
        inputs = any(one.type == "bit" for one in config.channels.values())
        self.stale_s: float = max(STALE_INPUTS_S if inputs else STALE_LEAST_S, STALE_PERIODS * config.period_s)
        """Age above which a frame is stale, s."""
        self.values: list[float] = [nan] * len(config.channels)

    def fresh(self, now: float) -> bool:
        """Return whether the node is online and its last frame, at ``now`` s, not stale."""
        return self.online and now - self.stamp_s <= self.stale_s

    def on_tpdo1(self, t: float, data: bytes) -> None:
        """Decode the channels; a frame that is too short is counted and ignored."""
        if not self.connected:
            return
        if len(data) < self._least_bytes:
            self.malformed += 1
            return
        for number, (unpack_from, byte, scale, bit) in enumerate(self._fields):
            if bit >= 0:
                self.values[number] = float(data[byte] >> bit & 1)
                continue
            count: float = unpack_from(data, byte)[0]
            self.values[number] = count * scale
        self.tpdo1_data = data
        self.stamp_s = t

    def connect(self) -> Conversation:
        """Return the conversation that resets, checks and starts the node."""
        return _connect(self)

    def begin_connect(self) -> None:
        """Forget the device."""
        self.disconnect()
        self.lost = self.booted = False
        self.nmt_state = -1
        self.stamp_s = -inf
        self.values = [nan] * len(self.values)
        self.refused = None

    def finish_connect(self) -> None:
        """Accept a device that is OPERATIONAL."""
        self.connected = True
        self.online = self.nmt_state == o.NmtState.OPERATIONAL
        self.heartbeat.arm()


def _connect(node: SensorNode) -> Conversation:
    node.begin_connect()
    try:
        yield from _check(node)
        yield SendNmt(NmtCommand.START)
        running = yield Until(AwaitedCondition.OPERATIONAL, START_TIMEOUT_S)
        if not running:
            raise RequestError(f"not OPERATIONAL within {START_TIMEOUT_S:g} s of the start", 0)
        node.finish_connect()
    except RequestError as error:
        node.disconnect()
        node.refused = f"{error}"
        yield SendNmt(NmtCommand.PRE_OPERATIONAL)


def _check(node: SensorNode) -> Generator[Request, Reply, None]:
    """Restart the node's communication, compare its identity, and set its heartbeat."""
    config = node.config
    yield SendNmt(NmtCommand.RESET_COMMUNICATION)
    booted = yield Until(AwaitedCondition.BOOTED, BOOT_TIMEOUT_S)
    if not booted:
        yield from read_number(o.DEVICE_TYPE)  # the boot-up message can be missed; an answer cannot
    for sub, expected in ((1, config.vendor_id), (2, config.product_code)):
        if expected:
            found = yield from read_number(o.IDENTITY, sub)
            if found != expected:
                difference = f"{describe(o.IDENTITY, sub)}: read 0x{found:08X}, the configuration has 0x{expected:08X}"
                raise RequestError(f"{difference}: another device", 0)
    yield SdoWrite(o.PRODUCER_HEARTBEAT, 0, round(1000.0 * config.heartbeat_s))
