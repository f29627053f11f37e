"""Paper G up to its model of adhesion: the rubber, the road, Eqs 1 to 13."""

from __future__ import annotations

from math import atan2, pi, sqrt
from typing import Final

import numpy as np

from sim.physics.greta import contact_slope, mean_square_slope
from sim.physics.materials import Sinusoid
from tester.analysis.papers import PaperFinding, PaperItem, judged, not_attempted, slight
from tester.kinds.specimen_on_track.papers.paper_parts import load_n, rubber, surface, tread_on_road

WARM_C: Final = 25.0
PRESSURE_PA: Final = 3e5
"""Pressure of Figures 17 and 18."""
DECADE_K: Final = 8.0
MACRO_M, MACRO_RA_M = 9.9e-3, 0.8e-3
MACRO: Final = ((0.5e-3, 50e-3), (0.1e-3, 20e-3))
MICRO: Final = ((0.0, 0.5e-3), (1e-6, 500e-6))
"""Table 1: wave length and Ra of a macrotexture and a microtexture, m."""
PREDICT: Final = (
    "tester predict --law greta --components --compound tread --surface road"
    ' --slip "1 m/s" --load "30 N" --temperature "25 degC"'
)


def modulus_pa(celsius: float, hertz: float) -> complex:
    """Return E* of the packaged tread compound, Pa."""
    result = rubber("tread").modulus.complex_pa(np.array([2.0 * pi * hertz]), celsius)
    return 3.0 * complex(result[0])


def _texture() -> PaperFinding:
    road = surface("road")
    assert road.coarse is not None and road.fine is not None
    holds = _within(road.coarse, MACRO) and _within(road.fine, MICRO)
    return judged(
        holds,
        f"the road's coarse wave ({1e3 * road.coarse.wavelength_m:g} mm, Ra {1e3 * road.coarse.ra_m:g} mm) is a"
        " macrotexture, its"
        f" fine one ({1e6 * road.fine.wavelength_m:g} um, {1e6 * road.fine.ra_m:g} um) a microtexture by the table."
        " Units of Ra were read by machine, micro as milli",
    )


def _within(wave: Sinusoid, bounds: tuple[tuple[float, float], tuple[float, float]]) -> bool:
    (low, high), (least, most) = bounds
    return low <= wave.wavelength_m <= high and least <= wave.ra_m <= most


def _road() -> PaperFinding:
    road = surface("road")
    assert road.coarse is not None and road.fine is not None
    printed = (MACRO_M, MACRO_RA_M, MACRO_M / 100.0, MACRO_RA_M / 100.0)
    result = (road.coarse.wavelength_m, road.coarse.ra_m, road.fine.wavelength_m, road.fine.ra_m)
    off = max(abs(a / b - 1.0) for a, b in zip(result, printed, strict=True))
    return judged(off < 1e-9, f"the surface `road` has these waves, off by {slight(off)}")


def _cycle() -> PaperFinding:
    e = modulus_pa(WARM_C, 1.0)
    t = np.linspace(0.0, 1.0, 20001)
    strain = np.sin(2.0 * pi * t)
    stress = e.real * strain + e.imag * np.cos(2.0 * pi * t)
    work = float(np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(strain)))
    phase = atan2(e.imag, e.real)
    largest = float(np.max(stress)) / abs(e) - 1.0
    off = max(abs(work / (pi * e.imag) - 1.0), abs(largest))
    return judged(
        off < 1e-4,
        f"a cycle of the tread's modulus does the work pi E'' and has the amplitude |E|, to {slight(off)}; tan d"
        f" {np.tan(phase):.3f}",
    )


def _shift() -> PaperFinding:
    fast, cold = modulus_pa(WARM_C, 100.0), modulus_pa(WARM_C - 2.0 * DECADE_K, 1.0)
    off = abs(fast / cold - 1.0)
    return judged(
        off < 1e-9,
        f"E at 25 degC and 100 Hz is E at {WARM_C - 2.0 * DECADE_K:g} degC and 1 Hz, to {slight(off)}; the indices in"
        " print are mixed up",
    )


def _trend_of_modulus() -> PaperFinding:
    hot, cold = modulus_pa(60.0, 1.0), modulus_pa(20.0, 1.0)
    fast = modulus_pa(20.0, 1e3)
    tan = [modulus_pa(float(entry), 1.0) for entry in np.arange(-60.0, 61.0, 5.0)]
    factors = [entry.imag / entry.real for entry in tan]
    inside = 0 < int(np.argmax(factors)) < len(factors) - 1
    return judged(
        hot.real < cold.real < fast.real and inside,
        f"the tread that ships [A]: E' {cold.real / 1e6:.1f} MPa at 20 degC and 1 Hz, {hot.real / 1e6:.1f} at 60 degC,"
        f" {fast.real / 1e6:.1f} at 1 kHz; tan d is largest at {-60.0 + 5.0 * int(np.argmax(factors)):g} degC",
    )


