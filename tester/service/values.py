"""Values and progress for people: measured, demanded and permitted values by the table of channels; steps with their
times.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import hypot, inf, isfinite

from tester.analysis.pressure import LOAD, pressure_kpa
from tester.base.axes import ListWords
from tester.base.quantities import LAST, Channel, Quantities, Screen
from tester.base.screen import Quality, Value
from tester.inputs.recipe.plan import ConditionStep, Step
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.machine.engine import Engine
from tester.machine.panel import News, RunPanel, Wanted
from tester.machine.sampler import values_at
from tester.machine.time_left import STANDSTILL, Earlier, PartTime, TimeLeft
from tester.service.state_view import PlanStep, PlanView, StepState

CONTACT_N = 20.0
"""Normal force below which a friction coefficient is only noise [A]."""
NOTHING_WANTED = Wanted(None)


def measured(
    unknown: Value,
    now: float | None,
    wanted: Wanted = NOTHING_WANTED,
    age_s: float | None = None,
    quality: Quality = "none",
) -> Value:
    """Return ``unknown`` completed with its present number, setpoint, age and quality."""
    setpoint, band = known(wanted.setpoint), wanted.band
    band_low = band_high = None
    if setpoint is not None and band is not None:
        band_low, band_high = known(setpoint - band), known(setpoint + band)
    bands = {"band_low": band_low, "band_high": band_high}
    return replace(unknown, value=known(now), setpoint=setpoint, age_s=age_s, quality=quality, **bands)


def screen_of(channel: Channel) -> Screen:
    """Return how a channel is shown; it must be one of ``Quantities.shown``."""
    assert channel.screen is not None
    return channel.screen


def unknown_value(channel: Channel, rig: object) -> Value:
    """Return a channel's value on a rig without its number: name, limits and bar range."""
    screen = screen_of(channel)
    high = screen.limit.of(rig) if screen.limit is not None else None
    low = screen.lower.of(rig) if screen.lower is not None else -high if high is not None and screen.both else None
    return Value(
        screen.key, channel.label, channel.read_as, None, None, low, high, None, None, screen.low.of(rig),
        screen.high.of(rig), channel.decimals, None, "none",
    )  # fmt: skip


def unknown_values(quantities: Quantities, rig: Rig) -> tuple[Value, ...]:
    """Return the values of a rig without their numbers, the most important first."""
    return tuple(unknown_value(channel, rig) for channel in quantities.shown)


def with_pressure(values: tuple[Value, ...], metadata: Mapping[str, str]) -> tuple[Value, ...]:
    """Return values with the nominal pressure behind the load, where the metadata of run or rig has an area."""
    kpa_per_n = pressure_kpa(1.0, metadata)
    at = next((place for place, value in enumerate(values) if value.key == LOAD), None)
    if kpa_per_n is None or at is None:
        return values

    def times(number: float | None) -> float | None:
        return None if number is None else kpa_per_n * number

    load = values[at]
    pressure = replace(
        load, key="pressure", label="Pressure", unit="kPa", value=times(load.value), setpoint=times(load.setpoint),
        low=times(load.low), high=times(load.high), band_low=times(load.band_low), band_high=times(load.band_high),
        scale_low=kpa_per_n * load.scale_low, scale_high=kpa_per_n * load.scale_high,
    )  # fmt: skip
    return (*values[: at + 1], pressure, *values[at + 1 :])


def known(value: float | None) -> float | None:
    """Return a value if it is a finite number, else None."""
    return value if value is not None and isfinite(value) else None


