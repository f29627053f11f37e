"""Schema of a recipe: the validated model of the YAML file.

Every quantity is a text with a unit in the file and a float here; the unit is in the annotation. Lists and ranges are
axes, a scalar is an axis of one value. The JSON Schema for editors is generated from these classes. A kind adds
sections of its own (``tester.inputs.recipe.recipe_part``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, TypeAlias, cast

from pydantic import BaseModel, BeforeValidator, Field, WithJsonSchema, create_model, model_validator

from tester.analysis.pressure import LOAD
from tester.base.axes import SURFACE, Axes, Axis
from tester.base.units import Quantity, UnitError, as_text, expected, parse_one_of
from tester.base.validation import Section
from tester.inputs.recipe.axis_lists import MAX_NAME, Listed
from tester.inputs.recipe.pressures import PRESSURE, ContactSection
from tester.inputs.recipe.specimen_section import Checklist, SpecimenModel, wrong_counts

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema

MAX_REPEATS = 1000
MAX_FREE_FIELD = 500
MAX_GRIDS = 1000


@dataclass(frozen=True, slots=True)
class Extent:
    """How much of a window: ``value`` revolutions (unit "rev") or seconds (unit "s")."""

    value: float
    unit: Literal["rev", "s"]

    @classmethod
    def __get_pydantic_core_schema__(cls, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return a validator of ``30 rev`` or ``60 s``."""
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
        """Return the extent in a value of the file; raises UnitError."""
        if not isinstance(value, str):
            raise UnitError(f"expected {expected('rev', 's')}")
        number, unit = parse_one_of(value, ("rev", "s"))
        if not 1.0 <= number <= 1e6:
            raise UnitError(f"{number:g} {unit} is out of range (expected 1 to 1e6 {unit})")
        return cls(number, "rev" if unit == "rev" else "s")


Text: TypeAlias = Annotated[str, Field(min_length=1, max_length=MAX_NAME)]
Load: TypeAlias = Annotated[float, Quantity("N", gt=0)]
Seconds: TypeAlias = Annotated[float, Quantity("s", ge=0)]
Band: TypeAlias = Annotated[float, Quantity("K", gt=0, le=20)]
Temperature: TypeAlias = Annotated[float, Quantity("degC", ge=-50, le=200)]
Count: TypeAlias = Annotated[int, Field(ge=1, le=MAX_REPEATS)]
Precision: TypeAlias = Annotated[float, Quantity("%", ge=0.1, le=50)]


def _free_field(value: object) -> str:
    """Return a free field as text: numbers and true/false keep their spelling."""
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


class AbrasiveModel(Section, frozen=True):
    """What the rubber slides on; recorded with every condition."""

    name: Text
    mesh: Annotated[int, Field(ge=1, le=10_000)] | None = None
    id: Text | None = None


class SoakModel(Section, frozen=True):
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


class RepeatsModel(Section, frozen=True):
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
    """Turn a single number into the repeats that count."""
    return cast("object", value) if isinstance(value, dict | RepeatsModel) else {"at_least": value}


Repeats: TypeAlias = Annotated[
    RepeatsModel,
    BeforeValidator(_repeats, json_schema_input_type=Count | RepeatsModel),
]


class MeasureModel(Section, frozen=True):
    """How a condition is measured; the defaults of every grid."""

    repeats: Repeats = RepeatsModel(at_least=5)
    """repeats that count, such as 5; or {at_least: 5, at_most: 10}"""
    until: Precision | None = None
    """repeated until the expanded repeatability (type A, 95 %) of the coefficient is this, such as 2 %"""
    combine: Literal["mean", "paper"] = "mean"
    """the mean of all repeats that count; or, as in the paper, of the closest two of three, which is less precise"""
    min_valid: Count | None = None
    """least valid repeats for a value without a flag (default 3, at most repeats)"""
    window: Extent = Extent(30.0, "rev")
    """revolutions (or seconds) over which drift is judged, such as "30 rev"; a repeat collects 1.5 windows"""
    extend_to: Extent | None = None
    """the most that a repeat collects, such as one of repeats: 1 that is judged alone (default 3 x window)"""
    temperature_band: Band = 2.0
    soak: SoakModel = SoakModel()


def _unpickled(make: Callable[..., type[BaseModel]], of: tuple[object, ...], state: dict[Any, Any]) -> BaseModel:
    model = make(*of)
    one = model.__new__(model)
    one.__setstate__(state)
    return one


class Made(Section, frozen=True):
    """A section whose class is made at run time, over a kind's axes."""

    axes: ClassVar[Axes]
    """Axes of the kind of rig."""
    made_by: ClassVar[tuple[Callable[..., type[BaseModel]], tuple[object, ...]]]
    """The function that makes the class, and its arguments: pickle keeps them in place of the class."""

    def __reduce__(self) -> tuple[object, ...]:
        return _unpickled, (*self.made_by, self.__getstate__())


class GridName(Section, frozen=True):
    """What a grid is called."""

    name: Text


