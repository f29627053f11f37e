"""Paper G, its model of hysteresis and results: Eqs 14 to 22, Figs 10 to 21."""

from __future__ import annotations

from dataclasses import replace
from math import asin, atan, pi, sin, sqrt
from typing import Final

import numpy as np

from sim.physics.greta import Dynamic, Greta
from sim.physics.materials import Components, Rubber, Sinusoid
from sim.physics.scratch import DEPTHS, FADE, HARMONICS, Scratch, harmonics, normal_x, shear_x
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted, slight, unjudged
from tester.base.arrays import Array
from tester.kinds.specimen_on_track.papers.adhesion import MACRO_M, MACRO_RA_M, PREDICT, PRESSURE_PA, WARM_C, modulus_pa
from tester.kinds.specimen_on_track.papers.paper_parts import Stiffer, load_n, rubber, surface, tread_on_road

STRESS_PA: Final = 125e3
"""Stress of Figures 11 to 14."""
PRESSURES_PA: Final = (5e4, 5e5)
SPEEDS_M_S: Final = (0.1, 1.0, 10.0)
DRAWN: Final = "tester figure --components --law greta --compound tread --surface road"
DRASTIC: Final = 0.1
"""Change of the friction that counts as drastic [A]."""


def _parts(
    pressure_pa: float = PRESSURE_PA, celsius: float = WARM_C, speed: float = 1.0, law: Greta | None = None
) -> Components:
    law = law or tread_on_road()
    return law.components(celsius, load_n(pressure_pa, law), speed)


def _sum() -> PaperFinding:
    law = tread_on_road()
    parts = _parts()
    off = law.mu(WARM_C, load_n(PRESSURE_PA, law), 1.0) - sum(parts)
    return judged(
        off == 0.0,
        f"{parts.adhesion:.3f} and {parts.hysteresis:.4f} make the coefficient, to {off:g} (1 m/s, 25 degC, 300 kPa)",
    )


def _loss() -> PaperFinding:
    e = modulus_pa(WARM_C, 1.0 / MACRO_M)
    tan_delta = e.imag / e.real
    off = tan_delta / sin(atan(tan_delta)) - 1.0
    return judged(
        abs(off) < 0.05,
        f"the loss of a cycle of given stress goes with sin d; tan d is {100.0 * off:.1f} % more at tan d"
        f" {tan_delta:.2f} (tread, 1 m/s)",
    )


def _power() -> PaperFinding:
    """Compare the work of friction with the power that Eq 19 dissipates in the volume, both per area."""
    law = tread_on_road()
    coarse = law.dynamic(WARM_C, 1.0)[0]
    normal_m, _ = law.stress_m(PRESSURE_PA / (coarse.magnitude_pa * law.full_per_modulus))
    period_s = law.coarse.wavelength_m / 1.0
    dissipated = pi * coarse.tan_delta * normal_m * PRESSURE_PA**2 / coarse.magnitude_pa / period_s
    friction = law.hysteresis(PRESSURE_PA, coarse, 0.0) * PRESSURE_PA * 1.0
    off = friction / dissipated - 1.0
    return judged(
        abs(off) < 1e-9,
        f"mu p v and the power of all cycles agree to {slight(abs(off))}, with T0 = {1e3 * period_s:g} ms at 1 m/s",
    )


def _eq_20() -> PaperFinding:
    law, parts = tread_on_road(), _parts()
    coarse = law.dynamic(WARM_C, 1.0)[0]
    scratch = Scratch(law.coarse.wavelength_m, 1e-3 * law.parameters.tread, 2 * HARMONICS, 20 * DEPTHS)
    normal_m, shear_m = scratch.parts_m(PRESSURE_PA / (coarse.magnitude_pa * law.full_per_modulus))
    squares_m = normal_m + min(1.0, parts.adhesion) ** 2 * shear_m
    limit = pi * coarse.tan_delta * squares_m * PRESSURE_PA / (law.coarse.wavelength_m * coarse.magnitude_pa)
    off = parts.hysteresis / limit - 1.0
    return judged(
        abs(off) < 0.05,
        f"{parts.hysteresis:.4f}, {100.0 * off:+.1f} % off a field of twice the harmonics and twenty times the"
        " depths. The stress is"
        " Westergaard's with friction on it [A]: the formulas of Kuznetsov and Gorokhovsky are not printed",
    )


