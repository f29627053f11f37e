"""Commands to a simulated rig while it runs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import pytest

from drivers.ports import BusLost
from sim import machines
from sim.faults.can import FaultyCanWire
from sim.machines.specimen_on_track.rig import TrackRig
from tester.kinds import load_rig
from tester.run.sim_console import HELP, RigClock, SimConsole, SpoiledLife
from tester.run.simulated import simulated_ports, spec_of


class Computer:
    """A computer's clock, set by hand."""

    def __init__(self) -> None:
        self.s = 1000.0

    def __call__(self) -> float:
        return self.s


class Bench:
    """A rig and its console."""

    def __init__(self, name: str = "sim") -> None:
        rig = load_rig(name, ("sim.noise=0",))
        _, self.rig, _ = simulated_ports(rig, 1, None, FaultyCanWire)
        self.life = SpoiledLife(self.rig)
        self.computer = Computer()
        self.clock = RigClock(now=self.computer)
        machine = machines.find("wheel_on_belt" if name == "sim" else "specimen_on_track")
        self.console = SimConsole(self.life, machine, machine.language(spec_of(rig)), self.rig, self.clock)
        self.heard: list[tuple[float, int]] = []

    def live(self, until_s: float) -> None:
        """Run in steps of 10 ms and keep the frames that arrive."""
        while self.rig.now_s < until_s - 1e-6:
            self.life.advance(self.rig.now_s + 0.01)
            with suppress(BusLost):  # which is one of the faults
                self.heard += [(t, can_id) for t, can_id, _ in self.rig.can.receive(self.rig.now_s)]

    def say(self, line: str) -> Sequence[str]:
        return self.console.command(line, self.rig.now_s)

    def unheard(self, can_id: int, from_s: float, to_s: float) -> bool:
        return not [t for t, one in self.heard if one == can_id and from_s < t <= to_s]


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_a_fault_is_there_from_now_on_for_its_time(bench: Bench) -> None:
    bench.live(0.5)  # no heartbeats before a client requests them
    bench.rig.can.send(0x602, bytes.fromhex("2B17100032000000"), bench.rig.now_s)  # 0x1017: 50 ms
    bench.live(1.0)
    [answer] = bench.say("fault belt drive heartbeat lost for 1 s")
    assert answer == "belt drive heartbeat lost: from 1.000 s, for 1 s"
    bench.live(3.0)
    assert not bench.unheard(0x702, 0.5, 1.0)
    assert bench.unheard(0x702, 1.02, 1.98)
    assert not bench.unheard(0x702, 2.0, 3.0)
    assert [line.split("  ")[1] for line in bench.console.happened()] == [
        "belt drive heartbeat lost for 1 s: begins",
        "belt drive heartbeat lost for 1 s: is over",
    ]
    assert bench.console.happened() == []


def test_a_fault_may_come_later(bench: Bench) -> None:
    bench.live(0.1)
    bench.say("fault t=0.5 s: load cell frozen")
    assert bench.say("faults") == ["in 0.4 s: load cell frozen"]
    bench.live(0.6)
    assert bench.say("faults") == ["now: load cell frozen"]


def test_clear_ends_present_and_planned_faults(bench: Bench) -> None:
    before = bench.rig.devices["load cell"].powered
    bench.say("fault load cell without supply")
    bench.say("fault t=50 s: load cell frozen")
    bench.live(0.1)
    assert bench.rig.devices["load cell"].powered is not before
    assert bench.say("clear") == ("1 ended; no fault is planned",)
    assert bench.rig.devices["load cell"].powered is before
    assert bench.say("faults") == ("nothing is wrong",)
    assert bench.life.due_s == float("inf")


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("fault belt drive hartbeat lost", "nearest is"),
        ("fault operator stop", "another process"),
        ("fault process killed", "another process"),
        ("fault step measure: load cell frozen", "scans or steps of the program"),
        ("fault t=0 s: load cell frozen", "already"),
        ("fault load cell gain 3 kg", "unit"),
        ("speed 1000", "0.01 to 100"),
        ("speed fast", "fast"),
        ("speed nan", "0.01 to 100"),
        ("dance", "help"),
        ("fault", "help"),
    ],
)
def test_impossible_commands_are_reported(bench: Bench, line: str, why: str) -> None:
    bench.live(0.05)
    assert why in " ".join(bench.say(line))
    assert bench.say("faults") == ("nothing is wrong",)


