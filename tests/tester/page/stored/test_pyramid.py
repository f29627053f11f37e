"""Samples at every zoom: no recorded value lies outside the drawing."""

from __future__ import annotations

import shutil
import sqlite3
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.page.stored import pyramid, run_cache
from tester.page.stored.asked import PREPARE, answer
from tester.page.stored.drawn_columns import ColumnValues, drawn_columns
from tester.page.stored.pyramid import FACTOR, Buckets, Pyramid, pyramid_of
from tester.page.stored.run_cache import RunCache
from tester.results.run_files import write_file
from tester.results.verify import verify
from tester.store.run_reader import RunReader


@pytest.fixture
def own(run: Path, tmp_path: Path) -> Path:
    """Return a copy of the run, without a file left beside its record by another test."""
    return Path(shutil.copytree(run, tmp_path / run.name, ignore=shutil.ignore_patterns("*.pyramid")))


def made(folder: Path, before: Pyramid | None = None, *, lasting: bool = True) -> Pyramid:
    with RunReader(folder) as reader:
        return pyramid_of(reader, before, lasting=lasting)


def window(folder: Path, of: Pyramid, from_s: float, to_s: float, points: int) -> Buckets:
    with RunReader(folder) as reader:
        return of.window(reader, from_s, to_s, points)


