"""Another table of channels: its channels are stored, averaged, verified and exported."""

from __future__ import annotations

import csv
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.blocks import BlockCounter
from tester.analysis.reduce import reduce_repeat
from tester.analysis.results import ConditionStatus
from tester.analysis.stability import Window
from tester.analysis.swing import swing_of
from tester.base import clock
from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Quantities, Roles
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.recomputed import coefficient_problems
from tester.store.kind_rows import channel_rows, quantities_of
from tester.store.merge import Merge
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tester.tui.stored import condition
from tests.tester.results.made import made
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS

FORCES = (
    Channel("drag_n", "N", "Drag", "readings.drag_n", 1),
    Channel("weight_n", "N", "Weight", "readings.weight_n", 2),
)
HUMIDITY = Channel("humidity_percent", "%", "Humidity", "readings.humidity_percent", 3, 1)
TRACK = Quantities(
    (
        Channel(TIME, "s", "Time", "now"),
        Channel("way_m", "m", "Way", "readings.way_m", column="way_mm", shown_unit="mm", scale=1e3),
        Channel(
            "speed_m_s", "m/s", "Speed", "readings.speed_m_s", 4, column="speed_mm_s", shown_unit="mm/s", scale=1e3
        ),
        *FORCES,
        HUMIDITY,
        *(Channel(name, "", name, name, whole=True) for name in (GATE, BURST, KEY)),
    ),
    Roles(friction=("drag_n",), normal="weight_n", turn="way_m", block=0.01, sliding="speed_m_s"),
)  # fmt: skip
"""A specimen that slides along a track: one friction force, no temperature, blocks of 10 mm."""


def slide(folder: Path, repeat: int = 1) -> None:
    """Record a repeat of a condition: 12.5 blocks, 1 mm a sample."""
    folder.mkdir(exist_ok=True)
    writer = RunWriter(folder / "run.db", TRACK, clock=clock.monotonic, synchronous=True)
    writer.begin_run(RUN, SPECIMENS, [replace(CONDITIONS[0], window_revolutions=8.0, window_s=None)])
    writer.begin_condition(CONDITIONS[0].condition, 0.0)
    key = writer.begin_repeat(CONDITIONS[0].condition, repeat, 1, 0.0, piece=1)
    counter = BlockCounter(TRACK)
    for i in range(125):
        sample = (0.1 * i, 1e-3 * i, 0.01, 70.0 + i % 10, 100.0, 45.0 + 0.01 * i, 0.0, 1.0, float(key))
        writer.sample(sample)
        counter.add(sample)
    writer.commit_repeat(key, reduce_repeat(counter.blocks, Window(8.0), swing=swing_of(counter.trace)))
    writer.end_condition(CONDITIONS[0].condition, ConditionStatus.OK, t_s=60.0)
    writer.finish("done", rig_seconds=60.0, ended_utc="2024-02-21T15:00:00.000Z")
    writer.close()


def table(text: bytes) -> list[dict[str, str]]:
    """Rows of a CSV file."""
    return list(csv.DictReader(text.decode("utf-8-sig").splitlines()))


def test_blocks_are_counted_by_the_way(tmp_path: Path) -> None:
    slide(tmp_path)
    with RunReader(tmp_path) as reader:
        result = reader.repeats()[0].result
    assert result.revolutions == 12
    assert result.mu_resultant == pytest.approx(0.745)
    assert result.mu_lateral == 0.0


def test_a_channel_of_the_table_is_stored_averaged_and_exported(tmp_path: Path) -> None:
    slide(tmp_path)
    with RunReader(tmp_path) as reader:
        (row,) = table(made("repeats", reader))
        (condition, *_) = table(made("conditions", reader))
        (first, *_) = table(made("samples", reader))
    means = [name for name in row if name.startswith("measured_")]
    assert means == ["measured_drag_n", "measured_weight_n", "measured_humidity_percent", "measured_speed_mm_s"]
    assert float(row["measured_humidity_percent"]) == pytest.approx(45.595)
    assert float(condition["measured_speed_mm_s"]) == pytest.approx(10.0)
    assert [*first] == [*TRACK.names, "condition", "repeat", "attempt"]
    assert (first["humidity_percent"], first["burst"]) == ("45.0", "1")


def test_the_means_of_a_channel_are_verified_by_its_samples(tmp_path: Path) -> None:
    slide(tmp_path)
    with RunReader(tmp_path) as reader:
        assert coefficient_problems(reader) == (1, [])
        chain = reader.chain()
    assert chain.problems == ()


def test_parts_with_a_channel_more_are_put_together(tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    writer = RunWriter(run / "run.db", TRACK, clock=clock.monotonic, synchronous=True)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.close()
    with Merge(run) as merging:
        for repeat in (1, 2):
            slide(tmp_path / f"part {repeat}", repeat)
            merging.add(tmp_path / f"part {repeat}")
    with RunReader(run) as reader:
        first, second = reader.repeats()
        assert dict(first.result.means) == pytest.approx(dict(second.result.means))
        assert (reader.samples(1, 2)["humidity_percent"] == reader.samples(1, 1)["humidity_percent"]).all()


def test_a_table_comes_back_as_it_was() -> None:
    for one in (TRACK, QUANTITIES):
        found = quantities_of(channel_rows(one))
        assert (found.channels, found.roles) == (one.channels, one.roles)


def test_a_tare_is_kept_by_the_names_of_its_channels(tmp_path: Path) -> None:
    with closing(RunWriter(tmp_path / "run.db", TRACK, clock=clock.monotonic, synchronous=True)) as writer:
        writer.begin_run(RUN, SPECIMENS, CONDITIONS)
        writer.tare(1.0, "reference", {"drag_n": 0.5, "weight_n": -2.0})
    with RunReader(tmp_path) as reader:
        (tare,) = reader.tares()
        assert (tare.zeros["drag_n"], tare.zeros["weight_n"]) == (0.5, -2.0)
        assert resume_point(reader).reference_tare == pytest.approx(dict(tare.zeros), nan_ok=True)


def test_the_results_screen_traces_the_coefficient_by_the_roles_of_the_channels(tmp_path: Path) -> None:
    slide(tmp_path / "run")
    _, (repeat,) = condition(tmp_path / "run", CONDITIONS[0].condition, 5)
    assert [pytest.approx((0.70, 0.79))] * 5 == list(repeat.trace)
