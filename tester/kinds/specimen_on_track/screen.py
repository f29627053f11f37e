"""The screens of this machine: its tables, and the view of a run between two ticks."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from tester.base.screen import Check, HandAxis, MachineView, PlotView, SoakView, axis_views, trend_columns
from tester.kinds.specimen_on_track.axes import AXES, NAME
from tester.kinds.specimen_on_track.drawing import DRAWING
from tester.kinds.specimen_on_track.procedures.steps import TemperAir
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.machine.panel import News, RunPanel, Wanted

HAND: Final = (
    HandAxis("track", "Track speed", "a tenth of the greatest a step, arm raised"),
    HandAxis("arm", "Arm", "down or up, track standing"),
    HandAxis("chamber", "Chamber", "1 K a step"),
)
"""Axes of manual mode, in the order of the screen."""

MACHINE: Final = MachineView(
    NAME,
    trend_columns(QUANTITIES),
    (
        PlotView("friction", "friction", 0.1),
        PlotView("force", "force_n", 5.0),
        PlotView("air", "air_c", 4.0),
        PlotView("track", "track_mm_s", 0.01),
    ),
    ("track", "force", "lift", "air", "chamber"),
    HAND,
    axis_views(AXES),
    specimen="specimen",
    moves="the track",
    look=("Take the weights off the arm if it is down.",),
    drawing=DRAWING,
)


class TrackPanel(RunPanel):
    """The view of one run on this machine."""

    def news(self) -> dict[str, News]:
        """Return the news of the devices; "air": of chamber or thermometer, "contact": of the pyrometer, else "air"."""
        news = super().news()
        measured = "chamber" if "chamber" in news else "thermometer"
        air = replace(news[measured], stale_s=self.engine.ctx.rig.interlocks.stale_air_s)
        return news | {"air": air, "contact": news.get("pyrometer", air)}

    def wanted(self) -> dict[str, Wanted]:
        """Return the setpoints and gates, for values that have them."""
        ctx, out = self.engine.ctx, self.engine.control.state.setpoints
        target = ctx.target
        mm_s = 1e3 * out.track_m_s
        found = {
            "track": Wanted(mm_s, abs(0.01 * ctx.rig.gates.speed_percent * mm_s)),
            "lift": Wanted(out.lift_mm),
            "load": Wanted(ctx.weights_n if ctx.demand.lowered else 0.0),
            "air": Wanted(out.chamber_c if out.chamber else None),
        }
        if ctx.burst > 0:
            found["air"] = Wanted(target.temperature_c, target.band_k)
        return found

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way, None where there is none."""
        activity = self.engine.executor.activity
        return activity.view(now, self.engine.ctx.readings.air_c) if isinstance(activity, TemperAir) else None

    def checks(self) -> tuple[Check, ...]:
        """Return the connected rig's own checks before a start."""
        mounted = self.engine.ctx.mounted
        specimen = f"{mounted.compound}, {1e3 * mounted.sliding_m:.1f} mm slid" if mounted.number else "none on"
        return (*super().checks(), Check("specimen", None, specimen))
