"""A moment of a stored run, for replay: the values of the screen, the step, and what had happened shortly before."""

from __future__ import annotations

from bisect import bisect_right
from math import isfinite
from typing import Any

from tester.base.words import finite
from tester.results.run_results import RunResults
from tester.service.protocol import Event
from tester.service.recorded_steps import present_of, recorded_steps
from tester.service.recorded_values import recorded_setpoint, recorded_value
from tester.service.values import screen_of
from tester.store.record_schema import StoreError
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import unpack
from tester.store.sql import blob, whole

OLD_S = 2.0
"""A sample that is older than this at the moment shown is no value of it, s; between contacts two a second are
recorded.
"""
EVENTS = 30
"""Events up to the moment that are listed."""


def moment_page(reader: RunReader, results: RunResults, at_s: float) -> dict[str, Any]:
    """Return what the screen showed at a moment, rig seconds. Raises StoreError."""
    name = results.run.info.name
    events = [Event(e.sequence, e.t_s, e.utc, e.kind, e.severity, e.text, name) for e in reader.events()]
    steps = recorded_steps(events, results.run.rig_seconds)
    here = present_of(steps, at_s)
    before = events[: bisect_right([event.t_s for event in events], at_s)]
    shown = [event for event in before if event.severity != "debug"][-EVENTS:]
    return {
        "t_s": at_s, "values": _values(reader, results, at_s), "step": steps[here - 1].title if here else "",
        "step_n": here,
        "events": [{"t_s": e.t_s, "kind": e.kind, "text": e.text, "severity": e.severity} for e in shown],
    }  # fmt: skip


def _values(reader: RunReader, results: RunResults, at_s: float) -> list[Any]:
    quantities, row = results.quantities, _sample_at(reader, at_s)
    condition = next(
        (
            m.condition
            for m in results.conditions()
            if m.condition.started_s <= at_s and not (isfinite(m.condition.ended_s) and m.condition.ended_s <= at_s)
        ),
        None,
    )
    info = condition.info if condition is not None else None
    values: list[Any] = []
    for channel in quantities.shown:
        value = finite_or_none(recorded_value(quantities, channel, row)) if row else None
        setpoint = recorded_setpoint(quantities, channel, row, info).setpoint if row else None
        values.append({
            "key": screen_of(channel).key, "label": channel.label, "unit": channel.read_as, "value": value,
            "setpoint": finite_or_none(setpoint), "decimals": channel.decimals,
        })  # fmt: skip
    return values


def finite_or_none(value: float | None) -> float | None:
    """Return a finite number; None for any other."""
    return finite(value) if value is not None else None


def _sample_at(reader: RunReader, at_s: float) -> dict[str, float]:
    """Return the last sample up to a moment; empty where there is none that is recent. Raises StoreError."""
    names = reader.quantities().names
    sql = "SELECT * FROM sample_block WHERE first_s <= ? AND last_s >= ? ORDER BY id"
    newest: dict[str, float] = {}
    for row in reader.rows(sql, (at_s, at_s - OLD_S)):
        try:
            columns = unpack(blob(row, "data"), whole(row, "rows"), len(names))
        except ValueError as error:
            raise StoreError(f"{reader.path}, block {row['id']}: {error}") from error
        place = bisect_right(columns[0], at_s) - 1
        if place >= 0 and at_s - columns[0][place] <= OLD_S:
            newest = {name: column[place] for name, column in zip(names, columns, strict=True)}
    return newest
