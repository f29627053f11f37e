"""Mistakes written as data: a fault of a machine, its rig file or its computer, and the finding that names it.

A list of them is a YAML file (``doctor.yaml``; another author's by ``--list``), one mapping each, with ``mistake`` and
``named`` required::

    - mistake: load cell at 150 N unloaded     # its name
      kind: sim                                # the packaged rig; sim is the default rig: ["axes.belt.rated_torque=12 N
      m"]   # as --set: the rig file of doctor and run machine: ["axes.belt.node_id=12"]        # as --set: the real
      machine beyond: {axes.belt.node_id: 1}           # the machine, past every check of a rig file faults: ["load cell
      offset 150 N"]       # of sim.faults, begun before the doctor looks objects: {belt: {"6080:00": 300}} # values of
      a drive's objects, by hexadecimal index and sub-index registers: {jacket: {26: 1200}}          # values of a
      Modbus device's registers echo: true                               # its serial adapters receive their own
      transmissions computer: {latency_ms: 16}               # latency_ms, missing, forbidden, free_bytes, can_bitrate,
      can_state named: "load cell: .*150"                # a regular expression that a printed warning or fault must
      match run: refuses                             # if it cannot be measured: a run in memory has no adapters

The doctor examines the machine, then the same machine runs: the doctor's exit code must agree with the run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, Literal

import yaml

from drivers.canopen.dictionary import Entry
from drivers.canopen.objects import DataType
from drivers.ports import BusLost, LinePort, WatchedLine, byte_bits
from sim import machines
from sim.faults import FaultScript, Scene
from sim.faults.can import FaultyCanWire
from sim.nodes.object_store import ObjectStore
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, Severity
from tester.doctor.open_wires import SimulatedWires
from tester.doctor.probe_table import examined
from tester.inputs.rig import Rig
from tester.inputs.rig.config import LineConfig
from tester.kinds import load_rig
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.machine.state import Mode
from tester.run.kind_lookup import run_parts
from tester.run.preconditions import prepared
from tester.run.simulated import simulated_ports, spec_of
from tester.store.recorder import NullRecorder
from tests.tester.doctor.fake_computer import CELL, FakeComputer, ip_link, on_adapters

WATCHED_S: Final = 3.0
"""Observation time of the doctor, s of rig time: sixty heartbeats, some hundred readings of the load cell."""
ARMED_S: Final = 10.0
"""A run has armed by this rig time, s; its first contact is then past, or follows."""
GIVEN_UP_S: Final = 120.0
RECIPES: Final = {"sim": "quickstart", "grosch": "grosch", "pin-on-disc": "pin-on-disc"}
"""The recipe for a packaged rig."""
Runs = Literal["arms", "refuses"]
Rebuilt = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Written:
    """A mistake as in its file; the module documents the keys."""

    mistake: str
    named: str
    kind: str = "sim"
    rig: Sequence[str] = ()
    machine: Sequence[str] = ()
    beyond: Mapping[str, Any] = field(default_factory=dict[str, Any])
    faults: Sequence[str] = ()
    objects: Mapping[str, Mapping[str, int]] = field(default_factory=dict[str, Mapping[str, int]])
    registers: Mapping[str, Mapping[int, int]] = field(default_factory=dict[str, Mapping[int, int]])
    echo: bool = False
    computer: Mapping[str, Any] = field(default_factory=dict[str, Any])
    run: Runs | None = None


def read_list(path: Path) -> tuple[Written, ...]:
    """Return the mistakes in a file. Raises TypeError for an unknown key, OSError, yaml.YAMLError."""
    return tuple(Written(**entry) for entry in yaml.safe_load(path.read_text(encoding="utf-8")))


class NoComputer:
    """The computer of a scene without a control computer: nothing of it can be injected here."""

    def stall(self, seconds: float) -> None: ...
    def kill(self) -> None: ...
    def jump(self, seconds: float) -> None: ...
    def operate(self, action: str) -> None: ...


class EchoingLine(WatchedLine):
    """The port of an adapter that receives its own transmission, once the last bit has left."""

    def __init__(self, inner: LinePort, byte_s: float) -> None:
        """``byte_s``: time of one byte on the line, s."""
        super().__init__()
        self._inner, self._byte_s = inner, byte_s
        self._echoes: list[tuple[float, bytes]] = []
        self._free_s = 0.0

    def write(self, data: bytes, now: float) -> None:
        """Send; the echo is complete when the line is free again."""
        self._free_s = max(self._free_s, now) + len(data) * self._byte_s
        self._echoes.append((self._free_s, data))
        self._inner.write(data, now)
        self.tell(now, data, sent=True)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return echoes and replies up to ``now``, in the order of their arrival."""
        echoes = [one for one in self._echoes if one[0] <= now]
        self._echoes = self._echoes[len(echoes) :]
        read = sorted([*echoes, *self._inner.read(now)], key=lambda chunk: chunk[0])
        for at_s, data in read:
            self.tell(at_s, data, sent=False)
        return read


