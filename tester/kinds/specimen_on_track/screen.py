"""The screens of this machine: its tables, and the view of a run between two ticks."""

from __future__ import annotations

from typing import Final

from tester.base.screen import Check, HandAxis, MachineView, PlotView, SoakView, axis_views, trend_columns
from tester.kinds.specimen_on_track.axes import AXES, NAME
from tester.kinds.specimen_on_track.procedures.steps import TemperAir
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.machine.engine import Engine
from tester.machine.panel import News, RunPanel, Wanted, soak_view

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
)


class TrackPanel(RunPanel):
    """The view of one run on this machine."""

    def __init__(self, engine: Engine) -> None:
        """Store the run; the panel only reads it."""
        super().__init__(engine)
        limits = engine.ctx.rig.interlocks
        self._stale_s = (limits.stale_cell_s, limits.stale_can_s, limits.stale_air_s, limits.stale_exit_s)

    def news(self) -> dict[str, News]:
        """Return the news of the devices; for the drives, that of the drive with the oldest data."""
        r, (cell_s, can_s, air_s, exit_s) = self.engine.ctx.readings, self._stale_s
        air = News(r.air_at_s, r.air_valid, air_s)
        pyrometer = self.engine.ctx.devices.pyrometer is not None
        return {
            "cell": News(r.cell_at_s, r.cell_valid, cell_s),
            "can": News(min(r.track_at_s, r.lift_at_s), not r.drive_fault, can_s),
            "air": air,
            "contact": News(r.exit_at_s, r.exit_valid, exit_s) if pyrometer else air,
        }

    def wanted(self) -> dict[str, Wanted]:
        """Return the setpoints and gates, for values that have them."""
        ctx, out = self.engine.ctx, self.engine.control.state.setpoints
        target = ctx.target
        mm_s = 1e3 * out.track_m_s
        found = {
            "track": Wanted(mm_s, abs(0.01 * ctx.rig.gates.speed_percent * mm_s)),
            "lift": Wanted(out.lift_mm),
            "load": Wanted(ctx.on.weights_n if ctx.demand.lowered else 0.0),
            "air": Wanted(out.chamber_c if out.chamber else None),
        }
        if ctx.burst > 0:
            found["air"] = Wanted(target.temperature_c, target.band_k)
        return found

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way, None where there is none."""
        activity = self.engine.executor.activity
        if not isinstance(activity, TemperAir):
            return None
        step = activity.temper
        return soak_view(
            now, self.engine.ctx.readings.air_c, step.temperature_c, step.within_k, activity.since_s, step.for_s,
            activity.began_s, step.at_most_s,
        )  # fmt: skip

    def checks(self) -> tuple[Check, ...]:
        """Return the connected rig's own checks before a start."""
        on = self.engine.ctx.on
        specimen = f"{on.compound}, {1e3 * on.sliding_m:.1f} mm slid" if on.number else "none on"
        return (*super().checks(), Check("specimen", None, specimen))

    def mounted(self) -> tuple[int, str]:
        """Return number and compound of the specimen on the arm."""
        on = self.engine.ctx.on
        return on.specimen, on.compound
