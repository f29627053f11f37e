"""A configuration file to frozen dataclasses and back.

The dataclass is the only description of a section: its field names, types, defaults, units and ranges. From it this
module builds the validation (pydantic models, made once per class), so a misspelt key, a wrong unit or a value out of
range is a problem with a position in the file, as in a recipe.

A quantity is ``Annotated[float, "m/s"]``, optionally with a ``Range``. Its key in the file is the field's name without
its unit's suffix: ``wheel_speed_m_s`` is ``wheel_speed``. A bare number counts in the field's unit.

A mapping of sections whose default has entries is merged with them by name: an entry of the default keeps each key that
the file does not state, and an entry with a new name must state all of its keys.
"""

from __future__ import annotations

import json
import types
from collections.abc import Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass
from functools import cache, partial
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Final,
    NamedTuple,
    TypeVar,
    Union,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

from tester.base.source import InvalidSource, Tree
from tester.base.units import Quantity, units_like

if TYPE_CHECKING:
    from _typeshed import DataclassInstance
    from pydantic import BaseModel

Config = TypeVar("Config", bound="DataclassInstance")

FURTHER_KEYS: Final = "further keys"
"""Marks the one field of a dataclass that takes all keys without a field of their own: ``Annotated[Mapping[str, float],
FURTHER_KEYS]``. Each is a bare number; in the file they are beside the others."""

LEFT_OUT: Final = {"left out": True}
"""Metadata of a field that is written only where it differs from its default."""

SUFFIXES: dict[str, str] = {
    "m/s": "_m_s", "mm/s": "_mm_s", "rad/s": "_rad_s", "m/s2": "_m_s2", "mm/s2": "_mm_s2",
    "mm": "_mm", "m": "_m", "um": "_um", "deg": "_deg", "s": "_s", "ms": "_ms", "Hz": "_hz", "rev": "_rev",
    "N": "_n", "N m": "_nm", "N/mm": "_n_per_mm", "N s/m": "_ns_per_m", "N/K": "_n_per_k", "N/s": "_n_s",
    "degC": "_c", "K": "_k", "K/s": "_k_s", "W": "_w", "J": "_j", "J/K": "_j_k", "W/K": "_w_k",
    "mm3/(N m)": "_mm3_per_n_m", "mm/K": "_mm_per_k", "%": "_percent", "bit/s": "_bit_s",
    "kg/m3": "_kg_m3", "J/(kg K)": "_j_kg_k", "W/(m K)": "_w_m_k", "W/(m2 K)": "_w_m2_k",
}  # fmt: skip
"""Suffix of a field's name for its unit. The list is closed: a field with another unit keeps its name as its key."""


@dataclass(frozen=True, slots=True)
class Range:
    """Bounds of a quantity, in its unit: ``Annotated[float, "N", Range(gt=0)]``."""

    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None


@dataclass(frozen=True, slots=True)
class KeyEntry:
    """A field of a configuration class: its name, its key in the file, its type and its unit.

    ``unit`` is "" for anything but a quantity. ``marks``: everything else that its ``Annotated`` type carries.
    """

    name: str
    key: str
    type: Any
    unit: str
    marks: tuple[object, ...]


@cache
def entries(kind: type[DataclassInstance]) -> tuple[KeyEntry, ...]:
    """Return the fields of a configuration class that a file sets, in their order."""
    hints = _hints(kind)
    return tuple(_entry(field.name, hints[field.name]) for field in fields(kind) if field.init)


def _entry(name: str, hint: Any) -> KeyEntry:
    marks = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
    bare: Any = get_args(hint)[0] if marks else hint
    return KeyEntry(name, _key(name, hint), bare, _unit(hint) or "", marks)


def key_of(kind: type[DataclassInstance], name: str) -> str:
    """Return the key of a configuration class's field in the file."""
    return _key(name, _hints(kind)[name])


def read(kind: type[Config], tree: Tree, missing: str = "") -> Config:
    """Return a file's tree as an instance of ``kind``; raises InvalidSource with every problem.

    ``missing`` is added to the message for every missing key, except those of an entry with a new name.
    """
    from pydantic import TypeAdapter, ValidationError  # only commands that read a file pay for it

    from tester.base.validation import problems_of

    model = _model(kind)
    try:
        return cast("Config", TypeAdapter[object](_built(kind)).validate_python(tree.data))
    except ValidationError as error:
        raise InvalidSource(problems_of(error, tree, model, missing)) from error


