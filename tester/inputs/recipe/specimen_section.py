"""A specimen in a recipe: its compound, where its rubber came from, and what was measured before it was put on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from datetime import date
from typing import TYPE_CHECKING, Annotated, Final, Literal, TypeAlias, cast

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag

from tester.base.units import SHORE_A, Quantity
from tester.base.validation import Section
from tester.inputs.recipe.axis_lists import MAX_NAME
from tester.inputs.recipe.plan import Specimen

if TYPE_CHECKING:
    from tester.inputs.recipe.recipe_schema import Recipe

PROMPT: Final = "prompt"
_COLUMNS: Final = {"hardness": "hardness_shore_a", "diameter": "diameter_mm"}
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
_Read: TypeAlias = Annotated[
    list[Annotated[float, Quantity(SHORE_A, True, ge=0, le=100)]],
    BeforeValidator(_as_list),
    Field(min_length=1, max_length=100),
    Tag("read"),
]
Hardness: TypeAlias = Annotated[
    _Read | Annotated[Literal["prompt"], Tag(PROMPT)],
    Discriminator(lambda value: PROMPT if value == PROMPT else "read"),
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

    @property
    def asked(self) -> bool:
        """Whether the question at mounting asks for the hardness."""
        return self.hardness == PROMPT

    @property
    def listed(self) -> Iterator[tuple[str, Sequence[float]]]:
        """The measured values by key, those that the recipe states."""
        for key, values in (("hardness", self.hardness), ("diameter", self.diameter)):
            if values is not None and not isinstance(values, str):
                yield key, values

    hardness: Hardness | None = None
    """Shore A, 0 to 100; ``prompt``: the question at mounting asks for it"""
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
        Specimen(index, model.compound, model.note, checks, model.measured is not None and model.measured.asked)
        for index, model in enumerate(recipe.specimens, start=1)
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
        for key, values in model.measured.listed if model.measured is not None else ():
            result[f"specimen_{index}_{_COLUMNS[key]}"] = " ".join(f"{value:g}" for value in values)
    return result


def wrong_counts(specimens: Sequence[SpecimenModel], replicates: int) -> str:
    """Return what is wrong with the number of values measured of each replicate; "" if nothing is."""
    for index, model in enumerate(specimens, start=1):
        for key, values in model.measured.listed if model.measured is not None else ():
            if len(values) != replicates:
                return (f"specimens, item {index}, measured.{key} has {len(values)} values"
                        f" (expected one for each replicate: {replicates})")  # fmt: skip
    return ""
