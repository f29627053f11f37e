"""The moves every step is made of: lift, turn, load, yaw, wait. Small state objects, stepped once a scan.

An activity's ``step`` writes the demand it needs and returns True in the scan in which it is done. It keeps its
state in plain attributes: a running activity can be copied.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Final

from tester.engine.activity import Activity, MoveFailedError
from tester.engine.context import Context
from tester.engine.unloaded import loaded
from tester.process import Press

SPEED_SHARE: Final = 0.01
SPEED_FLOOR_M_S: Final = 0.003
"""A speed counts as reached within 1 % or 3 mm/s, whichever is more [A]."""
Zero = tuple[float, float, float, float]
"""Offsets of the load cell: Fx, Fy, Fz in N, Mz in N m."""

LIFTED_N: Final = 5.0
"""Below this force the wheel counts as lifted [A]."""
LIFTED_MM: Final = 0.3
"""... or this near to the lifted position: the zero of the cell may have drifted by more than that force [A]."""
TARE_LEAST: Final = 10
"""Readings that a tare averages at least."""
GUARD_OPEN: Final = "answered with the guard open: close it, then the question is put again"
AGAIN: Final = "the guard is closed now, go on?"
CELL_SILENT_S: Final = 5.0
"""A tare that has not got its readings this long after its time is given up, s [A]."""


class Move:
    """An activity that has to end in a time of its own."""

    limit_s: float = inf
    """Longest time the move may take, s."""
    name: str = "move"


class Sequence:
    """Activities one after the other; a move among them that overruns its time raises MoveFailedError."""

    def __init__(self, *parts: Activity) -> None:
        """Take the parts in order."""
        self.parts = list(parts)
        self.since_s = float("nan")

    def resume(self, ctx: Context) -> None:
        """Give the current part its whole time again."""
        self.since_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Step the current part."""
        if not self.parts:
            return True
        part = self.parts[0]
        if not isfinite(self.since_s):
            self.since_s = ctx.now
        if part.step(ctx):
            self.parts.pop(0)
            self.since_s = float("nan")
        elif isinstance(part, Move) and ctx.now - self.since_s > part.limit_s:
            raise MoveFailedError(f"{part.name} not done after {part.limit_s:g} s")
        return not self.parts


class Power(Move):
    """Enable or disable the drives, and wait until they say so."""

    limit_s = 20.0  # [A]; a drive needs well under a second
    name = "switching the drives"

    def __init__(self, on: bool) -> None:
        """``on``: what is wanted."""
        self.on = on

    def step(self, ctx: Context) -> bool:
        """Wait for every drive."""
        ctx.demand.enabled = self.on
        ctx.moving = True
        return ctx.readings.drives_enabled if self.on else ctx.readings.drives_disabled


class Lift(Move):
    """Take the wheel off the belt."""

    limit_s = 30.0  # [A]; the whole travel takes 3 s
    name = "lifting"

    def step(self, ctx: Context) -> bool:
        """Done when the force is gone, or the press is back and what the cell still shows is its zero."""
        ctx.demand.press = Press.LIFT
        ctx.demand.load_n = 0.0
        ctx.moving = True
        if ctx.contact.in_contact:
            return False
        force, lifted_mm = ctx.readings.force_z_n, ctx.contact.lifted_mm(ctx.rig.loops.load)
        return force < LIFTED_N or (isfinite(force) and ctx.readings.press_mm <= lifted_mm + LIFTED_MM)


class Turn(Move):
    """Bring wheel and belt to their speeds (m/s)."""

    limit_s = 30.0  # [A]; the ramps take under a second
    name = "reaching the speeds"

    def __init__(self, wheel_m_s: float, belt_m_s: float) -> None:
        """Both line speeds."""
        self.wheel_m_s = wheel_m_s
        self.belt_m_s = belt_m_s

    def step(self, ctx: Context) -> bool:
        """Done when both are reached."""
        ctx.demand.wheel_speed_m_s = self.wheel_m_s
        ctx.demand.belt_speed_m_s = self.belt_m_s
        ctx.moving = True
        return speeds_reached(ctx)


