"""Laws fitted to a specimen on a track: they are the simulator's, and fits recover their parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product
from math import exp
from pathlib import Path

import numpy as np
import pytest

from sim.physics.greta import Greta, GretaParameters
from sim.physics.materials import Rubber, Surface, UnknownMaterialError
from sim.physics.moduli import FractionalZener
from sim.physics.persson import PerssonByLoad, PerssonLaw
from sim.physics.roughness import SelfAffine
from sim.physics.simple import PowerLaw, PowerParameters
from sim.physics.wlf import WlfBell, WlfBellParameters
from tester.analysis.fit.fit_law import FitError, FitPoint, Law, Source
from tester.analysis.fit.joint import GroupFit, fit_group
from tester.kinds.specimen_on_track.fit.fits import TrackFits
from tester.kinds.specimen_on_track.fit.laws import GRETA, PERSSON, POWER, WLF_BELL, reference_band
from tester.kinds.specimen_on_track.fit.track_group import TrackGroup, group_of
from tests.sim.physics.greta_example import SHEAR, road, rubber
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run

pytest.importorskip("scipy", reason="needs the extra `report`")

SPEEDS_M_S = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
LOADS_N = (10.0, 20.0)
GROUP, SMOOTH = "SBR, dry on road", "Zener, dry on track"
TEMPERATURES_C = (5.0, 23.0, 45.0)
NOISE = 0.02
Value = Callable[[float, float, float], float]


ZENER = FractionalZener(1e6, 1e9, 1e-6, 0.6, shift_c=-3.0)


class Shelf:
    """Folder of the tests' materials: a track of two waves, and one of a spectrum with its rubber."""

    def rubber(self, name: str) -> Rubber:
        known = {"SBR": rubber(), "Zener": Rubber("Zener", ZENER)}
        if name not in known:
            raise UnknownMaterialError(f"no compound {name!r}")
        return known[name]

    def surface(self, name: str) -> Surface:
        if name == "track":
            return Surface("track", spectrum=SelfAffine(2.6023e-19, 2e4, 10.0**5.344, 0.8))
        if name != "road":
            raise UnknownMaterialError(f"no surface {name!r}")
        return road()


PART = TrackFits(Shelf)


def points(
    mu: Value, speeds: Sequence[float] = SPEEDS_M_S, temperatures: Sequence[float] = TEMPERATURES_C,
    noise: float = 0.0, seed: int = 0,
) -> list[FitPoint]:  # fmt: skip
    random, source = np.random.default_rng(seed), Source("synthetic")
    made: list[FitPoint] = []
    for v, t, load in product(speeds, temperatures, LOADS_N):
        value = mu(t, load, v) * exp(noise * random.standard_normal())
        made.append(FitPoint("", GROUP, (v, t, load), (v, t, load), value, source))
    return made


def fitted(law: Law, own: Sequence[FitPoint], count: int = 99) -> GroupFit:
    return fit_group(PART.bound(law, GROUP, "", {}), GROUP, own, PART.cells, count=count)


@pytest.mark.parametrize("seed", range(3))
def test_a_bell_is_found_from_one_of_its_flanks(seed: int) -> None:
    bell = WlfBell(WlfBellParameters(mu_0=0.08, mu_max=0.17, width=4.0, v_ref=1e-10, t_ref=-15.0))
    own = points(bell.mu, (1e-5, 1e-4, 1e-3, 1e-2), (0.0, 10.0, 20.0, 30.0, 40.0, 50.0), 0.01, seed)
    mu_0, mu_max, width, _, t_ref = fitted(WLF_BELL, own).parameters
    assert (mu_0, mu_max) == (pytest.approx(0.08, abs=0.005), pytest.approx(0.17, abs=0.02))
    assert (width, t_ref) == (pytest.approx(4.0, abs=0.5), pytest.approx(-15.0, abs=5.0))


def test_a_bell_upside_down_is_no_fit() -> None:
    assert WLF_BELL.improper is not None and WLF_BELL.improper((0.2, 0.5, 3.0, 1e-3, 0.0)) == ""
    assert "maximum (0.2) is below" in WLF_BELL.improper((0.5, 0.2, 3.0, 1e-3, 0.0))