def _eq_21() -> PaperFinding:
    k = 2.0 * pi / MACRO_M
    printed = 1.0 / (k**2 * MACRO_RA_M)
    step = 1e-3 * MACRO_M
    bend = (2.0 * MACRO_RA_M - 2.0 * MACRO_RA_M * float(np.cos(k * step))) / step**2
    amplitude = 1.0 / (k**2 * MACRO_RA_M * pi / 2.0)
    return judged(
        abs(printed * bend - 1.0) < 1e-3,
        f"{1e3 * printed:.2f} mm for the road, the curvature of a wave whose amplitude is Ra. The Ra of a sine is 2 /"
        f" pi of its amplitude: then {1e3 * amplitude:.2f} mm. The paper's is kept",
    )


def _eq_22() -> PaperFinding:
    e, nu, p = abs(modulus_pa(WARM_C, 1.0 / MACRO_M)), 0.5, STRESS_PA
    radius = 1.0 / ((2.0 * pi / MACRO_M) ** 2 * MACRO_RA_M)
    share = p / (pi * e * MACRO_RA_M / (MACRO_M * (1.0 - nu**2)))
    westergaard = MACRO_M / pi * asin(sqrt(min(1.0, share)))
    of_length = MACRO_M / pi * asin(sqrt(min(1.0, 4.0 * pi * radius * p * (1.0 - nu**2) / (MACRO_M * e))))
    argument = pi / MACRO_M * sqrt(4.0 * p * radius * (1.0 - nu**2) / (pi * e))
    off = of_length / westergaard - 1.0
    return judged(
        False,
        f"as printed its argument has the unit 1 / sqrt(m) ({argument:.3g} in SI); with p times the wave length it is"
        f" Westergaard's half width, {1e3 * westergaard:.3f} mm at 125 kPa, to {slight(abs(off))}. So it is used",
        "0: formulas are compared",
    )


def _field(friction: float, depth: float = 0.02) -> tuple[Array, Array]:
    """Return places in shares of a wave, and sx over p at a depth (share of the wave) under the mean pressure."""
    law = tread_on_road()
    coarse = law.dynamic(WARM_C, 1.0)[0]
    a = harmonics(STRESS_PA / (coarse.magnitude_pa * law.full_per_modulus), HARMONICS)
    n: Array = np.arange(1, HARMONICS + 1, dtype=np.float64)
    u: Array = np.asarray(2.0 * pi * depth * n, dtype=np.float64)
    x = np.linspace(-0.5, 0.5, 401)
    phase = 2.0 * pi * np.outer(x, n)
    return x, np.cos(phase) @ (-a * normal_x(u)) + friction * (np.sin(phase) @ (a * shear_x(u)))


def _asymmetry(friction: float) -> float:
    _, stress = _field(friction)
    return float(np.max(np.abs(stress - stress[::-1])))


def _along() -> PaperFinding:
    friction = min(1.0, _parts(STRESS_PA).adhesion)
    x, stress = _field(friction)
    entry, other = float(x[int(np.argmin(stress))]), float(x[int(np.argmax(stress))])
    return judged(
        entry * other < 0.0,
        f"largest pressure {entry:+.2f}, largest tension {other:+.2f} of a wave from the crest, on either side of it (K"
        f" {friction:.2f}, own field)",
    )


def _across() -> PaperFinding:
    return judged(
        _asymmetry(0.0) < 1e-9,
        f"without friction the field differs from its mirror image by {slight(_asymmetry(0.0))} of p",
    )


def _more_friction() -> PaperFinding:
    result = [_asymmetry(friction) for friction in (0.0, 0.5, 1.0)]
    phrase = ", ".join(f"{entry:.2f}" for entry in result)
    return judged(result[0] < result[1] < result[2], f"sx and its mirror image differ by {phrase} p at K = 0, 0.5, 1")


