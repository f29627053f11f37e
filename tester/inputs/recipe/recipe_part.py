"""A kind's part of the recipe reader: one object, passed to every function here that reads a recipe.

The way from a file to a plan is generic: positions, specimens, grids over axes, repeats, conditions in their order. A
kind adds its axes, sections of its own, rules of sense, limits of its rig, the steps of its conditions, their durations
and their wording.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

from tester.analysis.terms import Term
from tester.base.axes import Axes
from tester.base.source import Location, Problem, Tree
from tester.inputs.recipe.grid_settings import settings_of
from tester.inputs.recipe.plan import ConditionStep, Plan, Settings, Stand, Step
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe, recipe_model
from tester.inputs.recipe.time_estimate import Estimate, Estimator, StepEstimate, estimate
from tester.inputs.rig import Rig


class RecipePart(ABC):
    """A kind's part of the recipe reader. One object a kind, without state.

    A kind subclasses it, sets ``kind`` and ``axes``, and implements the abstract methods. All else has a default: a
    kind that only keeps its axes at their setpoints, one condition after the other, needs no more::

        class SledgeRecipe(Recipe, frozen=True):
            run_in: RunInModel | None = None            # a section of its own, a pydantic model

        class SledgePart(RecipePart):
            kind = "sledge"
            axes = AXES
            recipe = SledgeRecipe                        # default: no sections beyond the common ones

            def expand(self, recipe, rig, estimator):    # steps: frozen data classes with kind, index and contact
                conditions = conditions_of(recipe, self.settings)
                ...
                return Plan(...)

            def estimator(self, rig, repeatability): ... # an Estimator: a StepEstimate for every step
            def words(self, step, one): ...              # "slide 2 m at 10 mm/s"

    A section is a field of the kind's ``Recipe`` subclass. Keys of a grid or ``measure`` beyond repeats, precision,
    windows, bands and soak are fields of its ``GridModel`` and ``MeasureModel`` subclasses, and reach conditions by a
    ``Settings`` subclass. A grid's axes are added to its model from ``axes``; an axis that is ``in_measure`` must also
    be a field of the kind's ``MeasureModel``. A rig comes as ``tester.inputs.rig.Rig``; the kind's own
    ``RigConfig.of(rig)`` narrows it. Two objects of one class are equal: a part is its class.
    """

    kind: ClassVar[str]
    """Value of the key ``kind`` in rig files and recipes."""
    axes: ClassVar[Axes]
    """Axes of its conditions."""
    recipe: ClassVar[type[Recipe]] = Recipe
    """The recipe's sections; ``grids`` is replaced by a list of ``grid`` with the axes."""
    measure: ClassVar[type[MeasureModel]] = MeasureModel
    """The section ``measure`` of ``recipe``."""
    grid: ClassVar[type[GridModel]] = GridModel
    """A grid without its axes."""
    begins: ClassVar[str] = "measure: {repeats: REPEATS}"
    """Lines of YAML between the specimens and the grids of a new recipe (`tester new`), with REPEATS for their number:
    ``measure``, and further sections of a first recipe."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))

    def model(self) -> type[Recipe]:
        """Return the model of this kind's recipes: its sections, and grids over its axes."""
        return recipe_model(self.kind, self.recipe, self.axes, self.grid)

    def settings(self, measure: MeasureModel, grid: GridModel) -> Settings:
        """Return how the conditions of a grid are measured; hashable, equal for equal measurements."""
        return settings_of(measure, grid)

    def whole(self, recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
        """Yield faults of the recipe as a whole; ``recipe`` is None where part of it is invalid."""
        if not (tree.data.get("grids") if isinstance(tree.data, dict) else None):
            yield tree.problem((), "there is nothing to do: no grids")

    def sense(self, measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
        """Yield faults of a grid that do not depend on the rig; the grid is at ``at``."""
        yield from ()

    def limits(self, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield values beyond the rig's limits, as far as the values of the file can be read."""
        yield from ()

    def terms(self, rig: Rig) -> Sequence[Term]:
        """Return the possible errors of the rig's measuring chain: the machine's part of every budget."""
        return ()

    def rubs_as_described(self, rig: Rig) -> bool:
        """Return whether rubber on this rig follows temperature as in its compound's file.

        A simulated rig may use any friction law, which the file does not describe.
        """
        return not rig.simulated

    def outlasted(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield parts of an otherwise valid recipe that a rig could do but a specimen would not survive."""
        yield from ()

    def doubts(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield parts that a rig can do but is not expected to complete; a run continues all the same."""
        yield from ()

    @abstractmethod
    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> Estimator:
        """Return the estimator of durations on a rig.

        ``repeatability``: standard deviation between repeats, per cent of the coefficient, by compound.
        """

    @abstractmethod
    def expand(self, recipe: Recipe, rig: Rig, estimator: Estimator | None = None) -> Plan:
        """Return the plan of a valid recipe on a rig; ``estimator``: this part's for the rig, None: make one."""

    def estimate(self, plan: Plan, rig: Rig) -> Estimate:
        """Return the totals of a plan on a rig, with the assumed scatter between repeats."""
        return estimate(plan, self.estimator(rig))

    @abstractmethod
    def remaining(self, plan: Plan, stand: Stand) -> Plan:
        """Return the plan of the rest after an interruption; without steps where nothing is left."""

    @abstractmethod
    def words(self, step: Step, one: StepEstimate) -> str:
        """Return the work of a step, as a line."""

    def heading(self, plan: Plan, step: Step) -> str:
        """Return the heading of a section that begins with a step, such as a specimen with its compound; "" for
        none."""
        return ""

    def totals(self, plan: Plan, estimate: Estimate) -> Iterator[str]:
        """Yield further lines of the totals, after sliding distance: a name in 18 columns, then the figure."""
        yield from ()

    def plan_fields(self, plan: Plan, estimate: Estimate) -> dict[str, object]:
        """Return further fields of a plan's JSON; units in the keys."""
        return {}

    def step_fields(self, step: Step, one: StepEstimate) -> dict[str, object]:
        """Return a step's fields in a plan's JSON, for a step other than a condition, beside kind, index and
        seconds."""
        return {}

    def condition_fields(self, step: ConditionStep, one: StepEstimate) -> dict[str, object]:
        """Return a condition's fields in a plan's JSON, beside kind, index and seconds; units in the keys."""
        return {
            "condition": step.condition,
            "row": step.row,
            "specimen": step.specimen,
            "replicate": step.replicate,
            "grid": step.grid,
            "compound": step.setpoint.compound,
            **{axis.field: step.setpoint.value(axis.name) for axis in self.axes},
            "repeats": step.repeats,
            "at_most": step.at_most,
            "until_percent": step.until_percent,
            "repeats_expected": round(one.repeats, 2),
            "min_valid": step.min_valid,
            "window": step.window.words,
            "temperature_band_k": step.temperature_band_k,
            "held": one.held,
            "sliding_m": round(one.sliding_m, 3),
        }
