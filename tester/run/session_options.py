"""Options of a run on the command line, and reasons for refusing them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tester.base.processes import EXIT_USAGE
from tester.base.words import plain_text
from tester.inputs.rig import Rig
from tester.inputs.rig.risks import counts_as_simulated
from tester.run.endings import CannotStartError
from tester.run.kind_lookup import run_parts
from tester.run.remote_hands import refused_hands
from tester.run.reporter import ReportScreen


@dataclass(frozen=True, slots=True)
class SessionOptions:
    """Options of the command line."""

    recipe: str = ""
    rig: str = "sim"
    overrides: tuple[str, ...] = ()
    accept_risk: str = ""
    """Reason for accepting safety keys that are looser than they should be; "" = they are refused."""
    out: Path = Path("runs")
    seed: int = 0
    lapse: float | None = None
    """Rig seconds per second; None = as fast as possible, in real time on wires."""
    bus_log: Path | None = None
    operator: str = ""
    jobs: int = 1
    """Number of processes that run independent parts side by side (simulated rig only)."""
    samples: bool = True
    """Whether samples are stored."""
    leaps: bool = True
    """Whether a simulated rig leaps time in which only heat flows (``tester.machine.leaps``)."""
    faults: tuple[str, ...] = ()
    """Lines of a fault script (sim.faults.language), in addition to the rig file's."""
    hands: str = ""
    """HOST:PORT of the console of a simulated machine in another process (``tester.run.remote_hands``)."""


def only_plain(**texts: str) -> None:
    """Raise CannotStartError, naming the text, if a person's text is more than one line of printable characters."""
    try:
        for where, text in texts.items():
            plain_text(text, where)
    except ValueError as error:
        raise CannotStartError(str(error), EXIT_USAGE) from error


def refusal(options: SessionOptions, rig: Rig, screen: ReportScreen) -> str:
    """Return why the options do not fit the rig or the screen; "" if they do."""
    if refused := refused_hands(options.hands, rig):
        return refused
    if not rig.simulated and options.lapse not in (None, 1.0) and not counts_as_simulated(rig):
        return (
            f"--speed {options.lapse:g}: this rig is real; only a simulated rig in another process can live faster, and"
            " its rig file demands the simulator's identity of every drive"
        )
    jobs = options.jobs
    if jobs > 1 and not rig.simulated:
        return f"--jobs {jobs}: only a simulated rig can run several parts at a time, and this rig is real"
    if screen.answer_yes and not (screen.can_ask or counts_as_simulated(rig)):
        return "--yes: this is no interactive terminal, and only a person can answer the prompts of a real rig"
    if screen.answer_yes:
        return ""
    if jobs > 1:
        return f"--jobs {jobs}: prompts of several parts at a time cannot be answered; use --yes, or one job"
    if not screen.can_ask:
        return "the recipe has prompts, and this is no interactive terminal: use --yes"
    return ""


def check_faults(texts: tuple[str, ...], rig: Rig) -> None:
    """Raise CannotStartError for an invalid fault script or a real rig."""
    if rig.can.interface != "sim":
        raise CannotStartError("faults happen only on a rig that is simulated in this process", EXIT_USAGE)
    from sim import machines
    from sim.faults import FaultTextError
    from tester.run.simulated import spec_of

    try:
        machines.find(run_parts(rig).plant).language(spec_of(rig)).parse_script(texts)
    except FaultTextError as error:
        raise CannotStartError(str(error), EXIT_USAGE) from error
