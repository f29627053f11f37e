"""What the probes look at: the rig file, the computer, and what was read over the wires, each once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from tester.doctor.can_survey import CanSurvey, survey_can
from tester.doctor.line_survey import LineSurvey, survey_line
from tester.doctor.system import ComputerDoor
from tester.doctor.watch import RigWatch, watched
from tester.doctor.wires import Wires
from tester.inputs.rig import Rig


def nobody(_: str) -> None:
    """Tell nobody how far the look is."""


@dataclass
class Examination:
    """A look at a rig. What costs time is done when a probe first asks for it."""

    rig: Rig
    """As its file says it is."""
    computer: ComputerDoor
    wires: Wires
    runs: Path = Path("runs")
    """The folder that runs are written to."""
    seconds: float = 60.0
    """How long devices and computer are watched."""
    packaged_keys: tuple[str, ...] = ()
    """Keys for which the packaged value counts, because the rig file does not have them."""
    everybody: bool = True
    """Ask every unit number of a Modbus line, not only those of the rig file."""
    say: Callable[[str], None] = field(default=nobody)
    """Is told what is being looked at."""

    @property
    def in_memory(self) -> bool:
        """Whether the rig is simulated in this process: it has no adapters."""
        return self.rig.can.interface == "sim"

    @cached_property
    def can(self) -> CanSurvey:
        """What is on the CAN bus."""
        self.say("CAN bus: listening, then asking every node number")
        return survey_can(self.rig, self.wires)

    @cached_property
    def lines(self) -> dict[str, LineSurvey]:
        """What is on the Modbus lines, by their names."""
        found: dict[str, LineSurvey] = {}
        for name in self.rig.lines:
            whom = "every unit number" if self.everybody else "its devices"
            self.say(f"Modbus line {name}: asking {whom}")
            found[name] = survey_line(self.rig, name, self.wires, everybody=self.everybody)
        return found

    @cached_property
    def watch(self) -> RigWatch:
        """What a stretch of watching shows, after the wires were surveyed."""
        can, lines = not self.can.lost, self.lines
        self.say(f"watching for {self.seconds:g} s")
        return watched(self.rig, self.wires, lines, self.seconds, can=can)

    def limit(self, *names: str) -> float | None:
        """Return the first of these parameters of the rig file's interlocks that it has, None where it has none."""
        section = getattr(self.rig, "interlocks", None)
        for name in names:
            value = getattr(section, name, None)
            if isinstance(value, float | int):
                return float(value)
        return None
