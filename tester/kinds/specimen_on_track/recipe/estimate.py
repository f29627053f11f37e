"""Durations of the steps of a specimen on a track, and the heat of friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import fsum
from pathlib import Path
from typing import ClassVar, Final

from sim.physics.laws import NO_SETTING, FrictionLaw
from tester.analysis.uncertainty import Budget
from tester.base.axes import Setpoint
from tester.base.source import InvalidSource
from tester.inputs.materials.setting import law_setting
from tester.inputs.recipe.plan import ConditionStep, Plan, PromptStep, Step
from tester.inputs.recipe.recipe_schema import Recipe
from tester.inputs.recipe.repeats_section import expected
from tester.inputs.recipe.time_estimate import NEW, Estimator, Outlook, StepEstimate
from tester.kinds.specimen_on_track.axes import TrackHeld, held_by
from tester.kinds.specimen_on_track.budget import instruments_budget
from tester.kinds.specimen_on_track.recipe.plan_steps import Cover, MountSpecimen, Prepare, Temper, TrackCondition
from tester.kinds.specimen_on_track.rig import TrackConfig

PERSON_S: Final = 300.0
"""Time of a person for a prompt, s [A]; none on a simulated rig."""
REPEAT_S: Final = 4.2
"""Time for tare, lowering, settling and raising, s, from simulated runs of `pin-on-disc`, whose estimate was 6 % too
long with 5 s [A]."""
SETTLES: Final = {"linear": 1.7, "disc": 0.35}
"""Windows until friction is stationary; on a linear track forward and back together. From simulated runs [A]."""
CHAMBER_K_S: Final = 0.045
"""Rate of the chamber from one temperature to another, K/s [A]."""
LEAPT: Final = 0.9
"""Share of the time at the chamber that is leapt; from simulated runs [A]."""
LIKELY_MU: Final = 1.0
"""Coefficient without a known law [A]."""


class TrackEstimator(Estimator):
    """Estimates of the durations of steps on one rig."""

    spread: ClassVar[float] = 0.1
    """Twice the greatest deviation of the training recipes of ``tests.campaigns.queue``, with reserve [A]."""

    def __init__(
        self,
        rig: TrackConfig,
        repeatability: Mapping[str, float] | None = None,
        surface: str = "",
        recipe: Path | None = None,
    ) -> None:
        """``repeatability``: standard deviation between repeats, per cent of the coefficient, by compound.

        ``surface``: name of the track's covering; ``recipe``: the file beside which materials are looked up first.
        """
        super().__init__(repeatability)
        self.rig = rig
        self.surface = surface
        self.recipe = recipe
        self._laws: dict[tuple[str, str, str], FrictionLaw] = {}

    @classmethod
    def of(cls, rig: TrackConfig, recipe: Recipe, path: Path) -> TrackEstimator:
        """Return the estimator of a recipe at a path."""
        return cls(rig, surface=recipe.abrasive.name if recipe.abrasive is not None else "", recipe=path)

    def mu(self, setpoint: Setpoint) -> float:
        """Return the expected coefficient at a setpoint."""
        return self.mu_of(setpoint.compound, held_by(setpoint))

    def mu_of(self, compound: str, held: TrackHeld) -> float:
        """Return the expected coefficient, by the simulated rig's law if it has one."""
        try:
            return self.law(compound, held.interface, held.surface).mu(held.temperature_c, held.load_n, held.track_m_s)
        except (ValueError, InvalidSource):
            return LIKELY_MU

    def law(self, compound: str, interface: str, surface: str = "") -> FrictionLaw:
        """Return the simulated rig's law of a rubber on a surface ("": the recipe's abrasive); raises ValueError or
        InvalidSource if it has none.
        """
        named = surface or self.surface
        key = compound, interface, named
        if key not in self._laws:
            sim = self.rig.sim
            setting = law_setting(named, self.recipe) if sim.by_surface else NO_SETTING
            law = sim.law_of(compound, setting)
            self._laws[key] = sim.contact.through(law, interface)  # type: ignore[arg-type]
        return self._laws[key]

    def rise_k(self, compound: str, held: TrackHeld) -> float:
        """Return the final warming of the contact by friction, K."""
        return self.rig.heat.rise * self.mu_of(compound, held) * held.load_n * held.track_m_s

    def walk(self, plan: Plan) -> Sequence[StepEstimate]:
        """Return an estimate for every step of a plan."""
        self.surface = self.surface or plan.metadata.get("abrasive", "")
        air_c = self.rig.ambient_c
        found: list[StepEstimate] = []
        for step in plan.steps:
            found.append(self._step(step, air_c))
            if isinstance(step, Temper):
                air_c = step.temperature_c
        return found

    def _step(self, step: Step, air_c: float) -> StepEstimate:
        person_s = 0.0 if self.rig.simulated else PERSON_S
        if isinstance(step, MountSpecimen | Cover | Prepare | PromptStep):
            return StepEstimate(person_s + 2.0)
        if isinstance(step, Temper):
            way_s = abs(step.temperature_c - air_c) / CHAMBER_K_S if self.rig.chamber else 0.0
            return StepEstimate(step.for_s + way_s, waiting_s=way_s)
        if isinstance(step, TrackCondition):
            return self._condition(step)
        return StepEstimate(0.0)

    def _condition(self, step: TrackCondition) -> StepEstimate:
        held, compound = held_by(step.setpoint), step.setpoint.compound
        repeats = expected(step, self.s_percent(compound))
        slid_m = repeats * (1.5 + SETTLES[self.rig.track]) * step.way_m(held.track_m_s)
        arm_s = 0.0 if self.rig.axes.lift is not None or self.rig.simulated else 2.0 * PERSON_S
        rise_k, power_w = self.rise_k(compound, held), self.mu_of(compound, held) * held.load_n * held.track_m_s
        return StepEstimate(
            slid_m / held.track_m_s + repeats * (REPEAT_S + arm_s), slid_m,
            friction_j=slid_m * power_w / held.track_m_s,
            peak_c=held.temperature_c + rise_k, bursts=2 if self.rig.linear else 1,
            held=rise_k <= step.temperature_band_k, heat_w=power_w, repeats=repeats,
        )  # fmt: skip

    def shut_down_s(self, plan: Plan) -> float:
        """Return the seconds from the last step to standstill."""
        return 1.0

    def leapt_s(self, plan: Plan, steps: Sequence[StepEstimate]) -> float:
        """Return the seconds leapt while the chamber tempers."""
        pairs = zip(plan.steps, steps, strict=True)
        return LEAPT * fsum(estimate.seconds for step, estimate in pairs if isinstance(step, Temper))

    def budget(self, step: ConditionStep, outlook: Outlook = NEW) -> tuple[float, Budget] | None:
        """Return a condition's expected coefficient, and the instruments' part of its uncertainty."""
        held, mu = held_by(step.setpoint), self.mu(step.setpoint)
        return mu, instruments_budget(mu, held.load_n, held.track_m_s, outlook.slope)