def speeds_reached(ctx: Context) -> bool:
    """Tell whether both measured speeds are at their demands."""
    r, d = ctx.readings, ctx.demand
    return abs(r.wheel_speed_m_s - d.wheel_speed_m_s) <= max(
        SPEED_SHARE * abs(d.wheel_speed_m_s), SPEED_FLOOR_M_S
    ) and abs(r.belt_speed_m_s - d.belt_speed_m_s) <= max(SPEED_SHARE * abs(d.belt_speed_m_s), SPEED_FLOOR_M_S)


class Load(Move):
    """Press to a load (N) and wait until it stands within ``percent`` for ``for_s`` seconds."""

    limit_s = 180.0  # [A]; a first touch takes 15 s
    name = "loading"

    def __init__(self, load_n: float, *, percent: float = 2.0, for_s: float = 1.0, quick: bool = False) -> None:
        """``quick``: the fast approach to a known contact."""
        self.load_n = load_n
        self.percent = percent
        self.for_s = for_s
        self.quick = quick
        self.since_s = float("inf")

    def step(self, ctx: Context) -> bool:
        """Done when the averaged load has been in band long enough."""
        ctx.demand.press = Press.LOAD
        ctx.demand.load_n = self.load_n
        ctx.demand.quick_touch = self.quick
        ctx.gates.target.load_n = self.load_n
        ctx.moving = True
        inside = abs(ctx.gates.load.value - self.load_n) <= 0.01 * self.percent * self.load_n
        self.since_s = min(self.since_s, ctx.now) if inside else float("inf")
        return ctx.now - self.since_s >= self.for_s


class Yaw(Move):
    """Turn to a sideslip and a camber angle (degrees); only ever unloaded."""

    limit_s = 60.0  # [A]; 30 degrees take 2 s
    name = "reaching the angles"

    def __init__(self, sideslip_deg: float, camber_deg: float) -> None:
        """Both angles."""
        self.sideslip_deg = sideslip_deg
        self.camber_deg = camber_deg
        self.began_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Done when both axes report their targets reached at the wanted angles."""
        ctx.demand.sideslip_deg = self.sideslip_deg
        ctx.demand.camber_deg = self.camber_deg
        ctx.moving = True
        r = ctx.readings
        near = abs(r.sideslip_deg - self.sideslip_deg) < 0.05 and abs(r.camber_deg - self.camber_deg) < 0.05
        return near and r.yaw_reached


class Wait:
    """Let time pass (s)."""

    def __init__(self, seconds: float) -> None:
        """How long."""
        self.seconds = seconds
        self.began_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Done when the time is over."""
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        return ctx.now - self.began_s >= self.seconds - 1e-9


class Ask:
    """Put a question and wait for its answer.

    It moves nothing: whoever asks has brought the rig to where a person may go near. An answer counts with the guard
    closed; one that was given with the guard open is asked for again then, so that closing it starts nothing.
    """

    def __init__(self, text: str, *, near: bool = True) -> None:
        """The question as a person reads it; ``near``: it asks a person to come near the machine."""
        self.text = text
        self.near = near
        self.number = 0
        self.record = 0
        self.heard = False

    def step(self, ctx: Context) -> bool:
        """Done when it is answered; question and answer are journalled."""
        if not self.number:
            self._put(ctx, self.text)
        asked = ctx.prompts.asked[self.number - 1]
        answer = asked.answer
        alone = ctx.prompts.answers_itself(near=self.near)
        ctx.demand.attended = not alone
        if answer is None:
            return False
        # Where nobody is asked, an open guard is a fault: it trips with the next drive switched on.
        closed = ctx.readings.guard_closed or alone
        if not self.heard:
            self.heard = True
            ctx.journal.prompt_answered(self.record, ctx.now, answer, asked.by)
            if closed:
                ctx.demand.attended = False
                return True
            ctx.progress.phase = GUARD_OPEN
        elif closed:
            self._put(ctx, f"{self.text}: {AGAIN}")
        return False

    def _put(self, ctx: Context, text: str) -> None:
        self.number = ctx.prompts.ask(ctx.now, text, near=self.near).number
        self.record = ctx.journal.prompt(ctx.now, text)
        self.heard = False