def test_a_fit_without_a_law_s_own_parameters_is_refused() -> None:
    own = points(WlfBell(WlfBellParameters()).mu)
    with pytest.raises(FitError, match="does not end: never its own"):
        fitted(replace(WLF_BELL, improper=lambda parameters: "never its own"), own)


@pytest.mark.parametrize(
    ("law", "parameters", "mu"),
    [
        (WLF_BELL, (0.5, 2.2, 3.0, 1.74e-3, -3.0), WlfBell(WlfBellParameters()).mu),
        (POWER, (0.9, 0.2, -0.15), PowerLaw(PowerParameters(a=0.9, n=0.2, m=-0.15)).mu),
        (GRETA, (SHEAR.strength_pa, SHEAR.speed_m_s, SHEAR.exponent), Greta(rubber(), road()).mu),
    ],
)  # fmt: skip
def test_the_fitted_law_is_the_simulators(law: Law, parameters: tuple[float, ...], mu: Value) -> None:
    own = points(mu)
    x = np.array([one.measured for one in own])
    found = PART.bound(law, GROUP, "", {}).value(np.array([parameters, parameters]), x)
    assert found.shape == (2, len(own))
    assert found[1] == pytest.approx([one.value for one in own], rel=1e-3 if law is GRETA else 1e-9)


@pytest.mark.parametrize(("law", "truth", "mu"), [
    (WLF_BELL, (0.5, 2.2, 3.0, 1.74e-3, -3.0), WlfBell(WlfBellParameters()).mu),
    (POWER, (0.9, 0.2, -0.15), PowerLaw(PowerParameters(a=0.9, n=0.2, m=-0.15)).mu),
])  # fmt: skip
def test_the_fit_recovers_the_true_parameters(law: Law, truth: tuple[float, ...], mu: Value) -> None:
    speeds = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2) if law is WLF_BELL else SPEEDS_M_S
    assert fitted(law, points(mu, speeds), 9).parameters == pytest.approx(truth, rel=1e-5)


def test_the_intervals_of_greta_contain_the_true_values() -> None:
    truth = (SHEAR.strength_pa, SHEAR.speed_m_s, SHEAR.exponent)
    law, mu, held = PART.bound(GRETA, GROUP, "", {}), Greta(rubber(), road()).mu, np.zeros(3, dtype=int)
    for seed in range(20):
        found = fit_group(law, GROUP, points(mu, noise=NOISE, seed=seed), PART.cells, count=199)
        held += [low <= one <= high for one, (low, high) in zip(truth, found.intervals, strict=True)]
    assert min(held) >= 17, held


def test_the_fitted_persson_is_the_simulators_up_to_any_wave_number() -> None:
    own = points(lambda *_: 1.0)
    law = PART.bound(PERSSON, SMOOTH, "", {"area": 50.0})
    x = np.array([one.measured for one in own])
    for q1 in (1e5, 10.0**5.344):
        spectrum = SelfAffine(2.6023e-19, 2e4, q1, 0.8)
        exact = PerssonByLoad(PerssonLaw(ZENER, 0.5, spectrum), 50.0)
        expected = [exact.mu(t, load, v) for v, t, load in x.tolist()]
        assert law.value(np.array([q1]), x) == pytest.approx(expected, rel=5e-3)


def test_the_interval_of_q1_contains_the_true_value() -> None:
    mu = PerssonByLoad(PerssonLaw(ZENER, 0.5, SelfAffine(2.6023e-19, 2e4, 1e5, 0.8)), 100.0).mu
    law, exact = PART.bound(PERSSON, SMOOTH, "", {}), points(mu, temperatures=(10.0, 30.0))
    held = 0
    for seed in range(20):
        scatter = np.exp(np.random.default_rng(seed).normal(0.0, NOISE, len(exact)))
        own = [replace(one, value=one.value * float(e)) for one, e in zip(exact, scatter, strict=True)]
        (low, high), *_ = fit_group(law, GROUP, own, PART.cells, count=199).intervals
        held += low <= 1e5 <= high
    assert held >= 17


