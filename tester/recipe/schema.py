"""What a recipe may say: the validated model of the YAML file.

Every quantity is a text with a unit in the file and a float here; the unit is in the annotation. Lists are
axes, a scalar is an axis of one. The JSON Schema for editors is generated from these classes.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias, cast

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema, model_validator

from tester.units import Quantity, UnitError, as_text, expected, parse_one_of

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema

LEAST_SPEED_M_S = 0.05
"""Slowest wheel or belt that is ever loaded: below it the control cannot be sure that they turn [A]."""

MAX_REPEATS = 1000
MAX_FREE_FIELD = 500
MAX_CONDITIONS = 250_000
"""Conditions of one plan, over all specimens and replicates: some five years of rig time."""


@dataclass(frozen=True, slots=True)
class Axis(Quantity):
    """Mark a field as an axis: a list of quantities, or one quantity for a list of one."""

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Give pydantic a list of at least one quantity; errors carry the index of the element."""
        from pydantic_core import core_schema

        items = Quantity.__get_pydantic_core_schema__(self, float, handler)
        return core_schema.no_info_before_validator_function(_as_list, core_schema.list_schema(items, min_length=1))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Describe both forms to editors."""
        one = Quantity.__get_pydantic_json_schema__(self, schema, handler)
        return {"anyOf": [one, {"type": "array", "items": one, "minItems": 1}]}


def _as_list(value: object) -> list[object]:
    return cast("list[object]", value) if isinstance(value, list) else [value]


@dataclass(frozen=True, slots=True)
class Extent:
    """How much of a window: ``value`` wheel revolutions (unit "rev") or seconds (unit "s")."""

    value: float
    unit: Literal["rev", "s"]

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Give pydantic a validator that reads ``30 rev`` or ``60 s``."""
        from pydantic_core import PydanticCustomError, core_schema

        def validate(value: object) -> Extent:
            try:
                return cls.read(value)
            except UnitError as error:
                raise PydanticCustomError("quantity", "{message}", {"message": str(error)}) from error

        in_json = core_schema.plain_serializer_function_ser_schema(str, when_used="json")
        return core_schema.no_info_plain_validator_function(validate, serialization=in_json)

    def __str__(self) -> str:
        return as_text(self.value, self.unit)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Describe the field to editors."""
        return {"type": "string", "description": expected("rev", "s"), "examples": ["30 rev", "60 s"]}

    @classmethod
    def read(cls, value: object) -> Extent:
        """Return the extent that a value of the file means; raises UnitError."""
        if not isinstance(value, str):
            raise UnitError(f"expected {expected('rev', 's')}")
        number, unit = parse_one_of(value, ("rev", "s"))
        if not 1.0 <= number <= 1e6:
            raise UnitError(f"{number:g} {unit} is out of range (expected 1 to 1e6 {unit})")
        return cls(number, "rev" if unit == "rev" else "s")


Text: TypeAlias = Annotated[str, Field(min_length=1, max_length=200)]
Speed: TypeAlias = Annotated[float, Quantity("m/s", ge=LEAST_SPEED_M_S)]
Load: TypeAlias = Annotated[float, Quantity("N", gt=0)]
Seconds: TypeAlias = Annotated[float, Quantity("s", ge=0)]
Band: TypeAlias = Annotated[float, Quantity("K", gt=0, le=20)]
Temperature: TypeAlias = Annotated[float, Quantity("degC", ge=-50, le=200)]
Count: TypeAlias = Annotated[int, Field(ge=1, le=MAX_REPEATS)]
Precision: TypeAlias = Annotated[float, Quantity("%", ge=0.1, le=50)]
MaxBursts: TypeAlias = Annotated[int, Field(ge=1, le=10_000)]
WearCheckName: TypeAlias = Literal["never", "each_condition", "prompt"]


def _free_field(value: object) -> str:
    """Return a free field as text: numbers and true/false are kept as they would be written."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int | float | str):
        text = str(value)
        if len(text) <= MAX_FREE_FIELD:
            return text
        raise ValueError(f"longer than {MAX_FREE_FIELD} characters")
    raise ValueError("expected a text or a number")


FreeField: TypeAlias = Annotated[
    str,
    BeforeValidator(_free_field),
    WithJsonSchema({"type": ["string", "number", "boolean"], "maxLength": MAX_FREE_FIELD}),
]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, use_attribute_docstrings=True)