class TakeTare:
    """Average the unloaded load cell over whole turns and make that its zero.

    The reference zero (the first of this wheel) is kept: a zero that has wandered off it by more than ``stop_n``
    is a damaged or touching cell (5 N warn, 20 N stop). The reference itself is no more than an
    unloaded cell may show (``arming.unloaded``), else it is not taken.
    """

    def __init__(
        self, seconds: float, reference: list[float], warn_n: float, stop_n: float, *, ends_run: bool = True
    ) -> None:
        """``reference``: shared list, empty until the first tare fills it.

        ``ends_run``: a zero that has wandered too far ends the run, which comes to its standstill with that zero: with
        the one before, its stop would take the cell's drift for a load. Where work goes on, such a zero is not taken.
        """
        self.seconds = seconds
        self.reference = reference
        self.warn_n = warn_n
        self.stop_n = stop_n
        self.ends_run = ends_run
        self.began_s = float("nan")
        self.stamp_s = float("-inf")
        self.sums = [0.0, 0.0, 0.0, 0.0]
        self.count = 0
        self.drift_n = 0.0
        """How far off the reference the zero is, N: of the three forces the one that has moved most."""
        self.failed = ""

    def step(self, ctx: Context) -> bool:
        """Done when the average is taken; ``failed`` says why the zero is not to be trusted."""
        r = ctx.readings
        ctx.moving = True
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        if r.cell_valid and r.cell_at_s > self.stamp_s and r.cell_at_s > self.began_s:
            self.stamp_s = r.cell_at_s
            for i, value in enumerate((r.force_x_n, r.force_y_n, r.force_z_n, r.moment_z_nm)):
                self.sums[i] += value
            self.count += 1
        late_s = ctx.now - self.began_s - self.seconds
        if late_s < 0.0 or self.count < TARE_LEAST:
            if late_s > CELL_SILENT_S:
                self.failed = f"the load cell gave {self.count} valid readings in {ctx.now - self.began_s:.0f} s"
            return bool(self.failed)
        ox, oy, oz, om = ctx.cell.tare
        sx, sy, sz, sm = self.sums
        new = (ox + sx / self.count, oy + sy / self.count, oz + sz / self.count, om + sm / self.count)
        if not self.reference:
            # A tare has nothing to be compared with yet: what it may take off is bounded, or it hides a load.
            self.failed = loaded(new, ctx.rig)
            if not self.failed:
                self.reference.extend(new)
                self._take(ctx, "reference", new)
            return True
        self.failed = self._wandered(ctx, new)
        if self.ends_run or not self.failed:
            self._take(ctx, "repeat", new)
        return True

    def _take(self, ctx: Context, kind: str, new: Zero) -> None:
        ctx.cell.set_tare(new)
        ctx.journal.tare(ctx.now, kind, new, ctx.repeat_key)

    def _wandered(self, ctx: Context, new: Zero) -> str:
        """Return "" or how far a zero is off the reference; one that is worth a warning is written down."""
        self.drift_n = drift = max(abs(n - r) for n, r in zip(new[:3], self.reference[:3], strict=True))
        text = f"load cell zero drifted by {drift:.1f} N since the wheel's reference tare"
        if drift > self.warn_n:
            ctx.journal.event(ctx.now, "tare", text, "warning")
        return text if drift > self.stop_n else ""


class Settle:
    """Wait at the fast scan rate for ``seconds``."""

    def __init__(self, seconds: float) -> None:
        """How long, s."""
        self.seconds = seconds
        self.left_s = seconds

    def step(self, ctx: Context) -> bool:
        """Done when the time is over."""
        ctx.moving = True
        self.left_s -= ctx.dt
        return self.left_s <= 0.0
