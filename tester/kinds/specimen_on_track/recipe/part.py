"""This machine's part of the recipe reader (``tester.inputs.recipe.recipe_part``)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import ClassVar, Final

from tester.analysis.terms import Term
from tester.base.axes import SURFACE, Axes, AxisValue, Setpoint, condition_words, numbers
from tester.base.source import Location, Problem, Tree
from tester.base.units import show
from tester.base.words import rough_duration
from tester.inputs.recipe.conditions import Condition, conditions_of
from tester.inputs.recipe.plain_recipe import Mount, SpecimenPart
from tester.inputs.recipe.plan import ConditionStep, Plan, PromptStep, Settings, Stand, Step, fields_of
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe
from tester.inputs.recipe.semantics import axis_values
from tester.inputs.recipe.surface_turns import in_turns, surface_problems
from tester.inputs.recipe.time_estimate import Estimate, StepEstimate
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.axes import AXES, NAME, held_by
from tester.kinds.specimen_on_track.budget import TERMS
from tester.kinds.specimen_on_track.recipe.estimate import TrackEstimator
from tester.kinds.specimen_on_track.recipe.feasible import (
    area_problems,
    law_problems,
    low_friction,
    out_of_reach,
    unwitnessed,
)
from tester.kinds.specimen_on_track.recipe.plan_steps import (
    INSERTED,
    Cover,
    MountSpecimen,
    Open,
    Prepare,
    Temper,
    TrackCondition,
)
from tester.kinds.specimen_on_track.recipe.schema import (
    TrackGrid,
    TrackMeasure,
    TrackRecipe,
    track_settings,
)
from tester.kinds.specimen_on_track.rig import TrackConfig

OPENED_K: Final = 10.0
"""Greatest difference from the room's air at which a chamber is opened to change the surface, K [A]."""
UNUSED: Final = ("window", "extend_to")
"""Keys of the common sections without effect here: a condition slides for a ``distance``."""


