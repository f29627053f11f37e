"""Packaged compounds and surfaces: each is read without a doubt and matches its stated figures."""

from __future__ import annotations

import tomllib
from itertools import pairwise
from math import exp, log10, pi
from pathlib import Path

import numpy as np
import pytest
import yaml

import recipes
from sim.physics import laws
from sim.physics.laws import LawSetting
from sim.physics.loss_maxima import loss_maxima
from sim.physics.moduli import FractionalZener
from sim.physics.persson import PerssonLaw
from sim.physics.roughness import SelfAffine, TabulatedSpectrum
from sim.physics.track_bells import RUBBERS, SURFACES
from tester.base.validation import editor_text
from tester.inputs.materials.formula_facts import formula_facts
from tester.inputs.materials.library import Library
from tester.inputs.materials.material_schema import CompoundModel, SurfaceModel

LIBRARY = Library([recipes.FOLDER])
COMPOUNDS = [one.name for one in LIBRARY.entries("compound")]
SURFACE_FILES = [one.name for one in LIBRARY.entries("surface")]


def test_the_packaged_materials() -> None:
    assert sorted(COMPOUNDS) == ["1#", "2#", "3#", "ABR", "INR", "NBR", "NR", "SBR", "butyl", "tread", "tread soft"]
    assert sorted(SURFACE_FILES) == [
        "S0", "anti-slip tape", "asphalt", "concrete", "glass", "granite", "polished steel", "road", "silicon carbide",
        "wavy glass", "zirconia corundum belt",
    ]  # fmt: skip


@pytest.mark.parametrize("name", COMPOUNDS)
def test_a_compound_is_read_without_a_doubt(name: str) -> None:
    one = LIBRARY.compound(name)
    assert one.file.doubts == () and one.model.source


@pytest.mark.parametrize("name", SURFACE_FILES)
def test_a_surface_is_read_without_a_doubt(name: str) -> None:
    one = LIBRARY.surface_file(name)
    assert one.file.doubts == () and one.model.source and ("[A]" in one.model.source or "doi " in one.model.source)


def uncovered(section: dict[str, object], covered: frozenset[str]) -> list[str]:
    """Return the keys of a file whose number, or text with a unit, has no source of its own or of its section."""
    missing: list[str] = []
    for key, value in section.items():
        if key in covered or key in ("name", "note", "source", "sources", "doubts", "columns"):
            continue
        if isinstance(value, dict):
            missing += [] if "source" in value else uncovered(value, covered)
        elif not isinstance(value, str) or any(letter.isdigit() for letter in value):
            missing.append(key)
    return missing


@pytest.mark.parametrize("path", sorted(recipes.FOLDER.glob("*/*.yaml")), ids=lambda path: path.stem)
def test_every_number_of_a_file_has_its_source(path: Path) -> None:
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    sources = content["sources"]
    assert uncovered(content, frozenset(sources)) == []
    # A source is a publication's place or an assumption.
    marks = ("[A]", "doi ", "Table ", "section ", "paper S", "as printed", "handbook", "Handbook")
    assert [text for text in sources.values() if not any(mark in text for mark in marks)] == []


def test_a_number_without_a_source_is_found() -> None:
    content = yaml.safe_load((recipes.FOLDER / "surfaces" / "granite.yaml").read_text(encoding="utf-8"))
    assert uncovered(content, frozenset({"q0", "q1", "H"})) == ["C0"]


@pytest.mark.parametrize(
    ("name", "rms_um", "longest_um", "slope"),
    [
        ("S0", 20.0, 314.2, 1.03), ("asphalt", 400.0, 9900.0, 1.17), ("concrete", 80.0, 2000.0, 1.16),
        ("glass", 2e-3, 100.0, 0.00097), ("granite", 150.0, 5000.0, 0.87), ("polished steel", 0.125, 100.0, 0.036),
        ("silicon carbide", 12.0, 150.0, 1.25), ("zirconia corundum belt", 27.5, 344.0, 1.25),
        ("wavy glass", 1.0, 1e4, 0.0015),
    ],
)  # fmt: skip
def test_a_surface_has_the_roughness_and_the_slope_that_its_file_states(
    name: str, rms_um: float, longest_um: float, slope: float
) -> None:
    spectrum = LIBRARY.surface(name).spectrum
    assert isinstance(spectrum, SelfAffine | TabulatedSpectrum)
    assert 1e6 * spectrum.rms_height_m == pytest.approx(rms_um, rel=2e-3)
    assert 2e6 * pi / spectrum.band_1_m[0] == pytest.approx(longest_um, rel=1e-3)
    assert spectrum.rms_slope == pytest.approx(slope, rel=0.02)


@pytest.mark.parametrize("name", [name for name in COMPOUNDS if not name.endswith("#")])
def test_an_invented_compound_is_marked_as_such(name: str) -> None:
    assert "[A]" in (LIBRARY.compound(name).model.source or "")


