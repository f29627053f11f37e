"""The screens of this machine: its tables, and the view of a run between two ticks."""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.base.screen import Check, MachineView, PlotView, SoakView, axis_views, trend_columns
from tester.kinds.wheel_on_belt.image.axes import AXES, POSITIONED
from tester.kinds.wheel_on_belt.image.process_image import Press
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.condition import MeasureWheelCondition
from tester.kinds.wheel_on_belt.procedures.thermal_steps import HeatUp, SoakTo
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.kinds.wheel_on_belt.served.drawing import DRAWING
from tester.kinds.wheel_on_belt.served.manual import HAND
from tester.machine.panel import News, RunPanel, Wanted

KIND: Final = "wheel_on_belt"
PLOTS: Final = (
    PlotView("friction", "friction", 0.1),
    PlotView("surface", "surface_c", 4.0),
    PlotView("load", "load_n", 10.0),
    PlotView("slip", "slip_mm_s", 10.0),
)
"""Plots, the most important first: a low screen shows two, a narrow screen three."""
BY_HAND: Final = (
    "wheel_speed", "belt_speed", "slip", "load", "press", *(axis.name for axis in POSITIONED), "surface", "hub", "heat",
)  # fmt: skip
"""Values that change in manual mode."""

MACHINE: Final = MachineView(
    KIND,
    trend_columns(QUANTITIES),
    PLOTS,
    BY_HAND,
    HAND,
    axis_views(AXES),
    specimen="wheel",
    moves="wheel and belt",
    look=("Switch the heating off at the machine if the jacket stays hot.",),
    ring="Slip ring",
    drawing=DRAWING,
)


class WheelPanel(RunPanel):
    """The view of one run on this machine."""

    def news(self) -> dict[str, News]:
        """Return the news of the devices; those of the load cell as a whole, which may be several transmitters."""
        cell = self.engine.devices.cell
        stale_s = self.engine.ctx.rig.interlocks.stale_cell_s
        return super().news() | {"load_cell": News(cell.stamp_s, cell.valid, stale_s)}

    def wanted(self) -> dict[str, Wanted]:
        """Return the setpoints and gates, for values that have them."""
        ctx, out = self.engine.ctx, self.engine.control.state.setpoints
        demand, target, gates = ctx.demand, ctx.gates.target, ctx.rig.gates
        slip_band_m_s = max(0.01 * gates.slip_percent * target.slip_m_s, 1e-3 * gates.slip_floor_mm_s)
        wheel_m_s = out.wheel_rad_s * 0.5e-3 * ctx.readings.diameter_mm
        setpoints = {
            "surface": Wanted(demand.surface_c if isfinite(demand.surface_c) else None),
            "hub": Wanted(out.hub_c if out.heat else None),
            **{name: Wanted(position) for name, position in out.positions.items()},
            "wheel_speed": Wanted(wheel_m_s, abs(0.01 * gates.speed_percent * wheel_m_s)),
            "belt_speed": Wanted(out.belt_m_s, abs(0.01 * gates.speed_percent * out.belt_m_s)),
        }
        if demand.press is Press.LOAD:
            setpoints["load"] = Wanted(demand.load_n, 0.01 * gates.load_percent * demand.load_n)
        if ctx.burst > 0:
            setpoints["slip"] = Wanted(1000.0 * target.slip_m_s, 1000.0 * slip_band_m_s)
            setpoints["surface"] = Wanted(target.temperature_c, target.band_k)
        return setpoints

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way, None where there is none."""
        activity = self.engine.executor.activity
        soak: SoakTo | None = None
        if isinstance(activity, HeatUp):
            soak = activity.soak if activity.rolling else None
        elif isinstance(activity, MeasureWheelCondition):
            soak = None if activity.soaked else activity.soak
        return soak.view(now, self.engine.ctx.gates.surface.slow_c) if soak is not None else None

    def checks(self) -> tuple[Check, ...]:
        """Return the connected rig's own checks before a start."""
        wheel = self.engine.ctx.wheel
        worn = f"{wheel.cold_mm:.2f} mm, {wheel.loss_mm:.2f} mm worn off"
        plan = self.engine.executor.plan
        allowed_mm = plan.replace_after_mm if isinstance(plan, WheelPlan) else 0.0  # manual mode plans nothing
        left_mm = allowed_mm - wheel.loss_mm
        wheel_check = Check("wheel", None, worn)
        if allowed_mm > 0.0:
            left = f"{max(left_mm, 0.0):.2f} mm left before it is changed"
            wheel_check = Check("wheel", left_mm > 0.0, f"{worn}, {left}")
        return (*super().checks(), wheel_check)

    def mounted(self) -> tuple[int, str]:
        """Return specimen and compound of the wheel on the rig."""
        wheel = self.engine.ctx.wheel
        return wheel.specimen, wheel.compound
