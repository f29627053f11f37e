"""A stored run as scenes: what the screens showed at any moment, as far as it was recorded."""

from __future__ import annotations

from array import array
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from tester.analysis.results import Burst
from tester.base.quantities import Quantities
from tester.base.screen import MachineView, PlotView, Value, trend_columns
from tester.results.run_results import results_of
from tester.run.kind_lookup import load_rig_text, served_kind
from tester.run.run_materials import law_copies
from tester.service.present_results import results_view
from tester.service.protocol import Event
from tester.service.recorded_steps import RecordedStep, left_of, plan_of, present_of, recorded_steps
from tester.service.recorded_values import recorded_setpoint, recorded_value
from tester.service.results_view import GivenResults
from tester.service.state_view import (
    ClientsView,
    DiskView,
    ManualView,
    ProgressView,
    RunView,
    StateView,
    TickView,
)
from tester.service.values import (
    measured,
    screen_of,
    trend_row,
    unknown_values,
    with_pressure,
)
from tester.store.records import ConditionInfo, StoredCondition, StoredRepeat, StoredRun
from tester.store.run_reader import RunReader
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.trends_panel import WINDOW_S

SPACING_S = 0.25
"""Time between the samples kept, rig seconds; longer if there would be more than MOST."""
MOST = 40_000
PLOTS = 4
"""Number of trends on a screen."""
OLD_S = 2.0
"""A sample that is older than this at the moment shown is stale, s; between contacts two a second are recorded."""


