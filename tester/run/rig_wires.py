"""Opens the wires to a rig: simulated in this process, or a CAN adapter and Modbus lines whose arrivals one clock
stamps.
"""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drivers.ports import LinePort
from drivers.transports.can_bus import open_can
from drivers.transports.open_line import open_line
from tester.base.clock import UrgentPace
from tester.base.processes import RealTimePriority
from tester.inputs.rig import Rig
from tester.machine.rig_ports import Ports
from tester.machine.run_parts import NoAttendant
from tester.run.bus_log import BusLog

if TYPE_CHECKING:
    from sim.rig import SimRig

CATCH_UP_S = 0.002
"""Time allowed for reading the frames of a late scan, s [A]: the CAN thread takes some 0.1 ms a frame, and 20 may be
waiting.
"""


def connect_ports(
    rig: Rig,
    seed: int,
    log: BusLog | None,
    *,
    faulty: bool = False,
    recipe: Path | None = None,
    surface: str = "",
    times: float = 1.0,
) -> tuple[Ports, SimRig | None, Any]:
    """Open the wires to the rig: simulated in this process (with a faulty bus if ``faulty``), or real.

    ``recipe`` and ``surface``: as in ``simulated_ports``; ``times``: as in ``hardware_ports``. Returns the wires, the
    simulated rig, and the attendant (tester.machine.run_parts).
    """
    if rig.can.interface == "sim":
        from sim.faults.can import FaultyCanWire
        from sim.wires.can_wire import CanWire
        from tester.run.simulated import simulated_ports

        wire = FaultyCanWire if faulty else CanWire
        return simulated_ports(rig, seed, log, wire, recipe=recipe, surface=surface)
    return hardware_ports(rig, log, times), None, NoAttendant()


def hardware_ports(rig: Rig, log: BusLog | None, times: float = 1.0) -> Ports:
    """Open every wire of a rig file; raises BusLost for the first that fails, and then leaves none open.

    ``times``: rig seconds in a second, above 1 only for a simulated rig in another process that lives as fast.
    """
    pace = UrgentPace(CATCH_UP_S, times)
    with ExitStack() as opened:
        bus = open_can(rig.can.interface, rig.can.channel, rig.can.bitrate, pace.now, pace.hurry)
        opened.callback(bus.close)
        lines: dict[str, LinePort] = {}
        for name, config in rig.lines.items():
            line = open_line(config)
            opened.callback(line.close)
            lines[name] = line
        if log is not None:
            log.watch(bus, lines)
        opened.callback(RealTimePriority().close)
        return Ports(bus, lines, pace, opened.pop_all())
