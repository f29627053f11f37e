"""The least of a machine: a lamp that is lit, and that must not get too hot."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from tester.inputs.rig import Rig
from tester.inputs.rig.parameter import Parameter
from tester.machine.context import BaseContext
from tester.machine.control import Control
from tester.machine.image import BaseDemand, BaseReadings, BaseSetpoints
from tester.machine.inputs import ScanInputs
from tester.machine.interlock_table import InterlockTable
from tester.machine.mode_commands import may_move
from tester.machine.prompts import Prompts
from tester.machine.row import CONTROLLED, FAST, POWER_OFF, WARN, Interlock
from tester.machine.state import ControlState
from tester.machine.watches import at_most, condition
from tester.store.recorder import NullRecorder
from tests.tester.inputs.recipe.texts import rig

HOLD_S: Final = 10.0
ACK_S: Final = 0.5
HOT_C: Final = Parameter("hot_c", "degC", "80 degC", "a lamp hotter than this")
HOT_DELAY_S: Final = Parameter("hot_delay_s", "s", "100 ms", "... for this long")


@dataclass(slots=True)
class LampReadings(BaseReadings):
    """Readings of the lamp."""

    lamp_c: float = 20.0


@dataclass(slots=True)
class LampDemand(BaseDemand):
    """Requested brightness, 0..1."""

    light: float = 0.0


@dataclass(slots=True)
class LampSetpoints(BaseSetpoints):
    """Commanded brightness, 0..1."""

    light: float = 0.0


@dataclass(slots=True)
class LampInputs(ScanInputs):
    """Inputs of its rows."""

    readings: LampReadings = field(default_factory=LampReadings)


def _lit(v: LampInputs) -> bool:
    return v.readings.drives_enabled


TABLE: Final = InterlockTable(
    (
        Interlock("chain", "the safety chain is open", condition("open", lambda v: not v.readings.safety_chain),
                  FAST, "closed", at_rest=_lit),
        Interlock("hot", "the lamp is hot", at_most("above {}", lambda v: v.readings.lamp_c, HOT_C),
                  CONTROLLED, "cool", delay=HOT_DELAY_S),
        Interlock("stays on", "it is lit at rest", condition("power at rest", lambda v: v.resting and _lit(v)),
                  POWER_OFF, "off", at_rest=_lit),
        Interlock("late", "a scan came late", at_most("late", lambda v: v.late_s, 1.0, "s"), WARN, "by itself"),
    )
)  # fmt: skip


class LampControl(Control[ControlState[LampSetpoints], LampReadings, LampDemand, LampInputs]):
    """The control of a lamp."""

    def __init__(self) -> None:
        state, view = ControlState(LampSetpoints()), LampInputs()
        view.parameters = {one: one.value for one in TABLE.parameters}
        view.stop = state.stop
        super().__init__(state, view, TABLE, LampDemand(), LampDemand(), hold_at_most_s=HOLD_S, ack_wait_s=ACK_S)
        self.called: list[str] = []
        """The hooks that were called, in order."""
        self.must = ""
        """Why it has to cool."""

    def look(self, demand: LampDemand, readings: LampReadings, scan_s: float, dt: float) -> None:
        self.view.readings = readings
        self.view.note_times(self.state, readings.now_s, scan_s)
        self.view.loaded = demand.light > 0.0

    def detail(self, readings: LampReadings) -> str:
        return f"{readings.lamp_c:g} degC"

    def run_outputs(self, demand: LampDemand, readings: LampReadings, dt: float) -> None:
        out = self.state.setpoints
        out.enable, out.light = demand.enabled and may_move(readings), demand.light

    def keep(self, held: LampDemand, demand: LampDemand) -> None:
        held.light = 0.5 * demand.light

    def stop_outputs(self) -> None:
        self.called.append(f"stop outputs: {self.state.mode.value}")
        self.state.setpoints.light = 0.0

    def safe_outputs(self) -> None:
        self.state.setpoints.light = 0.0

    def emergency_outputs(self) -> None:
        self.state.setpoints.light = 0.0

    def rest_outputs(self) -> None:
        self.state.setpoints.light, self.state.setpoints.enable = 0.0, False

    def note_stop(self) -> None:
        self.called.append("note stop")

    def note_fast_stop(self) -> None:
        self.called.append("note fast stop")

    def note_rest(self) -> None:
        self.called.append("note rest")

    def stop_ended(self) -> bool:
        return not self.view.readings.drives_enabled

    def must_cool(self) -> str:
        return self.must

    def cool_outputs(self) -> str:
        return "cool" if self.view.readings.lamp_c < 40.0 else ""


class LampContext(BaseContext[Rig, LampReadings, LampDemand]):
    """Context of a lamp's step."""


def make_context() -> LampContext:
    """Return a context without a rig around it."""
    return LampContext(rig(), LampReadings(), LampDemand(), Prompts(), NullRecorder())