class TrackPart(SpecimenPart):
    """Recipes for a specimen on a track."""

    kind: ClassVar[str] = NAME
    axes: ClassVar[Axes] = AXES
    recipe: ClassVar[type[Recipe]] = TrackRecipe
    measure: ClassVar[type[MeasureModel]] = TrackMeasure
    grid: ClassVar[type[GridModel]] = TrackGrid
    mount: ClassVar[type[Mount]] = MountSpecimen
    condition: ClassVar[type[ConditionStep]] = TrackCondition
    begins: ClassVar[str] = "measure: {repeats: REPEATS, distance: 0.5 mm, at_least: 5 s}"

    def settings(self, measure: MeasureModel, grid: GridModel) -> Settings:
        """Return the settings of a grid's conditions."""
        return track_settings(measure, grid)

    def whole(self, recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
        """Yield the common problems, and keys without effect on this machine."""
        yield from super().whole(recipe, tree)
        top = tree.data if isinstance(tree.data, dict) else {}
        grids = top.get("grids")
        nodes: list[tuple[Location, object]] = [(("measure",), top.get("measure"))]
        if isinstance(grids, list):
            nodes += [(("grids", index), node) for index, node in enumerate(grids)]
        for at, node in nodes:
            for key in UNUSED:
                if isinstance(node, dict) and key in node:
                    yield tree.problem((*at, key), f"{key}: this machine slides for a way (expected distance)")
        yield from surface_problems(tree)

    def terms(self, rig: Rig) -> tuple[Term, ...]:
        """Return the possible errors of the measuring chain."""
        return TERMS

    def outlasted(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield values that the rig cannot reach, and speeds whose friction would overheat a tempered contact."""
        own = TrackConfig.of(rig)
        measure = recipe.measure
        if own.simulated:
            yield from law_problems(own, recipe, tree)
            yield from area_problems(own, recipe, tree)
        if measure is None:
            return
        yield from unwitnessed(own, recipe, tree)
        yield from low_friction(own, recipe, tree)
        for number, grid in enumerate(recipe.grids):
            at: Location = ("grids", number)
            values = axis_values(measure, grid)
            numeric = {name: numbers(listed) for name, listed in values.items() if not AXES[name].textual}
            yield from _limits(own, numeric, at, tree)
            within_k = track_settings(measure, grid).soak.within_k
            yield from out_of_reach(own, numbers(values["temperature"]), within_k, at, tree)
            yield from self._heat(own, recipe, measure, grid, at, tree)

    def _heat(
        self, rig: TrackConfig, recipe: Recipe, measure: MeasureModel, grid: GridModel, at: Location, tree: Tree
    ) -> Iterator[Problem]:
        """Yield the least speed of a grid at which friction would warm a tempered contact beyond its band."""
        if not rig.chamber:
            return  # without a chamber the contact is not tempered; the plan shows its warming
        estimator = TrackEstimator.of(rig, recipe, Path(tree.name))
        band_k = track_settings(measure, grid).temperature_band_k
        found: dict[float, tuple[float, str]] = {}
        for one in conditions_of(recipe.model_copy(update={"grids": [grid]}), self.settings):
            for specimen in recipe.specimens:
                setpoint = Setpoint(specimen.compound, one.values, self.axes)
                held = held_by(setpoint)
                rise_k = estimator.rise_k(specimen.compound, held)
                if rise_k > max(band_k, found.get(held.track_m_s, (0.0, ""))[0]):
                    found[held.track_m_s] = rise_k, condition_words(setpoint)
        if found:
            rise_k, words = found[min(found)]
            yield tree.problem(
                (*at, "track_speed"),
                f"track_speed: friction warms the contact by {rise_k:.1f} K at {words}, more than its band of"
                f' {show(band_k, "K")} (heat.rise of rig "{rig.name}")',
            )

    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> TrackEstimator:
        """Return the estimator of durations on a rig."""
        return TrackEstimator(TrackConfig.of(rig), repeatability)

    def in_turns(self, conditions: Sequence[Condition[Settings]]) -> list[list[Condition[Settings]]]:
        """Return the conditions of one surface after the other: a surface is changed at the temperature of the room.

        A named surface with talc has a turn of its own, on a new cover: talc does not come off.
        """
        surface, interface = AXES.places[SURFACE], AXES.places["interface"]
        return in_turns(conditions, lambda values: (
            values[surface], bool(values[surface]) and values[interface] == "talc"
        ))  # fmt: skip

    def before_turn(self, index: int, values: tuple[AxisValue, ...], settings: Settings, rig: Rig) -> Sequence[Step]:
        """Return the steps to a surface that the grids name, in air that a person can open the chamber to."""
        surface = str(values[AXES.places[SURFACE]])
        if not surface:
            return ()
        own, soak = TrackConfig.of(rig), settings.soak
        cover = Cover(index + 1 if own.chamber else index, surface)
        return (Open(index, own.ambient_c, OPENED_K, 0.0, soak.at_most_s), cover) if own.chamber else (cover,)

    def before_block(self, index: int, value: float, settings: Settings) -> tuple[Temper]:
        """Return the step that brings the air to the temperature of a block."""
        soak = settings.soak
        return (Temper(index, value, soak.within_k, soak.for_s, soak.at_most_s),)

    def before_condition(self, index: int, setpoint: Setpoint, before: Setpoint | None) -> tuple[Prepare, ...]:
        """Return the step that asks for other weights or another interface; nothing where both stay."""
        last = None if before is None else _prepared(before)
        if before is not None and held_by(before).surface != held_by(setpoint).surface:
            last = held_by(before).load_n, "dry"  # as it was covered
        return () if last == _prepared(setpoint) else (_prepare(index, last, _prepared(setpoint)),)

    def remaining(self, plan: Plan, stand: Stand) -> Plan:
        """Return the plan of the rest: conditions that are not over, and the steps to repeat before them."""
        mounted_before = {mounted.number: mounted for mounted in stand.mounted}
        steps: list[Step] = []
        due: dict[str, Step] = {}
        for step in plan.steps:
            if isinstance(step, TrackCondition):
                if step.condition not in stand.ended:
                    steps += [*due.values(), step]
                    due.clear()
                continue
            if isinstance(step, MountSpecimen):
                due.clear()
                mounted = mounted_before.get(step.piece)
                if mounted is not None:
                    step = replace(step, index=INSERTED, again=True, sliding_m=mounted.sliding_m)
            elif isinstance(step, Prepare):
                step = replace(step, text=_prepare(INSERTED, None, (step.load_n, step.interface)).text)
            elif isinstance(step, Cover):
                # What was tempered and prepared for the surface before does not hold for this one: it is dry.
                due.pop(Temper.kind, None)
                before = due.pop(Prepare.kind, None)
                due.pop(Cover.kind, None)
                due[Cover.kind] = step
                step = _prepare(INSERTED, None, (before.load_n, "dry")) if isinstance(before, Prepare) else step
            due.pop(step.kind, None)
            due[step.kind] = step
        return replace(plan, steps=tuple(steps))

    def words(self, step: Step, one: StepEstimate) -> str:
        """Return a description of a step, in a line."""
        match step:
            case MountSpecimen():
                return f"put specimen {step.piece} on the arm"
            case Prepare():
                return f"ask: {step.text}"
            case Cover():
                return f"ask: {step.title}"
            case Open():
                return f"temper to {step.temperature_c:g} degC, to open the chamber"
            case Temper():
                return f"temper to {step.temperature_c:g} degC, {rough_duration(step.for_s)} within {step.within_k:g} K"
            case TrackCondition():
                words = condition_words(step.setpoint, compound=False)
                held = held_by(step.setpoint)
                rise_k = one.peak_c - held.temperature_c
                warm = "" if one.held else f", friction warms it by {rise_k:.0f} K"
                way_mm = 1e3 * step.way_m(held.track_m_s)
                return f"{step.condition:>4}  {words}  {step.repeats_words} x {way_mm:g} mm{warm}"
            case PromptStep():
                return f"ask: {step.text}"
            case _:
                return step.kind

    def heading(self, plan: Plan, step: Step) -> str:
        """Return the specimen that begins with a step; "" for none."""
        if not isinstance(step, MountSpecimen):
            return ""
        note = f" ({step.note})" if step.note else ""
        return f"specimen {step.piece}: {step.compound}{note}"

    def totals(self, plan: Plan, estimate: Estimate) -> Iterator[str]:
        """Yield the peak temperature, and the conditions that friction warms beyond their band."""
        if math.isfinite(estimate.peak_c):
            yield f"peak temperature  {estimate.peak_c:.0f} degC at the contact"
        if estimate.not_held:
            listed = ", ".join(str(number) for number in estimate.not_held[:20])
            yield f"friction warms the contact beyond its band: conditions {listed}"

    def step_fields(self, step: Step, one: StepEstimate) -> dict[str, object]:
        """Return the fields of a step other than a condition in a plan's JSON."""
        match step:
            case MountSpecimen():
                return {"specimen": step.specimen, "replicate": step.replicate, "number": step.piece,
                        "compound": step.compound, "note": step.note}  # fmt: skip
            case Temper():
                return {"temperature_c": step.temperature_c, "within_k": step.within_k, "for_s": step.for_s}
            case _:
                return fields_of(step)


def _prepared(setpoint: Setpoint) -> tuple[float, str]:
    """Return what a person prepares for a setpoint: the weights, N, and the interface."""
    held = held_by(setpoint)
    return held.load_n, held.interface


def _prepare(index: int, before: tuple[float, str] | None, now: tuple[float, str]) -> Prepare:
    """Return the step that asks for the changes since ``before``; None: for everything."""
    load_n, interface = now
    asked = [f"hang {load_n:g} N of weights on the arm"] if before is None or before[0] != load_n else []
    asked += [f"make the track {_MADE[interface]}"] if before is None or before[1] != interface else []
    return Prepare(index, load_n, interface, " and ".join(asked))


_MADE: Final = {"dry": "clean and dry", "wet": "wet", "talc": "white with talc"}


def _limits(rig: TrackConfig, values: Mapping[str, tuple[float, ...]], at: Location, tree: Tree) -> Iterator[Problem]:
    """Yield values beyond the rig's limits, with the source of each limit."""
    limits, of = rig.limits, f'of rig "{rig.name}"'
    for index, speed in enumerate(values["track_speed"]):
        if not limits.slowest_m_s <= speed <= limits.track_speed_m_s:
            bounds = f"{show(limits.slowest_m_s, 'm/s')} to {show(limits.track_speed_m_s, 'm/s')}"
            fault = f"track_speed: {show(speed, 'm/s')} is beyond what the track does"
            yield tree.problem((*at, "track_speed", index), f"{fault} (limits.slowest and track_speed {of}: {bounds})")
    for index, load in enumerate(values["load"]):
        if load not in rig.weights:
            listed = ", ".join(f"{one:g} N" for one in rig.weights)
            fault = f"load: no weights make {show(load, 'N')}"
            yield tree.problem((*at, "load", index), f"{fault} (weights {of}: {listed})")
    for index, air_c in enumerate(values["temperature"]):
        if not limits.air_low_c <= air_c <= limits.air_high_c:
            bounds = f"{limits.air_low_c:g} to {limits.air_high_c:g} degC"
            fault = f"temperature: {show(air_c, 'degC')} is beyond the air's range"
            yield tree.problem((*at, "temperature", index), f"{fault} (limits.air_low and air_high {of}: {bounds})")


PART: Final = TrackPart()
