"""A plain machine's answers to a service (``tester.machine.served.ServedKind``): its screen, and manual mode."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from tester.base.axes import Axes
from tester.base.quantities import Quantities
from tester.base.screen import HandAxis, MachineView, PlotView, axis_views, trend_columns
from tester.base.words import listed
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.engine import Engine
from tester.machine.manual import NAME, ManualExecutor
from tester.machine.panel import RunPanel, drives_alone
from tester.machine.plain.context import PlainAttendant, PlainContext
from tester.machine.plain.runs import PlainRuns
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.served import ByHand, History, Left, ServedKind
from tester.store.recorder import Recorder

STEPS_TO_TOP: Final = 20
"""Manual steps from standstill to a drive's greatest speed [A]."""


class PlainPanel(RunPanel):
    """The view of one run on a plain machine."""

    def mounted(self) -> tuple[int, str]:
        """Return number and compound of the mounted specimen."""
        mount = self.engine.ctx.mounted
        return (mount.specimen, mount.compound) if mount is not None else (0, "")


class SpeedHand:
    """Changes the speeds of drives in a person's steps."""

    busy = ""
    tare_text = ""

    def __init__(self, tops: Mapping[str, float]) -> None:
        """``tops``: the greatest speed of each drive, in the unit of its axis."""
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

    def __init__(
        self,
        kind: str,
        runs: PlainRuns,
        axes: Axes,
        quantities: Quantities,
        drives: Mapping[str, str],
        plots: tuple[PlotView, ...] = (),
        compound: str = "1#",
    ) -> None:
        """``drives``: each drive's name for people; ``plots``: trends to draw; ``compound``: of a specimen in manual
        mode.
        """
        self.runs = runs
        self.quantities = quantities
        self.compound = compound
        step = f"a {STEPS_TO_TOP}th of its greatest speed a step"
        self.machine = MachineView(
            kind,
            trend_columns(quantities),
            plots,
            hand=tuple(HandAxis(name, title, step) for name, title in drives.items()),
            axes=axis_views(axes),
            moves=listed(drives.values()),
        )

    def panel(self, engine: Engine) -> PlainPanel:
        """Return what clients see of a run."""
        return PlainPanel(engine)

    def alone(self, rig: Rig) -> str:
        """Return what the drives do without a program, in words."""
        return drives_alone(rig)

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: PlainAttendant, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Build manual mode: a person's steps in place of a recipe."""
        own = PlainRig.of(rig)
        run = self.runs.build(own, Plan(NAME, (), (), 1), ports, attendant, record, Prompts())
        attendant.install(1, self.compound)
        executor = ManualExecutor(SpeedHand({name: axis.max_speed for name, axis in own.axes.items()}))
        run.engine.executor = executor
        return ByHand(run, executor, "the specimen is taken to be a new one")