class SpecimenModel(_Strict):
    """A compound to test; each specimen (and each replicate of it) starts on a new wheel."""

    compound: Text
    """name of the rubber compound; 1#, 2#, 3# have a friction model in the simulator"""
    note: Annotated[str, Field(max_length=500)] = ""


class AbrasiveModel(_Strict):
    """The belt; recorded with every condition."""

    name: Text
    mesh: Annotated[int, Field(ge=1, le=10_000)] | None = None
    id: Text | None = None


class PreGrindModel(_Strict):
    """Grinding of a new wheel before it measures."""

    wheel_speed: Speed
    belt_speed: Speed
    load: Load
    duration: Annotated[float, Quantity("s", gt=0, le=24 * 3600)]


class RestModel(_Strict):
    """Standing lifted after pre-grinding, until the surface is at a temperature again."""

    at_least: Seconds = 0.0
    until: Temperature | None = None
    within: Band = 2.0
    at_most: Annotated[float, Quantity("s", gt=0)] = 5400.0
    """longest wait (default 90 min), then a prompt on hardware and "not reached" otherwise"""

    @model_validator(mode="after")
    def _long_enough(self) -> RestModel:
        if self.at_most < self.at_least:
            raise ValueError(f"at_most, {self.at_most:g} s, is shorter than at_least, {self.at_least:g} s")
        return self


class SoakModel(_Strict):
    """When a temperature counts as reached."""

    within: Band = 1.0
    for_: Annotated[float, Quantity("s", ge=0)] = Field(default=60.0, alias="for")
    at_most: Annotated[float, Quantity("s", gt=0)] = 1800.0
    """longest wait (default 30 min), then a prompt on hardware and "not reached" otherwise"""

    @model_validator(mode="after")
    def _long_enough(self) -> SoakModel:
        if self.at_most < self.for_:
            raise ValueError(f"at_most, {self.at_most:g} s, is shorter than for, {self.for_:g} s")
        return self


class RepeatsModel(_Strict):
    """How many repeats a condition gets: as many as it needs to count, within bounds."""

    at_least: Count
    """repeats that count"""
    at_most: Count | None = None
    """repeats made in all, with those that make up for refused ones (default 2 x at_least)"""

    @model_validator(mode="after")
    def _in_order(self) -> RepeatsModel:
        if self.at_most is not None and self.at_most < self.at_least:
            raise ValueError(f"at_most, {self.at_most}, is less than at_least, {self.at_least}")
        return self


def _repeats(value: object) -> object:
    """Take a single number for the repeats that count."""
    return value if isinstance(value, dict | RepeatsModel) else {"at_least": value}


Repeats: TypeAlias = Annotated[
    RepeatsModel,
    BeforeValidator(_repeats, json_schema_input_type=Count | RepeatsModel),
]


class MeasureModel(_Strict):
    """How a condition is measured; the defaults of every grid."""

    wheel_speed: Speed
    repeats: Repeats = RepeatsModel(at_least=5)
    """repeats that count, such as 5; or {at_least: 5, at_most: 10}"""
    until: Precision | None = None
    """repeated until the expanded repeatability (type A, 95 %) of the coefficient is this, such as 2 %"""
    min_valid: Count | None = None
    """least valid repeats for a value without a flag (default 3, at most repeats)"""
    window: Extent = Extent(30.0, "rev")
    """wheel revolutions (or seconds) over which drift is judged, such as "30 rev"; a repeat collects 1.5 windows"""
    extend_to: Extent | None = None
    """the most that a repeat collects, such as one of repeats: 1 that is judged alone (default 3 x window)"""
    temperature_band: Band = 2.0
    soak: SoakModel = SoakModel()
    max_bursts: MaxBursts = 40
    """slip pulses in which a repeat may collect its window"""
    wear_check: WearCheckName = "never"


