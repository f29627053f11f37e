"""One run as people see it: the state view's parts that come from its engine, and the alarms that follow from them."""

from __future__ import annotations

from math import isfinite

from tester import clock
from tester.control.state import Mode
from tester.engine.condition import MeasureCondition
from tester.engine.connect import Stage
from tester.engine.run import Run
from tester.engine.thermal_steps import HeatUp, SoakTo
from tester.process import GATE_LOAD, GATE_SETTLING, GATE_SLIP, GATE_SPEED, GATE_TEMPERATURE
from tester.rig import RigConfig
from tester.rig.load import risks_of
from tester.service.alarms import AlarmList, Cause
from tester.service.alone import left_alone
from tester.service.buses import BusWatch
from tester.service.frames import FrameLog
from tester.service.progress import PlanTrack
from tester.service.state import Check, Gate, ProgressView, PromptView, SoakView, Value
from tester.service.values import ValueView

GATES = (
    ("load", GATE_LOAD),
    ("speed", GATE_SPEED),
    ("slip", GATE_SLIP),
    ("temperature", GATE_TEMPERATURE),
    ("settling", GATE_SETTLING),
)
NO_MODE = "CONNECTING"
MODES = {Mode.EMERGENCY: "E-STOP"}
"""Modes that are shown under another name than control's."""
RESTING = (Mode.IDLE, Mode.LATCHED)
"""Modes in which drives are let go of at the end of a run."""


def risk_of(rig: RigConfig) -> str:
    """Return the safety keys of a rig that are looser than they should be, in words; "" where none is."""
    return "; ".join(map(str, risks_of(rig)))


class RunWatch:
    """Looks at one run, between two ticks."""

    def __init__(self, run: Run, track: PlanTrack) -> None:
        """Work out what stays the same. ``track``: of the whole plan, of which this run may be a part."""
        self.run = run
        engine = run.engine
        self.rig = engine.ctx.rig
        self.risk = risk_of(self.rig)
        self.values = ValueView(engine)
        self.buses = BusWatch(engine.devices, self.rig)
        self.frames = FrameLog(engine.devices, tuple(self.rig.lines))
        self.alone = left_alone(self.rig)
        self.track = track
        track.begin_part(engine.executor.plan)
        self.watched: set[str] = set()
        """Names of the alarms that stand for this run's devices: they go with it."""
        self.tripped = ""
        """Name of the alarm of the trip that latches the rig."""
        self.acknowledged = False
        """There was a trip, and it has been acknowledged."""
        self._asked_utc: dict[int, str] = {}

    # -- what is shown ----------------------------------------------------------------------------------------

    @property
    def mode(self) -> tuple[str, str, float]:
        """Mode, why, and for how many seconds."""
        run = self.run
        if run.connector.stage is not Stage.READY:
            return NO_MODE, run.connector.stage.value, 0.0
        state = run.engine.control.state
        name = MODES.get(state.mode, state.mode.value.upper())
        why = state.trip.text if state.trip is not None else state.stop_requested
        return name, why, max(run.engine.ctx.now - state.mode_since_s, 0.0)

    @property
    def latched(self) -> bool:
        """A trip or a fast stop waits for its acknowledgement."""
        return self.run.engine.control.state.mode is Mode.LATCHED

    def progress(self, now: float, lapse: float | None) -> ProgressView:
        """Return where the run is; ``lapse``: rig seconds per second, None where nobody knows."""
        p = self.run.engine.ctx.progress
        left = self.track.left_s()
        finish = clock.utc_in(left / lapse) if lapse and left is not None else ""
        return ProgressView(p.step, p.steps, p.title, p.phase, p.condition, p.conditions, p.repeat, p.repeats,
                            p.revolutions, p.revolutions_wanted, p.burst, self.track.share(), now, left,
                            finish)  # fmt: skip

    def gates(self) -> tuple[Gate, ...]:
        """Return the gates as of the last scan."""
        closed = self.run.engine.ctx.gate
        return tuple(Gate(key, not closed & bit) for key, bit in GATES)

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way, None where there is none."""
        activity = self.run.engine.executor.activity
        soak: SoakTo | None = None
        if isinstance(activity, HeatUp):
            soak = activity.soak if activity.rolling else None
        elif isinstance(activity, MeasureCondition):
            soak = None if activity.soaked else activity.soak
        if soak is None:
            return None
        surface = self.run.engine.ctx.gates.surface.slow_c
        return SoakView(
            surface if isfinite(surface) else None, soak.target_c, soak.within_k,
            max(now - soak.since_s, 0.0) if isfinite(soak.since_s) else 0.0, soak.for_s,
            max(now - soak.began_s, 0.0) if isfinite(soak.began_s) else 0.0, soak.at_most_s,
        )  # fmt: skip

    def prompt(self) -> PromptView | None:
        """Return the question that waits."""
        waiting = self.run.engine.ctx.prompts.waiting
        if waiting is None:
            return None
        asked = self._asked_utc.setdefault(waiting.number, clock.utc_now())
        return PromptView(waiting.number, waiting.text, waiting.at_s, asked)

    def preflight(self) -> tuple[Check, ...]:
        """Return what the connected rig says of its readiness."""
        r, rig = self.run.engine.ctx.readings, self.rig
        wheel = self.run.engine.ctx.wheel
        worn = f"{wheel.cold_mm:.2f} mm, {wheel.loss_mm:.2f} mm worn off"
        allowed_mm = self.run.engine.executor.plan.replace_after_mm  # 0: by hand, nothing is planned
        left_mm = allowed_mm - wheel.loss_mm
        wheel_check = Check("wheel", None, worn)
        if allowed_mm > 0.0:
            left = f"{max(left_mm, 0.0):.2f} mm left before it is changed"
            wheel_check = Check("wheel", left_mm > 0.0, f"{worn}, {left}")
        return (
            Check("safety chain", r.safety_chain, "closed" if r.safety_chain else "open"),
            Check("guard closed", r.guard_closed, "" if r.guard_closed else "the guard is open"),
            wheel_check,
            Check("last run", None, "under way"),
            Check("ambient", None, f"{rig.ambient_c:g} °C"),
        )

    # -- alarms -----------------------------------------------------------------------------------------------

    def watch_values(self, alarms: AlarmList, now: float, values: tuple[Value, ...]) -> None:
        """Raise and clear what follows from what is shown: data that has stopped coming, a device that is lost."""
        if self.run.connector.stage is not Stage.READY or self.run.engine.control.state.mode in RESTING:
            return
        for value in values:
            if value.key not in ("load", "slip", "surface", "hub"):
                continue
            name = f"no fresh data: {value.label}"
            self.watched.add(name)
            late = value.quality == "stale" and value.age_s is not None and value.age_s > 2.0
            alarms.set(late, Cause(name, 2, f"{value.age_s or 0.0:.0f} s old", "in contact the run stops"), now)
        for device in self.buses.device_views(now):
            lost = not device.online
            alarms.set(
                lost, Cause(f"{device.name} offline", 2, device.detail or "does not answer", "the run stops"), now
            )

    def watch_trip(self, alarms: AlarmList, now: float) -> None:
        """Raise what has stopped the rig, for as long as it is latched."""
        trip = self.run.engine.control.state.trip
        if trip is not None:
            consequence = "the rig comes to a standstill; nothing moves before it is acknowledged"
            alarms.raise_(Cause(trip.name, 1, trip.text, consequence), now)
            self.tripped = trip.name
        elif self.tripped:
            alarms.clear(self.tripped)
            self.tripped, self.acknowledged = "", True