def _fade() -> PaperFinding:
    t = np.linspace(-1.0, 1.0, 200001)
    mean = float(np.mean((1.0 - t**2) ** 2))
    return judged(
        abs(mean / FADE - 1.0) < 1e-4,
        f"it fades as 1 - t^2 across the crest, in square {FADE:.4f} in the mean to {slight(abs(mean / FADE - 1.0))}",
    )


def _speed() -> PaperFinding:
    mu = [sum(_parts(speed=speed)) for speed in SPEEDS_M_S]
    phrase = ", ".join(f"{entry:.3f}" for entry in mu)
    return unjudged(
        f"a surface without numbers; `greta` with the tread and road that ship: {phrase} at 0.1, 1, 10 m/s and 300 kPa"
    )


def _pressure() -> PaperFinding:
    low, high = (sum(_parts(p)) for p in PRESSURES_PA)
    # The sum over depths leaves the hysteresis up to 2.2 % above its limit (DEPTHS), at both pressures alike in sign.
    u = 0.022 * max(_parts(p).hysteresis for p in PRESSURES_PA) / low
    return judged(
        high < low,
        f"the printed formulas give mu {low:.4f} at 50 kPa, {high:.4f} at 500 kPa: {100.0 * (high / low - 1.0):+.1f}"
        " %. In them, without hardening (Fig 8), adhesion does not depend on pressure and hysteresis rises",
        f"{100.0 * u:.2f} %, from the sum over depths",
    )


def _text_pressure() -> PaperFinding:
    low, high = (sum(_parts(p)) for p in PRESSURES_PA)
    return unjudged(
        "the text has friction fall with a falling pressure, its reason (hardening) with a rising one; here, without"
        f" hardening, {100.0 * (high / low - 1.0):+.1f} % from 50 to 500 kPa"
    )


def _warm() -> PaperFinding:
    mu = {celsius: sum(_parts(celsius=celsius)) for celsius in (25.0, 55.0)}
    change = mu[55.0] / mu[25.0] - 1.0
    return judged(
        abs(change) >= DRASTIC, f"{100.0 * change:+.0f} % from 25 to 55 degC at 1 m/s and 300 kPa (tread [A])"
    )


def _soft() -> PaperFinding:
    stiff = Greta(_stiffer(2.0), surface("road"))
    parts, other = _parts(), _parts(law=stiff)
    return judged(
        sum(other) < sum(parts),
        f"E' twice as high: adhesion {100.0 * (other.adhesion / parts.adhesion - 1.0):+.0f} %, hysteresis"
        f" {100.0 * (other.hysteresis / parts.hysteresis - 1.0):+.0f} %",
    )


def _stiffer(factor: float) -> Rubber:
    entry = rubber("tread")
    return replace(entry, modulus=Stiffer(entry.modulus, factor))


def _smooth(factor: float) -> Components:
    road = surface("road")
    assert road.coarse is not None and road.fine is not None
    waves = (Sinusoid(entry.wavelength_m, factor * entry.ra_m) for entry in (road.coarse, road.fine))
    coarse, fine = waves
    return _parts(law=Greta(rubber("tread"), replace(road, coarse=coarse, fine=fine)))


def _rough_adhesion() -> PaperFinding:
    ratio = _smooth(0.5).adhesion / _parts().adhesion
    return judged(ratio > 1.0, f"Ra halved: adhesion times {ratio:.3f}")


def _rough_hysteresis() -> PaperFinding:
    law = tread_on_road()
    coarse = law.dynamic(WARM_C, 1.0)[0]
    free = [_free(factor, coarse) for factor in (0.5, 1.0)]
    half, whole = _smooth(0.5).hysteresis, _parts().hysteresis
    return judged(
        half < whole,
        f"Ra halved: {whole:.4f} becomes {half:.4f}; at the same K = 0 {free[1]:.4f} becomes {free[0]:.4f}. K, the"
        " adhesion, is limited to 1: friction above it would outgrow the pressure [A]",
    )