def test_every_fault_of_the_catalogue_is_taken_or_refused_in_words() -> None:
    for name in ("sim", "grosch"):
        bench = Bench(name)
        phrases = bench.say("catalogue")
        assert len(phrases) > 50
        for phrase in phrases:
            [answer] = bench.say(f"fault {phrase}")
            assert answer.startswith((f"{phrase}: from", "no fault: ")), answer
        bench.live(0.3)
        bench.say("clear")
        assert bench.say("faults") == ("nothing is wrong",)


def test_the_catalogue_is_searched_by_words(bench: Bench) -> None:
    assert bench.say("catalogue belt heartbeat") == ("belt drive heartbeat lost",)
    assert bench.say("catalogue unicorn") == ("none of that name",)


def test_state_help_and_end(bench: Bench) -> None:
    assert "wheel_m_s 0.00000" in bench.say("state")
    assert tuple(bench.say("help"))[: len(HELP)] == HELP
    assert bench.say("") == ()
    assert not bench.console.ended
    bench.say("end")
    assert bench.console.ended
    assert "nothing wrong" in bench.console.status()


def test_a_machine_s_own_verbs_are_listed_and_carried_out() -> None:
    bench = Bench("pin-on-disc")
    assert isinstance(bench.rig, TrackRig)
    listed = " | ".join(bench.say("help"))
    assert "specimen SPECIMEN COMPOUND" in listed and "hang WEIGHTS_N N" in listed and "track dry|wet|talc" in listed
    for line in ("specimen 1 SBR", "lower", "hang 20 N", "track wet"):
        assert bench.say(line) == (f"done: {line}",)
    plant = bench.rig.plant
    assert (bench.rig.lift_mm, plant.weights_n, plant.interface) == (0.0, 20.0, "wet")
    bench.say("raise")
    assert bench.rig.lift_mm > 0.0
    assert "wheel SPECIMEN WHEEL COMPOUND yes|no" in " | ".join(Bench().say("help"))


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("hang 20", "expected WEIGHTS_N N: a number in N"),
        ("hang -20 N", "at least 0 N"),
        ("specimen 1 XYZ", "XYZ"),
        ("track oily", "expected dry|wet|talc, not 'oily'"),
        ("specimen 1 'SBR", "No closing quotation"),
    ],
)
def test_a_verb_that_cannot_be_carried_out_is_refused_in_one_line(line: str, why: str) -> None:
    bench = Bench("pin-on-disc")
    [answer] = bench.say(line)
    assert answer.startswith("not done: ") and why in answer and "\n" not in answer


def test_the_clock_of_the_rig_runs_at_its_speed_and_never_jumps() -> None:
    computer = Computer()
    clock = RigClock(2.0, now=computer)
    computer.s += 10.0
    assert clock() == pytest.approx(20.0)
    clock.set(speed=0.5)
    assert clock() == pytest.approx(20.0)
    computer.s += 10.0
    assert clock() == pytest.approx(25.0)
    assert clock.computer_s(24.0) == pytest.approx(computer.s - 2.0)


def test_an_idle_speed_counts_while_no_client_is_on_the_bus() -> None:
    computer = Computer()
    clock = RigClock(1.0, 20.0, computer)
    computer.s += 1.0
    clock.controlled(True)
    computer.s += 1.0
    assert clock() == pytest.approx(21.0)
    clock.controlled(False)
    computer.s += 1.0
    assert clock() == pytest.approx(41.0)


def test_a_speed_reports_its_effect_on_time_outs(bench: Bench) -> None:
    assert bench.say("speed 4") == ("4 x: a device's time-out of 100 ms takes 25 ms of a program's clock",)
    assert bench.say("idle speed 10")[1] == "10 x while no program is on the CAN bus"
