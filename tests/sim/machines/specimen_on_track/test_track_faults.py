"""Faults of a specimen on a track: the catalogue, and what each of its own effects does to the rig."""

from __future__ import annotations

import pytest

from sim.faults import FaultScript, Scene
from sim.faults.can import FaultyCanWire
from sim.machines.specimen_on_track.faults import CATALOGUE, LANGUAGE
from sim.machines.specimen_on_track.rig import TrackRig
from sim.nodes.sensor_slave import CellSlave
from tests.sim.machines.specimen_on_track.test_track_rig import drive, lower, run
from tests.sim.machines.specimen_on_track.variants import parameters, wiring


class FaultlessComputer:
    """A computer without faults."""

    def stall(self, seconds: float) -> None:
        """Not this one."""

    def kill(self) -> None:
        """Not this one."""

    def jump(self, seconds: float) -> None:
        """Not this one."""

    def operate(self, action: str) -> None:
        """Not this one."""


def made(variant: str = "grosch") -> TrackRig:
    rig = TrackRig(wiring(variant), parameters(variant, noise=0.0, scatter=0.0), 1, FaultyCanWire)
    rig.install(0, "SBR")
    rig.put_on(20.0)
    rig.advance(0.5)
    return rig


def play(rig: TrackRig, fault: str, seconds: float = 0.5) -> FaultScript:
    """Let a fault begin now, and time pass."""
    script = FaultScript().add([LANGUAGE.parse(f"t={rig.now_s:.6f} s: {fault}")])
    scene = Scene(rig, FaultlessComputer())
    end = rig.now_s + seconds
    while rig.now_s < end - 1e-9:
        script.act(scene, rig.now_s + 1e-6)
        script.renew(scene, rig.now_s)
        rig.advance(rig.now_s + 0.01)
    return script


def cell_n(rig: TrackRig) -> float:
    assert isinstance(rig.cell, CellSlave)
    return int.from_bytes(rig.cell.sample(0, rig.now_s)[:4], "big", signed=True) * 1e-3


@pytest.mark.parametrize("phrase", CATALOGUE)
def test_every_row_can_be_written_begins_and_ends(phrase: str) -> None:
    rig = made("pin-on-disc" if phrase.split()[0] in ("pyrometer", "thermometer", "height") else "grosch")
    script = play(rig, f"{phrase} for 0.05 s", 0.2)
    assert [text.rsplit(": ", 1)[1] for _, text in script.happened] == ["begins", "is over"]


@pytest.mark.parametrize("phrase", [row.phrase for row in CATALOGUE.values() if row.reaction.name == "MAY"])
def test_a_row_without_demands_gives_a_reason(phrase: str) -> None:
    assert CATALOGUE[phrase].note


def test_a_chamber_that_runs_away_gets_hot_despite_its_setpoint() -> None:
    rig = made()
    play(rig, "chamber runs away", 30.0)
    assert rig.plant.air_c > 24.0


def test_a_silent_chamber_answers_nothing() -> None:
    rig = made()
    play(rig, "chamber without supply")
    assert rig.chamber is not None and not rig.chamber.powered


def test_a_frozen_cell_keeps_its_reading() -> None:
    rig = run(drive(lower(made()), 1.0), 2.0)
    shown = cell_n(rig)
    play(rig, "load cell frozen")
    rig.plant.force_n = 5.0
    assert cell_n(rig) == shown


@pytest.mark.parametrize(
    ("fault", "expected"), [("load cell offset 5 N", 45.0), ("load cell gain 50 %", 20.0), ("load cell open", 200.0)]
)
def test_a_spoiled_cell_shows_something_else(fault: str, expected: float) -> None:
    rig = made()
    play(rig, fault, 0.02)
    rig.plant.force_n = 40.0
    assert cell_n(rig) == pytest.approx(expected, abs=0.01)


def test_a_cell_drifts_with_time() -> None:
    rig = made()
    play(rig, "load cell drift 0.1 N/s", 10.0)
    assert cell_n(rig) == pytest.approx(1.0, abs=0.02)


def test_a_track_that_stalls_stands() -> None:
    rig = run(drive(made(), 1.0), 1.0)
    play(rig, "track stalls")
    assert rig.track_m_s == 0.0


def test_a_stuck_lift_stays_where_it_is() -> None:
    rig = made()
    play(rig, "lift stuck", 0.02)
    assert lower(rig).lift_mm == 10.0


def test_a_dead_end_switch_lets_the_track_run_into_its_stop() -> None:
    rig = made()
    play(rig, "end switch dead", 0.02)
    rig.axes["track"].axis.position = 299.0
    run(drive(rig, 10.0), 1.0)
    assert rig.hit_stop and not rig.beyond_switch


def test_an_emergency_stop_takes_the_tracks_torque() -> None:
    rig = made()
    play(rig, "emergency stop pressed")
    assert rig.axes["track"].torque_off and not rig.axes["lift"].torque_off


def test_a_fault_of_another_machine_is_none_here() -> None:
    with pytest.raises(ValueError, match="unknown fault 'belt torn'"):
        LANGUAGE.parse("t=1 s: belt torn")