def every_sample(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    with RunReader(folder) as reader:
        samples, quantities = reader.samples(), reader.quantities()
        of_columns = ColumnValues(drawn_columns(quantities), quantities, reader.conditions())
        return samples["time_s"], of_columns.values(samples)


@pytest.mark.parametrize("points", [1, 7, 50, 400, 8192])
def test_every_sample_lies_between_the_least_and_the_greatest_value_of_its_bucket(run: Path, points: int) -> None:
    t_s, values = every_sample(run)
    found = window(run, made(run), -1.0, 1e9, points)
    assert 0 < len(found.t_s) <= 2 * points
    place = np.searchsorted(found.t_s, t_s, "right") - 1
    known = np.isfinite(values)
    assert (place >= 0).all()
    assert (values.astype(np.float32) >= found.low[:, place])[known].all()
    assert (values.astype(np.float32) <= found.high[:, place])[known].all()


def test_the_extremes_are_recorded_values_and_no_others(run: Path) -> None:
    _, values = every_sample(run)
    found = window(run, made(run), -1.0, 1e9, 20)
    assert np.array_equal(np.nanmax(found.high, axis=1), np.nanmax(values, axis=1).astype(np.float32))
    assert np.array_equal(np.nanmin(found.low, axis=1), np.nanmin(values, axis=1).astype(np.float32))


def test_a_narrow_window_shows_the_samples_themselves(run: Path) -> None:
    t_s, values = every_sample(run)
    first = len(t_s) // 2
    found = window(run, made(run), float(t_s[first]), float(t_s[first + 99]), 100)
    assert np.array_equal(found.t_s, t_s[first : first + 100])
    assert np.array_equal(found.low, found.high, equal_nan=True)
    assert np.array_equal(found.low, values[:, first : first + 100].astype(np.float32), equal_nan=True)


def test_a_window_without_samples_is_empty(run: Path) -> None:
    found = window(run, made(run), 1e8, 1e9, 100)
    assert found.low.shape == (len(made(run).columns), len(found.t_s)) and len(found.t_s) <= 1


def test_a_bucket_of_the_first_level_has_eight_samples_of_its_block(run: Path) -> None:
    with RunReader(run) as reader:
        counts = [block.rows for block in reader.sample_blocks()]
    t_s, values = every_sample(run)
    firsts = [sum(counts[:at]) + of for at, count in enumerate(counts) for of in range(0, count, FACTOR)]
    ends = [*firsts[1:], len(t_s)]
    found = made(run).first
    assert np.array_equal(found.t_s, t_s[firsts])
    for at in range(0, len(firsts), 37):
        samples = values[:, firsts[at] : ends[at]].astype(np.float32)
        assert np.array_equal(found.low[:, at], np.fmin.reduce(samples, axis=1), equal_nan=True)
        assert np.array_equal(found.high[:, at], np.fmax.reduce(samples, axis=1), equal_nan=True)


def test_a_column_whose_scale_is_negative_has_its_ends_the_right_way_round(run: Path) -> None:
    with RunReader(run) as reader:
        (one,) = (column for column in drawn_columns(reader.quantities()) if column.key == "load_n")
        turned = replace(one, channel=replace(one.channel, scale=-1.0))
        rows = [*reader.rows("SELECT * FROM sample_block ORDER BY id")]
        plain, found = (pyramid._Blocks(reader, (column,)).eights(rows) for column in (one, turned))
    assert np.array_equal(found.low, -plain.high) and np.array_equal(found.high, -plain.low)


def test_a_set_point_is_that_of_the_condition_under_way(run: Path) -> None:
    with RunReader(run) as reader:
        columns, conditions = drawn_columns(reader.quantities()), reader.conditions()
        of_columns = ColumnValues(columns, reader.quantities(), conditions)
        moments = np.array([-1.0, *(t for one in conditions for t in (one.started_s, one.ended_s))])
        samples = dict.fromkeys(reader.quantities().names, np.zeros(len(moments))) | {"time_s": moments}
    slip = of_columns.values(samples)[[column.key for column in columns].index("slip_setpoint_mm_s")]
    assert np.array_equal(slip, [np.nan, 200.0, np.nan, 300.0, np.nan], equal_nan=True)


def test_levels_shrink_by_eight(run: Path) -> None:
    sizes = [len(level.t_s) for level in made(run).levels]
    assert all(-(-a // FACTOR) == b for a, b in pairwise(sizes)) and sizes[-1] <= FACTOR


def test_the_file_beside_the_record_is_read_again_and_is_no_part_of_the_run(
    own: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pyramid, "AT_LEAST", 1)
    first = made(own)
    assert (own / "samples.pyramid").is_file() and not [p for p in verify(own).problems if "pyramid" in p]
    monkeypatch.setattr(pyramid, "_made", lambda *_: pytest.fail("made again"))
    again = made(own)
    assert np.array_equal(first.first.low, again.first.low, equal_nan=True)


def test_a_run_is_prepared_once_it_is_over(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept = Event()
    monkeypatch.setattr(run_cache, "keep", lambda *_: kept.set())
    with ExclusiveUse() as use:
        use.lock_file(own.name, own / RUN_LOCK, own.name, lasting=False)
        answer(RunCache(own.parent), PREPARE, {"run": own.name}, "")
        assert not kept.is_set()
    answer(RunCache(own.parent), PREPARE, {"run": own.name}, "")
    assert kept.wait(20)


def test_an_answer_does_not_wait_for_the_file(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pyramid, "AT_LEAST", 1)
    written = Event()
    monkeypatch.setattr(pyramid, "write_file", lambda *given: (written.wait(20), write_file(*given)))
    with RunReader(own) as reader:
        assert RunCache(own.parent).pyramid(reader).kept
    assert not (own / "samples.pyramid").exists()
    written.set()


@pytest.mark.parametrize("damage", [b"", b"\x93NUMPY", b"x" * 100])
def test_a_damaged_file_is_made_anew(damage: bytes, own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pyramid, "AT_LEAST", 1)
    first = made(own)
    (own / "samples.pyramid").write_bytes(damage)
    assert np.array_equal(made(own).first.low, first.first.low, equal_nan=True)


def test_a_file_of_other_samples_is_not_used(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pyramid, "AT_LEAST", 1)
    made(own)
    kept = (own / "samples.pyramid").read_bytes()
    with sqlite3.connect(own / "run.db") as database:
        database.execute("DELETE FROM sample_block WHERE id = (SELECT max(id) FROM sample_block)")
    fewer = made(own)
    assert (own / "samples.pyramid").read_bytes() != kept
    assert len(fewer.first.t_s) < len(made(own, lasting=False).first.t_s) + 1


def test_a_growing_run_adds_only_its_new_blocks(own: Path) -> None:
    whole = made(own, lasting=False)
    with sqlite3.connect(own / "run.db") as database:
        last = database.execute("SELECT * FROM sample_block ORDER BY id DESC LIMIT 1").fetchone()
        database.execute("DELETE FROM sample_block WHERE id = ?", (last[0],))
    before = made(own, lasting=False)
    with sqlite3.connect(own / "run.db") as database:
        database.execute(f"INSERT INTO sample_block VALUES ({', '.join('?' * len(last))})", last)
    after = made(own, before, lasting=False)
    assert np.array_equal(after.first.t_s, whole.first.t_s)
    assert np.array_equal(after.first.high, whole.first.high, equal_nan=True)
