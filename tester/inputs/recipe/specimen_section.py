"""A specimen in a recipe: its compound, where its rubber came from, and what was measured before it was put on."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from typing import TYPE_CHECKING, Annotated, TypeAlias, cast

from pydantic import AfterValidator, BeforeValidator, Field

from tester.base.units import Quantity
from tester.base.validation import Section
from tester.inputs.recipe.axis_lists import MAX_NAME
from tester.inputs.recipe.plan import Specimen

if TYPE_CHECKING:
    from tester.inputs.recipe.recipe_schema import Recipe

MAX_CHECKS = 20
"""Most items of a checklist: a person reads all of them at once, on a screen of 24 lines."""


def _day(text: str) -> str:
    try:
        return date.fromisoformat(text).isoformat()
    except ValueError:
        raise ValueError(f'"{text}" is not a day (expected one as "2026-11-25")') from None


def _as_list(value: object) -> object:
    return cast("object", value) if isinstance(value, list) else [value]


Name: TypeAlias = Annotated[str, Field(min_length=1, max_length=MAX_NAME)]
Day: TypeAlias = Annotated[str, AfterValidator(_day)]
Hardnesses: TypeAlias = Annotated[
    list[Annotated[float, Quantity("1", ge=0, le=100)]], BeforeValidator(_as_list), Field(min_length=1, max_length=100)
]
Diameters: TypeAlias = Annotated[
    list[Annotated[float, Quantity("mm", gt=0)]], BeforeValidator(_as_list), Field(min_length=1, max_length=100)
]
Check: TypeAlias = Annotated[str, Field(min_length=1, max_length=80)]
Checklist: TypeAlias = Annotated[list[Check], Field(max_length=MAX_CHECKS)]


class OriginSection(Section, frozen=True):
    """Where the rubber of a specimen came from; recorded."""

    lot: Name | None = None
    mixed: Day | None = None
    """day of mixing, as "2026-11-25" """
    cured: Day | None = None
    """day of curing"""
    mould: Name | None = None


class MeasuredSection(Section, frozen=True):
    """What a person measured of a specimen before it was put on; recorded. Of several replicates a list, one each."""

    hardness: Hardnesses | None = None
    """Shore A, 0 to 100"""
    diameter: Diameters | None = None
    """at room temperature; the rig file's geometry is what the run calculates with"""


class SpecimenModel(Section, frozen=True):
    """A compound to test; each specimen (and each replicate of it) starts on new rubber."""

    compound: Name
    """name of the rubber compound; 1#, 2#, 3# have a friction model in the simulator"""
    note: Annotated[str, Field(max_length=500)] = ""
    origin: OriginSection | None = None
    measured: MeasuredSection | None = None


def specimens_of(recipe: Recipe) -> tuple[Specimen, ...]:
    """Return a recipe's specimens for its plan, in the recipe's order."""
    checks = checks_of(recipe)
    return tuple(
        Specimen(index, model.compound, model.note, checks) for index, model in enumerate(recipe.specimens, start=1)
    )


def checks_of(recipe: Recipe) -> str:
    """Return a recipe's checklist as one text."""
    return "; ".join(recipe.checklist)


def specimen_metadata(recipe: Recipe) -> dict[str, str]:
    """Return origin and measured values of a recipe's specimens, in columns named with specimen and unit."""
    result: dict[str, str] = {}
    for index, model in enumerate(recipe.specimens, start=1):
        if model.origin is not None:
            result |= {f"specimen_{index}_{key}": text for key, text in model.origin if text is not None}
        if model.measured is not None:
            for key, values in (
                ("hardness_shore_a", model.measured.hardness), ("diameter_mm", model.measured.diameter)
            ):  # fmt: skip
                if values is not None:
                    result[f"specimen_{index}_{key}"] = " ".join(f"{value:g}" for value in values)
    return result


def wrong_counts(specimens: Sequence[SpecimenModel], replicates: int) -> str:
    """Return what is wrong with the number of values measured of each replicate; "" if nothing is."""
    for index, model in enumerate(specimens, start=1):
        for key, values in model.measured or ():
            if values is not None and len(values) != replicates:
                return (f"specimens, item {index}, measured.{key} has {len(values)} values"
                        f" (expected one for each replicate: {replicates})")  # fmt: skip
    return ""
