"""The activities of a plan's steps: mount a specimen, change surface, weights, interface, temper the air, measure."""

from __future__ import annotations

from collections.abc import Sequence as Steps

from tester.base.units import SHORE_A
from tester.inputs.recipe.plan import PromptStep, Step
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.procedures.motions import AskBesideTrack
from tester.kinds.specimen_on_track.procedures.slide import MeasureTrackCondition
from tester.kinds.specimen_on_track.recipe.plan_steps import Cover, MountSpecimen, Prepare, Temper, TrackCondition
from tester.machine.activity import Activity
from tester.machine.context import MountedSpecimen
from tester.machine.executor import Procedures
from tester.machine.hardness import with_hardness
from tester.machine.result_keeping import StoredResults
from tester.machine.soak import SoakWait


class InstallSpecimen(AskBesideTrack):
    """Ask a person to put a specimen on the raised arm."""

    def __init__(self, step: MountSpecimen) -> None:
        """The step of the plan."""
        self.install = step
        note = f" ({step.note})" if step.note else ""
        text = f"put specimen {step.piece} on the arm and raise it: {step.compound}{note}"
        if step.again:
            text = f"the run continues with specimen {step.piece} on the raised arm: {step.compound}{note}"
        hardness = step.hardness and not step.again
        super().__init__(with_hardness(text) if hardness else text, unit=SHORE_A if hardness else "")

    def step(self, ctx: TrackContext) -> bool:
        """Done when it is mounted."""
        ctx.demand.tared = False
        if self.unit:
            self.by_itself = ctx.hardness.by_itself(self.install.piece, self.install.compound)
        if not super().step(ctx):
            return False
        one = self.install
        if one.again:
            ctx.attendant.keep(one.specimen, one.compound)
        else:
            ctx.attendant.install(one.specimen, one.compound)
        ctx.attendant.raise_arm()
        if ctx.rig.axes.lift is None:
            ctx.devices.by_hand_mm = ctx.rig.arm.raised_mm
        ctx.weights_n = 0.0
        if one.again:
            ctx.mounted = MountedSpecimen(one.piece, one.specimen, one.compound, one.sliding_m)
        else:
            ctx.mount(one, self.ask.prompt(ctx) if self.ask is not None else None)
        return True


class CoverTrack(AskBesideTrack):
    """Ask a person to cover the track with another surface."""

    def __init__(self, step: Cover) -> None:
        """The step of the plan."""
        super().__init__(f"cover the track with {step.surface}, clean and dry")
        self.cover = step

    def step(self, ctx: TrackContext) -> bool:
        """Done when it is covered."""
        if not super().step(ctx):
            return False
        ctx.attendant.cover(self.cover.surface)
        return True


class PrepareTrack(AskBesideTrack):
    """Ask a person to change weights or interface."""

    def __init__(self, step: Prepare) -> None:
        """The step of the plan."""
        super().__init__(step.text)
        self.prepare = step

    def step(self, ctx: TrackContext) -> bool:
        """Done when both are prepared."""
        if not super().step(ctx):
            return False
        one = self.prepare
        ctx.attendant.put_on(one.load_n)
        ctx.attendant.prepare(one.interface)
        ctx.weights_n = one.load_n
        return True


class TemperAir(SoakWait):
    """Bring the air to a temperature and let the specimen follow. If it is not reached, later conditions report it."""

    def __init__(self, step: Temper) -> None:
        """The step of the plan."""
        super().__init__(step.temperature_c, step.within_k, step.for_s, step.at_most_s)

    def step(self, ctx: TrackContext) -> bool:
        """Done when the air has been near its target long enough, or has not come near in time."""
        ctx.demand.chamber_c = self.target_c if ctx.rig.chamber else float("nan")
        return self.over(ctx, "temper", ctx.readings.air_c, valid=ctx.readings.air_valid)


class TrackProcedures(Procedures[TrackContext]):
    """The steps of this machine."""

    def __init__(self, results: StoredResults[TrackContext]) -> None:
        """``results``: where repeats go."""
        self.results = results

    def resumed(self, ctx: TrackContext) -> None:
        """Resume at rest, with the arm raised."""
        ctx.demand.track_m_s, ctx.demand.lowered = 0.0, False

    def activity(self, step: Step, to_come: Steps[Step], ctx: TrackContext) -> Activity[TrackContext]:
        """Return the activity of a step."""
        match step:
            case MountSpecimen():
                return InstallSpecimen(step)
            case Cover():
                return CoverTrack(step)
            case Prepare():
                return PrepareTrack(step)
            case Temper():
                return TemperAir(step)
            case TrackCondition():
                return MeasureTrackCondition(step, self.results)
            case PromptStep():
                return AskBesideTrack(step.text)
            case _:
                raise TypeError(f"{step.kind}: no step of this machine")
