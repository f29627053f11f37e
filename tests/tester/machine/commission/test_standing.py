"""How the steps stand by the record, in words."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.machine.commission.record import BEGUN, DONE, REFUSED, CommissionRecord
from tester.machine.commission.standing import standing_of
from tester.machine.commission.step import CommissionStep, sections_sha256
from tester.run.kinds import load_rig

STEP = CommissionStep("jog", "a jog", ("can",))


@pytest.mark.parametrize(
    ("what", "same", "words"),
    [
        (DONE, True, "done on 2026-11-23, me: told"),
        (DONE, False, "to be done again (the rig file has changed under it, 2026-11-23): told"),
        (BEGUN, True, "to be done again (was cut off, 2026-11-23): told"),
        (REFUSED, True, "to be done again (refused, 2026-11-23): told"),
    ],
)
def test_a_step_stands_by_its_newest_entry_and_the_rig_file(what: str, same: bool, words: str, tmp_path: Path) -> None:
    rig = load_rig("sim")
    record = CommissionRecord(tmp_path / "r.jsonl", lambda: "2026-11-23T10:00:00Z", "me")
    (fresh,) = standing_of(record, (STEP,), rig)
    assert fresh.words == "to be done" and fresh.stands is None
    record.add("rig", "", sections_sha256(rig, STEP.sections) if same else "another", "jog", what, "told")
    (found,) = standing_of(record, (STEP,), rig)
    assert found.words == words and (found.stands is not None) == (what == DONE and same)
