"""A laboratory's interlock: a kind that adds one row to the wheel's."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.cli.main import invoke
from tester.inputs.rig import Rig
from tester.kinds import UnknownKindError, find, load_rig, load_rig_text, packaged_keys, packaged_text, wheel_on_belt
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.store.run_reader import RunReader
from tests.extension.installing import installed
from tests.tester.kinds.wheel_on_belt.bench import SHORT


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A laboratory's folder: its module is installed, its rig file names the kind."""
    own = packaged_text().replace("\nkind: wheel_on_belt", "\nkind: lab_wheel:KIND", 1)
    (tmp_path / "my-rig.yaml").write_text(own, encoding="utf-8")
    (tmp_path / "short.yaml").write_text(SHORT, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with installed("interlock", tmp_path / "site", monkeypatch):
        yield tmp_path


def run_of(folder: Path) -> Path:
    (found,) = (path for path in (folder / "runs").iterdir() if (path / "run.db").exists())
    return found


def test_its_fault_trips_it_first_and_the_trip_is_on_record(folder: Path) -> None:
    from lab_wheel import FAULT

    fault = f'sim.faults=["t=40 s: {FAULT}"]'
    assert invoke(["run", "short.yaml", "--rig", "my-rig.yaml", "--set", fault, "--yes"]) == 5
    with closing(RunReader(run_of(folder))) as reader:
        first = next(iter(reader.trips()))
        assert 'kind: "lab_wheel:KIND"' in reader.run().info.rig_text
    assert (first.interlock, first.unit) == ("rubber hotter than hub", "K")
    assert first.value > first.limit_value == 8.0


def test_without_the_fault_nothing_trips(folder: Path) -> None:
    assert invoke(["run", "short.yaml", "--rig", "my-rig.yaml", "--yes"]) == 0
    assert invoke(["verify", str(run_of(folder))]) == 0


def test_its_parameter_is_a_key_of_the_rig_file_with_its_default() -> None:
    assert packaged_keys("my-rig.yaml") == ("interlocks.surface_excess",)
    assert load_rig("my-rig.yaml").interlocks.surface_excess_k == 8.0
    assert load_rig("my-rig.yaml", ["interlocks.surface_excess=7 K"]).interlocks.surface_excess_k == 7.0
    with pytest.raises(InvalidSource, match="surface_excess"):
        load_rig("my-rig.yaml", ["interlocks.surface_excess=31 K"])


def test_the_rig_is_stored_and_sent_to_other_processes_as_it_is() -> None:
    rig = load_rig("my-rig.yaml")
    assert load_rig_text(rig.text) == rig
    assert pickle.loads(pickle.dumps(rig)) == rig  # noqa: S301 - our own


def test_the_kind_it_was_made_from_is_as_it_was() -> None:
    assert "rubber hotter than hub" in find("lab_wheel:KIND").interlocks().table()
    assert "rubber hotter than hub" not in {row.name for row in TABLE.rows}


def test_a_row_that_control_would_not_evaluate_is_refused() -> None:
    import lab_wheel

    shown = replace(lab_wheel.KIND, rig=wheel_on_belt.KIND.rig)
    lab_wheel.KIND, kind = shown, lab_wheel.KIND
    try:
        with pytest.raises(UnknownKindError, match="lacks rubber hotter than hub, which its interlocks list"):
            find("lab_wheel:KIND")
    finally:
        lab_wheel.KIND = kind


def test_a_rig_class_without_a_table_takes_no_row() -> None:
    import lab_wheel

    kind = wheel_on_belt.KIND.extended("lab:KIND", "a lab's", rows=[lab_wheel.HOTTER_THAN_HUB])
    bare = replace(wheel_on_belt.KIND, rig=lambda: Rig).extended(
        "lab:KIND", "a lab's", rows=[lab_wheel.HOTTER_THAN_HUB]
    )
    assert kind.rig().table.rows[0] is lab_wheel.HOTTER_THAN_HUB
    with pytest.raises(TypeError, match="Rig has no interlock table that rows could join"):
        bare.rig()
