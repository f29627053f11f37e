"""Which law a compound has on the simulated wheel."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.physics import laws
from sim.physics.friction import KNOWN, UnknownCompoundError
from sim.physics.laws import LawSetting, StatedLaw
from sim.physics.tabulated import TabulatedLaw
from sim.physics.wheel_law import ASSUMED, known_law, wheel_law
from tests.sim.physics.materials_example import Shelf

AT = 40.0, 200.0, 0.3
OWN = StatedLaw("power", {"a": 0.7, "n": 0.3}, 0.2)


def stating(name: str) -> StatedLaw | None:
    return OWN if name == "own" else None


@pytest.mark.parametrize("compound", KNOWN)
@pytest.mark.parametrize("model", ["paper", "v2"])
def test_the_papers_compounds_keep_their_laws_whatever_a_file_states(model: str, compound: str) -> None:
    found = wheel_law(model, compound, LawSetting(stated=lambda name: OWN))
    assert found.mu(*AT) == laws.make(model, compound).mu(*AT) and not found.assumed
    assert found.cornering_factor(-30.0) == pytest.approx(1.29 if compound == "1#" else 1.0)


def test_a_compound_without_a_law_rubs_as_the_assumed_one_and_the_law_reports_it() -> None:
    found = wheel_law("v2", "none", LawSetting(stated=stating))
    assert found.mu(*AT) == laws.make("v2", ASSUMED).mu(*AT)
    assert "'none' is assumed, not known" in found.assumed and found.cornering == 0.0


def test_a_law_of_a_file_counts_where_the_rig_names_the_papers_or_the_same() -> None:
    for model in ("paper", "v2", "power"):
        found = wheel_law(model, "own", LawSetting(stated=stating))
        assert found.mu(*AT) == laws.make("power", "own", OWN.figures).mu(*AT)
        assert (found.cornering, found.assumed) == (0.2, "")
    other = wheel_law("arrhenius", "own", LawSetting(stated=stating))
    assert other.mu(*AT) == laws.make("arrhenius", "own").mu(*AT)


def test_a_law_of_materials_is_made_of_the_modulus_on_the_wheels_area(tmp_path: Path) -> None:
    setting = LawSetting(Shelf(), "grit", tables=tmp_path)
    slow = wheel_law("persson", "SBR", setting, 540.0)
    quick = wheel_law("persson", "SBR", setting, 540.0, quick=True)
    expected = laws.make("persson", "SBR", setting=LawSetting(Shelf(), "grit", 540.0)).mu(*AT)
    assert slow.mu(*AT) == expected and isinstance(quick.law, TabulatedLaw)
    assert quick.mu(*AT) == pytest.approx(expected, rel=0.005)
    with pytest.raises(ValueError, match="needs the modulus of '1#' and a surface"):
        wheel_law("persson", "1#", area_mm2=540.0)


def test_a_law_is_known_without_files_only_of_the_papers_compounds() -> None:
    law = known_law("v2", "2#")
    assert law is not None and law.mu(*AT) == laws.make("v2", "2#").mu(*AT)
    assert known_law("v2", "own") is None and known_law("greta", "1#") is None


def test_a_law_from_elsewhere_may_refuse_a_compound(monkeypatch: pytest.MonkeyPatch) -> None:
    def picky(compound: str, figures: object) -> laws.FrictionLaw:
        raise UnknownCompoundError(compound)

    monkeypatch.setattr(laws, "_LAWS", {**laws._LAWS, "picky": picky})
    with pytest.raises(UnknownCompoundError):
        wheel_law("picky", "own", LawSetting(stated=stating))
