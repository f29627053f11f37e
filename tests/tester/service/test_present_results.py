"""Results of the run under way: those of the tables, computed in a separate process while a client views them."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest

from tester.results.conditions_table import conditions_table, value_words
from tester.results.run_results import results_of
from tester.service.asked_process import RefusedQuestionError
from tester.service.live_results import LiveResults
from tester.service.present_results import PresentResults
from tester.service.protocol import Event, encode
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.results.test_so_far import VALUES, running

DESIGN = [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)]


def test_values_are_those_of_the_table(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "one", DESIGN, failed=[2])
    found = PresentResults(tmp_path).answer("one")
    assert isinstance(found, dict)
    with RunReader(folder) as reader:
        table = conditions_table(results_of(reader))
    first, second = found["conditions"]
    assert first["text"] == value_words(table, table.rows[0]) and first["over"]
    assert (first["mu"], first["u"]) == (table["mu"].as_json(table.rows[0]), table["u_expanded"].as_json(table.rows[0]))
    assert (second["mu"], second["text"], second["over"]) == (None, "not reached", True)
    assert found["over"] and found["growing"] is None


@pytest.mark.parametrize("name", ["", "none", "../one", ".", 7, None])
def test_a_name_that_is_no_run_of_the_folder_is_refused(tmp_path: Path, name: object) -> None:
    made_run(tmp_path / "one", DESIGN)
    with pytest.raises(RefusedQuestionError):
        PresentResults(tmp_path / "runs").answer(name)  # type: ignore[arg-type]


def test_a_new_repeat_is_seen_and_the_same_record_is_not_reduced_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import tester.service.present_results as module

    made: list[int] = []
    real = module.results_of
    monkeypatch.setattr(module, "results_of", lambda reader: (made.append(1), real(reader))[1])
    running(tmp_path / "one", VALUES[:2])
    present = PresentResults(tmp_path)
    first = present.answer("one")
    assert present.answer("one") == first and len(made) == 1
    running(tmp_path / "two", VALUES[:3])
    (tmp_path / "one" / "run.db").unlink()
    (tmp_path / "two" / "run.db").rename(tmp_path / "one" / "run.db")
    assert present.answer("one") != first and len(made) == 2


def test_parts_of_a_simulated_run_are_read_where_they_are_recorded(tmp_path: Path) -> None:
    running(tmp_path / "one", ())
    (tmp_path / "one" / "parts").mkdir()
    part = running(tmp_path / "one" / "parts" / "1", VALUES, before=True)
    found = PresentResults(tmp_path).answer("one")
    assert isinstance(found, dict)
    with RunReader(part) as reader:
        table = conditions_table(results_of(reader))
    assert [one["text"] for one in found["conditions"]] == [value_words(table, row) for row in table.rows]
    assert found["run"] == "one"


def test_an_event_brings_results_to_the_clients_only_while_one_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import tester.service.live_results as module

    monkeypatch.setattr(module, "GROWS_S", 0.01)
    monkeypatch.setattr(module, "LEAST_S", 0.0)
    made_run(tmp_path / "one", DESIGN)
    there: list[int] = []
    sent: list[bytes] = []

    async def act() -> None:
        live = LiveResults(tmp_path, sent.append, lambda: bool(there))
        work = asyncio.create_task(live.work())
        live.event(encode(Event(1, 0.0, "", "repeat", "info", "", "one")))
        await asyncio.sleep(0.1)
        assert not sent
        there.append(1)
        async with asyncio.timeout(30.0):
            while not sent:
                await asyncio.sleep(0.01)
        assert live.encoded == sent[0]
        work.cancel()
        await asyncio.gather(work, return_exceptions=True)

    asyncio.run(act())
    assert [one["condition"] for one in json.loads(sent[0])["conditions"]] == [1, 2] and len(sent) == 1
