"""The simulated rig as a process, in real time: the work of `tester sim`."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path

from sim import machines
from sim.faults.can import FaultyCanWire
from sim.rig import SimRig
from sim.servers.connection import listen
from sim.servers.doors import Doors
from sim.servers.server import RigServer
from sim.servers.tcp_doors import GATEWAY, SOCKETCAND
from sim.servers.text_doors import CommandDoor, StandardInput
from tester.base import clock
from tester.base.processes import RealTimePriority, end_asked
from tester.base.words import listed
from tester.inputs.rig import Rig
from tester.inputs.rig.config import OneRig
from tester.machine.tickers import collector_at_rest
from tester.run.bus_log import BusLog
from tester.run.kind_lookup import load_rig, run_parts
from tester.run.sim_console import RigClock, SimConsole, SpoiledLife
from tester.run.simulated import simulated_ports, spec_of


def reached(rig: OneRig, can: tuple[str, str], lines: Mapping[str, tuple[str, bool]], how: str) -> OneRig:
    """Return ``rig`` as a real machine, with its bus at ``can`` (python-can's interface and channel) and its lines at
    ``lines``.

    The latter are each line's port, and whether it uses Modbus TCP. ``how`` is added to the rig's name. The ambient
    values that the rig file states are those of the simulated rig.
    """
    interface, channel = can
    return replace(
        rig.in_air(rig.ambient_c),
        rig=f"{rig.rig}, over {how}",
        simulated=False,
        can=replace(rig.can, interface=interface, channel=channel),
        lines={
            name: replace(line, port=lines[name][0], framing="socket" if lines[name][1] else "rtu")
            for name, line in rig.lines.items()
        },
    )


SHOWN_EVERY_S = 1.0
"""Period of the status line, s of this computer's clock."""
LOG_COLUMNS = ("time_s", "clock_s", "controlled")
"""First columns of a state log, which has a row for every step of 10 ms: rig seconds, seconds of this machine's
monotonic clock, and 1 while a program is on the CAN bus. The plant's true values follow; the plant's kind names them.
"""


@dataclass(frozen=True, slots=True)
class SimOptions:
    """Options of the command line."""

    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    accept_risk: str = ""
    seed: int = 0
    compound: str = ""
    doors: Doors = field(default_factory=Doors)
    speed: float = 1.0
    idle_speed: float | None = None
    control: int | None = None
    """Port for commands, 0 = any free port; None = no port."""
    typed: bool = False
    """Whether to read commands from standard input."""
    write_rig: Path | None = None
    log: Path | None = None
    bus_log: Path | None = None


class StateLog:
    """Writes the rig's state as CSV, unbuffered: each row is passed to the operating system at once."""

    def __init__(self, path: Path, rig_clock: RigClock, machine: machines.SimulatedMachine) -> None:
        """Create the file; ``machine``: the simulated machine of the rig's kind."""
        self._file = path.open("w", encoding="utf-8", newline="\n", buffering=1)
        self._clock = rig_clock
        self._machine = machine
        self._form = "{:.6f},{:.6f},{:d}" + "".join(f",{{:.{digits}f}}" for digits in self._machine.log_decimals) + "\n"
        self._file.write(",".join((*LOG_COLUMNS, *self._machine.log_columns)) + "\n")

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Write a row with the rig's present state."""
        row = self._machine.log_row(rig)
        self._file.write(self._form.format(rig.now_s, self._clock.computer_s(rig.now_s), controlled, *row))

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def run_sim(options: SimOptions, say: Callable[[str], None], show: Callable[[str], None] | None = None) -> float:
    """Run a simulated rig until this process is asked to end (TERM, INT, or a command).

    Returns the greatest lateness, s of this computer's clock at the last speed. ``say`` is called with a line of all
    addresses, once clients can connect and the rig file is written, and then with the answers to commands. ``show``, if
    given, is called every second with the rig's state in one line. Raises InvalidSource for an invalid rig file,
    ValueError for an unknown door or fault, and OSError if a port, a device, an interface or a file is not available.
    """
    config = _on_doors(load_rig(options.rig, options.overrides, options.accept_risk), options.doors)
    kind = run_parts(config)
    machine = machines.find(kind.plant)
    language = machine.language(spec_of(config))
    language.parse_script(config.faults)
    with ExitStack() as stack:
        bus_log = None
        if options.bus_log is not None:
            bus_log = BusLog(options.bus_log, config)
            stack.callback(bus_log.close)
        _, rig, hands = simulated_ports(config, options.seed, bus_log, FaultyCanWire)
        kind.mount(hands, options.compound)
        rig_clock = RigClock(options.speed, options.idle_speed)
        state_log = None
        if options.log is not None:
            state_log = StateLog(options.log, rig_clock, machine)
            stack.callback(state_log.close)
        life = SpoiledLife(rig)
        console = SimConsole(life, machine, language, rig, rig_clock)
        server = RigServer(rig, "", 0, doors=options.doors)
        stack.callback(server.close)
        server.life = life
        server.observer = _Observers(server, rig_clock, console, state_log, say, show)
        for text in config.faults:
            for line in console.command(f"fault {text}", rig.now_s):
                say(line)
        asked = stack.enter_context(end_asked())
        places = _opened(options, config, server, console, say)
        say("ready: " + ", ".join(places))
        stack.callback(RealTimePriority().close)
        with collector_at_rest():
            server.serve(rig_clock, lambda: asked() or console.ended)
        return server.latest_s / rig_clock.speed


def _opened(
    options: SimOptions, config: Rig, server: RigServer, console: SimConsole, say: Callable[[str], None]
) -> list[str]:
    """Open the requested doors for commands and write the rig file if requested; return all addresses, in words."""
    places = [f"CAN {server.can.place}"] + [f"{name} {place}" for name, place in server.line_places.items()]
    if options.control is not None:
        door = CommandDoor(listen(options.doors.host, options.control), console.command)
        server.add(door)
        places.append(str(door.place))
    if options.typed:
        server.add(StandardInput(console.command, say))
    if options.write_rig is not None:
        write_atomically(options.write_rig, _reached(config, server).text)
        places.append(f"rig file {options.write_rig}")
    return places


class _Observers:
    """What observes the rig in every step: the log, the clock (is the rig idle?), and the reader of events."""

    def __init__(
        self,
        server: RigServer,
        rig_clock: RigClock,
        console: SimConsole,
        state_log: StateLog | None,
        say: Callable[[str], None],
        show: Callable[[str], None] | None,
    ) -> None:
        """Store the parts that observe the rig."""
        self._server, self._clock, self._console = server, rig_clock, console
        self._state_log, self._say, self._show = state_log, say, show
        self._shown_s = -SHOWN_EVERY_S

    def observe(self, rig: SimRig, controlled: bool) -> None:
        """Log the step, update the clock, and report events."""
        if self._state_log is not None:
            self._state_log.observe(rig, controlled)
        self._clock.controlled(controlled)
        self._server.speed = self._clock.speed
        for line in self._console.happened():
            self._say(line)
        for late_s in self._server.starved_s:
            self._say(f"this computer was late by {late_s:.2f} s: the machine stood still, and a drive reports it")
        self._server.starved_s.clear()
        if self._show is not None:
            now = clock.monotonic()
            if now - self._shown_s >= SHOWN_EVERY_S:
                self._shown_s = now
                self._show(f"{'CAN taken' if controlled else 'CAN free'}  {self._console.status()}")


def _on_doors(config: Rig, doors: Doors) -> Rig:
    """Return the rig with no parity on its lines if they are pseudo-terminals, which have no parity bit."""
    if doors.lines != "rtu":
        return config
    return replace(config, lines={name: replace(line, parity="N") for name, line in config.lines.items()})


def _reached(config: Rig, server: RigServer) -> Rig:
    """Return the rig with the addresses of a server's doors."""
    can = server.can.place
    lines = {name: (place.at, place.speaks == GATEWAY) for name, place in server.line_places.items()}
    spoken = sorted({can.speaks, *(place.speaks for place in server.line_places.values())})
    how = "TCP" if spoken == sorted((SOCKETCAND, GATEWAY)) else listed(spoken)
    return reached(config, (can.speaks, can.at), lines, how)


def write_atomically(path: Path, text: str) -> None:
    """Write a file so that readers see all of it or nothing."""
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        part.write_text(text, encoding="utf-8", newline="\n")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