def as_tree(config: DataclassInstance) -> dict[str, object]:
    """Return a configuration as data for a file: every key, quantities as text with their unit."""
    tree: dict[str, object] = {}
    for name, key, unit, hint, may_be_empty in _layout(type(config)):
        value = getattr(config, name)
        if key is None:
            tree.update({further: _number(number) for further, number in value.items()})
        elif value or not may_be_empty:
            tree[key] = _plain(value, hint, unit)
    return tree


def as_text(config: DataclassInstance) -> str:
    """Return a configuration as YAML that ``read`` turns into an equal one."""
    return "\n".join(_lines(as_tree(config), "")) + "\n"


@cache
def _hints(kind: type[DataclassInstance]) -> dict[str, Any]:
    return get_type_hints(kind, include_extras=True)


class _FieldLayout(NamedTuple):
    """How a field is written; ``key`` is None for the field of all further keys."""

    name: str
    key: str | None
    unit: str | None
    hint: Any
    may_be_empty: bool


@cache
def _layout(kind: type[DataclassInstance]) -> tuple[_FieldLayout, ...]:
    """Return how the fields of a dataclass are written, worked out once per class."""
    hints = _hints(kind)
    return tuple(
        _FieldLayout(
            field.name, None if _takes_rest(hint) else _key(field.name, hint), _unit(hint), hint, _may_be_empty(field)
        )
        for field, hint in ((one, hints[one.name]) for one in fields(kind))
    )


def _takes_rest(hint: object) -> bool:
    return get_origin(hint) is Annotated and FURTHER_KEYS in get_args(hint)


def _without_marks(hint: Any) -> Any:
    """Return the type of a field that is no quantity, without what marks it."""
    return get_args(hint)[0] if get_origin(hint) is Annotated and _unit(hint) is None else hint


def _may_be_empty(field: Field[Any]) -> bool:
    """Return whether an empty field is left out: a mapping, or one marked so."""
    return get_origin(field.default_factory) is dict or "left out" in field.metadata


def _unit(hint: object) -> str | None:
    """Return the unit of a quantity's type, None for any other type.

    ``N.m`` is the table's ``N m``. Raises KeyError for a unit that is not in the table of ``tester.base.units``.
    """
    if get_origin(hint) is not Annotated or _takes_rest(hint):
        return None
    unit = next((argument for argument in get_args(hint)[1:] if isinstance(argument, str)), None)
    if unit is not None:
        unit = unit.replace(".", " ")
        units_like(unit)
    return unit


def _key(name: str, hint: object) -> str:
    return name.removesuffix(SUFFIXES.get(_unit(hint) or "", ""))


@cache
def _base(*, further: bool) -> type[BaseModel]:
    """Return every model's base: text and true are no numbers; unknown keys are errors, or numbers if ``further``."""
    from pydantic import BaseModel, ConfigDict

    strict = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, protected_namespaces=())

    class Known(BaseModel):
        model_config = strict

    class Further(BaseModel):
        model_config = strict | {"extra": "allow"}
        __pydantic_extra__: dict[str, Annotated[float, Quantity("1", True)]]  # pyright: ignore

    return Further if further else Known


@cache
def _model(kind: type[DataclassInstance], known: tuple[str, ...] = ()) -> type[BaseModel]:
    """Return the pydantic model that checks a mapping for ``kind``.

    ``known``: the default's names, of an entry that must have every key if its name is another.
    """
    from pydantic import create_model

    hints = _hints(kind)
    base = _base(further=any(_takes_rest(hint) for hint in hints.values()))
    definitions: dict[str, Any] = {
        field.name: (_field_type(field, hints[field.name]), _field(field, hints[field.name], known))
        for field in fields(kind)
        if field.init and not _takes_rest(hints[field.name])
    }
    return create_model(kind.__name__, __base__=base, **definitions)


def _field_type(field: Field[Any], hint: Any) -> Any:
    """Return the pydantic type of a field; of a mapping of sections whose default has entries, one that merges them."""
    default: object = field.default_factory() if field.default_factory is not MISSING else field.default
    if not (isinstance(default, Mapping) and default):
        return _type(hint)
    from pydantic import BeforeValidator

    of = get_args(_without_marks(hint))[1]
    named = {name: as_tree(entry) for name, entry in cast("Mapping[str, DataclassInstance]", default).items()}
    return Annotated[dict[str, _built(of, tuple(named))], BeforeValidator(partial(_merged, named))]


