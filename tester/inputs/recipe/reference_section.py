"""A reference condition: the same one again and again through a run, to observe the counterface.

This section is common to recipes of any kind: how often, how many repeats. A kind adds the axes of its setpoint.
References become ordinary conditions of the plan, under a grid's name that is reserved in recipes with references.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Final

from pydantic import Field

from tester.analysis.reference import EVERY, NAME
from tester.inputs.recipe.axis_lists import MAX_CONDITIONS
from tester.inputs.recipe.recipe_schema import Repeats, Section, Text

REFERENCE: Final = NAME
"""The grid of reference conditions."""


class ReferenceSection(Section, frozen=True):
    """A reference condition, measured at the start, after every so many conditions, and at the end."""

    every: Annotated[int, Field(ge=1, le=MAX_CONDITIONS)]
    """conditions after which it is measured again"""
    repeats: Repeats | None = None
    """repeats that count (default: those of ``measure``)"""
    compound: Text | None = None
    """of the reserved piece (default: the first specimen's)"""


def reference_metadata(section: ReferenceSection | None) -> Mapping[str, str]:
    """Return the metadata that identify a run's references for a reader."""
    return {} if section is None else {EVERY: str(section.every)}
