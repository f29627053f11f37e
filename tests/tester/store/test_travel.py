"""Travel of counterface and piece: on record with each repeat, and for a resumed run."""

from __future__ import annotations

from pathlib import Path

from tester.store.records import Travel
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tests.tester.store.build import CONDITIONS, PIECE, RUN, SPECIMENS, open_writer


def test_it_is_known_of_each_repeat_and_of_the_last_state(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.piece_mounted(PIECE)
    key = writer.begin_repeat(1, 1, 1, 9.0, piece=1)
    writer.travelled(1, Travel(120.0, 30.0), key)
    for travel_m in (150.0, 180.0):
        writer.travelled(1, Travel(travel_m, 35.0))
    writer.close()
    with RunReader(tmp_path) as reader:
        assert reader.travels() == {key: Travel(120.0, 30.0)}
        assert resume_point(reader).stand.travels_m == {"": 180.0}
        found = reader.chain()
    assert not found.problems


def test_every_surface_has_its_own_travel_and_the_last_state_is_that_of_the_mounted_one(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.piece_mounted(PIECE)
    writer.surface_changed(5.0, "A", {"": 0.0, "A": 0.0})
    writer.travelled(1, Travel(180.0, 30.0))
    writer.surface_changed(99.0, "B", {"": 0.0, "A": 200.0, "B": 0.0})
    writer.travelled(1, Travel(0.0, 35.0))
    writer.travelled(1, Travel(70.0, 40.0))
    writer.close()
    with RunReader(tmp_path) as reader:
        assert resume_point(reader).stand.travels_m == {"": 0.0, "A": 200.0, "B": 70.0}
        assert [event.text for event in reader.events() if event.kind == "surface"] == [
            "A is on, after 0 m under load", "B is on, after 0 m under load"
        ]  # fmt: skip