class MistakenWires(SimulatedWires):
    """The wires of a machine with mistakes, whose faults continue while time passes."""

    def __init__(self, built: Rig, seed: int, faults: Sequence[str] = (), *, echo: bool = False) -> None:
        """Switch the machine on, with its faults from the beginning; ``echo``: its adapters receive their own
        transmissions."""
        self._built, self._echo = built, echo
        self._ports, self.world, _ = simulated_ports(built, seed, None, FaultyCanWire)
        self._now_s = 0.0
        language = machines.find(run_parts(built).plant).language(spec_of(built))
        self._scene = Scene(self.world, NoComputer())
        self._script = FaultScript().add(language.parse(f"t=0 s: {text}") for text in faults)
        self._script.act(self._scene, 0.0)

    def line(self, name: str, config: LineConfig) -> LinePort:
        """Return the line with its adapter's behaviour."""
        line = super().line(name, config)
        byte_s = byte_bits(config.framing, config.parity, config.stop_bits) / config.baud
        return EchoingLine(line, byte_s) if self._echo else line

    def wait_until(self, due_s: float) -> None:
        """Advance the machine to ``due_s`` (s), its faults renewed on the way."""
        if due_s > self._now_s:
            self._script.renew(self._scene, self._now_s)
            self._now_s = due_s
            self.world.advance(due_s)


class Case:
    """A machine of a seed with a mistake, for the doctor and then for a run."""

    def __init__(self, written: Written, seed: int, rebuilt: Rebuilt | None = None) -> None:
        """Build the machine; nothing is sent yet. ``rebuilt`` changes it in ways that no key can describe."""
        self.written = written
        self.rig: Rig = load_rig(written.kind, tuple(written.rig))
        built = load_rig(written.kind, tuple(written.machine))
        for key, value in written.beyond.items():
            built = _replaced(built, key.split("."), value)
        built = rebuilt(built) if rebuilt is not None else built
        self.wires = MistakenWires(built, seed, written.faults, echo=written.echo)
        world = self.wires.world
        for axis, objects in written.objects.items():
            for place, value in objects.items():
                index, _, sub = place.partition(":")
                hold(world.axes[axis].store, (int(index, 16), int(sub or "0", 16)), value)
        for device, registers in written.registers.items():
            for address, value in registers.items():
                slave = world.slave(device)
                slave.put(address, value.to_bytes(2, "big"))
                slave.written(address, value, 0.0)

    def findings(self) -> list[Finding]:
        """Return all of the doctor's findings."""
        computer = _computer(self.written.computer)
        examination = Examination(on_adapters(self.rig), computer, self.wires, Path("runs"), WATCHED_S)
        return [entry.finding for entry in examined(examination)]

    def run(self) -> str:
        """Run the machine up to its first contact; return why it refused or tripped earlier, "" if it armed."""
        if self.written.run is not None:
            return "by its list" if self.written.run == "refuses" else ""
        wires, rig = self.wires, self.rig
        try:
            lines: dict[str, LinePort] = {name: wires.line(name, line) for name, line in rig.lines.items()}
            run = self._built_run(Ports(wires.can(rig.can.bitrate), lines))
        except BusLost as lost:
            return str(lost)
        begun_s, armed_s = wires.now(), float("inf")
        while not run.finished and wires.now() < begun_s + GIVEN_UP_S:
            due_s = run.tick(wires.now())
            if run.connected and run.engine.control.state.mode is Mode.RUN:
                armed_s = min(armed_s, wires.now())
            if wires.now() - armed_s > ARMED_S:
                run.abandon()
                return ""
            wires.wait_until(min(max(due_s, wires.now() + 5e-4), max(wires.world.urgent_s, wires.now() + 5e-4)))
        trip = run.engine.control.state.trip
        return run.reason or (f"{trip.name}: {trip.text}" if trip is not None else "") or "it did not arm"

    def _built_run(self, ports: Ports) -> Run:
        kind, work = run_parts(self.rig), prepared(RECIPES[self.written.kind], self.written.kind, ()).work
        prompts = Prompts(automatic=True)
        world = self.wires.world
        return kind.build(RunSetup(self.rig, kind.split(work.plan)[0].plan, ports, world, NullRecorder(), prompts))


