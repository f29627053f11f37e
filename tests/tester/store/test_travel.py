"""How far counterface and piece have come: on record with each repeat, and for a run that goes on."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

from tester.store.reader import DATABASE, RunReader
from tester.store.records import Travel
from tester.store.resume import resume_point
from tests.tester.store.build import CONDITIONS, PIECE, RUN, SPECIMENS, open_writer, without_looks


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
        assert resume_point(reader).stand.travel_m == 180.0
        found = reader.chain()
    assert found is not None and not found.problems


def test_a_record_of_before_says_nothing_of_it(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.close()
    with closing(sqlite3.connect(tmp_path / DATABASE)) as database:
        database.execute("DROP TABLE travel")
        database.execute("DROP TABLE material")
        without_looks(database)
        database.execute("PRAGMA user_version = 10")
        database.commit()
    with RunReader(tmp_path) as reader:
        assert reader.travels() == {} and reader.counterface_m() == 0.0