@dataclass(frozen=True, slots=True)
class Playback:
    """A run's record: samples by column, in order of rig time; conditions, repeats, journal."""

    run: StoredRun
    status: str
    """The run's status, a word of RunStatus."""
    rig_name: str
    machine: MachineView
    quantities: Quantities
    specs: tuple[Value, ...]
    """The run's values, without their numbers."""
    samples: dict[str, array[float]]
    conditions: tuple[StoredCondition, ...]
    repeats: tuple[StoredRepeat, ...]
    bursts: dict[int, tuple[Burst, ...]]
    """Bursts of the committed repeats, by the repeats' keys."""
    events: tuple[Event, ...]
    event_times: tuple[float, ...]
    steps: tuple[RecordedStep, ...]
    results: GivenResults

    @property
    def length_s(self) -> float:
        """Return the run's rig seconds."""
        return max(self.run.rig_seconds, self.samples["time_s"][-1] if self.samples["time_s"] else 0.0)

    def show(self, scene: ScreenScene, at_s: float) -> None:
        """Set the scene to a moment of the run, rig seconds."""
        condition = next((c for c in self.conditions if c.started_s <= at_s < _end(c, self.length_s)), None)
        index = bisect_right(self.samples["time_s"], at_s) - 1
        scene.replayed = True
        scene.machine = self.machine
        scene.state = self._state(at_s, index, condition)
        scene.results = self.results
        scene.plan = plan_of(self.run.info.recipe_name, self.steps, at_s)
        scene.events.clear()
        scene.events.extend(self.events[: bisect_right(self.event_times, at_s)])
        scene.trend.clear()
        first = bisect_right(self.samples["time_s"], at_s - WINDOW_S)
        step = max((index - first) // 2000, 1)
        scene.trend.extend(self._row(i) for i in range(first, index + 1, step))
        scene.epoch += 1

    def _state(self, at_s: float, index: int, condition: StoredCondition | None) -> StateView:
        info, run = self.run.info, self.run
        over = at_s >= self.length_s
        compound = condition.info.compound if condition is not None else ""
        note = condition.info.note if condition is not None else ""
        return StateView(
            mode="RUN" if not over else self.status,
            mode_text="" if not over else run.reason,
            mode_since_s=at_s, t_s=at_s, wall_s=at_s, utc=info.started_utc, rig=self.rig_name,
            simulated=info.simulated,
            run=RunView(info.name, "", info.recipe_name, compound, note, info.operator, info.seed, info.simulated, None,
                        info.started_utc, self.status, run.reason, None, ()),
            progress=self._progress(at_s, condition),
            values=self._values(at_s, index, condition.info if condition is not None else None),
            gates=(), soak=None, alarms=(), prompt=None, manual=ManualView(None, ""), devices=(), buses=(),
            disk=DiskView(None, 0, False), tick=TickView(0.0, 0.0, run.overruns), clients=ClientsView("", 0, 0),
            interrupted=(), preflight=(), risk=info.risk,
        )  # fmt: skip

    def _progress(self, at_s: float, condition: StoredCondition | None) -> ProgressView:
        here = present_of(self.steps, at_s)
        left_s, step_left_s = left_of(self.steps, at_s)
        last = max((r for r in self.repeats if condition is not None and r.begun_s <= at_s
                    and r.condition == condition.info.condition), key=lambda r: r.begun_s, default=None)  # fmt: skip
        bursts = [b for b in self.bursts.get(last.key, ()) if b.started_s <= at_s] if last is not None else []
        wanted = condition.info.window_revolutions if condition is not None else None
        return ProgressView(
            step=here, steps=len(self.steps), title=self.steps[here - 1].title if here else "connecting",
            over=sum(c.ended_s <= at_s for c in self.conditions), conditions=len(self.conditions),
            repeat=last.repeat if last is not None else 0,
            repeats=condition.info.repeats_planned if condition is not None else 0,
            revolutions=sum(_done(burst, at_s) for burst in bursts), revolutions_wanted=wanted or 0.0,
            burst=bursts[-1].number if bursts else 0,
            share=at_s / max(at_s + left_s, 1e-9), elapsed_s=at_s, left_s=left_s, step_left_s=step_left_s,
        )  # fmt: skip

    def _values(self, at_s: float, index: int, info: ConditionInfo | None) -> tuple[Value, ...]:
        if index < 0:
            return with_pressure(self.specs, self.run.info.metadata)
        row = {name: column[index] for name, column in self.samples.items()}
        age_s = at_s - row["time_s"]
        found = tuple(
            measured(spec, recorded_value(self.quantities, channel, row),
                     recorded_setpoint(self.quantities, channel, row, info), age_s,
                     "good" if age_s <= OLD_S else "stale")
            for spec, channel in zip(self.specs, self.quantities.shown, strict=True)
        )  # fmt: skip
        return with_pressure(found, self.run.info.metadata)

    def _row(self, index: int) -> tuple[float | None, ...]:
        """Return a row of the trend; unrecorded setpoints are left empty."""
        row = {name: column[index] for name, column in self.samples.items()}
        values = {
            spec.key: measured(
                spec, recorded_value(self.quantities, channel, row),
                recorded_setpoint(self.quantities, channel, row, None),
            )
            for spec, channel in zip(self.specs, self.quantities.shown, strict=True)
        }  # fmt: skip
        return (row["time_s"], row["time_s"], *trend_row(self.quantities, values))


def _done(burst: Burst, at_s: float) -> float:
    """Return the revolutions of a burst up to a moment, assuming a constant rate."""
    return burst.revolutions * min((at_s - burst.started_s) / max(burst.ended_s - burst.started_s, 1e-9), 1.0)


def _end(condition: StoredCondition, length_s: float) -> float:
    return condition.ended_s if isfinite(condition.ended_s) else length_s


def load(folder: Path) -> Playback:
    """Read a run; raises StoreError, InvalidSource (its rig file), sqlite3.Error."""
    with RunReader(folder) as reader:
        results = results_of(reader)
        run = results.run
        rig = load_rig_text(run.info.rig_text, law_copies(folder, run.info.materials))
        kind = served_kind(rig)
        events = tuple(
            Event(e.sequence, e.t_s, e.utc, e.kind, e.severity, e.text, run.info.name) for e in reader.events()
        )
        repeats = tuple(reader.repeats(attempts=True))
        quantities, conditions = reader.quantities(), tuple(reader.conditions())
        shown = unknown_values(quantities, rig)
        spacing_s = max(SPACING_S, run.rig_seconds / MOST)
        return Playback(
            run, results.status.value, rig.name, drawn_as(quantities, shown, kind.machine), quantities, shown,
            _thinned(reader, spacing_s),
            conditions, repeats, {r.key: tuple(reader.bursts(r.key)) for r in repeats}, events,
            tuple(event.t_s for event in events),
            recorded_steps(events, run.rig_seconds, conditions),
            results_view(reader, results, run.info.name, running=False),
        )  # fmt: skip


def drawn_as(quantities: Quantities, shown: Sequence[Value], kind: MachineView) -> MachineView:
    """Return how to draw a record's channels: as the kind does if its trend has the same columns, else by the record's
    own table.

    If the kind has changed since, or is not installed, the first trends are drawn; each range is at least a fiftieth of
    the channel's bar.
    """
    columns = trend_columns(quantities)
    if kind.trend == columns:
        return kind
    drawn = [(spec, screen_of(channel).trend) for spec, channel in zip(shown, quantities.shown, strict=True)]
    plots = [PlotView(spec.key, column, 0.02 * (spec.scale_high - spec.scale_low)) for spec, column in drawn if column]
    return MachineView("", columns, tuple(plots[:PLOTS]))


def _thinned(reader: RunReader, spacing_s: float) -> dict[str, array[float]]:
    """Return a run's samples at this spacing."""
    kept: dict[str, array[float]] = {name: array("d") for name in reader.quantities().names}
    due_s = float("-inf")
    for block in reader.sample_blocks():
        chosen: list[int] = []
        for index, t_s in enumerate(block.columns["time_s"]):
            if t_s >= due_s:
                chosen.append(index)
                due_s = t_s + spacing_s
        for name, column in block.columns.items():
            kept[name].extend(column[index] for index in chosen)
    return kept