def _devices() -> PaperFinding:
    from tester.kinds import load_rig
    from tester.kinds.specimen_on_track.rig import TrackConfig

    rig = TrackConfig.of(load_rig("pin-on-disc"))
    there = [name for name in ("load_cell", "pyrometer", "thermometer") if name in rig.devices]
    weights = ", ".join(f"{entry:g}" for entry in rig.weights)
    holds = len(there) == 3 and not rig.linear and {10.0, 20.0} <= set(rig.weights)
    return judged(
        holds,
        f"the rig `pin-on-disc` has {', '.join(there)}, a disc whose drive tells its speed, an arm and weights of"
        f" {weights} N; no encoder of its own on the disc",
    )


def _eq_11_12_13() -> PaperFinding:
    law, shear = tread_on_road(), rubber("tread").shear
    assert shear is not None
    off = 0.0
    for speed in (0.01, 1.0, 30.0):
        e = abs(modulus_pa(WARM_C, speed / law.fine.wavelength_m))
        tau = shear.strength_pa * (1.0 + shear.ratio / (1.0 + shear.speed_m_s / speed) ** shear.exponent)
        share = min(1.0, 2.0 * PRESSURE_PA / (sqrt(pi * mean_square_slope(law.fine)) * e))
        result = law.components(WARM_C, load_n(PRESSURE_PA, law), speed).adhesion
        off = max(off, abs(result / (tau * share / PRESSURE_PA) - 1.0))
    return judged(off < 1e-6, f"adhesion at 0.01, 1 and 30 m/s differs from the formulas by {slight(off)}")


def _eq_13() -> PaperFinding:
    wave = Sinusoid(MACRO_M / 100.0, MACRO_RA_M / 100.0)
    slope = sqrt(mean_square_slope(wave))
    full = contact_slope(wave) / slope
    return judged(
        False,
        f"m2 is called the rms slope; only with the mean square slope is contact full at {full:.2f} E times the"
        " slope, which is Persson's limit. So it is taken",
        "0: formulas are compared",
    )


ADHESION_ITEMS: Final = (
    not_attempted("Eq 1", "mu is force over load", "a definition; every run measures it so"),
    not_attempted("Fig 1, Eq 2", "adhesion, hysteresis and cohesion add up (Kummer)",
                  "no law of wear or cohesion, which the paper puts at 2 %; that the first two add up is below"),
    not_attempted("Fig 2", "which scale of roughness makes which friction", "a drawing; `greta` is built so"),
    PaperItem("Table 1", "scales of a road's texture", "tester materials show road", _texture),
    not_attempted("Figs 3, 4", "volume of the tread; scan of a road and its two waves",
                  "no scan is printed; of a scan of one's own `tester materials show` finds the two waves"),
    PaperItem("Results", "the road: 9.9 mm, Ra 0.8 mm; fine waves of a hundredth", "tester materials show road", _road),
    PaperItem("Eqs 3 to 7", "stress of a harmonic strain; E', E'', tan d, E", "tester materials show tread", _cycle),
    PaperItem("Fig 5", "E' falls with temperature and rises with frequency, tan d has a maximum",
              "tester materials show tread", _trend_of_modulus),
    not_attempted("Figs 6, 7", "E' and tan d of a passenger tyre at 1 Hz, 1 % strain, -50 to 100 degC",
                  "curves without numbers; the treads that ship are invented [A]"),
    PaperItem("Eqs 8, 9", "8 K stand for a decade of frequency", "tester materials show tread", _shift),
    not_attempted("Eq 10, Fig 8", "the modulus grows as rubber is pressed, 8.5 times for 1 mm in 10 mm",
                  "a curve without numbers but this one; hardening is not modelled"),
    PaperItem("Fig 9", "pin on a disc: weights, load cell, encoder, pyrometer, ambient sensor",
              "tester rig show --rig pin-on-disc", _devices),
    PaperItem("Eqs 11 to 13", "adhesion from shear strength and area of contact", PREDICT, _eq_11_12_13),
    PaperItem("Eq 13", "m2 is the rms slope", "", _eq_13),
    not_attempted("Eq 12", "tau_s0, v_c, n from experiments on the disc", "the values are not printed"),
)  # fmt: skip
