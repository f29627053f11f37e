"""The section ``law`` of a compound's file: its law of friction on the belt of a simulated wheel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final, Literal, TypeAlias, get_args, get_type_hints

from pydantic import Field, model_validator

from sim.physics import laws
from sim.physics.friction import NormalisedParameters, PaperParameters, V2Parameters
from sim.physics.simple import ArrheniusParameters, PowerParameters
from sim.physics.wlf import WlfBellParameters
from tester.base.units import Quantity, UnitError
from tester.base.validation import Section

Form: TypeAlias = Literal["paper", "v2", "wlf_bell", "power", "arrhenius"]
FIGURES: Final[Mapping[str, tuple[type, ...]]] = {
    "paper": (PaperParameters, NormalisedParameters),
    "v2": (V2Parameters,),
    "wlf_bell": (WlfBellParameters,),
    "power": (PowerParameters,),
    "arrhenius": (ArrheniusParameters,),
}
"""Groups of figures of each law; a field's unit is in its type."""


def units_of(form: str) -> dict[str, str]:
    """Return the unit of each figure of a law."""
    units: dict[str, str] = {}
    for group in FIGURES[form]:
        hints: dict[str, Any] = get_type_hints(group, include_extras=True)
        units |= {name: str(get_args(hint)[1]) for name, hint in hints.items()}
    return units


class LawModel(Section, frozen=True):
    """Its friction on the belt of a simulated wheel."""

    form: Form
    """a law with figures: paper (of equation 6) and v2 know temperature, load and speed, power load and speed, wlf_bell
    and arrhenius temperature and speed"""
    figures: dict[Annotated[str, Field(min_length=1, max_length=40)], float | int | str]
    """its figures; one that is no ratio has a unit, such as tm: 68 degC"""
    cornering: Annotated[float, Quantity("1", ge=0, le=5)] = 0.0
    """extra friction per sin|sideslip|"""
    source: Annotated[str, Field(min_length=1, max_length=2000)] | None = None
    """source of the figures; [A] for an assumption"""

    @model_validator(mode="after")
    def _makes_a_law(self) -> LawModel:
        stated = self.stated()
        laws.make(stated.form, "of this file", stated.figures)
        return self

    def stated(self) -> laws.StatedLaw:
        """Return the law. Raises ValueError for a figure that is unknown or has another unit."""
        units, read = units_of(self.form), dict[str, float]()
        for name, value in self.figures.items():
            if name not in units:
                raise ValueError(f"figures: law {self.form} has no {name} (expected {', '.join(units)})")
            try:
                read[name] = Quantity(units[name]).read(value)
            except UnitError as error:
                raise ValueError(f"figures: {name}: {error}") from error
        return laws.StatedLaw(self.form, read, self.cornering)
