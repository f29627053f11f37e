"""A compound's law of friction on the simulated wheel's belt.

The laws ``paper`` and ``v2`` know the paper's three compounds; any other compound takes the law in its file. A file
without one, or no file, leaves the law unknown: the compound then takes that of ``ASSUMED``, and ``assumed`` states so.
A law of another name that the rig file chooses is the law of every compound, with the figures of a compound's file
where that states the same law. A law of materials is made of the compound's modulus and the recipe's surface.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians, sin
from typing import Final

from sim.physics import laws
from sim.physics.friction import KNOWN, MODEL_NAMES
from sim.physics.laws import FrictionLaw, LawSetting
from sim.physics.lookup import TableSpan
from sim.physics.materials import ReadOnce
from sim.physics.slip import CORNERING

ASSUMED: Final = "1#"
"""Compound whose law is assumed for one of which none is known [A]: a carbon-black filled tread of natural rubber."""
WHEEL_M_S: Final = (1e-4, 3.0)
WHEEL_C: Final = (0.0, 120.0)
WHEEL_N: Final = (20.0, 600.0)
"""Ranges of a slow law's table for a simulated wheel [A]. Values below the least speed and load are those there."""


@dataclass(frozen=True, slots=True)
class WheelLaw:
    """A compound's law on the belt, and its extra friction per sin|sideslip|."""

    law: FrictionLaw
    cornering: float = 0.0
    assumed: str = ""
    """Why the law is an assumption, "" where it is known."""

    def cornering_factor(self, sideslip_deg: float) -> float:
        """Return the coefficient's factor at a sideslip angle."""
        return 1.0 + self.cornering * sin(radians(abs(sideslip_deg)))

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient without sideslip."""
        return self.law.mu(temperature_c, load_n, slip_m_s)


def wheel_law(
    model: str, compound: str, setting: LawSetting = laws.NO_SETTING, area_mm2: float | None = None, *,
    quick: bool = False,
) -> WheelLaw:  # fmt: skip
    """Return the law of a compound; ``model``: the name that the rig file chooses.

    ``area_mm2``: nominal area of contact. ``quick``: a slow law as its table, for a simulated rig. Raises
    UnknownLawError, UnknownCompoundError, UnknownMaterialError, and ValueError for unsuitable figures and materials.
    """
    cornering = CORNERING.get(compound, 0.0)
    maker = laws.find(model)
    if isinstance(maker, laws.OfMaterials):
        materials = ReadOnce(setting.materials) if setting.materials is not None else None
        own = replace(setting, materials=materials, area_mm2=area_mm2)
        if quick and maker.slow:
            from sim.physics.tabulated import tabulated  # numpy takes a tenth of a second to import

            span = TableSpan(WHEEL_M_S, WHEEL_C, WHEEL_N)
            return WheelLaw(tabulated(model, compound, laws.NO_FIGURES, own, span), cornering)
        return WheelLaw(laws.make(model, compound, setting=own), cornering)
    if model in MODEL_NAMES and compound in KNOWN:
        return WheelLaw(laws.make(model, compound), cornering)
    stated = setting.stated(compound)
    if stated is not None and (model in MODEL_NAMES or stated.form == model):
        return WheelLaw(laws.make(stated.form, compound, stated.figures), stated.cornering)
    if model in MODEL_NAMES:
        why = f"the simulated wheel's law of {compound!r} is assumed, not known: it rubs as {ASSUMED} does"
        return WheelLaw(laws.make(model, ASSUMED), 0.0, why)
    return WheelLaw(laws.make(model, compound), cornering)


def known_law(model: str, compound: str) -> FrictionLaw | None:
    """Return the law of a compound of the paper; None for any other, and where the law is made of files or not its."""
    if compound not in KNOWN or isinstance(laws.find(model), laws.OfMaterials):
        return None
    try:
        return laws.make(model, compound)
    except ValueError:
        return None
