"""A load cell of several transmitters, on the simulated rig: its rig file, runs, and the named transmitter."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from math import hypot, pi, sin
from pathlib import Path
from random import Random

import pytest

from bench.machine import scan_is_compiled
from drivers.joined_cell import JoinedCell
from sim.faults.scene import Scene
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tester.base.source import InvalidSource, load_tree
from tester.inputs.rig.packaged import packaged_text
from tester.inputs.rig.rig_files import load
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.run import Outcome
from tester.run.provenance import record_statistics
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT, Simulation, in_contact

SINGLE = """\
  load_cell:
    profile: four_axis_transmitter  # Fx, Fy, Fz, Mz and a status in one block
    line: load_cell
    unit_id: 1
"""
LINES = "lines:\n"
SECOND = "  second:\n    port: sim\n    baud: 115200\n    parity: N\n    framing: rtu\n"
LAUMAS, DAT = "laumas_tlb", "dat_400"
BRIEF = SHORT.replace("window: 14 rev", "window: 4 rev")


def part(force: str, profile: str, line: str, unit_id: int) -> str:
    """Return the lines of a transmitter."""
    return (
        f"  cell_{force[1]}:\n    part_of: load_cell\n    profile: {profile}\n    line: {line}\n"
        f"    unit_id: {unit_id}\n    channels: {{force: {force}}}\n"
    )


THREE_LAUMAS = [("fx", LAUMAS, "load_cell", 1), ("fy", LAUMAS, "load_cell", 2), ("fz", LAUMAS, "load_cell", 3)]
THREE_DAT = [("fx", DAT, "load_cell", 1), ("fy", DAT, "load_cell", 2), ("fz", DAT, "second", 1)]
MIXED = [("fx", LAUMAS, "load_cell", 1), ("fy", LAUMAS, "load_cell", 7), ("fz", DAT, "second", 3)]


def joined(parts: Sequence[tuple[str, str, str, int]], overrides: Sequence[str] = QUIET) -> RigConfig:
    """Return the simulated rig with a load cell of these transmitters."""
    text = packaged_text(RigConfig, "")
    assert SINGLE in text
    assert LINES in text
    text = text.replace(SINGLE, "".join(part(*one) for one in parts)).replace(LINES, LINES + SECOND)
    return load(RigConfig, load_tree(text), list(overrides))


def problems(parts: Sequence[tuple[str, str, str, int]], overrides: Sequence[str] = ()) -> list[str]:
    """Return the problems of a rig with these transmitters."""
    with pytest.raises(InvalidSource) as caught:
        joined(parts, overrides)
    return [problem.message for problem in caught.value.problems]


class Unattended:
    """A computer without faults."""

    def stall(self, seconds: float) -> None: ...

    def kill(self) -> None: ...

    def jump(self, seconds: float) -> None: ...

    def operate(self, action: str) -> None: ...


# the rig file ------------------------------------------------------------------------------------------------------


def test_a_transmitter_of_one_force_is_no_load_cell_of_three() -> None:
    with pytest.raises(InvalidSource) as caught:
        load(RigConfig, load_tree(packaged_text(RigConfig, "")), ["devices.load_cell.profile=laumas_tlb"])
    said = [problem.message for problem in caught.value.problems]
    assert [text.split(" (")[0] for text in said] == [f"nothing measures {force}" for force in ("fx", "fy", "fz")]
    assert "part_of: load_cell" in said[0]


@pytest.mark.parametrize("missing", ["fx", "fy", "fz"])
def test_a_cell_without_a_channel_is_refused_by_its_name_and_place(missing: str) -> None:
    parts = [one for one in THREE_LAUMAS if one[0] != missing]
    (said,) = problems(parts)
    assert said.startswith(f"nothing measures {missing} (a load cell of this machine measures fx, fy, fz; cell_")


def test_two_transmitters_of_one_channel_are_refused() -> None:
    text = packaged_text(RigConfig, "").replace(SINGLE, "".join(part(*one) for one in THREE_LAUMAS))
    with pytest.raises(InvalidSource) as caught:
        load(RigConfig, load_tree(text.replace("force: fy", "force: fx")))
    said = [problem.message for problem in caught.value.problems]
    assert "measures fx, as cell_x does: rename it by `channels`" in said
    assert any(text.startswith("nothing measures fy") for text in said)


def test_a_part_beside_the_whole_is_refused() -> None:
    text = packaged_text(RigConfig, "").replace(SINGLE, SINGLE + part("fx", LAUMAS, "load_cell", 5))
    with pytest.raises(InvalidSource, match="devices has load_cell itself, too"):
        load(RigConfig, load_tree(text))


def test_a_part_of_an_undivided_cell_is_refused() -> None:
    text = packaged_text(RigConfig, "").replace(SINGLE, SINGLE + part("fx", LAUMAS, "load_cell", 5))
    with pytest.raises(InvalidSource, match="jacket is no device that may have several transmitters"):
        load(RigConfig, load_tree(text.replace("part_of: load_cell", "part_of: jacket")))


def test_a_line_too_slow_for_the_skew_is_refused_with_a_remedy() -> None:
    (said,) = problems(THREE_LAUMAS, ["lines.load_cell.baud=9600"])
    assert "are read 51 ms apart" in said
    assert "interlocks.cell_skew is 30 ms: raise the baud, or give each a line of its own" in said


def test_the_rig_reads_back_from_the_record_of_a_run() -> None:
    rig = joined(MIXED, ())
    again = load(RigConfig, load_tree(rig.text))
    assert again == rig
    assert "part_of" not in load(RigConfig, load_tree(packaged_text(RigConfig, ""))).text


# runs --------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pressed() -> Simulation:
    """Three Laumas on one line, under load; to be copied."""
    return Simulation(BRIEF, config=joined(THREE_LAUMAS)).until(in_contact)


def coefficient(run: Simulation) -> float:
    """Return resultant friction over normal force, each summed over the counted samples."""
    rows = run.rows(gate=0.0)
    return sum(hypot(row["force_x_n"], row["force_y_n"]) for row in rows) / sum(row["force_z_n"] for row in rows)


@pytest.fixture(scope="module")
def single() -> float:
    """The coefficient with one transmitter of all channels."""
    return coefficient(Simulation(BRIEF, QUIET).to_the_end())


@pytest.mark.parametrize("parts", [THREE_LAUMAS, THREE_DAT, MIXED], ids=["laumas", "dat", "mixed"])
def test_a_recipe_gives_the_coefficient_that_a_single_transmitter_gives(
    parts: list[tuple[str, str, str, int]], single: float
) -> None:
    run = Simulation(BRIEF, config=joined(parts)).to_the_end()
    assert run.run.outcome is Outcome.DONE, run.run.reason
    cell = run.run.engine.devices.cell
    assert 0.0 < cell.greatest_skew_s <= 0.030
    record_statistics(run.run.engine.devices, run.notes, run.now)
    told = [" ".join(map(str, values)) for values in run.notes.written("INSERT INTO bus_statistic")]
    assert any(f"greatest skew ms {1e3 * cell.greatest_skew_s}" in line for line in told)
    assert coefficient(run) == pytest.approx(single, rel=0.005)


@pytest.mark.parametrize("moment", range(3))
@pytest.mark.parametrize("how", ["without supply", "silent", "CRC errors"])
@pytest.mark.parametrize("force", ["fx", "fy", "fz"])
def test_the_first_alarm_names_the_transmitter_whose_cable_or_supply_is_off(
    pressed: Simulation, force: str, how: str, moment: int
) -> None:
    run = deepcopy(pressed)
    later_s = run.now + Random(f"{force} {how} {moment}").uniform(0.0, 6.0)
    run.until(lambda one: one.now >= later_s and in_contact(one))
    began_s = run.now
    scene = Scene(run.world, Unattended())
    CATALOGUE[f"load cell {force} {how}"].effect().begin(scene, began_s)
    run.to_the_end()
    at_s, _, first, _ = next(event for event in run.notes.events if event[1] in ("trip", "alarm"))
    assert first.startswith("load cell silent")
    assert f"[cell {force[1]}: no reading for " in first
    assert not any(f"cell {other}:" in first for other in "xyz" if other != force[1])
    assert at_s - began_s <= 0.1 + 0.05 + 0.01  # stale_cell, its delay, a scan or two


def test_a_transmitter_that_repeats_itself_is_named(pressed: Simulation) -> None:
    run = deepcopy(pressed)
    run.world.cells["cell_x"].frozen = True
    run.to_the_end()
    first = run.notes.texts("trip")[0]
    assert first.startswith("load cell frozen")
    assert "[cell x: the same counts for " in first


def test_a_transmitter_whose_bridge_is_broken_is_named(pressed: Simulation) -> None:
    run = deepcopy(pressed)
    run.world.cells["cell_y"].status_bits = 1
    run.to_the_end()
    first = run.notes.texts("trip")[0]
    assert first.startswith("load cell saturated")
    assert "[cell y: reading not valid (status 0x" in first


@pytest.mark.skipif(scan_is_compiled() == "yes", reason="a compiled method is not counted from outside")
def test_the_cause_is_looked_up_only_at_a_trip(pressed: Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[float] = []

    def blame(self: JoinedCell, now: float, limit_s: float) -> str:
        asked.append(now)
        return f"nobody for {limit_s} s"

    monkeypatch.setattr(JoinedCell, "blame", blame)
    run = deepcopy(pressed)
    end = run.now + 1.0
    run.until(lambda one: one.now >= end)
    assert asked == []
    run.world.cells["cell_y"].power(False)
    run.to_the_end()
    assert run.notes.texts("trip")[0].startswith("load cell silent")
    assert asked
    assert "[nobody for 0.05 s]" in run.notes.texts("trip")[0]


def test_nothing_moves_while_a_transmitter_does_not_answer() -> None:
    run = Simulation(BRIEF, config=joined(THREE_LAUMAS))
    run.world.cells["cell_y"].power(False)
    run.to_the_end()
    assert run.run.outcome is Outcome.UNREACHABLE
    assert run.run.reason == "not up after 90 s: cell y"
    assert not any(scan.slip_m_s for scan in run.scans)


# the page ------------------------------------------------------------------------------------------------------------


def test_the_rig_file_of_the_how_to_page_is_accepted_and_names_missing_parts() -> None:
    page = Path(__file__).parents[5] / "docs" / "how-to" / "a-cell-of-several-transmitters.md"
    text = page.read_text(encoding="utf-8").split("```yaml\ndevices:\n")[1].split("```")[0]
    rig = load(RigConfig, load_tree(packaged_text(RigConfig, "").replace(SINGLE, text)))
    assert [name for name, one in rig.devices.items() if one.part_of] == ["cell_x", "cell_y", "cell_z"]
    without = text[: text.index("  cell_y:")] + text[text.index("  cell_z:") :]
    with pytest.raises(InvalidSource) as caught:
        load(RigConfig, load_tree(packaged_text(RigConfig, "").replace(SINGLE, without)))
    (said,) = caught.value.problems
    assert f": {said.message}\n" in page.read_text(encoding="utf-8")


@pytest.mark.parametrize(("skew_ms", "momentary"), [(11.0, 0.007), (30.0, 0.019), (50.0, 0.030)])
def test_the_skew_leaves_the_ratio_of_means_alone_and_moves_the_momentary_one(skew_ms: float, momentary: float) -> None:
    turns_hz, swing_hz, shift_s = 2.83, 20.0, 1e-3 * skew_ms
    times = [index / 5000.0 / turns_hz for index in range(5000 * 40)]

    def normal_n(t: float) -> float:
        return 200.0 * (1.0 + 0.05 * sin(2.0 * pi * turns_hz * t))

    along = [0.75 * (1.0 + 0.2 * sin(2.0 * pi * swing_hz * t)) * normal_n(t) for t in times]
    normal = [normal_n(t + shift_s) for t in times]
    at_once = sum(along) / sum(map(normal_n, times))
    assert sum(along) / sum(normal) == pytest.approx(at_once, rel=1e-4)
    ratios = [normal_n(t) / later for t, later in zip(times, normal, strict=True)]
    mean = sum(ratios) / len(ratios)
    assert (sum((one - mean) ** 2 for one in ratios) / len(ratios)) ** 0.5 == pytest.approx(momentary, abs=0.0005)


# an ordinary adapter ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("held", ["0 s", "1 ms", "3 ms", "5 ms"])
def test_three_transmitters_on_one_line_run_with_an_ordinary_adapter(held: str) -> None:
    run = Simulation(BRIEF, config=joined(THREE_LAUMAS, (*QUIET, f"sim.latency_timer={held}"))).until(in_contact, 200.0)
    cell = joined_cell(run)
    before = cell.apart
    end = run.now + 5.0
    run.until(lambda one: one.now > end)
    assert cell.valid and cell.apart == before and cell.skew_s <= cell.measured_skew_s + 1e-9


@pytest.mark.parametrize(("held", "apart"), [("8 ms", 34.3), ("16 ms", 50.3)])
def test_an_adapter_that_holds_replies_too_long_is_refused_with_skew_and_timer(held: str, apart: float) -> None:
    run = Simulation(BRIEF, config=joined(THREE_LAUMAS, (*QUIET, f"sim.latency_timer={held}"))).to_the_end(100.0)
    failure = run.run.connector.failure
    assert "line load_cell is too slow for interlocks.cell_skew, 30.0 ms" in failure
    assert f"read {apart} ms apart" in failure and "the adapter's latency timer" in failure


def joined_cell(run: Simulation) -> JoinedCell:
    """Return the cell of a run."""
    return next(one.driver.cell for one in run.run.engine.devices.modbus if hasattr(one.driver, "cell"))
