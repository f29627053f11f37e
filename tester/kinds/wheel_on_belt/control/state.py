"""Control's memory beside the modes: its loops, and the data of its stops and its heat."""

from __future__ import annotations

from math import inf

from tester.kinds.wheel_on_belt.control.heat_loop import HeatLoop
from tester.kinds.wheel_on_belt.control.load_loop import LoadLoop
from tester.kinds.wheel_on_belt.image.process import Setpoints
from tester.kinds.wheel_on_belt.interlocks.inputs import StopStart
from tester.machine.state import ControlState


class WheelState(ControlState[Setpoints]):
    """Everything ``WheelControl.step`` carries from one scan to the next; plain data, copyable."""

    def __init__(self, setpoints: Setpoints, load: LoadLoop, heat: HeatLoop) -> None:
        """Begin in idle."""
        super().__init__(setpoints)
        self.load = load
        self.heat = heat
        self.stop_start = StopStart()
        self.turning_since_s = inf
        """Since when the wheel has been confirmed turning."""
        self.hub_ceiling: list[tuple[float, float]] = []
        """(time, hub setpoint) within ``runaway_window``, falling ones only: the first is the highest."""
