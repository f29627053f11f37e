"""Steps around a wheel: install it, check its contact, grind it in."""

from __future__ import annotations

from dataclasses import replace
from math import nan
from typing import Final

from tester.base.units import SHORE_A
from tester.inputs.recipe.plan import Mounted
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.procedures.first_contact import FirstContact
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, TakeTare, Turn, speeds_reached
from tester.kinds.wheel_on_belt.procedures.on_record import record_state
from tester.kinds.wheel_on_belt.procedures.operator_access import AskAtRest
from tester.kinds.wheel_on_belt.procedures.thermal_steps import Straighten
from tester.kinds.wheel_on_belt.procedures.wheel_life import SURE_U, wheel_of
from tester.kinds.wheel_on_belt.procedures.zero_check import ZeroCheck, informs, is_due
from tester.kinds.wheel_on_belt.recipe.plan_steps import ChangeBelt, Install, PreGrind
from tester.machine.activity import MoveFailedError
from tester.machine.hardness import keep_hardness, with_hardness
from tester.machine.motions import Power, Sequence
from tester.store.records import PieceInfo

REFERENCE_TARE_S: Final = 2.0
"""Averaging time of a wheel's first tare, s [A]."""


class ShowContact:
    """Take the zero and sweep the first contact after a person was at the wheel or the belt."""

    def __init__(self, reference_tare: list[float]) -> None:
        """``reference_tare``: the wheel's first zero; filled where it is empty."""
        self.reference = reference_tare
        self.tare: TakeTare | None = None
        self.moves = Sequence()

    def resume(self, ctx: Context) -> None:
        """Start again after a hold."""
        self.tare = None

    def step(self, ctx: Context) -> bool:
        """Done when the contact is checked, or when the zero is not trustworthy: no load is applied with it."""
        ctx.demand.surface_c = nan
        if self.tare is None:
            self.tare = TakeTare(REFERENCE_TARE_S, self.reference)
            self.moves = Sequence(Power(True), Straighten(), self.tare, FirstContact())
        return bool(self.failed) or self.moves.step(ctx)

    @property
    def failed(self) -> str:
        """Why the run cannot continue with this zero, or ""."""
        return self.tare.failed if self.tare is not None else ""


class InstallWheel:
    """Stand still, ask a person to mount the wheel, then take its reference tare and check its first contact."""

    def __init__(self, step: Install, reference_tare: list[float]) -> None:
        """``reference_tare``: filled with the new wheel's zero."""
        self.install = step
        self.reference = reference_tare
        note = f" ({step.note})" if step.note else ""
        text = f"install wheel {step.wheel}: {step.compound}{note}"
        if step.again:
            text = f"mount wheel {step.wheel} again: {step.compound}{note}"
        if step.worn is not None:
            text = f"the run resumes with wheel {step.wheel}: {step.compound}{note}, mounted as it was"
        self.ask = AskAtRest(with_hardness(text), unit=SHORE_A) if step.hardness else AskAtRest(text)
        self.mounted = False
        self.contact: ShowContact | None = None

    def resume(self, ctx: Context) -> None:
        """Repeat the tare, if it had begun."""
        self.ask.resume(ctx)
        if self.contact is not None:
            self._begin_contact()

    def step(self, ctx: Context) -> bool:
        """Done when the wheel is mounted and the cell tared."""
        ctx.demand.surface_c = nan
        if not self.mounted:
            if self.install.hardness:
                self.ask.by_itself = ctx.hardness.by_itself(self.install.wheel, self.install.compound)
            self.mounted = self.ask.step(ctx)
            return False
        if self.contact is None:
            self._mount(ctx)
            self.contact = self._begin_contact()
        return self.contact.step(ctx)

    def _begin_contact(self) -> ShowContact:
        if self.install.worn is None:
            self.reference.clear()
        self.contact = ShowContact(self.reference)
        return self.contact

    @property
    def failed(self) -> str:
        """Why the run cannot continue with this wheel, or ""."""
        return self.contact.failed if self.contact is not None else ""

    def _mount(self, ctx: Context) -> None:
        step, old = self.install, ctx.wheel
        if step.worn is not None:
            self._remount(ctx, step.worn)
            return
        if old.wheel:
            ctx.shelf[(old.specimen, old.replicate)] = old
        if step.again and self._back_on(ctx):
            return
        new_specimen = old.wheel == 0
        ctx.attendant.install(step.specimen, step.wheel, step.compound, new_specimen=new_specimen)
        wheel = wheel_of(ctx.rig.geometry, step.specimen, step.replicate, step.wheel, step.compound)
        ctx.put_on(wheel)
        ctx.view.wheel_changed(ctx.now)
        ctx.journal.piece_mounted(
            PieceInfo(
                wheel.wheel, wheel.specimen, wheel.replicate, wheel.compound, ctx.now, wheel.installed_mm,
                wheel.cold_mm, updated_s=ctx.now,
            )
        )  # fmt: skip
        if step.hardness:
            keep_hardness(ctx, self.ask.prompt(ctx), wheel.wheel, wheel.compound)

    def _back_on(self, ctx: Context) -> bool:
        """Mount the specimen's last wheel again and return True; return False without a wheel."""
        step = self.install
        wheel = ctx.shelf.pop((step.specimen, step.replicate), None)
        if wheel is None:
            return False
        ctx.attendant.mount_again(wheel.specimen, wheel.wheel, wheel.compound, wheel.cold_mm, wheel.sliding_m)
        # Remounting invalidates the press's position from the first check.
        ctx.put_on(replace(wheel, reference=None, last_check=None))
        ctx.view.wheel_changed(ctx.now)
        return True

    def _remount(self, ctx: Context, worn: Mounted) -> None:
        """Resume with a wheel from the store: it keeps its record, its first tare and its number."""
        step = self.install
        ctx.attendant.keep(step.specimen, step.wheel, step.compound, worn.diameter_mm, worn.sliding_m)
        wheel = wheel_of(
            ctx.rig.geometry, step.specimen, step.replicate, step.wheel, step.compound, worn.diameter_mm
        )
        wheel.sliding_m = worn.sliding_m
        ctx.put_on(wheel)


