"""The simulated rig in a process of its own, in real time: what `tester sim` runs."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import FrameType, TracebackType

from sim import machines
from sim.rig import SimRig
from sim.servers.server import RigServer
from tester.base import clock
from tester.base.priority import RealTimePriority
from tester.machine.tickers import collector_at_rest
from tester.rig.reach import BUS, reached_over_tcp
from tester.run.bus_log import BusLog
from tester.run.kinds import run_parts
from tester.run.rigs import load_rig
from tester.run.simulated import simulated_ports

LOG_COLUMNS = ("time_s", "clock_s", "controlled")
"""What a state log begins with, a row every step of 10 ms: seconds of the rig and of this machine's monotonic clock, 1
while a program is on the CAN bus. The plant's true values follow, those that its kind names."""


@dataclass(frozen=True, slots=True)
class SimOptions:
    """What the command line said; ``port`` 0 = any free ones."""

    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    seed: int = 0
    compound: str = ""
    host: str = "127.0.0.1"
    port: int = 0
    write_rig: Path | None = None
    log: Path | None = None
    bus_log: Path | None = None


class StateLog:
    """Writes the rig's state as CSV; every row is handed to the operating system at once."""

    def __init__(self, path: Path, origin_s: float, machine: machines.SimulatedMachine) -> None:
        """Create the file; ``origin_s``: this computer's monotonic clock at the rig's second 0; ``machine``: the
        kind that the rig is."""
        self._file = path.open("w", encoding="utf-8", newline="\n", buffering=1)
        self._origin_s = origin_s
        self._machine = machine
        self._form = "{:.6f},{:.6f},{:d}" + "".join(f",{{:.{digits}f}}" for digits in self._machine.log_decimals) + "\n"
        self._file.write(",".join((*LOG_COLUMNS, *self._machine.log_columns)) + "\n")

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Write a row."""
        row = self._machine.log_row(rig)
        self._file.write(self._form.format(rig.now_s, rig.now_s + self._origin_s, controlled, *row))

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def run_sim(options: SimOptions, ready: Callable[[str], None]) -> float:
    """Run a simulated rig until this process is asked to end (TERM or INT); return how late it has been at most, s.

    ``ready`` is called with a line that says where everything is, once clients can connect and the rig file is
    written. Raises InvalidSource for an invalid rig file and OSError where a port or a file cannot be had.
    """
    config = load_rig(options.rig, options.overrides)
    kind = run_parts(config)
    with ExitStack() as stack:
        bus_log = None
        if options.bus_log is not None:
            bus_log = BusLog(options.bus_log, config)
            stack.callback(bus_log.close)
        _, rig, hands = simulated_ports(config, options.seed, bus_log)
        kind.mount(hands, options.compound)
        origin = clock.monotonic()
        state_log = None
        if options.log is not None:
            state_log = StateLog(options.log, origin, machines.find(kind.plant))
            stack.callback(state_log.close)
        server = RigServer(rig, options.host, options.port, state_log)
        stack.callback(server.close)
        asked = stack.enter_context(EndAsked())
        places = [f"CAN {BUS}@{_text(server.can_address)} (socketcand)"]
        places += [f"{name} {_text(address)} (Modbus TCP)" for name, address in server.line_addresses.items()]
        if options.write_rig is not None:
            reached = reached_over_tcp(config, server.can_address, server.line_addresses)
            write_atomically(options.write_rig, reached.text)
            places.append(f"rig file {options.write_rig}")
        ready("ready: " + ", ".join(places))
        stack.callback(RealTimePriority().close)
        with collector_at_rest():
            server.serve(lambda: clock.monotonic() - origin, asked)
        return server.latest_s


class EndAsked:
    """Turns TERM and INT into an answer to the question whether to end."""

    def __init__(self) -> None:
        """Nobody has asked."""
        self._asked = False

    def __call__(self) -> bool:
        """Tell whether this process has been asked to end."""
        return self._asked

    def __enter__(self) -> EndAsked:
        """Take the signals over."""
        self._restore = {number: signal.signal(number, self._on_signal) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        """Give the signals back."""
        for number, handler in self._restore.items():
            signal.signal(number, handler)

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._asked = True


def write_atomically(path: Path, text: str) -> None:
    """Write a file that others see whole or not at all."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8", newline="\n")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _text(address: tuple[str, int]) -> str:
    return f"{address[0]}:{address[1]}"
