"""The input of the probes: the rig file, the computer, and the results read over the wires, each read once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tester.doctor.bus_watch import RigWatch, watched
from tester.doctor.can_survey import CanSurvey, survey_can
from tester.doctor.line_survey import LineSurvey, survey_line
from tester.doctor.open_wires import Wires
from tester.doctor.system import Computer
from tester.inputs.rig import Rig


@dataclass
class Examination:
    """An examination of a rig. Slow parts run when a probe first needs them."""

    rig: Rig
    """The rig as its file describes it."""
    computer: Computer
    wires: Wires
    runs: Path = Path("runs")
    """The folder into which runs are written."""
    seconds: float = 60.0
    """For how long devices and computer are watched, s."""
    packaged_keys: tuple[str, ...] = ()
    """Keys missing in the rig file, for which the packaged value applies."""
    everybody: bool = True
    """Whether to query every unit number of a Modbus line, not only those of the rig file."""
    say: Callable[[str], object] = str
    """Shows what is being examined; by default the text is dropped."""

    @property
    def in_memory(self) -> bool:
        """Whether the rig is simulated in this process, without adapters."""
        return self.rig.can.interface == "sim"

    @cached_property
    def can(self) -> CanSurvey:
        """The survey of the CAN bus."""
        self.say("CAN bus: listening, then asking every node number")
        return survey_can(self.rig, self.wires)

    @cached_property
    def lines(self) -> dict[str, LineSurvey]:
        """The surveys of the Modbus lines, by name."""
        surveys: dict[str, LineSurvey] = {}
        for name in self.rig.lines:
            units = "every unit number" if self.everybody else "its devices"
            self.say(f"Modbus line {name}: asking {units}")
            surveys[name] = survey_line(self.rig, name, self.wires, everybody=self.everybody)
        return surveys

    @cached_property
    def watch(self) -> RigWatch:
        """The results of watching the rig, which follows the surveys; empty if nothing has answered."""
        can, lines = not self.can.lost, self.lines
        units = [unit for line in lines.values() for unit in line.units.values()]
        if not self.can.present and not self.can.traffic.frames and not any(unit.there for unit in units):
            return RigWatch()
        self.say(f"watching for {self.seconds:g} s")
        return watched(self.rig, self.wires, lines, self.seconds, can=can)

    def limit(self, name: str) -> float | None:
        """Return the value of an interlock parameter; None if the rig does not have it."""
        return getattr(getattr(self.rig, "interlocks", None), name, None)