def _free(factor: float, coarse: Dynamic) -> float:
    road = surface("road")
    assert road.coarse is not None
    wave = Sinusoid(road.coarse.wavelength_m, factor * road.coarse.ra_m)
    return Greta(rubber("tread"), replace(road, coarse=wave)).hysteresis(PRESSURE_PA, coarse, 0.0)


def _rough_sum() -> PaperFinding:
    half, whole = _smooth(0.5), _parts()
    return judged(sum(half) > sum(whole), f"Ra halved: mu {sum(whole):.3f} becomes {sum(half):.3f} (tread [A])")


def _tape() -> PaperFinding:
    tape = Greta(rubber("tread"), surface("anti-slip tape"))
    phrase = ", ".join(
        f"{tape.components(40.0, 10.0, speed).hysteresis:.3f}" for speed in (0.05, 0.5, 1.0, 2.0)
    )  # fmt: skip
    return unjudged(
        "moduli of C1 and C2 and the measured points are curves without numbers; wave lengths of the tape are not"
        f" printed. Hysteresis of `tread` on `anti-slip tape`, 40 degC, 10 N, 0.05 to 2 m/s: {phrase}"
    )


def _wet() -> PaperFinding:
    from sim.physics.track import TrackContact

    law = tread_on_road()
    at = WARM_C, load_n(PRESSURE_PA, law), 1.0
    wet = TrackContact().through(law, "wet").mu(*at)
    off = wet - law.components(*at).hysteresis
    return unjudged(
        f"the twin's wet track has the hysteresis of the law alone, to {off:g}: what dry less wet gives there is put in"
    )


HYSTERESIS_ITEMS: Final = (
    PaperItem("Eqs 14 to 18", "power of friction is that of the stress cycles, T0 = l / v", PREDICT, _power),
    PaperItem("Eq 19", "loss of a cycle of stress by tan d", "", _loss),
    PaperItem("Eq 20", "hysteresis as an integral of the stress", PREDICT, _eq_20),
    PaperItem("Eq 21", "radius of a crest", "", _eq_21),
    PaperItem("Eq 22, Fig 10", "half length of the contact", "", _eq_22),
    PaperItem("Fig 11, 14a", "along the sliding, pressure before the crest, tension behind", "", _along),
    PaperItem("Fig 12", "across, the stress is symmetrical", "", _across),
    PaperItem("Fig 13", "adhesion makes the field asymmetrical, the more the higher K", "", _more_friction),
    PaperItem("Fig 14b", "the field fades across the crest by a quadratic", "", _fade),
    not_attempted("Fig 15", "finite elements confirm the fade; shear adds a tenth", "no finite elements here"),
    PaperItem("Fig 16", "friction over speed", f"{DRAWN} --over speed", _speed),
    PaperItem("Fig 16", "friction falls with pressure (by the reason in the text, hardening)",
              f"{DRAWN} --over pressure", _pressure),
    PaperItem("Text to Fig 8", "friction falls with decreasing pressure", f"{DRAWN} --over pressure", _text_pressure),
    PaperItem("Fig 17a", "30 K change friction drastically", PREDICT, _warm),
    PaperItem("Fig 17b", "a higher storage modulus lowers friction", "", _soft),
    PaperItem("Fig 18", "a smoother road has more adhesion", DRAWN, _rough_adhesion),
    PaperItem("Fig 18", "... less hysteresis", DRAWN, _rough_hysteresis),
    PaperItem("Fig 18", "... and more friction in all", DRAWN, _rough_sum),
    not_attempted("Figs 19, 20", "E' and tan d of the compounds C1 and C2", "curves without numbers"),
    PaperItem("Fig 21",
              "hysteresis of C1 and C2 on 3M tape, 40 degC, 10 and 20 N, 0.05 to 2 m/s, agrees with wet tests",
              "tester components RUN", _tape),
    PaperItem("Fig 21", "dry less wet is adhesion", "tester components RUN", _wet),
    PaperItem("Conclusions", "friction is the sum of adhesion and hysteresis", PREDICT, _sum),
    not_attempted("Conclusions", "fast enough for real time", "no figure is printed"),
)  # fmt: skip
