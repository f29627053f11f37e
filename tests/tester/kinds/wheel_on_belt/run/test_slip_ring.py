"""The slip ring on the simulated rig: a worn place is found in the record of a run, and reported by a command."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner

from sim.faults.scene import Scene
from sim.machines.wheel_on_belt.faults import CATALOGUE
from sim.machines.wheel_on_belt.faults.heat import WornSector
from tester.analysis.ring_errors import sector_of
from tester.cli.results_group import slip_ring
from tester.kinds.wheel_on_belt.image.ring_watch import SlipRingWatch
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation
from tests.tester.kinds.wheel_on_belt.image.test_joined_cell import Unattended
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, open_writer

NOTED = 40


def turning(simulation: Simulation) -> bool:
    """Return whether the wheel turns at its setpoint."""
    return simulation.ctx.readings.wheel_speed_m_s > 0.79


@pytest.mark.parametrize("seed", range(10))
def test_a_worn_place_is_found_at_its_angle(seed: int) -> None:
    run = Simulation(SHORT, seed=seed).until(turning)
    watch = run.run.engine.devices.slip_ring
    effect = CATALOGUE["slip ring worn"].effect(37.0 * seed)
    assert isinstance(effect, WornSector)
    scene = Scene(run.world, Unattended())
    began_rev = run.ctx.readings.wheel_angle_rev
    effect.begin(scene, run.world.now_s)
    while len(watch.segments[-1].at_rev) < NOTED:
        effect.renew(scene, run.world.now_s)
        run.tick()
        assert not run.run.finished, run.run.reason
        assert run.now < 200.0
    found = sector_of(watch.segments[-1].at_rev)
    assert found.found
    expected = (360.0 * began_rev + 37.0 * seed) % 360.0
    assert abs((found.centre_deg - expected + 180.0) % 360.0 - 180.0) < 40.0
    assert found.half_deg < 35.0


def test_a_sound_ring_has_no_errors() -> None:
    run = Simulation(SHORT).until(lambda one: turning(one) and one.now > 60.0)
    watch = run.run.engine.devices.slip_ring
    assert sum(map(sum, (one.errors for one in watch.segments))) == 0
    assert watch.segments[-1].requests[3] > 20  # 2 to 4 rev/s
    assert watch.segments[-1].turns == pytest.approx(run.ctx.readings.wheel_angle_rev, abs=0.2)


# the watch by itself -------------------------------------------------------------------------------------------------


class Counting:
    """A device with counters that the test sets."""

    def __init__(self) -> None:
        from drivers.modbus import Counters

        self.counters = Counters()
        self.station = self


def test_an_error_belongs_to_where_the_wheel_stood_when_it_was_asked() -> None:
    device = Counting()
    watch = SlipRingWatch(device)  # type: ignore[arg-type]
    watch.look(10.0, 20.0)
    device.counters.requests = 1  # left at the end of that scan
    watch.look(10.1, 20.0)
    device.counters.timeouts = 1
    watch.look(10.4, 20.0)
    assert watch.segments[-1].at_rev == [10.0]
    assert (watch.segments[-1].requests[3], watch.segments[-1].errors[3]) == (1, 1)


def test_another_wheel_begins_a_count_of_its_own() -> None:
    device = Counting()
    watch = SlipRingWatch(device)  # type: ignore[arg-type]
    watch.look(500.0, 20.0)
    watch.look(0.0, 0.0)
    watch.look(7.0, 20.0)
    assert [one.turns for one in watch.segments] == [500.0, 7.0]


def test_an_error_while_the_wheel_is_at_rest_has_no_angle() -> None:
    device = Counting()
    watch = SlipRingWatch(device)  # type: ignore[arg-type]
    watch.look(3.0, 0.0)
    device.counters.requests = 1
    watch.look(3.0, 0.0)
    device.counters.crc_errors = 1
    watch.look(3.0, 0.0)
    assert watch.segments[-1].at_rev == []
    assert watch.segments[-1].errors == [1, 0, 0, 0, 0]


# the command ---------------------------------------------------------------------------------------------------------


def ring_run(folder: Path, started: str, errors: int) -> None:
    """Write a run of 1000 turns whose ring failed so often at 90 degrees of 10,000 requests."""
    from dataclasses import replace

    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, started_utc=started), SPECIMENS, CONDITIONS)
    device = Counting()
    watch = SlipRingWatch(device)  # type: ignore[arg-type]
    for turn in range(1000):
        watch.look(turn + 0.25, 20.0)
        device.counters.requests += 10
        watch.look(turn + 0.26, 20.0)
        device.counters.crc_errors += turn < errors
    watch.look(1000.0, 20.0)
    watch.store(writer, 900.0)
    writer.close()


def test_the_command_prints_angle_speed_and_trend(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("TESTER_CATALOGUE", raising=False)
    ring_run(tmp_path / "runs" / "first", "2026-01-01T08:00:00.000Z", 10)
    ring_run(tmp_path / "runs" / "second", "2026-02-01T08:00:00.000Z", 60)
    told = CliRunner().invoke(slip_ring, ["second", "first", "--before", "500"]).stdout
    assert "second: 60 of 10000 requests failed (6.00 of 1000) in 1000 turns" in told
    assert "2 to 4 rev/s          60 of 10000    6.00 of 1000" in told
    assert "errors gather at 90 degrees" in told
    rows = [line.split() for line in told.splitlines() if line.startswith(("first ", "second "))]
    assert rows == [["first", "1500", "10000", "10", "1.00"], ["second", "2500", "10000", "60", "6.00"]]
    assert "+5.000 errors of 1000 for every 1000 turns" in told
    assert told.rstrip().endswith("grows")
    (first, second) = json.loads(CliRunner().invoke(slip_ring, ["first", "second", "--json"]).stdout)
    assert (first["errors"], second["wheels"][0]["gather"], second["age_turns"]) == (10, True, 2000.0)
