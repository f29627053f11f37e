"""Paper S, sections 2 to 5: Grosch's experiments and the vibration of rubber."""

from __future__ import annotations

from math import log10, pi
from typing import Final

import numpy as np

from sim.physics.laws import LawSetting
from sim.physics.loss_maxima import loss_maxima
from sim.physics.materials import ShearModulus
from sim.physics.track import TWO_BELLS, TrackParameters
from sim.physics.track_bells import RUBBERS
from sim.physics.wlf import GLASS_TO_REFERENCE_K, WlfBell, log10_shift
from tester.analysis.master_curve.collapse import collapse
from tester.analysis.master_curve.peaks import Peak
from tester.analysis.master_curve.points import MasterPoint, MasterSource, set_of
from tester.analysis.master_curve.rules import GRIT_M, JUMP_M, rules_of
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted, slight, unjudged
from tester.kinds.specimen_on_track.papers.paper_parts import (
    PRESSURE_PA,
    ROOM_C,
    SPEEDS_M_S,
    peak,
    persson_over_speed,
    rubber,
    spectrum,
)

GRAINS_M: Final = 1.4e-4
OUR_RUBBERS: Final = ("SBR", "ABR", "INR", "butyl")
"""Grosch's four rubbers, as formulas [A]."""
LIGHT_PA: Final = (5.5e3, 5.5e4)
NEGLIGIBLE: Final = 0.05
"""A change of friction up to this share counts as negligible or marginal [A]."""
HALF_DECADE: Final = 0.5
"""A speed within this many decades of a rule's agrees with the rule [A]: the paper gives lengths to two digits."""


def _wlf() -> PaperFinding:
    places = ((-40.0, -3.0), (20.0, -3.0), (60.0, 25.0))
    off = max(abs(log10_shift(t, ts) + 8.86 * (t - ts) / (101.5 + t - ts)) for t, ts in places)
    return judged(off < 1e-12, f"the shift that laws and fits use differs from it by {slight(off)}")


def _rig() -> PaperFinding:
    from tester.kinds import load_rig
    from tester.kinds.specimen_on_track.rig import TrackConfig

    rig = TrackConfig.of(load_rig("grosch"))
    limits = rig.limits
    holds = rig.chamber and limits.air_low_c <= -50.0 and limits.air_high_c >= 100.0
    return judged(
        holds, f"the rig `grosch`: chamber from {limits.air_low_c:g} to {limits.air_high_c:g} degC, weights on an arm"
    )


def _cold_contact() -> PaperFinding:
    from tester.kinds import load_rig
    from tester.kinds.specimen_on_track.rig import TrackConfig

    rig = TrackConfig.of(load_rig("grosch"))
    fastest_m_s, load = 0.01, 20.0
    mu = WlfBell(RUBBERS["SBR"]).parameters.mu_max
    rise_k = rig.heat.rise * mu * load * fastest_m_s
    return judged(
        rise_k < 1.0,
        f"{rise_k:.2f} K at 1 cm/s, {load:g} N and the largest mu of the law, {mu:g}, by the belief of the rig [A]",
    )


def _one_curve() -> PaperFinding:
    phrase: list[str] = []
    worst_k = 0.0
    for name in OUR_RUBBERS:
        law, ts_c = WlfBell(RUBBERS[name]), RUBBERS[name].t_ref
        source = MasterSource("formula")
        points = [
            MasterPoint("", name, v, celsius, celsius, law.mu(celsius, 20.0, v), source)
            for celsius in np.arange(ts_c - 30.0, ts_c + 70.0, 20.0).tolist()
            for v in np.logspace(-6.0, -2.0, 9).tolist()
        ]
        result = collapse(set_of(points), resamples=20)
        worst_k = max(worst_k, abs(result.ts_c - ts_c))
        phrase.append(f"{result.ts_c - ts_c:+.2f} K ({name})")
    return judged(
        worst_k <= 1.0,
        "values of the law `wlf_bell` over 5 temperatures and 9 speeds fall on one curve, Ts off by"
        f" {', '.join(phrase)}; the rubbers obey WLF by construction: this shows the method",
    )


def _ts() -> PaperFinding:
    off = {name: RUBBERS[name].t_ref - (rubber(name).glass_c or 0.0) - GLASS_TO_REFERENCE_K for name in OUR_RUBBERS}
    phrase = ", ".join(f"{entry:+.1f} K ({name})" for name, entry in off.items())
    return unjudged(f"Ts - Tg - 50 K of the rubbers that ship: {phrase}, but by construction")