class GridModel(_Strict):
    """All combinations of its axes; what is not said here is as in ``measure``."""

    name: Text
    slip_velocity: Annotated[list[float], Axis("m/s")]
    load: Annotated[list[float], Axis("N", gt=0)]
    temperature: Annotated[list[float], Axis("degC", ge=-50, le=200)]
    sideslip: Annotated[list[float], Axis("deg", ge=-90, le=90)] = [0.0]
    camber: Annotated[list[float], Axis("deg", ge=-90, le=90)] = [0.0]
    wheel_speed: Annotated[list[float], Axis("m/s", ge=LEAST_SPEED_M_S)] | None = None
    repeats: Repeats | None = None
    until: Precision | None = None
    min_valid: Count | None = None
    window: Extent | None = None
    extend_to: Extent | None = None
    temperature_band: Band | None = None
    soak: SoakModel | None = None
    max_bursts: MaxBursts | None = None
    wear_check: WearCheckName | None = None


class OrderModel(_Strict):
    """In which order a wheel goes through its conditions."""

    temperature: Literal["ascending"] = "ascending"
    """ascending only: cooling a wheel takes far longer than heating it"""
    within: Literal["listed", "snake", "shuffled"] = "listed"
    """order at one temperature: as listed, back and forth, or shuffled (with a seed)"""
    seed: Annotated[int, Field(ge=0, le=2**63 - 1)] | None = None

    @model_validator(mode="after")
    def _seed_fits(self) -> OrderModel:
        if self.within == "shuffled" and self.seed is None:
            raise ValueError("within: shuffled needs a seed (expected a whole number, such as seed: 1)")
        if self.within != "shuffled" and self.seed is not None:
            raise ValueError(f"a seed has no effect with within: {self.within} (expected within: shuffled)")
        return self


class WheelModel(_Strict):
    """When a wheel is worn."""

    replace_after: Annotated[float, Quantity("mm", gt=0, le=20)] = 2.0
    """loss of diameter after which a wheel is replaced"""


class PersonStepModel(_Strict):
    """Something a person does, again and again."""

    prompt: Text
    """what to do; it is shown and waits to be acknowledged"""
    every: Literal["condition", "temperature", "wheel"]
    """before every condition, before every temperature, or after every installed wheel"""


class Recipe(_Strict):
    """A recipe of the friction tester."""

    recipe: Text
    """the recipe's name"""
    specimens: Annotated[list[SpecimenModel], Field(min_length=1, max_length=1000)]
    """a list with one compound each"""
    replicates: Annotated[int, Field(ge=1, le=100)] = 1
    """how often every specimen is tested as a whole, each time on a new wheel"""
    abrasive: AbrasiveModel | None = None
    humidity: Annotated[float, Quantity("%", ge=0, le=100)] | None = None
    ambient: Temperature | None = None
    experiment: dict[Annotated[str, Field(min_length=1, max_length=60)], FreeField] = {}
    """free fields, stored with the run and in conditions.csv"""
    pre_grind: PreGrindModel | None = None
    rest: RestModel | None = None
    measure: MeasureModel | None = None
    grids: Annotated[list[GridModel], Field(max_length=1000)] = []
    steps: Annotated[list[PersonStepModel], Field(max_length=100)] = []
    order: OrderModel = OrderModel()
    wheel: WheelModel = WheelModel()


def recipe_schema() -> dict[str, object]:
    """Return the JSON Schema (2020-12) of recipes, for editors."""
    schema: dict[str, object] = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    schema.update(cast("dict[str, object]", _tidy(Recipe.model_json_schema(by_alias=True))))
    return schema


def schema_text() -> str:
    """Return the JSON Schema as the text of ``recipes/recipe.schema.json``."""
    return json.dumps(recipe_schema(), indent=2, ensure_ascii=False) + "\n"


def _tidy(node: object) -> object:
    """Drop what misleads an editor: generated titles, null for "left out", defaults without their unit."""
    if isinstance(node, list):
        return [_tidy(one) for one in cast("list[object]", node)]
    if not isinstance(node, dict):
        return node
    entries = cast("dict[str, object]", node)
    tidy = {
        key: _tidy(value)
        for key, value in entries.items()
        if not (key == "title" and isinstance(value, str))
        and not (key == "default" and not isinstance(value, str | int))
    }
    choices = tidy.get("anyOf")
    if isinstance(choices, list):
        kept = [one for one in cast("list[object]", choices) if one != {"type": "null"}]
        if len(kept) == 1 and isinstance(kept[0], dict):
            del tidy["anyOf"]
            return {**cast("dict[str, object]", kept[0]), **tidy}
        tidy["anyOf"] = kept
    return tidy