@pytest.mark.parametrize(
    ("name", "rubber", "filler", "sulphur", "sum_phr"),
    [("1#", 100.0, 60.0, 1.1, 171.3), ("2#", 100.0, 60.0, 1.2, 177.3), ("3#", 100.0, 55.0, 1.4, 169.07)],
)
def test_the_papers_compounds_are_those_of_its_table_1(
    name: str, rubber: float, filler: float, sulphur: float, sum_phr: float
) -> None:
    model = LIBRARY.compound(name).model
    parts = model.formulation
    assert sum(parts.get(one, 0.0) for one in ("NR", "3#RSS", "STR20", "BR")) == rubber
    assert sum(parts.get(one, 0.0) for one in ("N234", "N115", "175GR")) == filler
    assert (parts["S"], parts["ZnO"], sum(parts.values())) == (sulphur, 3.5, pytest.approx(sum_phr))
    assert model.cure is not None and (model.cure.temperature, model.cure.time) == (150.0, 1500.0)


@pytest.mark.parametrize("name", list(RUBBERS))
def test_rubbers_of_the_simulated_track_have_their_glass_transition(name: str) -> None:
    rubber = LIBRARY.rubber(name)
    assert rubber.glass_c == RUBBERS[name].t_ref - 50.0


@pytest.mark.parametrize("name", list(RUBBERS))
def test_rubbers_of_the_simulated_track_lose_most_where_their_file_does(name: str) -> None:
    of_modulus_hz, of_factor_hz = loss_maxima(LIBRARY.rubber(name).modulus, RUBBERS[name].t_ref)
    assert RUBBERS[name].loss_modulus == pytest.approx(of_modulus_hz, rel=1e-3)
    assert RUBBERS[name].loss_factor == pytest.approx(of_factor_hz, rel=1e-3)


@pytest.mark.parametrize("name", list(RUBBERS))
def test_widths_and_hysteresis_of_the_simulated_track_go_with_the_moduli(name: str) -> None:
    own, like = LIBRARY.rubber(name).modulus, LIBRARY.rubber("SBR").modulus
    assert isinstance(own, FractionalZener) and isinstance(like, FractionalZener)
    broader = like.exponent / own.exponent
    rubber, sbr = RUBBERS[name], RUBBERS["SBR"]
    assert rubber.hysteresis_width == pytest.approx(broader * sbr.hysteresis_width, abs=0.006)
    assert rubber.width == pytest.approx(broader * sbr.width, abs=0.06)
    assert rubber.v_ref == pytest.approx(1e-6 * SURFACES["silicon carbide"].grit * rubber.loss_factor, rel=2e-3)
    heights = [highest_hysteresis(one) for one in (name, "SBR")]
    assert rubber.hysteresis / sbr.hysteresis == pytest.approx(heights[0] / heights[1], rel=0.01)


def highest_hysteresis(name: str) -> float:
    """Return the greatest coefficient of hysteresis on silicon carbide by paper S, Eq 1, at 1 bar."""
    spectrum = LIBRARY.surface("silicon carbide").spectrum
    assert spectrum is not None
    law, celsius = PerssonLaw(LIBRARY.rubber(name).modulus, 0.5, spectrum), RUBBERS[name].t_ref + 23.0
    return max(law.contact(celsius, 1e5, v).mu for v in np.logspace(-2.5, -0.5, 21).tolist())


def test_grosch_s_four_rubbers_differ_in_every_fact_of_a_dma() -> None:
    found = {name: formula_facts(LIBRARY.rubber(name)) for name in ("SBR", "ABR", "INR", "butyl")}
    facts = [one for one in found.values() if one is not None]
    assert len(facts) == 4
    for what in ("rubber_pa", "peak_c", "peak", "decade_k"):
        values = sorted(getattr(one, what) for one in facts)
        assert all(b > a * (1.0 + 0.01 * (a > 0.0)) for a, b in pairwise(values)), (what, values)
    assert len({one.glass_pa / one.rubber_pa for one in facts}) == 3


def test_butyl_is_soft_and_relaxes_most_broadly() -> None:
    soft = min(("SBR", "ABR", "INR", "butyl"), key=lambda name: abs(LIBRARY.rubber(name).modulus.complex_pa(
        np.array([1e-6]), 20.0)[0]))  # fmt: skip
    broad = max(("SBR", "ABR", "INR", "butyl"), key=half_width)
    assert (soft, broad) == ("butyl", "butyl")


def half_width(name: str) -> float:
    """Return the decades over which tan delta is above half of its maximum."""
    rates = np.logspace(-8, 16, 2401)
    modulus = LIBRARY.rubber(name).modulus.complex_pa(rates, RUBBERS[name].t_ref)
    tan = modulus.imag / modulus.real
    return float(np.sum(tan > 0.5 * np.max(tan))) * 0.01


def test_the_grit_of_the_simulated_abrasive_is_the_longest_wave_of_its_file() -> None:
    spectrum = LIBRARY.surface("silicon carbide").spectrum
    assert spectrum is not None
    assert 1e-6 * SURFACES["silicon carbide"].grit == pytest.approx(2.0 * np.pi / spectrum.band_1_m[0], rel=1e-3)


