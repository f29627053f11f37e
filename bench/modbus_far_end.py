"""The far end of the pseudo-terminal, a process of its own: a simulated load cell that answers as fast as it can.

Run as ``python -m bench.modbus_far_end DESCRIPTOR``; its parent kills it.
"""

from __future__ import annotations

import os
import sys

from bench.effort import TopicFailedError
from drivers.crc16 import crc16
from drivers.profiles import load_profile
from sim.nodes.sensor_slave import CellSlave

PROFILE = "four_axis_transmitter"
UNIT_ID = 1
READY = b"R"


class Forces:
    """The cell's constant readings."""

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return Fx, Fy, Fz in N and the moment in N m."""
        return 60.0, 0.0, 200.0, 0.5


def serve(descriptor: int) -> None:
    """Answer requests; the reply to a repeated request comes from memory."""
    slave = CellSlave(load_profile(PROFILE), UNIT_ID, Forces())
    known: dict[bytes, bytes] = {}
    buffer = b""
    os.write(descriptor, READY)
    while True:
        buffer += os.read(descriptor, 256)
        reply = known.get(buffer)
        if reply is None:
            if len(buffer) < 8 or crc16(buffer) != 0:
                continue
            reply = slave.answer(buffer, 0.0)
            if reply is None:
                raise TopicFailedError("the load cell does not answer")
            known[buffer] = reply
        os.write(descriptor, reply)
        buffer = b""


if __name__ == "__main__":
    serve(int(sys.argv[1]))
