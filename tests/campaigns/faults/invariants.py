"""The invariants of docs/kinds/wheel-on-belt.md that can be seen in one scan: commands against knowledge.

The judge checks I5 (safe in three seconds), I4 (budgets) and I8 (nothing committed after a trip); the service checks
I12.
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from tester.kinds.wheel_on_belt.image.process_image import Press

if TYPE_CHECKING:
    from tests.campaigns.faults.stage import Stage

WORKING = frozenset({"run", "hold"})
AT_REST = frozenset({"idle", "latched"})
SLOW_M_S = 0.02
"""A wheel slower than this counts as standing (``standing`` of the rig file)."""
SHARE = 1.001
"""A command may exceed its limit by a rounding."""


class Invariants:
    """Watches the commands of one stage, scan by scan; ``broken`` names each invariant once."""

    def __init__(self) -> None:
        """Nothing seen yet."""
        self.broken: dict[str, str] = {}
        self._scans = 0
        self._mode = ""
        self._notes = 0

    def look(self, stage: Stage) -> None:
        """Look at the commands of the last scan, if there was a new one."""
        engine = stage.run.engine
        if engine.scans == self._scans or engine.control.state.events:
            return  # pending events: requested after the scan, the next scan acts on them
        self._scans = engine.scans
        mode = engine.control.state.mode.value
        self._heat(stage, mode)
        self._load(stage, mode)
        self._stopped(stage, mode)
        self._bounds(stage)
        self._changes(stage, mode)

    def _heat(self, stage: Stage, mode: str) -> None:
        engine = stage.run.engine
        out, r = engine.control.state.setpoints, engine.ctx.readings
        if not out.heat:
            return
        bounds = engine.ctx.rig.interlocks
        fresh = r.now_s - r.jacket_at_s <= bounds.stale_jacket_s and r.now_s - r.surface_at_s <= bounds.stale_ir_s
        turning = r.wheel_speed_m_s > SLOW_M_S
        if mode not in WORKING or not turning or not fresh or not (r.jacket_valid and r.surface_valid):
            self._break(stage, "I1", f"heat commanded in {mode}, turning {turning}, fresh {fresh}")

    def _load(self, stage: Stage, mode: str) -> None:
        engine = stage.run.engine
        out, r, demand = engine.control.state.setpoints, engine.ctx.readings, engine.ctx.demand
        if not out.press_mm_s > 0.0:
            return
        pressing = mode == "run" and demand.press is Press.LOAD
        both = r.wheel_speed_m_s > SLOW_M_S and r.belt_speed_m_s > SLOW_M_S
        if pressing and not (both and r.cell_valid):
            self._break(stage, "I2", f"press commanded down, wheel {r.wheel_speed_m_s}, belt {r.belt_speed_m_s}")
        if mode not in WORKING:
            self._break(stage, "I2", f"press commanded down in {mode}")

    def _stopped(self, stage: Stage, mode: str) -> None:
        engine = stage.run.engine
        state, out = engine.control.state, engine.control.state.setpoints
        if state.trip is not None and mode in WORKING:
            self._break(stage, "I3", f"tripped ({state.trip.name}) and still in {mode}")
        if mode in WORKING or mode == "armed":
            return
        if out.heat or out.contactor or out.press_mm_s > 0.0 or out.hub_c > engine.ctx.rig.loops.heat.hub_min_c:
            self._break(stage, "I3", f"{mode}: heat {out.heat}, contactor {out.contactor}, press {out.press_mm_s}")
        lifted = engine.ctx.contact.lifted_mm(engine.ctx.rig.loops.load)
        high = engine.ctx.readings.press_mm > lifted + 0.3
        if mode in ("stopping", "fast stop") and high and not out.press_mm_s < 0.0:
            self._break(stage, "I3", f"{mode}: the press is not told to lift")
        if mode == "fast stop" and (out.wheel_rad_s or out.belt_m_s or not out.quick_stop):
            self._break(stage, "I3", f"fast stop commands {out.wheel_rad_s} rad/s, {out.belt_m_s} m/s")
        if mode in AT_REST and (out.enable or out.wheel_rad_s or out.belt_m_s or out.press_mm_s):
            self._break(stage, "I6", f"{mode} commands motion")

    def _bounds(self, stage: Stage) -> None:
        engine = stage.run.engine
        out, limits, r = engine.control.state.setpoints, engine.ctx.rig.limits, engine.ctx.readings
        rim_m_s = out.wheel_rad_s * r.diameter_mm * 0.5e-3
        values = (rim_m_s, out.belt_m_s, out.press_mm_s, out.hub_c, *out.positions.values())
        if not all(isfinite(value) for value in values):
            self._break(stage, "I10", f"not a number is commanded: {values}")
        most = (
            limits.wheel_speed_m_s, limits.belt_speed_m_s, engine.ctx.rig.axes.press.max_speed, limits.jacket_c,
            *limits.positions().values(),
        )  # fmt: skip
        for value, limit in zip(values, most, strict=True):
            if not abs(value) <= limit * SHARE:
                self._break(stage, "I10", f"{value} is commanded, at most {limit}")

    def _changes(self, stage: Stage, mode: str) -> None:
        ledger, r = stage.ledger, stage.run.engine.ctx.readings
        if mode == self._mode:
            return
        before, self._mode = self._mode, mode
        if before and len(ledger.journal) == self._notes:
            self._break(stage, "I9", f"{before} -> {mode} is not in the journal")
        self._notes = len(ledger.journal)
        cause = r.drive_fault or r.bus_fault or r.foreign_master or not r.safety_chain
        if before == "latched" and mode == "idle" and cause:
            self._break(stage, "I6", "acknowledged with the cause still there")

    def _break(self, stage: Stage, name: str, text: str) -> None:
        self.broken.setdefault(name, f"{text} at {stage.run.engine.ctx.now:.2f} s")