class GridModel(GridName, Made, frozen=True):
    """All combinations of its axes; missing keys are as in ``measure``."""

    repeats: Repeats | None = None
    until: Precision | None = None
    min_valid: Count | None = None
    window: Extent | None = None
    extend_to: Extent | None = None
    temperature_band: Band | None = None
    soak: SoakModel | None = None
    measure_again: bool = False
    """conditions that another grid has too are measured in this one again (default: once, in the first of them)"""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Let editors accept a pressure in place of a load, which it becomes before validation."""
        written = handler(schema)
        properties, required = written.get("properties", {}), written.get("required", [])
        if LOAD in properties and LOAD in required:
            pressures = Listed("Pa").__get_pydantic_json_schema__(schema, handler)
            properties[PRESSURE] = pressures | {"description": "in place of load, over the area of `contact`"}
            written["required"] = [name for name in required if name != LOAD]
            written["oneOf"] = [{"required": [LOAD]}, {"required": [PRESSURE]}]
        return written


@lru_cache
def grid_model(axes: Axes, base: type[GridModel] = GridModel) -> type[GridModel]:
    """Return the model of a grid over a kind's axes: its keys are the names of the axes and the fields of ``base``."""
    fields: dict[str, Any] = {axis.name: _axis_field(axis) for axis in axes}
    due_first = dict(sorted(fields.items(), key=lambda entry: entry[1][1] is not ...))
    listed = create_model("GridAxes", __base__=GridName, **due_first)
    made = create_model("GridModel", __base__=(base, listed), __doc__=GridModel.__doc__)
    grid = cast("type[GridModel]", made)
    grid.axes, grid.made_by = axes, (grid_model, (axes, base))
    return grid


def _axis_field(axis: Axis) -> tuple[object, object]:
    """Return annotation and default of an axis: left out, it has the value of ``measure`` or its default, or is
    missing."""
    if axis.textual:
        listed: Any = Annotated[list[str], Listed("1", choices=axis.choices)]
    else:
        listed = Annotated[list[float], Listed(axis.recipe_unit, gt=axis.gt, ge=axis.ge, le=axis.le)]
    if axis.in_measure:
        return listed | None, None
    default = axis.recipe_default
    return listed, ... if default is None else [default]


def surfaces_of(recipe: Recipe) -> list[str]:
    """Return the names of the surfaces of a recipe, each once: the abrasive's, and those on the axis ``surface``."""
    named = [recipe.abrasive.name] if recipe.abrasive is not None else []
    for grid in recipe.grids:
        named += [name for name in getattr(grid, SURFACE, ()) if name]
    return list(dict.fromkeys(named))


class OrderModel(Section, frozen=True):
    """In which order a specimen goes through its conditions."""

    temperature: Literal["ascending"] = "ascending"
    """ascending only: cooling takes far longer than heating"""
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


class Recipe(Made, frozen=True):
    """A recipe of the friction tester."""

    recipe: Text
    """the recipe's name"""
    kind: Text = ""
    """kind of the rig that it is for"""
    specimens: Annotated[list[SpecimenModel], Field(min_length=1, max_length=1000)]
    """a list with one compound each"""
    replicates: Annotated[int, Field(ge=1, le=100)] = 1
    """how often every specimen is tested as a whole, each time on new rubber"""
    checklist: Checklist = Field(default_factory=list[str])
    """what a person checks at mounting; the question lists it, and the record keeps question and answer"""
    abrasive: AbrasiveModel | None = None
    contact: ContactSection | None = None
    """area under the rubber, which makes pressures of loads"""
    humidity: Annotated[float, Quantity("%", ge=0, le=100)] | None = None
    ambient: Temperature | None = None
    experiment: dict[Annotated[str, Field(min_length=1, max_length=60)], FreeField] = Field(
        default_factory=dict[str, str]
    )
    """free fields, stored with the run and in conditions.csv; `uncertainty.SETTING` replaces a bound of the budget"""
    measure: MeasureModel | None = None
    grids: Sequence[GridModel] = ()
    order: OrderModel = OrderModel()

    @model_validator(mode="after")
    def _one_each(self) -> Recipe:
        wrong = wrong_counts(self.specimens, self.replicates)
        if wrong:
            raise ValueError(wrong)
        return self


@lru_cache
def recipe_model(kind: str, base: type[Recipe], axes: Axes, grid: type[GridModel]) -> type[Recipe]:
    """Return the model of a kind's recipes: the sections of ``base``, and grids over its axes."""
    fields: dict[str, Any] = {
        "kind": (Text, Field(default=kind, description="kind of the rig that it is for")),
        "grids": (Annotated[list[grid_model(axes, grid)], Field(max_length=MAX_GRIDS)], []),
    }
    recipe = create_model("Recipe", __base__=base, __doc__=Recipe.__doc__, **fields)
    recipe.axes, recipe.made_by = axes, (recipe_model, (kind, base, axes, grid))
    return recipe
