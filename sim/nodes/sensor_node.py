"""A simulated CANopen node that measures: it sends its first transmit PDO in a fixed period while OPERATIONAL."""

from __future__ import annotations

import struct
from collections.abc import Mapping

from drivers.canopen import objects as o
from drivers.canopen.node_config import NodeConfig
from drivers.canopen.sensor_node import CODES
from sim.nodes.canopen_device import OPERATIONAL, CanopenDevice
from sim.nodes.object_store import ObjectStore
from sim.wires.can_traffic import Beat
from sim.wires.can_wire import CanWire

BOOT_S = 0.3
"""Time from power to the boot-up message, s [A]."""
TURNAROUND_S = 0.001
"""Time from an SDO request to its answer, s [A]."""


class SimulatedSensorNode(CanopenDevice):
    """A node with the channels of a configuration; ``show`` sets their values."""

    __slots__ = ("_frame", "config")

    def __init__(self, config: NodeConfig, wire: CanWire) -> None:
        """Switch the node on at time 0."""
        values: dict[tuple[int, int], int | str] = {}
        for sub, known in ((1, config.vendor_id), (2, config.product_code)):
            if known:
                values[o.IDENTITY, sub] = known
        for number, base in enumerate((o.TPDO1_BASE, o.TPDO2_BASE)):
            values[o.TPDO_COMMUNICATION + number, 1] = o.COB_INVALID | o.COB_NO_RTR | base + config.node_id
        self.config = config
        self._frame = Beat(o.TPDO1_BASE + config.node_id, bytes(8), config.period_s)
        super().__init__(wire, ObjectStore(config.node_id, values), BOOT_S, TURNAROUND_S, 0.0)
        self.show({})
        self.power(True)

    def show(self, values: Mapping[str, float]) -> None:
        """Set these channels from now on, in their units; the others stay as configured."""
        data = bytearray(8)
        for name, channel in self.config.channels.items():
            count = values.get(name, channel.simulated) / channel.scale
            if channel.type == "bit":
                data[channel.byte] |= int(count > 0.5) << channel.bit
                continue
            layout = struct.Struct("<" + CODES[channel.type])
            layout.pack_into(data, channel.byte, count if channel.type == "f32" else round(count))
        self._frame.data = bytes(data)

    def _enter(self, nmt: int, t: float) -> None:
        before = self.nmt
        super()._enter(nmt, t)
        if nmt != before:
            self.wire.unbeat(self._frame, t)
            if nmt == OPERATIONAL:
                self.wire.beat(self._frame, t + self.config.period_s)
