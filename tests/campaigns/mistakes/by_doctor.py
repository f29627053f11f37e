"""Mistakes that can be seen without motion: the doctor looks at the twin, which is not as its rig file says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import drivers.profiles
from drivers.canopen import objects as o
from drivers.canopen.node_config import NodeChannel, NodeConfig
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.wires.can_traffic import Beat
from sim.wires.modbus_wire import Impairment, Kind
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, Severity
from tester.doctor.open_wires import SimulatedWires
from tester.doctor.probe_table import examined
from tester.inputs.rig import Rig
from tester.kinds import load_rig
from tests.campaigns.mistakes.mistake import Mistake
from tests.tester.doctor.fake_computer import CELL, FakeComputer, ip_link, on_adapters

WATCHED_S = 3.0
"""The doctor watches so long, s of rig time: sixty heartbeats, some hundred readings of the load cell."""

Hands = Callable[[WheelRig, int], None]
"""What is done to the twin of a seed before the doctor looks."""
QUIET_AT_FIRST = 20
"""Transactions of a line before noise begins: the first questions are answered."""


def looked_at(
    seed: int,
    *,
    told: Sequence[str] = (),
    built: Sequence[str] = (),
    rebuilt: Callable[[Any], Any] | None = None,
    hands: Hands | None = None,
    computer: FakeComputer | None = None,
) -> list[Finding]:
    """Return all that the doctor finds at the twin of a seed.

    ``told``: keys of the rig file; ``built``: of the rig as it stands there; ``rebuilt`` changes that beyond what a rig
    file could say.
    """
    stands: Rig = load_rig("sim", built)
    wires = SimulatedWires(rebuilt(stands) if rebuilt is not None else stands, seed)
    assert isinstance(wires.world, WheelRig)
    if hands is not None:
        hands(wires.world, seed)
    rig = on_adapters(load_rig("sim", told))
    examination = Examination(rig, computer or FakeComputer(), wires, Path("runs"), WATCHED_S)
    return [entry.finding for entry in examined(examination)]


def said(findings: Sequence[Finding]) -> list[str]:
    """Return warnings and faults as they are printed."""
    return [str(finding) for finding in findings if finding.severity >= Severity.WARNING]


def clean(seed: int) -> list[str]:
    """Return the warnings and faults that are found on a rig that is as its file says."""
    return said(looked_at(seed))


def _named(name: str, named_by: str, **how: Any) -> Mistake:
    return Mistake(name, named_by, lambda seed: said(looked_at(seed, **how)))


# -- what is done to the twin -----------------------------------------------------------------------------------------


def _serial_numbers(numbers: dict[str, int], rig: WheelRig, _seed: int) -> None:
    for axis, number in numbers.items():
        rig.axes[axis].store.values[o.IDENTITY, 4] = number


def _another_product(rig: WheelRig, seed: int) -> None:
    rig.axes[("wheel", "belt", "sideslip")[seed % 3]].store.values[o.IDENTITY, 2] = 0x0707


def _no_heartbeat(rig: WheelRig, seed: int) -> None:
    """A drive set up before, whose heartbeat does not come."""
    for number, drive in enumerate(rig.axes.values()):
        drive.store.values[o.PRODUCER_HEARTBEAT, 0] = 50
        drive.store.save()
        drive.power(False)
        drive.power(True)
        drive.withhold_heartbeat(number == seed % 5)


def _second_master(rig: WheelRig, seed: int) -> None:
    identifier = (o.SYNC_ID, o.HEARTBEAT_BASE + 127, o.RPDO1_BASE + 1)[seed % 3]
    rig.can.beat(Beat(identifier, b"" if identifier == o.SYNC_ID else b"\x05", 0.2), 0.3)


def _no_supply(rig: WheelRig, _seed: int) -> None:
    for drive in rig.axes.values():
        drive.power(False)


def _local(rig: WheelRig, seed: int) -> None:
    rig.axes[("wheel", "belt", "press")[seed % 3]].local = True


def _guard(rig: WheelRig, _seed: int) -> None:
    io = rig.axes["press"].io
    assert io is not None
    io.set_guard(False)


def _chain(rig: WheelRig, _seed: int) -> None:
    io = rig.axes["press"].io
    assert io is not None
    io.set_chain(False, 0.0)


def _impaired(line: str, kind: Kind, count: int, rig: WheelRig, seed: int, *, delay_s: float = 0.0) -> None:
    rig.lines[line].impair = Impairment(
        kind, count, delay_s=delay_s, skip=seed % 5 + (QUIET_AT_FIRST if count > 0 else 0)
    )


def _broken_sensor(rig: WheelRig, _seed: int) -> None:
    rig.jacket.sensor_broken = True


def _two_of_one_number(rig: Any) -> Any:
    axes = rig.axes
    return replace(rig, axes=replace(axes, belt=replace(axes.belt, node_id=axes.wheel.node_id)))


def _a_stranger(rig: Any) -> Any:
    node = NodeConfig("stranger", 9, {"pressure": NodeChannel(0, "u16", 1.0, "Pa")})
    return replace(rig, can=replace(rig.can, nodes={"stranger": node}))


def _exchanged_lines(rig: Any) -> Any:
    """Each line's adapter leads to the other's devices, at the other's settings."""
    other = {"load_cell": "heat", "heat": "load_cell"}
    lines = {name: rig.lines[other[name]] for name in rig.lines}
    devices = {key: replace(device, line=other[device.line]) for key, device in rig.devices.items()}
    return replace(rig, lines=lines, devices=devices)