class ValueView:
    """Computes the values of a run from its engine."""

    def __init__(self, engine: Engine, panel: RunPanel) -> None:
        """Prepare everything that does not change."""
        self.engine = engine
        self.panel = panel
        rig = engine.ctx.rig
        quantities = quantities_on(rig)
        self.unknown = unknown_values(quantities, rig)
        self._quantities = quantities
        recorded = quantities.recorded[: -len(LAST) - len(quantities.further)]
        self._read_off = {channel.name: values_at([channel.source]) for channel in recorded}
        self._place = {channel.name: place for place, channel in enumerate(quantities.further)}

    def values(self) -> tuple[Value, ...]:
        """Return all values as of the last scan."""
        wanted, now = self.panel.wanted(), self.engine.wires_s
        quality = {device: self._quality(news, now) for device, news in self.panel.news().items()}
        nothing: tuple[float | None, Quality] = (None, "none")
        found = tuple(
            measured(
                unknown,
                channel.scaled(self._read(channel.name)) if channel.source else friction(self._quantities, self._read),
                wanted.get(unknown.key, NOTHING_WANTED),
                *quality.get(screen_of(channel).device, nothing),
            )
            for unknown, channel in zip(self.unknown, self._quantities.shown, strict=True)
        )
        return with_pressure(found, {**self.engine.ctx.rig.area_metadata, **self.engine.executor.plan.metadata})

    def _read(self, name: str) -> float:
        """Return a channel as it would be recorded now."""
        if name in self._place:
            return self.engine.ctx.readings.channels[self._place[name]]
        return float(self._read_off[name](self.engine.ctx)[0])

    def _quality(self, news: News, now: float) -> tuple[float | None, Quality]:
        """Return age (s) and quality. No device is read more often than once a scan."""
        if news.at_s == -inf:
            return None, "none"
        age_s = max(now - news.at_s, 0.0)
        if age_s > max(news.stale_s, 2.5 * self.engine.period_s):
            return age_s, "stale"
        return age_s, "good" if news.valid else "bad"


def friction(quantities: Quantities, of: Callable[[str], float]) -> float:
    """Return the momentary coefficient, resultant over normal force; NaN out of contact.

    ``of`` returns the force (N) of a channel, by its name.
    """
    roles = quantities.roles
    normal_n = of(roles.normal)
    # A measured load is never exactly 0, but the load of weights on an arm is known exactly.
    if not normal_n > (CONTACT_N if len(roles.friction) > 1 else 0.0):
        return float("nan")
    return hypot(*(of(name) for name in roles.friction)) / normal_n


def trend_row(quantities: Quantities, values: Mapping[str, Value]) -> list[float | None]:
    """Return a row of the trend after its two times (``tester.base.screen.trend_columns``)."""
    row: list[float | None] = []
    for channel in quantities.shown:
        screen, value = screen_of(channel), values.get(screen_of(channel).key)
        for column, of in ((screen.trend, "value"), (screen.setpoint_trend, "setpoint")):
            if column:
                row.append(None if value is None else getattr(value, of))
    return row


ASKING = frozenset({"install", "mount", "prompt"})
"""Kinds of steps that begin with a question to a person."""
LISTED = 400
"""Greatest number of steps in a plan message, around the present step: a plan may have 100,000."""
BEFORE = 100
"""Greatest number of these steps before the present one."""


class PlanTrack(TimeLeft):
    """A run's steps with their times, for display. Times are rig seconds."""

    def __init__(self, name: str, parts: Sequence[PartTime], earlier: Earlier | None = None) -> None:
        """Begin before the first step; ``name``: the plan's."""
        super().__init__(parts, earlier)
        self.name = name
        self._asking = [place for place, step in enumerate(self.steps) if step is not None and step.kind in ASKING]
        self._words = ListWords(step.setpoint for step in self.steps if isinstance(step, ConditionStep))

    def view(self) -> PlanView:
        """Return the steps around the present one."""
        first = max(min(self.position - BEFORE, len(self.steps) - LISTED), 0)
        behind = min(first + LISTED, len(self.steps))
        listed = tuple(
            PlanStep(
                i + 1, STANDSTILL if step is None else step.kind, self._title(step), self._state(i), self.estimated[i],
                self.measured.get(i), float(self.ahead[i]),
                step.condition if isinstance(step, ConditionStep) else 0,
            )
            for i, step in enumerate(self.steps[first:behind], first)
        )  # fmt: skip
        beyond_s = float(self.ahead[behind:].sum())
        return PlanView(self.name, len(self.steps), first + 1, listed, sum(self.estimated), beyond_s)

    def next_question(self) -> tuple[float, str] | None:
        """Return when a later step will ask a person, s of rig time from now, and for what; None if none will."""
        behind = bisect_right(self._asking, self.position)
        if behind == len(self._asking):
            return None
        place = self._asking[behind]
        return self.standing().step_left_s + float(self.ahead[self.position + 1 : place].sum()), self._title(
            self.steps[place]
        )

    def _title(self, step: Step | None) -> str:
        if step is None:
            return "to standstill"
        return self._words.of(step.setpoint) if isinstance(step, ConditionStep) else step.title

    def _state(self, index: int) -> StepState:
        return "done" if index < self.position else "now" if index == self.position else "later"
