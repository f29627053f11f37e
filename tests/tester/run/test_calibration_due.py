"""An expired certificate: a start warns or is refused, by the rig file; the budget has the weights' result."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import pytest

from tester.analysis.terms import Acts
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.run.endings import CannotStartError
from tester.run.kind_lookup import load_rig, recipe_part, run_parts
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE
from tests.tester.run.test_session import Screen

ENDED = "calibration.load_cell=2020-01-31"


def session(home: Path, *overrides: str) -> tuple[Session, Screen]:
    (home / "short.yaml").write_text(AT_ONCE, encoding="utf-8")
    screen = Screen()
    options = SessionOptions(recipe=str(home / "short.yaml"), out=home / "runs", overrides=overrides)
    return Session(options, screen), screen


def test_an_overdue_calibration_refuses_the_start_where_the_rig_file_asks_for_it(tmp_path: Path) -> None:
    one, _ = session(tmp_path, ENDED, "calibration.overdue=refuse")
    with pytest.raises(CannotStartError, match="load cell ended 2020-01-31"):
        one.run()
    assert not (tmp_path / "runs").exists()


def test_an_overdue_calibration_warns_by_default(tmp_path: Path) -> None:
    one, screen = session(tmp_path, ENDED)
    assert one.run() == 0
    assert "calibration overdue: load cell ended 2020-01-31" in screen.messages


def test_a_calibration_holds_on_its_last_day() -> None:
    calibration = load_rig("sim", [ENDED]).certificates()
    assert calibration.over(date(2020, 1, 31)) == ""
    assert calibration.over(date(2020, 2, 1)) == "load cell ended 2020-01-31"


def test_without_a_record_the_budget_is_as_it_was() -> None:
    rig = load_rig("sim")
    assert recipe_part(rig).terms(rig) == TERMS


def test_the_result_of_weights_is_a_term_and_the_run_names_the_record() -> None:
    rig = load_rig("sim", ["calibration.cell_sensitivity=0.26 %", f"calibration.record={'a' * 64}"])
    term = next(one for one in recipe_part(rig).terms(rig) if one.name == "cell sensitivity")
    assert (term.acts, term.bound) == (Acts.COEFFICIENT, pytest.approx(0.0026))
    assert "aaaaaaaaaaaa" in term.source
    found = {one.quantity: one.value for one in run_parts(rig).calibration(rig)}
    assert found["calibration record"] == "a" * 64
