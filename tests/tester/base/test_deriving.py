"""A subclass of a base class has slots for its own fields only."""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

from tester.base.deriving import derivable, mypyc_attr


@dataclass(slots=True)
class Base:
    """Modules that may be compiled."""

    now: float = 0.0


@derivable
class Plain(Base):
    """Base classes for a laboratory."""

    load_n: float = 1.0


@dataclass(slots=True)
class Own(Plain):
    """Of a laboratory's own."""

    way_mm: float = 2.0


def test_a_derived_class_makes_slots_for_its_own_fields_only() -> None:
    assert Own.__slots__ == ("way_mm",)


def test_all_fields_are_arguments_and_are_compared() -> None:
    assert Own(5.0, 6.0, 7.0) == Own(now=5.0, load_n=6.0, way_mm=7.0) != Own(5.0, 6.0)


def test_a_copy_has_every_field() -> None:
    assert copy(Own(5.0, 6.0, 7.0)) == Own(5.0, 6.0, 7.0)


def test_the_compilers_mark_leaves_a_class_as_it_is() -> None:
    assert mypyc_attr(allow_interpreted_subclasses=True)(Own) is Own