def _other_word_order(seed: int) -> list[str]:
    text = (Path(drivers.profiles.__file__).parent / "four_axis_transmitter.toml").read_text(encoding="utf-8")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "turned.toml"
        path.write_text('word_order = "low_first"\n' + text, encoding="utf-8")
        return said(looked_at(seed, built=(f"devices.load_cell.profile={path}",)))


SERIALS = tuple(f"axes.{name}.serial_number={number}" for name, number in (("wheel", 71), ("belt", 72)))

MISTAKES: tuple[Mistake, ...] = (
    _named(
        "drives of wheel and belt at each other's node number",
        r"(wheel|belt): .*swapped drives",
        told=SERIALS,
        hands=partial(_serial_numbers, {"wheel": 72, "belt": 71}),
    ),
    _named(
        "a drive at another node number", r"belt: nothing answers at node 2; node 12", built=("axes.belt.node_id=12",)
    ),
    _named("two drives at one node number", r"wheel: .*two nodes have one node number", rebuilt=_two_of_one_number),
    _named(
        "CAN at another bit rate",
        r"CAN bus: .*bit rate of 1000000",
        built=("can.bitrate=1000000",),
        computer=FakeComputer(outputs={"ip": ip_link(), "timedatectl": "yes"}),
    ),
    _named(
        "CAN interface set to another bit rate",
        r"CAN adapter: can0 runs at a bit rate of 125000",
        computer=FakeComputer(outputs={"ip": ip_link(125_000), "timedatectl": "yes"}),
    ),
    _named("drives without supply", r"CAN bus: silent", hands=_no_supply),
    _named("a second master", r"CAN bus: another master is sending: (SYNC|heartbeat|RPDO1)", hands=_second_master),
    _named("another product than the EDS's", r"(wheel|belt|sideslip): .*another drive", hands=_another_product),
    _named("a heartbeat that does not come", r"no heartbeat arrives", hands=_no_heartbeat),
    _named(
        "rated torque of another motor", r"belt: 0x6076 rated torque is 16 N m", told=("axes.belt.rated_torque=12 N m",)
    ),
    _named("a node that is not in the rig file", r"node 9 is not in the rig file", rebuilt=_a_stranger),
    _named("guard input inverted", r"press: guard open .*bit 17", hands=_guard),
    _named("safety chain open", r"press: safety chain open .*bit 16", hands=_chain),
    _named("wrong baud rate", r"line heat: wrong baud rate: .* 9600 baud", built=("lines.heat.baud=9600",)),
    _named("wrong parity", r"line load_cell: wrong parity: .* parity E", built=("lines.load_cell.parity=E",)),
    _named("adapters of two lines exchanged", r"line (heat|load_cell): .*exchanged adapters", rebuilt=_exchanged_lines),
    _named(
        "wrong unit id", r"load cell: nothing answers at unit id 1 .*unit 7", built=("devices.load_cell.unit_id=7",)
    ),
    _named(
        "unit ids of two devices exchanged",
        r"(jacket|infrared thermometer): wrong (device|profile)",
        built=("devices.jacket.unit_id=2", "devices.ir_thermometer.unit_id=1"),
    ),
    _named(
        "profile of another controller",
        r"jacket: wrong (device or )?profile",
        told=("devices.jacket.profile=omron_e5cc",),
    ),
    Mistake("word order of the load cell", r"load cell: wrong word order", _other_word_order),
    _named("thermocouple off", r"jacket: reports an invalid reading: .*sensor_break", hands=_broken_sensor),
    _named(
        "replies held back by 16 ms",
        r"load cell: .*latency timer",
        hands=partial(_impaired, "load_cell", "late", -1, delay_s=0.016),
    ),
    _named(
        "replies held back by 40 ms",
        r"load cell: .*a run refuses the line as too slow",
        hands=partial(_impaired, "load_cell", "late", -1, delay_s=0.04),
    ),
    _named(
        "noise on a line",
        r"load cell: .*% of \d+ questions failed",
        hands=partial(_impaired, "load_cell", "corrupt", 40),
    ),
    _named(
        "latency timer at its usual 16 ms",
        r"line load_cell: latency timer 16 ms",
        computer=FakeComputer(latency={CELL: 16}),
    ),
    _named(
        "no right to use the port",
        r"line load_cell: this user may not use",
        computer=FakeComputer(forbidden=frozenset({CELL})),
    ),
    _named(
        "no such serial port", r"line load_cell: there is no serial port", computer=FakeComputer(ports={}, latency={})
    ),
    _named("drive in local mode", r"(wheel|belt|press): in local mode", hands=_local),
    _named("full disk", r"run folder: the disk is full", computer=FakeComputer(free=1_000_000)),
)