def _maxima(compound: str, surface: str, interface: str = "dry") -> list[tuple[float, float]]:
    """Return log10 of the speed in m/s, and mu, of each maximum of the twin's friction at room temperature."""
    twin = TrackParameters(law=TWO_BELLS)
    law = twin.contact.through(twin.law_of(compound, LawSetting(surface=surface)), interface)  # type: ignore[arg-type]
    x = [0.01 * i - 8.0 for i in range(1200)]
    mu = [law.mu(ROOM_C, 20.0, 10.0**at) for at in x]
    # A bell's far end lies on mu_0 but for the last digits.
    return [(x[i], mu[i]) for i in range(1, len(x) - 1) if mu[i - 1] < mu[i] >= mu[i + 1] and mu[i] > mu[0] + 0.01]


def _shown(compound: str, surfaces: tuple[tuple[str, str], ...]) -> str:
    shown: list[str] = []
    for surface, interface in surfaces:
        tops = " and ".join(f"{mu:.2f}" for _, mu in _maxima(compound, surface, interface))
        shown.append(f"{tops} on {surface}{', talc' if interface == 'talc' else ''}")
    return f"{compound}: {'; '.join(shown)}"


_TRACKS: Final = (("wavy glass", "dry"), ("silicon carbide", "dry"), ("silicon carbide", "talc"))


def _dry_surfaces() -> PaperFinding:
    on = {
        name: float(np.max(persson_over_speed(rubber("SBR").modulus, spectrum(name))))
        for name in ("silicon carbide", "glass")
    }
    return unjudged(
        f"hysteresis of SBR by `persson` reaches {on['silicon carbide']:.2f} on silicon carbide and {on['glass']:.2f}"
        " on glass: no law of materials knows the adhesion that peaks there. The twin's law `two_bells` [A] has maxima"
        f" by construction; {_shown('SBR', _TRACKS)}. {_shown('ABR', (*_TRACKS, ('polished steel', 'dry')))}"
    )


def _butyl() -> PaperFinding:
    return unjudged(
        "curves without numbers; the butyl that ships is a formula [A]. The twin's maxima, by construction;"
        f" {_shown('butyl', _TRACKS)}"
    )


def _rules() -> PaperFinding:
    phrase: list[str] = []
    decades: list[float] = []
    for name in OUR_RUBBERS:
        ours = rubber(name)
        celsius = ROOM_C + RUBBERS[name].t_ref - RUBBERS["SBR"].t_ref  # the same distance above its Ts as SBR
        top = peak(persson_over_speed(ours.modulus, spectrum("silicon carbide"), celsius=celsius))
        rule = rules_of(ours.modulus, celsius, (Peak(10.0 ** top[1], top[0]),))[1]
        decades.append(rule.decades)
        phrase.append(f"{rule.decades:+.2f} ({name})")
    return judged(
        max(map(abs, decades)) <= HALF_DECADE,
        f"hysteresis by `persson` on silicon carbide peaks {', '.join(phrase)} decades above {1e6 * GRIT_M:g} um times"
        " the"
        " frequency: the rule is not put into that law, but the longest wave of the surface, 150 um, was chosen by it",
    )


def _same_for_all() -> PaperFinding:
    ratios: list[float] = []
    for name in OUR_RUBBERS:
        ours, celsius = rubber(name), ROOM_C + RUBBERS[name].t_ref - RUBBERS["SBR"].t_ref
        top = peak(persson_over_speed(ours.modulus, spectrum("silicon carbide"), celsius=celsius))
        ratios.append(10.0 ** top[1] / loss_maxima(ours.modulus, celsius).loss_factor_hz)
    phrase = ", ".join(f"{1e6 * entry:.0f}" for entry in ratios)
    return unjudged(
        f"of hysteresis by `persson` on silicon carbide the ratio is {phrase} um ({', '.join(OUR_RUBBERS)}, whose"
        " relaxation differs in width [A]); no law of adhesion over speed is printed"
    )


def _far_apart() -> PaperFinding:
    frequencies: list[float] = []
    between: list[float] = []
    names = sorted(OUR_RUBBERS, key=lambda name: _apart(rubber(name).modulus))
    for name in names:
        jump, grit = rules_of(rubber(name).modulus, ROOM_C, ())
        frequencies.append(_apart(rubber(name).modulus))
        between.append(log10(grit.speed_m_s / jump.speed_m_s))
    listed = ", ".join(f"{entry:.2f}" for entry in frequencies), ", ".join(f"{entry:.2f}" for entry in between)
    return judged(
        frequencies[0] < frequencies[-1] and between == sorted(between, reverse=True),
        f"{', '.join(names)}: frequencies {listed[0]} decades apart; by the rules the peaks are {listed[1]} apart",
    )


def _apart(modulus: ShearModulus) -> float:
    """Return the decades from the loss factor's maximum up to that of the loss modulus."""
    return log10(loss_maxima(modulus, ROOM_C).loss_modulus_hz / loss_maxima(modulus, ROOM_C).loss_factor_hz)


def _grains() -> PaperFinding:
    off = GRAINS_M / GRIT_M - 1.0
    return judged(abs(off) < 0.1, f"{100.0 * off:+.0f} %")


