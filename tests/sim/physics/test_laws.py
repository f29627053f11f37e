"""Laws of friction by name."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from sim.physics import laws
from sim.physics.friction import FrictionModel, UnknownCompoundError
from sim.physics.wlf import WlfBell


class Coulomb:
    """The oldest law."""

    def __init__(self, coefficient: float) -> None:
        self.coefficient = coefficient

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        return self.coefficient


def coulomb(compound: str, figures: Mapping[str, float]) -> Coulomb:
    return Coulomb(figures.get("mu", 0.8))


@pytest.fixture(autouse=True)
def forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a test registers is gone after it."""
    monkeypatch.setattr(laws, "_LAWS", dict(laws._LAWS))
    monkeypatch.setattr(laws, "_FINDERS", [])


@pytest.mark.parametrize("name", ["paper", "v2"])
def test_the_papers_laws_are_their_models(name: str) -> None:
    assert laws.make(name, "1#").mu(40.0, 200.0, 0.3) == FrictionModel("1#", name).mu(40.0, 200.0, 0.3)


def test_the_bell_takes_its_figures() -> None:
    law = laws.make("wlf_bell", "SBR", {"mu_max": 3.0})
    assert isinstance(law, WlfBell) and law.parameters.mu_max == 3.0


def test_a_registered_law_is_found_by_its_name() -> None:
    laws.register("coulomb", coulomb)
    assert laws.make("coulomb", "any", {"mu": 0.6}).mu(20.0, 1.0, 1.0) == 0.6
    assert "coulomb" in laws.names()


def test_a_name_is_given_once() -> None:
    with pytest.raises(ValueError, match="'paper' is there already"):
        laws.register("paper", coulomb)


def test_a_law_that_is_not_known_is_looked_up_elsewhere() -> None:
    laws.look_up_with(lambda name: coulomb if name == "far.away:coulomb" else None)
    assert laws.make("far.away:coulomb", "any").mu(20.0, 1.0, 1.0) == 0.8
    with pytest.raises(laws.UnknownLawError, match="no friction law 'nowhere'"):
        laws.find("nowhere")


def test_an_unknown_law_is_told_with_those_that_are_there() -> None:
    with pytest.raises(laws.UnknownLawError, match="no friction law 'magic'; known: paper, v2, wlf_bell"):
        laws.make("magic", "1#")


def test_the_papers_laws_know_their_compounds_and_take_no_figures() -> None:
    with pytest.raises(UnknownCompoundError):
        laws.make("paper", "9#")
    with pytest.raises(ValueError, match="takes none, not mu"):
        laws.make("paper", "1#", {"mu": 1.0})
