"""The first coefficient: compound, temperature, plausibility."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import yaml

from sim.physics.slip import predict
from tester.kinds.wheel_on_belt.commission import first
from tester.machine.commission.commission_step import Notes, StepRefused
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named

SOAKED = {"hub_c": 42.0, "cold_hub_c": 23.0, "cold_c": 22.0}


def measured(mu: float, compound: str) -> tuple[Notes, list[str], list[str]]:
    """Take a first coefficient that came out as ``mu``."""
    ran: list[str] = []
    told: list[str] = []

    def run_recipe(name: str, text: str) -> Mapping[str, Any]:
        ran.append(text)
        return {"run": "r", "rig_s": 1.0, "conditions": [{"mu": mu, "s": 0.01, "n": 3, "expanded": 0.03}]}

    done = {"touch": {"compound": compound}, "thermometer": SOAKED}
    notes = Notes(told.append, lambda text, values: None, done)
    first.coefficient(believed(), run_recipe, notes)
    return notes, told, ran


def expected(compound: str, notes: Notes) -> float:
    return predict(compound, 0.1, 100.0, notes.values["temperature_c"], 0.0, 0.8)


def test_the_hub_stays_below_the_soak() -> None:
    rig = believed()
    _, rolling = first.loss_ratios(rig)
    warm_c = first.as_soaked_c(rig, {"thermometer": SOAKED})
    hub_c = 23.0 + (warm_c - 22.0) * (1.0 + rolling)
    assert hub_c == pytest.approx(39.0)


def test_a_coefficient_near_its_compounds_model_passes_without_a_word() -> None:
    notes, told, _ = measured(0.55, "1#")
    assert notes.values["expected_mu"] == pytest.approx(expected("1#", notes))
    assert not told


def test_a_coefficient_a_third_off_is_reported() -> None:
    _, told, _ = measured(0.70, "1#")
    assert "take care" in told[0]


@pytest.mark.parametrize(("mu", "compound"), [(0.72, "2#"), (0.20, "1#"), (1.2, "3#")])
def test_an_impossible_coefficient_is_refused(mu: float, compound: str) -> None:
    with pytest.raises(StepRefused, match=f"of {compound} is .* off what its model gives"):
        measured(mu, compound)


def test_an_unknown_compound_is_compared_with_rubber_in_general() -> None:
    notes, told, ran = measured(0.9, 'tread "A", 60 phr')
    assert notes.values["expected_mu"] is None and "is unknown" in told[0]
    assert yaml.safe_load(ran[0])["specimens"][0]["compound"] == 'tread "A", 60 phr'
    with pytest.raises(StepRefused, match="rubber on an abrasive"):
        measured(0.01, "mine")


@pytest.mark.parametrize(("given", "compound"), [("", "1#"), ("2#", "2#")])
def test_the_compound_is_asked_for_and_on_record(tmp_path: Any, given: str, compound: str) -> None:
    bench = Bench(tmp_path / "r.jsonl", steps=named("touch"), given={"compound": given} if given else {})
    bench.run()
    last = bench.record.last("touch")
    assert last is not None and last.values["compound"] == compound
    assert any(question.key.startswith("compound") for question in bench.person.asked)