@pytest.mark.parametrize("name", list(SURFACES))
def test_surfaces_of_the_simulated_track_have_a_file(name: str) -> None:
    assert LIBRARY.path("surface", name) is not None


def test_recipes_find_their_materials() -> None:
    for path in recipes.FOLDER.glob("*.yaml"):
        recipe = yaml.safe_load(path.read_text(encoding="utf-8"))
        for specimen in recipe["specimens"]:
            assert LIBRARY.path("compound", specimen["compound"]) is not None
        if "abrasive" in recipe:
            assert LIBRARY.path("surface", recipe["abrasive"]["name"]) is not None


def test_the_sbr_has_its_loss_maximum() -> None:
    modulus = LIBRARY.rubber("SBR").modulus.complex_pa(np.logspace(-2, 9, 4000), 20.0)
    assert float(np.max(modulus.imag / modulus.real)) == pytest.approx(1.240, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "rubber_pa", "middle_c", "floor", "peak", "peak_c"),
    [("tread", 7e6, -25.0, 0.12, 0.55, -15.0), ("tread soft", 4e6, -35.0, 0.15, 0.60, -25.0)],
)
def test_a_tread_is_its_formula(
    name: str, rubber_pa: float, middle_c: float, floor: float, peak: float, peak_c: float
) -> None:
    glass_pa = 2e9
    one = LIBRARY.compound(name)
    assert one.table is not None and len(one.table.rows) == 261 and one.table.frequencies_hz == (1.0,)
    for row in one.table.rows:
        t = row.temperature_c
        high = log10(glass_pa) - log10(rubber_pa)
        storage = 10.0 ** (log10(rubber_pa) + high / (1.0 + exp((t - middle_c) / 6.0)))
        assert row.storage_pa == pytest.approx(storage, rel=1e-8)
        tan_delta = floor + peak * exp(-(((t - peak_c) / 18.0) ** 2))
        assert row.loss_pa / row.storage_pa == pytest.approx(tan_delta, rel=1e-7)
    shear = one.model.shear
    assert shear is not None and shear.ratio == pytest.approx(glass_pa / rubber_pa, rel=1e-12)


def test_the_tread_at_100_hz_is_that_of_16_k_less_at_1_hz() -> None:
    modulus = LIBRARY.rubber("tread").modulus
    (fast,) = modulus.complex_pa(np.array([2.0 * pi * 100.0]), 25.0)
    (cold,) = modulus.complex_pa(np.array([2.0 * pi]), 9.0)
    assert fast == pytest.approx(cold, rel=1e-9)


def test_grit_and_road_have_their_stated_lengths() -> None:
    grit = LIBRARY.surface("silicon carbide").spectrum
    assert grit is not None
    assert 2.0 * pi / grit.band_1_m[0] == pytest.approx(150e-6, rel=1e-6)
    road = LIBRARY.surface("road")
    assert road.coarse is not None and road.fine is not None
    assert road.fine.wavelength_m == pytest.approx(road.coarse.wavelength_m / 100.0)
    # m2 of the fine waves, (2 pi Ra / lambda)^2 / 2
    assert (road.fine.ra_m * 2.0 * pi / road.fine.wavelength_m) ** 2 / 2.0 == pytest.approx(0.1289, abs=5e-5)


@pytest.mark.parametrize(("what", "model"), [("compound", CompoundModel), ("surface", SurfaceModel)])
def test_a_schema_is_current(what: str, model: type[CompoundModel] | type[SurfaceModel]) -> None:
    stored = (recipes.FOLDER / f"{what}.schema.json").read_text(encoding="utf-8")
    assert stored == editor_text(model), f"write it again: tester schema --of {what} > recipes/{what}.schema.json"


def test_the_package_takes_every_file_along() -> None:
    project = tomllib.loads((Path(recipes.FOLDER).parent / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]["recipes"]
    for path in recipes.FOLDER.rglob("*"):
        relative = path.relative_to(recipes.FOLDER)
        if path.is_file() and path.suffix in (".yaml", ".csv", ".json"):
            assert any(relative.match(one) and len(relative.parts) == one.count("/") + 1 for one in patterns), relative


def test_sbr_on_s0_has_the_coefficient_of_the_example() -> None:
    rubber, surface = LIBRARY.rubber("SBR"), LIBRARY.surface("S0")
    assert surface.spectrum is not None
    law = PerssonLaw(rubber.modulus, rubber.poisson, surface.spectrum)
    assert law.contact(20.0, 4e5, 1e-2).mu == pytest.approx(1.0469, rel=5e-3)


def test_the_tread_on_the_road_has_the_coefficient_of_the_example() -> None:
    # 100 mm2 at 300 kPa carry 30 N.
    found = laws.make("greta", "tread", {}, LawSetting(LIBRARY, "road", area_mm2=100.0))
    assert found.mu(25.0, 30.0, 1.0) == pytest.approx(0.6919, rel=2e-3)