def _light() -> PaperFinding:
    low, high = (peak(persson_over_speed(rubber("SBR").modulus, spectrum("silicon carbide"), p))[0] for p in LIGHT_PA)
    change = high / low - 1.0
    return judged(
        abs(change) <= NEGLIGIBLE,
        f"SBR on silicon carbide by `persson`: {100.0 * change:+.2f} % at the peak, 5.5 to 55 kPa",
    )


def _glassy() -> PaperFinding:
    modulus = rubber("SBR").modulus
    slow, fast = (abs(complex(modulus.complex_pa(np.array([rate]), ROOM_C)[0])) for rate in (1e-6, 1e16))
    decades = log10(fast / slow)
    return judged(abs(decades - 3.0) < 0.2, f"SBR (a formula [A]): {decades:.2f} decades from rest to glass")


def _order() -> PaperFinding:
    jump, grit = rules_of(rubber("SBR").modulus, ROOM_C, ())
    of_loss, of_factor = 2.0 * pi * jump.speed_m_s / JUMP_M, 2.0 * pi * grit.speed_m_s / GRIT_M
    return judged(
        of_loss > of_factor, f"SBR (a formula [A]) at 20 degC: {of_loss:.2g} rad/s above {of_factor:.2g} rad/s"
    )


def _bell() -> PaperFinding:
    mu = persson_over_speed(rubber("SBR").modulus, spectrum("silicon carbide"))
    top, speed = peak(mu)
    return judged(
        float(mu[0]) < top > float(mu[-1]),
        f"SBR on silicon carbide at {PRESSURE_PA / 1e3:g} kPa by `persson`: {float(mu[0]):.2f} at {SPEEDS_M_S[0]:g}"
        f" m/s, {top:.2f} at {10.0**speed:.2g} m/s, {float(mu[-1]):.2f} at {SPEEDS_M_S[-1]:g} m/s",
    )


PREDICT: Final = (
    'tester predict --law persson --compound SBR --surface "silicon carbide"'
    ' --slip "10 mm/s" --load "10 N" --temperature "20 degC"'
)
GROSCH_ITEMS: Final = (
    not_attempted("2", "green tracks, rubbered tracks, rain", "observations without numbers"),
    PaperItem("Figs 1, 2", "a block under weights on a track in an enclosure from -50 to 100 degC",
              "tester rig show --rig grosch", _rig),
    PaperItem("3", "friction is too slow to heat the contact", "tester check grosch --rig grosch", _cold_contact),
    PaperItem("4", "log10 aT = -8.86 (T - Ts) / (101.5 + T - Ts)", "tester master RUN", _wlf),
    PaperItem("4", "Ts is about 50 K above Tg", 'tester materials show SBR', _ts),
    PaperItem("Figs 3, 4", "friction over speeds and temperatures falls on one curve over aT v",
              "tester run grosch --rig grosch, then tester master latest", _one_curve),
    PaperItem("Figs 5, 6",
              "SBR and ABR: one peak on glass, two on silicon carbide, talc lowers the first; steel between",
              "tester run grosch --rig grosch", _dry_surfaces),
    PaperItem("Fig 7", "the same of butyl", "tester run grosch --rig grosch", _butyl),
    PaperItem("4", "the peak on a rough track is at 0.15 mm times the loss factor's frequency, for four rubbers",
              "tester master RUN", _rules),
    not_attempted("4", "the peak on a smooth track is at 6 nm times the loss modulus' frequency",
                  "no law of adhesion over speed is printed; `tester master RUN` holds a measured peak against it"),
    PaperItem("4", "both ratios are the same for all rubbers", "tester master RUN", _same_for_all),
    PaperItem("4", "frequencies far apart put the peaks close together", "tester master RUN", _far_apart),
    PaperItem("4", "0.15 mm is about the spacing of the grains, 0.14 mm", "", _grains),
    PaperItem("4", "no influence of pressure up to 55 kPa", PREDICT, _light),
    not_attempted("4", "exponents of the load from -0.1 to 0.1, and -1/3 of simple theory",
                  "contact of single asperities is not modelled; the simulated friction falls with pressure to a power"
                  " that is put in"),
    not_attempted("4, Fig 8", "a racing tread on granite: mu falls from 1 to 7 bar",
                  "compound and granite are not printed; recipe `pressure` makes the test"),
    not_attempted("Fig 9", "an analyser of vibrations",
                  "a photograph; `tester materials import dma` reads what such write"),
    PaperItem("Fig 10", "glass is three orders of magnitude stiffer than rubber", "tester materials show SBR", _glassy),
    PaperItem("Fig 10", "the loss modulus peaks at a higher frequency than the loss factor", "", _order),
    PaperItem("Figs 15, 17, 9", "hysteresis has a peak over the sliding speed", PREDICT, _bell),
    not_attempted("Fig 11", "moduli fall with the strain",
                  "curves without numbers; moduli here are those of small strain"),
)  # fmt: skip