def test_without_different_speeds_the_shear_of_a_contact_is_unknown() -> None:
    own = points(Greta(rubber(), road()).mu, (1.0,), (5.0, 15.0, 25.0, 35.0, 45.0))
    with pytest.raises(FitError, match=r"one speed only \(1000 mm/s\), and v_c, n need at least 3"):
        fitted(GRETA, own)
    held = fit_group(
        PART.bound(GRETA, GROUP, "", {}), GROUP, own, PART.cells, {"v_c": 1.0, "n": 0.6}, count=9
    )  # fmt: skip
    assert held.parameters[0] == pytest.approx(SHEAR.strength_pa, rel=1e-3)


def test_without_different_temperatures_the_bell_has_no_reference() -> None:
    own = points(WlfBell(WlfBellParameters()).mu, (1e-6, 1e-5, 1e-4, 1e-3, 1e-2), (20.0,))
    with pytest.raises(FitError, match=r"one temperature only .* t_ref need at least 3"):
        fitted(WLF_BELL, own)


@pytest.mark.parametrize(("glass_c", "low", "high"), [(-53.0, -18.0, 12.0), (None, -60.0, 60.0)])
def test_the_reference_of_a_bell_belongs_near_the_glass_transition(
    glass_c: float | None, low: float, high: float
) -> None:
    assert reference_band(glass_c)[:2] == (low, high)


def test_the_band_of_a_compounds_reference_is_that_of_its_file() -> None:
    bound = TrackFits().bound(WLF_BELL, "SBR, dry", "", {})
    assert next(one for one in bound.parameters if one.name == "t_ref").band[:2] == (-18.0, 12.0)


@pytest.mark.filterwarnings("error")  # NumPy prints its name with a path
def test_a_degenerate_greta_is_named() -> None:
    own = [replace(one, type_a=0.01, df=50.0) for one in points(lambda *_: 0.8, noise=0.01)]
    found = fit_group(PART.bound(GRETA, GROUP, "", {}), GROUP, own, PART.cells, count=99)
    assert not found.sound


def test_a_bell_warns_of_conditions_beyond_its_shift() -> None:
    own = points(WlfBell(WlfBellParameters()).mu, (1e-6, 1e-5, 1e-4, 1e-3, 1e-2), (-20.0, 20.0, 60.0))
    (warning,) = fitted(WLF_BELL, own).beyond
    assert warning.startswith("10 conditions are outside -53 to 47 degC")


@pytest.mark.parametrize(
    ("group", "surface", "figures", "message"),
    [
        ("SBR, wet on road", "", {}, "greta includes adhesion, it is for dry contact"),
        ("SBR, dry", "", {}, "does not name its surface"),
        ("SBR, dry on road", "ice", {}, "no surface 'ice'"),
        ("NR, dry on road", "", {}, "no compound 'NR'"),
        ("SBR, dry on road", "", {"height": 1.0}, "greta has no height"),
    ],
)
def test_missing_inputs_of_a_groups_law_are_reported(
    group: str, surface: str, figures: dict[str, float], message: str
) -> None:
    with pytest.raises(FitError, match=message):
        PART.bound(GRETA, group, surface, figures)
    assert PART.bound(POWER, group, surface, {}) is POWER


def test_the_area_that_is_given_is_that_of_the_law() -> None:
    law = PART.bound(GRETA, "SBR, dry", "road", {"area": 50.0})
    x = np.array([[1.0, 25.0, 10.0]])
    truth = np.array([SHEAR.strength_pa, SHEAR.speed_m_s, SHEAR.exponent])
    expected = Greta(rubber(), road(), GretaParameters(area=50.0)).mu(25.0, 10.0, 1.0)
    assert law.value(truth, x)[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("group", [TrackGroup("SBR", "wet", ""), TrackGroup("a, b", "dry", "c on d, e")])
def test_a_group_is_read_from_its_option(group: TrackGroup) -> None:
    assert group_of(group.text) == group


def test_conditions_of_a_run_are_grouped_by_compound_interface_and_surface(tmp_path: Path) -> None:
    run = made_track_run(
        tmp_path / "one", (0.0, 20.0), (1e-4, 1e-3), interfaces=("dry", "wet"), metadata={"abrasive": "road"}
    )
    found = PART.run_points(run)
    assert {one.group for one in found.points} == {"SBR, dry on road", "SBR, wet on road"}
    assert {len(one.measured) for one in found.points} == {3}
