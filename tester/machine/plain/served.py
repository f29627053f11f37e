"""A plain machine's answers to a service (``tester.machine.served.ServedKind``): its screen, and manual mode."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from tester.base.axes import Axes
from tester.base.quantities import Quantities
from tester.base.screen import HandAxis, MachineView, PlotView, axis_views, trend_columns
from tester.base.words import listed
from tester.inputs.rig import Rig
from tester.machine.hand import Hand
from tester.machine.panel import RunPanel, drives_alone
from tester.machine.plain.context import PlainContext
from tester.machine.plain.runs import PlainRuns
from tester.machine.run import Run
from tester.machine.run_parts import Left
from tester.machine.served import ServedKind

STEPS_TO_TOP: Final = 20
"""Manual steps from standstill to a drive's greatest speed [A]."""


class SpeedHand(Hand):
    """Changes the speeds of drives in a person's steps."""

    def __init__(self, tops: Mapping[str, float]) -> None:
        """``tops``: the greatest speed of each drive, in the unit of its axis."""
        super().__init__()
        self.tops = tops
        self.wanted = dict.fromkeys(tops, 0)

    def demand(self, ctx: PlainContext) -> None:
        """Write the demand that results from the steps so far."""
        for name, steps in self.wanted.items():
            ctx.demand.speeds[name] = self.tops[name] * steps / STEPS_TO_TOP

    def step(self, ctx: PlainContext, axis: str, sign: float) -> str:
        """Take one step of a drive, up or down; return "", or the reason for refusing."""
        if axis not in self.wanted:
            return f"there is no drive {axis} (expected {', '.join(self.wanted)})"
        self.wanted[axis] = max(-STEPS_TO_TOP, min(STEPS_TO_TOP, self.wanted[axis] + (1 if sign > 0.0 else -1)))
        return ""

    def tare(self, ctx: PlainContext) -> str:
        """Refuse: sensors are zeroed when a specimen is mounted."""
        return "sensors are zeroed when a specimen is put on"


class PlainServed(ServedKind):
    """A plain kind's answers to a service."""

    panel: type[RunPanel] = RunPanel

    def __init__(
        self,
        kind: str,
        runs: PlainRuns,
        axes: Axes,
        quantities: Quantities,
        drives: Mapping[str, str],
        plots: tuple[PlotView, ...] = (),
    ) -> None:
        """``drives``: each drive's name for people; ``plots``: trends to draw."""
        self.runs = runs
        self.quantities = quantities
        self.compound = runs.compound
        step = f"a {STEPS_TO_TOP}th of its greatest speed a step"
        self.machine = MachineView(
            kind,
            trend_columns(quantities),
            plots,
            hand=tuple(HandAxis(name, title, step) for name, title in drives.items()),
            axes=axis_views(axes),
            moves=listed(drives.values()),
        )

    def alone(self, rig: Rig) -> str:
        """Return, in words, what the drives do by themselves when this program has ended."""
        return drives_alone(rig)

    def hand(self, run: Run, left: Left | None) -> tuple[SpeedHand, str]:
        """Take the specimen to be a new one."""
        ctx: PlainContext = run.engine.ctx
        ctx.attendant.install(1, self.compound)
        hand = SpeedHand({name: axis.max_speed for name, axis in ctx.rig.axes.items()})
        return hand, "the specimen is taken to be a new one"
