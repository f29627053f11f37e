"""Which scans are recorded: every one in contact, two a second otherwise."""

from __future__ import annotations

from typing import Final, Protocol

from tester.engine.context import Context
from tester.process import Press, Setpoints

IDLE_PERIOD_S: Final = 0.5
"""Recording period out of contact (2 Hz, interface: exports)."""
CONTACT_N: Final = 5.0
"""Above this force the wheel counts as in contact."""


class Sink(Protocol):
    """Takes one row of ``tester.process.SAMPLE_COLUMNS``."""

    def sample(self, row: tuple[float, ...]) -> None:
        """Record one row."""
        ...


class Sampler:
    """Picks scans and makes rows of them."""

    def __init__(self, sink: Sink) -> None:
        """``sink``: the run's store."""
        self.sink = sink
        self.due_s = float("-inf")

    def record(self, ctx: Context, out: Setpoints) -> None:
        """Record this scan if it is due."""
        r = ctx.readings
        contact = r.force_z_n > CONTACT_N or ctx.demand.press is Press.LOAD
        if not contact and ctx.now < self.due_s:
            return
        self.due_s = ctx.now + IDLE_PERIOD_S
        row: tuple[float, ...] = (
            ctx.now,
            r.wheel_speed_m_s,
            r.belt_speed_m_s,
            r.slip_m_s,
            r.sideslip_deg,
            r.camber_deg,
            ctx.demand.load_n,
            r.force_x_n,
            r.force_y_n,
            r.force_z_n,
            r.moment_z_nm,
            r.drive_torque_nm,
            r.surface_c,
            r.hub_c,
            out.hub_c,
            r.heat_percent,
            r.press_mm,
            r.wheel_angle_rev,
            float(ctx.gate),
            float(ctx.burst),
            float(ctx.repeat_key),
        )
        self.sink.sample(row)
        ctx.sample = row
