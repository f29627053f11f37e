"""Two bells over the reduced speed, against their closed form, and the surfaces of the simulated track."""

from __future__ import annotations

import math

import pytest

from sim.physics.laws import LawSetting
from sim.physics.track import TrackParameters
from sim.physics.track_bells import RUBBERS, SURFACES, TrackRubber, TrackSurface, bells
from sim.physics.two_bells import TwoBells, TwoBellsParameters, two_bells
from sim.physics.wlf import PoleError, log10_shift

LAW = TwoBells(TwoBellsParameters())
TWIN = TrackParameters(law="two_bells")
DECADES = [-7.0 + 0.01 * i for i in range(900)]
FOUR = ("SBR", "ABR", "INR", "butyl")
"""Grosch's rubbers."""


def maxima(
    surface: str, interface: str = "dry", celsius: float = 20.0, rubber: str = "SBR"
) -> list[tuple[float, float]]:
    """Return log10 of the speed, and mu, of each maximum of the twin's friction of a rubber."""
    law = TWIN.contact.through(TWIN.law_of(rubber, LawSetting(surface=surface)), interface)  # type: ignore[arg-type]
    mu = [law.mu(celsius, 20.0, 10.0**x) for x in DECADES]
    floor = min(mu) + 1e-6  # where a bell has ended, its last digit makes maxima
    return [(DECADES[i], mu[i]) for i in range(1, len(mu) - 1) if mu[i - 1] < mu[i] >= mu[i + 1] and mu[i] > floor]


def test_each_bell_is_down_to_one_over_e_a_width_from_its_place() -> None:
    p = TwoBellsParameters(adhesion=1.0, hysteresis=0.0)
    for decades in (-p.adhesion_width, p.adhesion_width):
        mu = TwoBells(p).mu(p.t_ref, 10.0, p.v_adhesion * 10.0**decades)
        assert mu == pytest.approx(p.mu_0 + 1.0 / math.e, rel=1e-12)
    p = TwoBellsParameters(adhesion=0.0, hysteresis=1.0)
    for decades in (-p.hysteresis_width, p.hysteresis_width):
        mu = TwoBells(p).mu(p.t_ref, 10.0, p.v_hysteresis * 10.0**decades)
        assert mu == pytest.approx(p.mu_0 + 1.0 / math.e, rel=1e-12)


@pytest.mark.parametrize("celsius", [-40.0, 20.0, 60.0])
def test_both_bells_have_the_shift_of_wlf(celsius: float) -> None:
    p = LAW.parameters
    for speed in (1e-6, 1e-4, 1e-2):
        shifted = speed * 10.0 ** log10_shift(celsius, p.t_ref)
        for warm, cold in zip(LAW.components(celsius, 9.0, speed), LAW.components(p.t_ref, 9.0, shifted), strict=True):
            assert warm == pytest.approx(cold, rel=1e-9)


def test_its_parts_make_the_whole_at_standstill_too() -> None:
    for speed in (0.0, 1e-5, 1e-3, 1e-1):
        assert sum(LAW.components(20.0, 10.0, speed)) == LAW.mu(20.0, 10.0, speed)
    assert LAW.mu(20.0, 10.0, 0.0) == pytest.approx(LAW.parameters.mu_0)