def hold(store: ObjectStore, key: tuple[int, int], value: int) -> None:
    """Let a drive hold a value in an object, which a restart of its communication keeps."""
    if key not in store.entries:
        store.entries = {**store.entries, key: Entry(*key, DataType.U32, "rw", value, "held by the machine")}
    store._overrides[key] = store.values[key] = value  # pyright: ignore[reportPrivateUsage]


def _replaced(config: Any, path: Sequence[str], value: object) -> Any:
    """Return a frozen configuration with one value replaced, without a check."""
    name, *rest = path
    if isinstance(config, Mapping):
        inner = _replaced(config[name], rest, value) if rest else value
        return {**config, name: inner}  # pyright: ignore[reportUnknownVariableType]
    return replace(config, **{name: _replaced(getattr(config, name), rest, value) if rest else value})


def _computer(changes: Mapping[str, Any]) -> FakeComputer:
    """Return the computer with its faults."""
    computer = FakeComputer()
    known = {"latency_ms", "missing", "forbidden", "free_bytes", "can_bitrate", "can_state"}
    if unknown := set(changes) - known:
        raise TypeError(f"computer: {', '.join(unknown)} (known: {', '.join(sorted(known))})")
    if "latency_ms" in changes:
        computer.latency = {CELL: changes["latency_ms"]}
    if changes.get("missing"):
        computer.ports, computer.latency = {}, {}
    if changes.get("forbidden"):
        computer.forbidden = frozenset({CELL})
    if "free_bytes" in changes:
        computer.free = changes["free_bytes"]
    if "can_bitrate" in changes:
        computer.outputs["ip"] = ip_link(changes["can_bitrate"])
    if "can_state" in changes:
        computer.files["/sys/class/net/can0/operstate"] = changes["can_state"]
    return computer


def printed(findings: Sequence[Finding], least: Severity = Severity.WARNING) -> list[str]:
    """Return the findings from a severity on as they are printed; by default warnings and faults."""
    return [str(finding) for finding in findings if finding.severity >= least]


def exits(findings: Sequence[Finding]) -> int:
    """Return the doctor's exit code."""
    return int(any(finding.severity is Severity.FAULT for finding in findings))


def disagreement(findings: Sequence[Finding], refused: str) -> str:
    """Return how the doctor's exit code disagrees with a run of the same machine that ended, or not, as ``refused``."""
    code = exits(findings)
    if bool(refused) == bool(code):
        return ""
    return f"the doctor exits with {code}, the run {'ends: ' + refused if refused else 'arms'}"
