"""The values of an axis in a recipe's file: one, a list, or a spaced range such as ``{from: 1 N, to: 100 N, per_decade:
5}``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Final, cast

from pydantic import Field, model_validator

from tester.base.source import Location, Value
from tester.base.units import Quantity, UnitError, show
from tester.base.validation import Section, WithSection

if TYPE_CHECKING:
    from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema

MAX_NAME: Final = 200
MAX_CONDITIONS: Final = 250_000
"""Conditions of one plan, over all specimens and replicates: some five years of rig time."""

MAX_PER_DECADE: Final = 100
"""Most values in a decade: neighbours then differ by 2.3 %, and remain different when rounded."""
DIGITS: Final = 4
"""Significant digits of the values between the ends in equal ratios: off by 0.05 % at most."""
WHOLE: Final = 1e-6
"""Greatest distance of a number of intervals from a whole number that counts as whole."""
_DIFFERENCE: Final = {"degC": "K"}
"""Unit of a difference where it has another kind than the quantity; such a quantity has no ratios."""


class SpacedModel(Section, frozen=True):
    """A range of values: both ends, and values between them in equal ratios or steps."""

    per_decade: Annotated[int, Field(ge=1, le=MAX_PER_DECADE)] | None = None
    """values in a decade, such as 5; a little more where the ends are no whole number of such ratios apart"""

    @model_validator(mode="after")
    def _possible(self) -> SpacedModel:
        first, last, step, unit = self.extent()
        if (self.per_decade is None) == (step is None):
            raise ValueError("expected per_decade or step beside from and to")
        if not first < last:
            raise ValueError(f"from, {show(first, unit)}, is not less than to, {show(last, unit)}")
        if self.per_decade is not None and unit in _DIFFERENCE:
            raise ValueError(f"per_decade: {unit} has no ratios (expected step, such as step: 10 K)")
        if self.per_decade is not None and not first > 0.0:
            raise ValueError(f"per_decade makes equal ratios, and from is {show(first, unit)} (expected more than 0)")
        if step is not None:
            self._whole(first, last, step, unit)
        return self

    @staticmethod
    def _whole(first: float, last: float, step: float, unit: str) -> None:
        """Raise ValueError unless a whole number of steps leads from end to end, and not too many of them."""
        begin, width = _exact(first), _exact(step)
        steps = (_exact(last) - begin) / width
        if steps >= MAX_CONDITIONS:
            message = f"{show(float(steps), 'steps')} make too many values"
            raise ValueError(f"{message} (expected less than {MAX_CONDITIONS}, the most conditions of a plan)")
        if steps.denominator != 1:
            below, above = (float(begin + whole * width) for whole in (math.floor(steps), math.ceil(steps)))
            message = f"to, {show(last, unit)}, is no whole number of steps from {show(first, unit)}"
            raise ValueError(f"{message} (expected {show(below, unit)} or {show(above, unit)})")

    def values(self) -> list[float]:
        """Return the values in ascending order, in the unit of the axis; the ends as written.

        In equal ratios the values between them have four significant digits; in equal steps they are exact.
        """
        first, last, step, _ = self.extent()
        if step is not None:
            begin, width = _exact(first), _exact(step)
            count = int((_exact(last) - begin) / width)
            return [first, *(float(begin + number * width) for number in range(1, count)), last]
        decades = math.log10(last / first)
        count = math.ceil((self.per_decade or 1) * decades - WHOLE)
        exponents = (decades * number / count for number in range(1, count))
        return [first, *(float(f"{first * 10.0**exponent:.{DIGITS}g}") for exponent in exponents), last]

    def extent(self) -> tuple[float, float, float | None, str]:
        """Return both ends, the step, and the unit of the ends: fields that depend on the axis (``spaced_model``)."""
        raise NotImplementedError


def _exact(value: float) -> Fraction:
    """Return a number as it is written: 0.1 is a tenth."""
    return Fraction(repr(value))


@lru_cache
def spaced_model(
    unit: str, gt: float | None = None, ge: float | None = None, le: float | None = None
) -> type[SpacedModel]:
    """Return the model of a range of an axis in ``unit``; the bounds are those of the axis."""
    end, width = Quantity(unit, gt=gt, ge=ge, le=le), Quantity(_DIFFERENCE.get(unit, unit), gt=0.0)

    class Spaced(SpacedModel, frozen=True):
        """A range of values: both ends, and values between them in equal ratios or steps."""

        from_: Annotated[float, end] = Field(alias="from")
        to: Annotated[float, end]
        step: Annotated[float, width] | None = None

        def extent(self) -> tuple[float, float, float | None, str]:
            """Return both ends, the step, and the unit of the ends."""
            return self.from_, self.to, self.step, unit

    return Spaced


@dataclass(frozen=True, slots=True)
class Listed(Quantity, WithSection):
    """Mark a field as an axis: a list of quantities or of texts, a single one for a list of one, or a range of
    quantities."""

    choices: tuple[str, ...] | None = None
    """The texts; (): any name. None: quantities."""

    def section(self) -> type[BaseModel] | None:
        """Return the model of a range; None for texts."""
        return None if self.choices is not None else spaced_model(self.unit, self.gt, self.ge, self.le)

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return a schema of a list of at least one value; errors carry the index of the element, or a range's key."""
        from pydantic_core import core_schema

        items: CoreSchema
        section = self.section()
        if section is not None:
            items = Quantity.__get_pydantic_core_schema__(self, float, handler)
        elif self.choices:
            items = core_schema.literal_schema(list(self.choices))
        else:
            items = core_schema.str_schema(min_length=1, max_length=MAX_NAME)
        listed = core_schema.no_info_before_validator_function(_as_list, core_schema.list_schema(items, min_length=1))
        if section is None:
            return listed
        spread = core_schema.no_info_after_validator_function(SpacedModel.values, handler.generate_schema(section))
        return core_schema.tagged_union_schema(
            {"listed": listed, "spaced": spread},
            discriminator=_form,
            serialization=core_schema.plain_serializer_function_ser_schema(self._all_written, when_used="json"),
        )

    def _all_written(self, values: list[float]) -> list[float] | list[str]:
        return values if self.bare or self.unit == "1" else [self._written(value) for value in values]

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Describe all forms to editors."""
        one: JsonSchemaValue
        if self.choices is None:
            one = Quantity.__get_pydantic_json_schema__(self, schema, handler)
        else:
            one = {"enum": list(self.choices)} if self.choices else {"type": "string", "maxLength": MAX_NAME}
        forms: list[JsonSchemaValue] = [one, {"type": "array", "items": one, "minItems": 1}]
        if self.choices is None:
            forms.append(self._range_for_editors(one, schema, handler))
        return {"anyOf": forms}

    def _range_for_editors(
        self, end: JsonSchemaValue, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        difference = Quantity(_DIFFERENCE.get(self.unit, self.unit))
        spacing: dict[str, JsonSchemaValue] = {"step": difference.__get_pydantic_json_schema__(schema, handler)}
        if self.unit not in _DIFFERENCE:
            spacing["per_decade"] = {"type": "integer", "minimum": 1, "maximum": MAX_PER_DECADE}
        return {
            "type": "object",
            "properties": {"from": end, "to": end, **spacing},
            "required": ["from", "to"],
            "oneOf": [{"required": [name]} for name in spacing],
            "additionalProperties": False,
        }


def _form(value: object) -> str:
    return "spaced" if isinstance(value, dict) else "listed"


def _as_list(value: object) -> list[object]:
    return cast("list[object]", value) if isinstance(value, list) else [value]


def readable(node: Value, at: Location, unit: str) -> Iterator[tuple[float, Location]]:
    """Yield the readable quantities of an entry of a file, with their positions: one, a list's, or a range's.

    Values of a range have the position of the range. Unreadable ones are left out: the schema reports them.
    """
    if isinstance(node, dict):
        try:
            values = spaced_model(unit).model_validate(node).values()
        except ValueError:
            return
        yield from ((value, at) for value in values)
        return
    quantity = Quantity(unit)
    places = [((*at, index), item) for index, item in enumerate(node)] if isinstance(node, list) else [(at, node)]
    for place, value in places:
        try:
            yield quantity.read(value), place
        except UnitError:
            continue