def test_there_is_no_law_at_the_pole_of_the_shift() -> None:
    with pytest.raises(PoleError, match=r"holds only above -104\.5 degC"):
        LAW.mu(-104.5, 10.0, 1e-3)


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ({"tg": -53.0}, "two_bells has no tg; it has mu_0"),
        ({"v_adhesion": 0.0}, r"v_adhesion must be above 0, not 0\.0"),
        ({"hysteresis": -0.1}, "hysteresis must be at least 0"),
        ({"mu_0": math.nan}, "mu_0 must be finite"),
    ],
)
def test_figures_out_of_range_are_refused(figures: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        two_bells("SBR", figures)


def test_outside_the_shifts_range_and_where_friction_heats_it_warns() -> None:
    assert [*LAW.caveats(20.0, 10.0, 1e-3)] == []
    (cold,) = LAW.caveats(60.0, 10.0, 1e-3)
    assert "60 degC is outside -53 to 47 degC" in cold
    assert len([*LAW.caveats(20.0, 10.0, 1.0)]) == 1


@pytest.mark.parametrize("rubber", FOUR)
@pytest.mark.parametrize("surface", ["glass", "wavy glass", "polished steel"])
def test_a_smooth_track_has_one_maximum_that_of_adhesion(surface: str, rubber: str) -> None:
    ((x, mu),) = maxima(surface, rubber=rubber)
    place_m_s = 6e-9 * RUBBERS[rubber].loss_modulus / 10.0 ** log10_shift(20.0, RUBBERS[rubber].t_ref)
    assert 10.0**x == pytest.approx(place_m_s, rel=0.02)
    assert mu > maxima("silicon carbide", rubber=rubber)[0][1]


def test_adhesion_of_sbr_on_glass_is_at_a_millimetre_a_second() -> None:
    ((x, _),) = maxima("wavy glass")
    assert 10.0**x == pytest.approx(6e-9 * 1e6 / (2.0 * math.pi), rel=0.02)  # 1e6 rad/s at 20 degC


def test_silicon_carbide_has_two_maxima_adhesion_at_the_slower_one() -> None:
    slow, fast = (x for x, _ in maxima("silicon carbide"))
    assert 10.0**slow == pytest.approx(6e-9 * 1e6 / (2.0 * math.pi), rel=0.05)
    assert 10.0**fast == pytest.approx(1.5e-4 * 3162.3 / (2.0 * math.pi), rel=0.05)


@pytest.mark.parametrize("rubber", FOUR)
def test_talc_lowers_the_slower_maximum_much_more_than_the_faster_one(rubber: str) -> None:
    dry, talc = (TWIN.contact.through(TWIN.law_of(rubber), interface) for interface in ("dry", "talc"))
    both = maxima("silicon carbide", rubber=rubber)
    left = [talc.mu(20.0, 20.0, 10.0**x) / dry.mu(20.0, 20.0, 10.0**x) for x, _ in both]
    assert left[0] < 0.4 < 0.75 < left[1]


def test_the_further_apart_the_frequencies_the_closer_the_maxima_on_silicon_carbide() -> None:
    """Paper S, section 4, of the loss modulus' and the loss factor's frequencies."""
    apart = {name: math.log10(RUBBERS[name].loss_modulus / RUBBERS[name].loss_factor) for name in FOUR}
    between: dict[str, float] = {}
    for name in FOUR:
        (slow, _), (fast, _) = maxima("silicon carbide", rubber=name)
        between[name] = fast - slow
    assert sorted(FOUR, key=apart.__getitem__) == ["INR", "ABR", "SBR", "butyl"]
    assert sorted(FOUR, key=between.__getitem__) == ["butyl", "SBR", "ABR", "INR"]
    assert between["INR"] - between["butyl"] == pytest.approx(apart["butyl"] - apart["INR"], abs=0.1)


def test_no_two_rubbers_have_their_maxima_at_the_same_speeds() -> None:
    for which in (0, 1):
        places = [maxima("silicon carbide", rubber=name)[which][0] for name in FOUR]
        assert min(abs(a - b) for i, a in enumerate(places) for b in places[:i]) > 0.1


def test_gum_rubbers_have_about_the_same_maximum_on_glass_and_others_on_silicon_carbide() -> None:
    heights = [maxima("wavy glass", rubber=name)[0][1] for name in FOUR]
    assert max(heights) - min(heights) < 0.05
    rough = [maxima("silicon carbide", rubber=name)[1][1] for name in FOUR]
    assert min(abs(a - b) for i, a in enumerate(rough) for b in rough[:i]) > 0.04


@pytest.mark.parametrize(("rubber", "surface", "warm_c", "cold_c"), [("INR", "silicon carbide", -35.0, -40.0),
                                                                     ("ABR", "wavy glass", 20.0, 10.0)])  # fmt: skip
def test_the_maximum_crosses_the_speeds_of_the_rig_where_fig_3_divides_the_temperatures(
    rubber: str, surface: str, warm_c: float, cold_c: float
) -> None:
    """Paper S, Fig 3, 1e-6 to 1e-2 m/s: INR at 90 to -35 and -40 to -58 degC, ABR at 85 to 20 and 10 to -15 degC."""
    for celsius in (warm_c, cold_c):
        assert -6.0 < maxima(surface, celsius=celsius, rubber=rubber)[-1][0] < -2.0


def test_any_other_surface_is_an_abrasive() -> None:
    assert maxima("S0") == maxima("") == maxima("silicon carbide")


@pytest.mark.parametrize("rubber", RUBBERS)
@pytest.mark.parametrize("surface", SURFACES)
def test_no_rubber_has_more_friction_than_its_single_bell(rubber: str, surface: str) -> None:
    law = TWIN.law_of(rubber, LawSetting(surface=surface))
    assert max(law.mu(20.0, 20.0, 10.0**x) for x in DECADES) <= RUBBERS[rubber].mu_max + 0.02


def test_places_are_lengths_times_frequencies_and_both_can_be_changed() -> None:
    p = bells(TrackRubber(loss_modulus=1e3, loss_factor=10.0), TrackSurface(jump=0.02, grit=400.0))
    assert (p.v_adhesion, p.v_hysteresis) == (pytest.approx(2e-5), pytest.approx(4e-3))


@pytest.mark.parametrize("wrong", [{"grit": 0.0}, {"jump": -1.0}, {"adhesion": math.inf}])
def test_a_surface_out_of_range_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="TrackSurface"):
        TrackSurface(**wrong)


def test_a_frequency_of_0_is_refused() -> None:
    with pytest.raises(ValueError, match="loss_factor must be finite and above 0"):
        TrackRubber(loss_factor=0.0)
