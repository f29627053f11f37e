"""The moves of this machine: track, arm, the cell's zero, standstill for a person.

The moves common to all machines are in ``tester.machine.motions``.
"""

from __future__ import annotations

from math import inf
from typing import Final

from tester.kinds.specimen_on_track.context import TrackContext
from tester.machine.motions import Ask, Move, Power, Sequence, ZeroOfCell
from tester.machine.prompts import DONE

TARE_S: Final = 1.0
"""Averaging time of the cell's zero, s [A]."""
NEAR_MM: Final = 0.5
"""A track within this distance of its target has arrived, mm [A]."""


class ComeToStand(Move):
    """Bring the track to standstill."""

    limit_s = 10.0  # [A]; the ramp takes 1.1 s at most
    name = "stopping the track"

    def step(self, ctx: TrackContext) -> bool:
        """Done when the speed counts as standstill."""
        ctx.demand.track_m_s = 0.0
        ctx.moving = True
        return abs(ctx.readings.track_now_m_s) <= still_m_s(ctx)


def still_m_s(ctx: TrackContext) -> float:
    """Return the speed below which the track counts as standing, m/s."""
    return ctx.rig.interlocks.standing_share * ctx.rig.axes.track.max_speed * ctx.rig.metres


class GoTo(Move):
    """Move a linear track to a place in its travel, with the arm raised."""

    limit_s = 120.0  # [A]; 270 mm at 10 mm/s take 27 s
    name = "bringing the track to its place"

    def __init__(self, place_mm: float) -> None:
        """``place_mm``: the target, between the soft ends."""
        self.place_mm = place_mm

    def step(self, ctx: TrackContext) -> bool:
        """Done when the track is there; ``ComeToStand`` follows."""
        far_mm = self.place_mm - ctx.readings.track_mm
        if abs(far_mm) <= NEAR_MM:
            ctx.demand.track_m_s = 0.0
            return True
        most = 0.5 * ctx.rig.limits.track_speed_m_s
        speed = min(most, 1e-3 * abs(far_mm))  # slower over the last millimetres
        ctx.demand.track_m_s = speed if far_mm > 0.0 else -speed
        ctx.moving = True
        return False


class TurnFor(Move):
    """Turn a disc for a way."""

    name = "turning the disc"

    def __init__(self, way_m: float, speed_m_s: float) -> None:
        """``way_m``: above 0."""
        self.way_m, self.speed_m_s = way_m, speed_m_s
        self.limit_s = 10.0 + 2.0 * way_m / speed_m_s
        self.until_m = inf

    def step(self, ctx: TrackContext) -> bool:
        """Done when the way is over; ``ComeToStand`` follows."""
        way_m = ctx.readings.way_m
        self.until_m = min(self.until_m, way_m + self.way_m)
        ctx.moving = True
        ctx.demand.track_m_s = self.speed_m_s if way_m < self.until_m else 0.0
        return way_m >= self.until_m


class MoveArm(Move):
    """Lower or raise the arm by its drive."""

    limit_s = 20.0  # [A]; 1.2 s by the drive
    name = "moving the arm"

    def __init__(self, *, lowered: bool) -> None:
        """``lowered``: the wanted place."""
        self.lowered = lowered

    def step(self, ctx: TrackContext) -> bool:
        """Done when it is there."""
        ctx.demand.lowered = self.lowered
        ctx.demand.track_m_s = 0.0
        ctx.moving = True
        return ctx.readings.lowered if self.lowered else ctx.readings.raised


class WithoutPower(Move):
    """Wait until the track is at rest and no drive applies torque."""

    limit_s = 10.0  # [A]
    name = "coming to a stand for a person to go near"

    def step(self, ctx: TrackContext) -> bool:
        """Done when both are measured, not just commanded."""
        ctx.moving = True
        return ctx.readings.drives_disabled and abs(ctx.readings.track_now_m_s) <= still_m_s(ctx)


class AskBesideTrack:
    """Ask a person to come near, with the track at rest and the drives off; an arm with a drive is raised first."""

    def __init__(self, text: str, *, unit: str = "") -> None:
        """``text``: the question; ``unit``: of a quantity that it asks for."""
        self.text = text
        self.unit = unit
        self.by_itself = DONE
        """The answer without a person."""
        self.moves: Sequence | None = None
        self.ask: Ask | None = None

    def resume(self, ctx: TrackContext) -> None:
        """Bring the track to standstill again."""
        if self.ask is None:
            self.moves = None

    def step(self, ctx: TrackContext) -> bool:
        """Done when it is answered."""
        if self.moves is None:
            raising = (
                (Power(True), ComeToStand(), MoveArm(lowered=False))
                if ctx.rig.axes.lift is not None
                else (ComeToStand(),)
            )
            standing = ctx.readings.drives_disabled and (ctx.readings.raised or ctx.rig.axes.lift is None)
            self.moves = Sequence(*(() if standing else raising), Power(False), WithoutPower())
        if self.ask is None:
            if not self.moves.step(ctx):
                return False
            self.ask = Ask(self.text, unit=self.unit)
            self.ask.by_itself = self.by_itself
            ctx.progress.phase = "prompt"
        return self.ask.step(ctx)


class ArmByHand(AskBesideTrack):
    """Ask a person to raise or lower an arm that has no drive."""

    def __init__(self, *, lowered: bool) -> None:
        """``lowered``: the wanted place."""
        super().__init__(f"{'lower' if lowered else 'raise'} the arm")
        self.lowered = lowered

    def step(self, ctx: TrackContext) -> bool:
        """Done when a person has done it."""
        if ctx.readings.lowered if self.lowered else ctx.readings.raised:
            ctx.demand.lowered = self.lowered
            return True
        if not super().step(ctx):
            return False
        if self.lowered:
            ctx.attendant.lower_arm()
            ctx.devices.by_hand_mm = 0.0
        else:
            ctx.attendant.raise_arm()
            ctx.devices.by_hand_mm = ctx.rig.arm.raised_mm
        ctx.demand.lowered = self.lowered
        return False  # done with the next reading


def arm(ctx: TrackContext, *, lowered: bool) -> tuple[MoveArm, ...] | tuple[ArmByHand, Power]:
    """Return the moves that bring the arm to its wanted place and leave the drives on."""
    if ctx.rig.axes.lift is not None:
        return (MoveArm(lowered=lowered),)
    return ArmByHand(lowered=lowered), Power(True)


class TakeTrackTare(ZeroOfCell):
    """Average the cell with the arm raised and make that its zero; ``failed``: why the zero is not trustworthy."""

    def __init__(self, kind: str) -> None:
        """``kind``: "reference" for a specimen's first, else "repeat"."""
        super().__init__(TARE_S)
        self.kind = kind

    def step(self, ctx: TrackContext) -> bool:
        """Done when the average is taken."""
        r, cell = ctx.readings, ctx.devices.cell
        if not self.averaged(ctx, r.cell_at_s, (r.force_n,), valid=r.cell_valid):
            return bool(self.failed)
        zero = self.zero(cell.tare)
        most_n = ctx.rig.interlocks.zero_stop_n
        if not abs(zero[0]) <= most_n:
            self.failed = f"the load cell's zero is {zero[0]:.1f} N, allowed are {most_n:g} N: does something touch?"
            return True
        cell.set_tare(zero)
        ctx.journal.tare(ctx.now, self.kind, {"friction_n": zero[0]}, ctx.repeat_key)
        ctx.demand.tared = True
        return True