class PutBeltOn(AskAtRest):
    """Ask a person to put another belt on, as at a change of the wheel: cool, lifted, standing, heat and drives off.

    The run counts on the new belt once the question is answered, and not before.
    """

    def __init__(self, step: ChangeBelt) -> None:
        """The step of the plan."""
        more = ", if it is not on already" if step.again else ""
        super().__init__(f"put belt {step.surface} on, clean and without dust{more}")
        self.belt = step.surface
        self.on = False

    def step(self, ctx: Context) -> bool:
        """Done when the belt is on and the wheel is free."""
        done = super().step(ctx)
        if self.answered and not self.on:
            self.on = True
            self._put_on(ctx)
        return done

    def _put_on(self, ctx: Context) -> None:
        ctx.change_belt(self.belt)
        ctx.attendant.cover(self.belt)
        travel_m = ctx.belts.travel_m
        if travel_m > 0.0:
            ctx.attendant.belt_travelled(travel_m)
        ctx.journal.surface_changed(ctx.now, self.belt, ctx.belts.travels_m)
        if ctx.wheel.wheel:
            record_state(ctx.journal, ctx, ctx.now)


class Grind:
    """Count the seconds in which the load is in band and both speeds are reached, up to ``seconds``."""

    def __init__(self, load_n: float, seconds: float) -> None:
        """Load in N."""
        self.load_n = load_n
        self.seconds = seconds
        self.done_s = 0.0
        self.counting = False

    def step(self, ctx: Context) -> bool:
        """Done when the whole grinding time has passed."""
        ctx.moving = True
        ready = speeds_reached(ctx) and abs(ctx.gates.load.value - self.load_n) <= 0.02 * self.load_n
        if ready and self.counting:
            self.done_s += ctx.dt
        self.counting = ready
        ctx.progress.phase = f"grind {self.done_s:.0f} of {self.seconds:.0f} s"
        return self.done_s >= self.seconds - 0.5 * ctx.dt


class PreGrindStep:
    """Grind a new wheel in: 4 min at 0.8 / 0.6 m/s and 200 N in the paper (its section 2.2.2)."""

    def __init__(self, step: PreGrind, reference_tare: list[float] | None = None) -> None:
        """The step of the plan; ``reference_tare``: the wheel's first zero, None where it has none."""
        self.pre_grind = step
        self.reference_tare = [] if reference_tare is None else reference_tare
        self.grind = Grind(step.load_n, step.duration_s)
        self.moves = self._moves()

    def _moves(self) -> Sequence:
        step = self.pre_grind
        wheel, belt = step.wheel_speed_m_s, step.belt_speed_m_s
        return Sequence(
            Power(True),
            Straighten(),
            Turn(wheel, wheel),
            Load(step.load_n, for_s=2.0),
            Turn(wheel, belt),
            self.grind,
            Turn(wheel, wheel),
            Lift(),
        )

    def resume(self, ctx: Context) -> None:
        """Touch again and grind for the remaining time."""
        self.grind.counting = False
        self.moves = self._moves()

    def step(self, ctx: Context) -> bool:
        """Done when ground and lifted."""
        ctx.demand.surface_c = nan
        if self.grind.counting and (is_due(ctx) or informs(ctx)):
            self.grind.counting = False
            self.moves = Sequence(ZeroCheck(self.pre_grind.wheel_speed_m_s, self.reference_tare), self._moves())
        if not self.moves.step(ctx):
            if ctx.wheel.loss_mm + SURE_U * ctx.wheel.u_mm > ctx.most_loss_mm(self.pre_grind.load_n):
                raise MoveFailedError(f"the wheel is worn out after {self.grind.done_s:.0f} s: grind it for less long")
            return False
        wheel = ctx.wheel
        ctx.journal.piece_ground(wheel.wheel, wheel.cold_mm, wheel.sliding_m, ctx.now)
        return True
