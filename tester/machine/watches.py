"""What rows of the interlock table watch: a number against its limit, a number between two limits, a state.

``at_most``, ``at_least`` and ``within`` compare a number with its limits. The row's condition, the record of a trip and
the sentence on the safety page come from the same value and limit. ``condition`` watches a state. Their functions take
the kind's inputs and run in every scan in which the row can apply (``When``); they change nothing and may run more than
once in a scan. NaN is beyond every limit, so that missing data trip.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from operator import attrgetter
from typing import Any, TypeAlias

from tester.base.config_reader import SUFFIXES
from tester.inputs.rig.parameter import Parameter
from tester.machine.row import NOTHING_COMPARED, Compared, Form, V, Watch

Limit: TypeAlias = Parameter | str | float | Callable[[V], float]
"""A limit: a parameter; a number of the rig by its place in the inputs ("limits.load_n"); a constant; or a function."""


def at_most(level: str, value: Callable[[V], float], limit: Limit[V], unit: str = "") -> Watch[V]:
    """Return the watch of a number that may not exceed its limit.

    ``level``: the sentence for the safety page, with ``{}`` for the limit's name. ``unit``: of value and limit. It is
    not needed for a parameter, or for a place in the inputs, whose name ends with the unit.
    """
    return _one_sided(Form.AT_MOST, level, value, limit, unit)


def at_least(level: str, value: Callable[[V], float], limit: Limit[V], unit: str = "") -> Watch[V]:
    """Return the watch of a number that may not fall below its limit; arguments as for ``at_most``."""
    return _one_sided(Form.AT_LEAST, level, value, limit, unit)


def within(level: str, span: Callable[[V], tuple[float, float, float]], unit: str) -> Watch[V]:
    """Return the watch of a number between two variable limits; ``span`` returns lower limit, number, upper limit.

    For a row that watches several numbers, ``span`` returns the first that is beyond its limits.
    """

    def holds(v: V) -> bool:
        low, value, high = span(v)
        return not (low <= value <= high)

    def compared(v: V) -> Compared:
        low, value, high = span(v)
        return Compared(value, low if value < low else high, unit)

    return Watch(level, holds, compared, (), Form.WITHIN, (span,))


def condition(
    level: str, holds: Callable[[V], bool], compared: Callable[[V], Compared] = lambda _: NOTHING_COMPARED
) -> Watch[V]:
    """Return the watch of a state. Write the condition so that missing data trip: ``not (x <= limit)``, never ``x >
    limit``.
    """
    return Watch(level, holds, compared)


def _one_sided(form: Form, level: str, value: Callable[[V], float], limit: Limit[V], unit: str) -> Watch[V]:
    inside = operator.le if form is Form.AT_MOST else operator.ge
    parameters = (limit,) if isinstance(limit, Parameter) else ()
    read, name, unit = _limit(limit, unit)
    return Watch(
        level.format(name),
        lambda v: not inside(value(v), read(v)),
        lambda v: Compared(value(v), read(v), unit),
        parameters,
        form,
        (value, read),
        limit if isinstance(limit, Parameter) else float(limit) if isinstance(limit, int | float) else None,
    )


def _limit(limit: Limit[Any], unit: str) -> tuple[Callable[[Any], float], str, str]:
    """Return the function that reads a limit from the inputs, the limit's name and its unit."""
    if isinstance(limit, Parameter):
        return lambda v: v.parameters[limit], limit.key, limit.unit
    if isinstance(limit, str):
        unit, suffix = max(SUFFIXES.items(), key=lambda one: len(one[1]) * limit.endswith(one[1]))
        return attrgetter(limit), limit.removesuffix(suffix), unit
    if isinstance(limit, int | float):
        return lambda _: limit, f"{limit:g}", unit
    return limit, "", unit