def _merged(named: Mapping[str, dict[str, object]], given: object) -> object:
    """Return the entries of a file over those of the default: key by key where both have a name."""
    if not isinstance(given, dict):
        return given  # refused by the type
    stated = cast("dict[str, object]", given)
    both = {
        name: {**named[name], **cast("dict[str, object]", entry)}
        for name, entry in stated.items()
        if name in named and isinstance(entry, dict)
    }
    return {**named, **stated, **both}


def _field(field: Field[Any], hint: Any, known: tuple[str, ...]) -> object:
    from pydantic import Field as ModelField

    key = _key(field.name, hint)
    if known:
        return ModelField(alias=key, description=f"every key of a new name; known names: {', '.join(known)}")
    if field.default_factory is not MISSING:
        return ModelField(default_factory=field.default_factory, alias=key)
    if field.default is not MISSING:
        return ModelField(default=field.default, alias=key)
    return ModelField(alias=key)


def _built(kind: type[DataclassInstance], known: tuple[str, ...] = ()) -> Any:
    """Return the type that validates a mapping and yields an instance of ``kind``; ``known`` as for ``_model``.

    A ValueError of the dataclass itself becomes a problem at the mapping's place.
    """
    from pydantic import AfterValidator

    hints = _hints(kind)
    names = [field.name for field in fields(kind) if field.init]
    rest = next((name for name in names if _takes_rest(hints[name])), "")

    def build(model: BaseModel) -> DataclassInstance:
        values: dict[str, Any] = {name: getattr(model, name) for name in names if name != rest}
        if rest:
            values[rest] = dict(model.model_extra or {})
        return kind(**values)

    return Annotated[_model(kind, known), AfterValidator(build)]


def _type(hint: Any) -> Any:
    """Return the pydantic type for a field's type."""
    from pydantic import Strict

    unit = _unit(hint)
    if unit is not None:
        bounds = next((argument for argument in get_args(hint) if isinstance(argument, Range)), Range())
        return Annotated[float, Quantity(unit, True, bounds.gt, bounds.ge, bounds.lt, bounds.le)]
    hint = _without_marks(hint)
    if isinstance(hint, type) and is_dataclass(hint):
        return _built(hint)
    origin, arguments = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return Union[tuple(_type(argument) for argument in arguments)]  # noqa: UP007 - made of a tuple
    if origin is tuple:
        # A file has lists only; their items stay strict.
        return Annotated[tuple[tuple(_type(argument) for argument in arguments)], Strict(False)]
    if origin in (dict, Mapping):
        return dict[str, _type(arguments[1])]
    return cast("object", hint)


def _plain(value: object, hint: object, unit: str | None) -> object:
    if unit is not None and isinstance(value, int | float):
        return _number(value) if unit == "1" else Written(f"{_number(value)} {unit}")
    if is_dataclass(value) and not isinstance(value, type):
        return as_tree(value)
    if isinstance(value, Mapping):
        of = get_args(_without_marks(hint))[1]
        unit = _unit(of)
        return {key: _plain(entry, of, unit) for key, entry in cast("Mapping[str, object]", value).items()}
    if isinstance(value, tuple):
        items = cast("tuple[object, ...]", value)
        return [_plain(item, None, None) for item in items]
    return value


class Written(str):
    """A quantity as text with its unit: it needs no quotes in the file."""


def _number(value: float) -> int | float:
    """Return a whole float as int, so that 450.0 is written 450."""
    return int(value) if value == int(value) and abs(value) < 1e15 else float(value)


def _lines(tree: Mapping[str, object], indent: str) -> list[str]:
    lines: list[str] = []
    for key, value in tree.items():
        name = key if key.replace("_", "a").isalnum() and key[0].isalpha() else json.dumps(key)
        if isinstance(value, Mapping) and value:
            lines.append(f"{indent}{name}:")
            lines.extend(_lines(cast("Mapping[str, object]", value), indent + "  "))
        else:
            lines.append(f"{indent}{name}: {value if isinstance(value, Written) else json.dumps(value)}")
    return lines
