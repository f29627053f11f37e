"""The figures of a law: made from a mapping of names, and refused where no law follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from math import isfinite
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Parameters = TypeVar("Parameters", bound="DataclassInstance")


def with_figures(law: str, parameters: type[Parameters], compound: str, figures: Mapping[str, float]) -> Parameters:
    """Return the parameters of a law (a dataclass) for a compound. Raises ValueError for unknown names, and its own."""
    known = [item.name for item in fields(parameters)]
    unknown = [name for name in figures if name not in known]
    if unknown:
        raise ValueError(f"compound {compound!r}: {law} has no {', '.join(unknown)}; it has {', '.join(known)}")
    return parameters(**figures)


def refuse(group: DataclassInstance, above_zero: tuple[str, ...], not_below_zero: tuple[str, ...] = ()) -> None:
    """Raise ValueError unless every number of a dataclass is finite, and above or at least 0 where it is listed."""
    for item in fields(group):
        value: float = getattr(group, item.name)
        name = f"{type(group).__name__}.{item.name}"
        if not isfinite(value):
            raise ValueError(f"{name} must be finite, not {value!r}")
        if item.name in above_zero and not value > 0.0:
            raise ValueError(f"{name} must be above 0, not {value!r}")
        if item.name in not_below_zero and not value >= 0.0:
            raise ValueError(f"{name} must be at least 0, not {value!r}")
