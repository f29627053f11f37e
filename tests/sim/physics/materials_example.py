"""Compounds and surfaces for laws that are made of materials."""

from __future__ import annotations

from collections.abc import Mapping

from sim.physics.laws import OfMaterials
from sim.physics.materials import Components, Rubber, Surface, UnknownMaterialError
from sim.physics.moduli import ConstantModulus, FractionalZener
from sim.physics.roughness import SelfAffine
from tests.sim.physics.greta_example import SHEAR, road, rubber

GRIT = SelfAffine(2.6023e-19, 2e4, 10.0**5.344, 0.8)
"""20 um high, slope 1.0272."""
SBR = FractionalZener(1e6, 1e9, 1e-6, 0.6, -3.0)


class Shelf:
    """Compounds SBR, plain and demonstration; surfaces grit, road and track, which is both."""

    def rubber(self, name: str) -> Rubber:
        """Return one of them."""
        known = {
            "SBR": Rubber("SBR", SBR, glass_c=-53.0, shear=SHEAR),
            "plain": Rubber("plain", ConstantModulus(1e6, 0.3)),
            "demonstration": rubber(),
        }
        if name not in known:
            raise UnknownMaterialError(f"no compound {name!r} on the shelf")
        return known[name]

    def surface(self, name: str) -> Surface:
        """Return one of them."""
        waves = road()
        known = {
            "grit": Surface("grit", GRIT),
            "road": waves,
            "track": Surface("track", GRIT, waves.coarse, waves.fine),
        }
        if name not in known:
            raise UnknownMaterialError(f"no surface {name!r} on the shelf")
        return known[name]


class Hard:
    """A law of materials from elsewhere."""

    def __init__(self, rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> None:
        """Take the materials."""
        self.area_mm2 = area_mm2

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion by the area under each newton, and a hysteresis that is always the same."""
        return Components(0.01 * self.area_mm2 / load_n, 0.25)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return their sum."""
        return sum(self.components(temperature_c, load_n, slip_m_s))


HARD = OfMaterials(Hard)
