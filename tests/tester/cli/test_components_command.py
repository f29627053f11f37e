"""``tester components``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from tester.cli.main import invoke
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run
from tests.tester.kinds.wheel_on_belt.fit.made import made_run


def split_run(folder: Path, interfaces: tuple[str, ...] = ("dry", "wet"), repeats: int = 3) -> Path:
    """Return a run in which the film changes nothing: all is hysteresis."""
    speeds = (1e-4, 1e-3, 1e-2)
    return made_track_run(folder, (0.0, 20.0), speeds, interfaces=interfaces, repeats=repeats, scatter=0.01)


def data(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, Any]:
    assert invoke([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_each_pair_has_its_parts_with_the_assumptions(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = split_run(tmp_path / "one")
    found = data(capsys, "components", str(run))
    assert len(found["conditions"]) == 6 and len(found["means"]) == 1
    for one in found["conditions"]:
        both = one["adhesion"]["value"] + one["hysteresis"]["value"]
        assert both == pytest.approx(one["mu_dry_as_measured"], rel=1e-9)
        assert 0.0 < one["hysteresis_share"]["U"] < 0.2
        assert one["hysteresis_share"]["value"] == pytest.approx(1.0, abs=one["hysteresis_share"]["U"] * 1.5)
    assert "takes all adhesion away" in found["assumed"][0]


def test_people_get_a_table_and_the_mean(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = split_run(tmp_path / "one", ("dry", "wet", "talc"))
    assert invoke(["components", str(run)]) == 0
    told = capsys.readouterr().out.splitlines()
    assert sum("±" in line and "mean of 6 conditions" in line for line in told) == 2
    assert sum("mm/s" in line and line.count("±") == 3 for line in told) == 12
    assert any(line.startswith("assumed: the film") for line in told)


def test_conditions_measured_once_have_no_uncertainty_and_the_output_states_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = split_run(tmp_path / "one", repeats=1)
    assert invoke(["components", str(run)]) == 0
    told = capsys.readouterr().out
    assert "±" not in told and "measured once" in told


def test_a_run_without_a_film_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = split_run(tmp_path / "one", ("dry",))
    assert invoke(["components", str(run)]) == 1
    assert "no condition has a value both dry and with a film" in capsys.readouterr().err


def test_a_machine_without_interfaces_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = made_run(tmp_path / "wheel")
    assert invoke(["components", str(run)]) == 1
    assert "do not say what is in the contact" in capsys.readouterr().err
