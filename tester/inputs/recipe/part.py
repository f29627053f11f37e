"""What a kind of rig says about recipes: one object, which everything here that reads a recipe is handed.

Generic is the way from a file to a plan: positions, specimens, grids over axes, repeats, conditions in their order. A
kind adds its axes, sections of its own, what makes no sense, what its rig cannot do, which steps conditions become, how
long they take, and the words for them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar

from tester.inputs.recipe.schema import GridModel, MeasureModel, Recipe
from tester.inputs.recipe.settings import Settings, settings_of

if TYPE_CHECKING:
    from tester.analysis.terms import Term
    from tester.base.axes import Axes
    from tester.base.source import Location, Problem, Tree
    from tester.inputs.recipe.estimate import Estimate, Estimator, StepEstimate
    from tester.inputs.recipe.plan import Plan, Stand, Step
    from tester.inputs.recipe.plan_json import ConditionJson
    from tester.inputs.rig import Rig


class RecipePart(ABC):
    """A kind's part of the recipe reader. One object a kind, without state.

    A kind subclasses it, sets ``kind`` and ``axes``, and answers the abstract methods. All else has a default, so that
    a kind that only holds its axes one condition after the other needs no more::

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

    A section is a field of the kind's ``Recipe`` subclass; what a grid or ``measure`` may say beyond repeats,
    precision, windows, bands and soak is a field of its ``GridModel`` and ``MeasureModel`` subclasses, and goes into
    conditions by a ``Settings`` subclass. A grid's axes are added to its model from ``axes``; one that is
    ``in_measure`` has to be a field of the kind's ``MeasureModel`` too. A rig comes as ``tester.inputs.rig.Rig``; the
    kind's own ``RigConfig.of(rig)`` narrows it. Two objects of one class are equal: a part is its class.
    """

    kind: ClassVar[str]
    """As the rig file's key ``kind``, and the recipe's, say it."""
    axes: ClassVar[Axes]
    """Of its conditions."""
    recipe: ClassVar[type[Recipe]] = Recipe
    """The recipe's sections; ``grids`` is replaced by a list of ``grid`` with the axes."""
    measure: ClassVar[type[MeasureModel]] = MeasureModel
    """The section ``measure`` of ``recipe``."""
    grid: ClassVar[type[GridModel]] = GridModel
    """A grid without its axes."""
    begins: ClassVar[str] = "measure: {repeats: REPEATS}"
    """Lines of YAML between the specimens and the grids of a new recipe (`tester new`), with REPEATS for their
    number: ``measure``, and what a first recipe needs beside it."""

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))

    def settings(self, measure: MeasureModel, grid: GridModel) -> Settings:
        """Return how the conditions of a grid are measured; hashable, equal where they are measured alike."""
        return settings_of(measure, grid)

    def whole(self, recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
        """Yield what makes no sense in the recipe as a whole; ``recipe`` is None where some of it is not valid."""
        if not (tree.data.get("grids") if isinstance(tree.data, dict) else None):
            yield tree.problem((), "there is nothing to do: no grids")

    def sense(self, measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
        """Yield what makes no sense in a grid whatever the rig; the grid stands at ``at``."""
        yield from ()

    def limits(self, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield what is beyond the rig's limits, as far as the values of the file can be read."""
        yield from ()

    def terms(self, rig: Rig) -> Sequence[Term]:
        """Return what the rig's measuring chain may be off by: the machine's part of every budget."""
        return ()

    def rubs_as_described(self, rig: Rig) -> bool:
        """Return whether rubber on this rig follows temperature as its compound's file says.

        A simulated rig may rub by any law: a file tells nothing of that.
        """
        return not rig.simulated

    def outlasted(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield what a rig could do and a specimen would not outlast, of a recipe that is valid otherwise."""
        yield from ()

    def doubts(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield what a rig can do and is not expected to bring to its end; a run goes on all the same."""
        yield from ()

    @abstractmethod
    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> Estimator:
        """Return what tells how long steps take on a rig.

        ``repeatability``: standard deviation between repeats, per cent of the coefficient, by compound.
        """

    @abstractmethod
    def expand(self, recipe: Recipe, rig: Rig, estimator: Estimator | None = None) -> Plan:
        """Return the plan of a valid recipe on a rig; ``estimator``: this part's for the rig, None: make one."""

    def estimate(self, plan: Plan, rig: Rig) -> Estimate:
        """Return what a plan takes on a rig, with what is assumed of the scatter between repeats."""
        from tester.inputs.recipe.estimate import estimate

        return estimate(plan, self.estimator(rig))

    @abstractmethod
    def remaining(self, plan: Plan, stand: Stand) -> Plan:
        """Return the plan of what is left to do after an interruption; without steps where nothing is."""

    @abstractmethod
    def words(self, step: Step, one: StepEstimate) -> str:
        """Return what a step does, in a line."""

    def heading(self, plan: Plan, step: Step) -> str:
        """Return the heading of what begins with a step, such as a specimen with its compound; "" for none."""
        return ""

    def totals(self, plan: Plan, estimate: Estimate) -> Iterator[str]:
        """Yield further lines of the totals, after sliding distance: a name in 18 columns, then the figure."""
        yield from ()

    def plan_fields(self, plan: Plan, estimate: Estimate) -> dict[str, object]:
        """Return further fields of a plan's JSON; units in the keys."""
        return {}

    def step_fields(self, step: Step, one: StepEstimate) -> dict[str, object]:
        """Return what a plan's JSON says of a step that is no condition, beside kind, index and seconds."""
        return {}

    def condition_json(self) -> ConditionJson:
        """Return what writes conditions as JSON."""
        from tester.inputs.recipe.plan_json import ConditionJson

        return ConditionJson(self.axes)
