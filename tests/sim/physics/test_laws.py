"""Laws of friction by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, replace

import pytest

from sim.physics import laws
from sim.physics.friction import COMPOUNDS, V2, FrictionModel, UnknownCompoundError
from sim.physics.materials import Components, Rubber, Surface
from sim.physics.wlf import WlfBell
from tester.kinds.wheel_on_belt.fit.laws import PAPER, joint_of
from tests.sim.physics.materials_example import Shelf


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
    """Laws that a test registers are removed after it."""
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


def test_an_unknown_law_is_reported_with_the_known_ones() -> None:
    known = "paper, v2, wlf_bell, two_bells, power, arrhenius, persson, greta"
    with pytest.raises(laws.UnknownLawError, match=f"no friction law 'magic'; known: {known}"):
        laws.make("magic", "1#")


def test_the_papers_laws_know_their_compounds_or_take_all_their_figures() -> None:
    with pytest.raises(UnknownCompoundError):
        laws.make("paper", "9#")
    with pytest.raises(ValueError, match="all of them, not mu"):
        laws.make("paper", "1#", {"mu": 1.0})
    own = laws.make("v2", "9#", asdict(V2["2#"]))
    assert own.mu(40.0, 200.0, 0.3) == laws.make("v2", "2#").mu(40.0, 200.0, 0.3)


def test_equation_6_takes_its_figures_printed_or_normalised() -> None:
    printed = laws.make("paper", "9#", asdict(COMPOUNDS["3#"]))
    normalised = laws.make("paper", "9#", dict(zip(PAPER.names, joint_of(COMPOUNDS["3#"]), strict=True)))
    for at in ((25.0, 100.0, 0.1), (40.0, 200.0, 0.3), (85.0, 400.0, 0.0)):
        assert printed.mu(*at) == laws.make("paper", "3#").mu(*at)
        assert normalised.mu(*at) == pytest.approx(printed.mu(*at), rel=1e-12)


def test_a_law_that_has_no_value_without_slip_is_refused() -> None:
    with pytest.raises(ValueError, match="b2 must be above 0"):
        laws.make("v2", "9#", asdict(V2["2#"]) | {"b2": -0.1})


SETTING = laws.LawSetting(Shelf(), "grit", 100.0)


def test_a_law_of_materials_is_made_of_the_materials_that_the_setting_finds() -> None:
    law = laws.with_parts("persson", laws.make("persson", "plain", setting=SETTING))
    # 10 N on 100 mm2 are 1e5 Pa.
    assert law.mu(20.0, 10.0, 1.0) == pytest.approx(0.291203, rel=1e-4)
    assert law.components(20.0, 10.0, 1.0) == Components(0.0, law.mu(20.0, 10.0, 1.0))


def test_a_law_of_materials_may_come_from_elsewhere() -> None:
    def made(rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> Coulomb:
        return Coulomb(area_mm2 * figures["per_mm2"] * len(rubber.name + surface.name))

    laws.register("lab", laws.OfMaterials(made))
    assert laws.make("lab", "SBR", {"per_mm2": 1e-3}, SETTING).mu(20.0, 50.0, 1.0) == pytest.approx(0.7)


def test_greta_is_given_the_area_of_the_setting() -> None:
    setting = replace(SETTING, surface="road")
    one = laws.with_parts("greta", laws.make("greta", "demonstration", setting=setting))
    wide = laws.with_parts("greta", laws.make("greta", "demonstration", setting=replace(setting, area_mm2=200.0)))
    assert one.components(25.0, 30.0, 1.0) == wide.components(25.0, 60.0, 1.0)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (laws.NO_SETTING, "needs the modulus of 'SBR' and a surface and the nominal area of contact"),
        (replace(SETTING, surface=""), "'persson' is made of materials and needs a surface$"),
        (replace(SETTING, area_mm2=None), "needs the nominal area of contact$"),
        (replace(SETTING, area_mm2=0.0), "must be finite and above 0 mm2"),
        (replace(SETTING, surface="glass"), "no surface 'glass' on the shelf"),
    ],
)
def test_a_setting_that_lacks_something_is_refused(setting: laws.LawSetting, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        laws.make("persson", "SBR", setting=setting)


def test_a_law_with_unknown_parts_reports_it() -> None:
    with pytest.raises(laws.NoPartsError, match="law 'paper' gives the coefficient alone"):
        laws.with_parts("paper", laws.make("paper", "1#"))
