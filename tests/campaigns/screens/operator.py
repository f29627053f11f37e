"""An afternoon at the rig, in tmux: a mistake in a recipe, a run, a hold, an alarm, a stop, results, an export."""

from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass

from tester.base import clock
from tester.kinds import packaged_text
from tests.campaigns.acceptance.figure import Figure, equal, holds
from tests.campaigns.screens.recipes import MISTAKEN
from tests.campaigns.screens.seat import Seat
from tests.campaigns.screens.tmux import Tmux, available

MISTAKE = f"5:{MISTAKEN.splitlines()[4].index('100') + 1} "
"""Line and column as the list of problems names them."""
FAULT = "t=420 s: belt drive heartbeat lost for 3 s"
EDITOR = "#!/bin/sh\nsed -i 's/load: 100,/load: [100 N, 200 N],/' \"$1\"\n"
SPEED = "20"


@dataclass(frozen=True, slots=True)
class Step:
    """Keys to press, and the text that must then appear. ``keep``: name of its picture, if it is kept."""

    title: str
    keys: tuple[str, ...]
    seen: str
    keep: str = ""
    within_s: float = 30.0


STEPS = (
    Step("the service is started", (), "READY (simulated)"),
    Step("the recipes are checked", (), "✘ 1 mine", "recipes", 60.0),
    Step("Enter on the one with a mistake jumps to it", ("Home", "Enter"), MISTAKE, "mistake"),
    Step("the editor corrects it, and it is checked again", ("e",), "✔   mine", "corrected"),
    Step("the plan", ("d",), "2 conditions", "plan"),
    Step("the start dialog plans it", ("Escape", "Enter"), "2 conditions", "start"),
    Step("the run begins and asks for a wheel", ("Enter",), "waits since", "prompt", 60.0),
    Step("the question is answered", ("Enter",), "The run asks", "answer"),
    Step("the run goes on and measures", ("i", "n", "Enter"), "rep 1/3", "measuring", 60.0),
    Step("help", ("F1",), "On every screen", "help"),
    Step("HOLD", ("Escape", "Space"), " HOLD ", "hold"),
    Step("resume shows the list first", ("r",), "HOLD ends", "resume"),
    Step("the run goes on", ("Enter",), " RUN "),
    Step("the event log", ("l",), "newest first", "log"),
    Step("the devices and frames", ("Escape", "F6"), "Frames", "bus"),
    Step("a drive is lost: the rig is latched, line 2 says why", ("F3",), "P1 ", "alarm", 60.0),
    Step("the manual screen shows it too", ("F4",), "P1 ", "alarm on manual"),
    Step("an acknowledgement is refused while the drive is lost", ("F3", "a"), "still there", "refused"),
    Step("STOP ends the run, the rig stays latched", ("F12",), "Last run", "over"),
    Step("acknowledged, and ready for another run", ("a",), "READY (simulated)", "acknowledged"),
    Step("another run is started", ("F2", "Home", "Enter"), "2 conditions", ""),
    Step("it asks, and is answered at once", ("Enter",), "waits since", "", 60.0),
    Step("it measures", ("Enter", "Right", "Enter"), "rep 1/3", "second run", 60.0),
    Step("STOP", ("F12",), "STOP taken", "stop"),
    Step("the rig is at a standstill", (), "READY (simulated)", "stopped", 60.0),
    Step("the results list both runs", ("F5",), "stopped", "results"),
    Step("the first run's conditions", ("Down", "Enter"), "short, tripped", "conditions"),
    Step("a condition's repeats", ("Enter",), "repeat 3", "repeats"),
    Step("the export dialog", ("Escape", "e"), "Export", "export"),
    Step("a table is exported", ("Enter",), "exported to", "exported"),
)


async def figures(seat: Seat, *, quick: bool) -> AsyncIterator[Figure]:
    """Carry out the steps, up to the first whose text does not appear."""
    if not available():
        yield holds("operator", True, "not measured: there is no tmux here", "tmux")
        return
    rig = packaged_text().replace("faults: []", f'faults: ["{FAULT}"]')
    (seat.folder / "rig.yaml").write_text(rig, encoding="utf-8")
    editor = seat.folder / "correct"
    editor.write_text(EDITOR, encoding="utf-8")
    editor.chmod(0o700)
    seat.environment["EDITOR"] = str(editor)
    tmux = Tmux(seat, seat.captures)
    tmux.open(["tui", "--rig", "rig.yaml", "--speed", SPEED, "--out", str(seat.runs)])
    began_s = clock.monotonic()
    try:
        for step in STEPS:
            await tmux.press(*step.keys)
            took_s = await tmux.see(step.seen, step.within_s)
            if step.keep and not quick:
                await tmux.keep(step.keep)
            yield holds(step.title, True, f"{step.seen.strip()!r} after {took_s:.1f} s", f"within {step.within_s:g} s")
        await tmux.press("q")
    finally:
        tmux.close()
        seat.end_services()
    exported = sorted(file.name for file in seat.folder.glob("*-appendix.csv"))
    yield equal("exported tables", len(exported), 1)
    yield holds("in all", True, f"{clock.monotonic() - began_s:.0f} s", "no limit")
    if not quick:
        yield holds("captures", True, f"{len(list(seat.captures.glob('*.svg')))} in {seat.captures}", "to be looked at")
