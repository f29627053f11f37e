"""The law `greta` itself in the twin, in place of its table: a table of each seed's own surface takes minutes."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Final

from sim.physics.greta import Greta, greta
from sim.physics.laws import OfMaterials
from sim.physics.materials import Components, Rubber, Surface

NAME: Final = "tests.campaigns.greta.direct:DIRECT"
STEP_C: Final = 0.02
"""Temperatures are rounded to this step: friction changes by less than 0.1 % over one."""


class DirectGreta:
    """The law; its value is cached while temperature, load and speed do not change."""

    def __init__(self, law: Greta) -> None:
        """Store the law."""
        self._components = lru_cache(maxsize=4096)(law.components)

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        """Return adhesion and hysteresis."""
        return self._components(STEP_C * round(temperature_c / STEP_C), load_n, slip_m_s)

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        """Return the coefficient."""
        return sum(self.components(temperature_c, load_n, slip_m_s))


def _direct(rubber: Rubber, surface: Surface, area_mm2: float, figures: Mapping[str, float]) -> DirectGreta:
    return DirectGreta(greta(rubber, surface, {**figures, "area": area_mm2}))


DIRECT: Final = OfMaterials(_direct)
