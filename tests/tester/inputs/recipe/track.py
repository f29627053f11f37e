"""A part for a specimen on a track: no wheel, sections of its own, one condition after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from tester.base.axes import Axes, Axis, Setpoint, condition_words, numbers
from tester.base.source import Location, Problem, Tree
from tester.base.units import Quantity, show
from tester.inputs.recipe.conditions import conditions_of, metadata_of, ordered
from tester.inputs.recipe.plan import ConditionStep, Plan, Specimen, Stand, Step
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe, Section
from tester.inputs.recipe.semantics import listed
from tester.inputs.recipe.time_estimate import Estimator, StepEstimate
from tester.inputs.rig import Rig

TRACK = Axes(
    (
        Axis("track_speed", "m/s", "track_speed_m_s", "mm/s", 1e3, "track_speed_mm_s", "Track Speed /mm·s⁻¹", "mm/s",
             "", None, True, gt=0.0, le=0.01),
        Axis("interface", "1", "interface", "", 1.0, "interface", "Interface", "Interface", "", "dry", True,
             choices=("dry", "wet", "talc")),
        Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "",
             None, True),
    ),
    blocks="temperature",
)  # fmt: skip

class RunInModel(Section, frozen=True):
    """Sliding before the first condition."""

    distance: Annotated[float, Quantity("mm", gt=0)]


class TrackRecipe(Recipe, frozen=True):
    """A recipe for a track."""

    run_in: RunInModel | None = None


@dataclass(frozen=True, slots=True)
class RunIn(Step):
    """Slide a distance before anything is measured."""

    kind: ClassVar[str] = "run_in"
    contact: ClassVar[bool] = True
    distance_mm: float


class TrackEstimator(Estimator):
    """Ten seconds a repeat."""

    spread = 0.1

    def walk(self, plan: Plan) -> Sequence[StepEstimate]:
        """Return an estimate for every step."""
        return [
            StepEstimate(10.0 * step.repeats, sliding_m=0.01, repeats=step.repeats)
            if isinstance(step, ConditionStep)
            else StepEstimate(60.0)
            for step in plan.steps
        ]

    def shut_down_s(self, plan: Plan) -> float:
        """Return nothing: a track stops at once."""
        return 0.0


class TrackPart(RecipePart):
    """A track's rules for recipes."""

    kind: ClassVar[str] = "track"
    axes: ClassVar[Axes] = TRACK
    recipe: ClassVar[type[Recipe]] = TrackRecipe

    def sense(self, measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
        """Yield speeds at which friction would heat the rubber."""
        for index, speed in enumerate(numbers(listed(grid, grid.axes["track_speed"]))):
            if speed > 0.005:
                yield tree.problem((*at, "track_speed", index), f"track_speed: {show(speed, 'm/s')} heats the rubber")

    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> TrackEstimator:
        """Return the estimator of the steps' times."""
        return TrackEstimator()

    def expand(self, recipe: Recipe, rig: Any, estimator: Estimator | None = None) -> Plan:
        """Return conditions after a run-in."""
        assert isinstance(recipe, TrackRecipe)
        specimens = tuple(Specimen(i, one.compound, one.note) for i, one in enumerate(recipe.specimens, start=1))
        found = conditions_of(recipe, self.settings)
        steps: list[Step] = []
        for specimen in specimens:
            if recipe.run_in is not None:
                steps.append(RunIn(len(steps), recipe.run_in.distance))
            for block in ordered(found, self.axes.number_of(self.axes.blocks), recipe.order, specimen.index, 1):
                for values, row, grid, how in block:
                    number = 1 + sum(isinstance(step, ConditionStep) for step in steps)
                    held = Setpoint(specimen.compound, values, self.axes)
                    steps.append(
                        ConditionStep(
                            index=len(steps), condition=number, row=row, specimen=specimen.index, replicate=1,
                            grid=grid, setpoint=held, **vars(how),
                        )
                    )  # fmt: skip
        return Plan(recipe.recipe, tuple(steps), specimens, 3, metadata_of(recipe), recipe.kind, self.axes)

    def remaining(self, plan: Plan, stand: Stand) -> Plan:
        """Return the unfinished conditions."""
        left = [one for one in plan.steps if not (isinstance(one, ConditionStep) and one.condition in stand.ended)]
        return replace(plan, steps=tuple(left))

    def words(self, step: Step, one: StepEstimate) -> str:
        """Return the activity of a step."""
        if isinstance(step, RunIn):
            return f"run in {step.distance_mm:g} mm"
        return condition_words(step.setpoint) if isinstance(step, ConditionStep) else step.kind

    def step_fields(self, step: Step, one: StepEstimate) -> dict[str, object]:
        """Return the distance of a run-in."""
        return {"distance_mm": step.distance_mm} if isinstance(step, RunIn) else {}
