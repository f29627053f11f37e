"""The screen when the service is gone, or the terminal too small: what became of the run, what to do."""

from __future__ import annotations

from tester.tui.formatting import clean, fit
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import Panel, Parts, rows

TITLE = "The service has died"
SHORT = "the service has died: nobody controls the rig. Use the machine's own stop"


def gone_line(scene: ScreenScene) -> str:
    """Return what has become of the service in a line, "" while nothing is known."""
    if scene.gone == "died":
        return SHORT
    return "the service has ended: `tester tui` starts another" if scene.gone == "ended" else ""


def death_text(scene: ScreenScene) -> str:
    """Return what a person must know whose service has died, in paragraphs."""
    state = scene.state
    rig = clean(state.alone) if state is not None else ""
    lines = [
        "The process that owned the rig is gone without having been told to. Nobody controls the rig any more, and "
        "no STOP from here can reach it.",
        "",
        rig,
        "",
    ]
    todo = [
        f"Look at the machine: {clean(scene.machine.moves)} must stand. If not, or in doubt: the machine's emergency "
        "stop.",
        *(clean(one) for one in scene.machine.look),
        "Leave this screen (q) and start `tester tui` again: it starts another service. Nothing moves by that.",
    ]
    if scene.run_under_way and state is not None and state.run is not None:
        name = clean(state.run.name)
        todo.append(f"{name} is interrupted. What it has committed is kept: `r`, or `tester resume {name}`, goes "
                    "on with it.")  # fmt: skip
    return "\n".join([*lines, *(f"{number}. {one}" for number, one in enumerate(todo, 1))])


def stop_failed(scene: ScreenScene, error: str) -> str:
    """Return why STOP has not been taken, and what to do."""
    look = f"Use the machine's own stop, and look that {clean(scene.machine.moves)} stand."
    if scene.gone == "died":
        rig = f" {clean(scene.state.alone)}" if scene.state is not None else ""
        return f"STOP cannot be taken: the service has died.{rig} {look}"
    if scene.gone == "ended":
        return f"STOP has nothing to stop: the service was told to end, and left the rig at standstill. {look}"
    return f"STOP has not reached the service: {error}. Use the machine's own stop."


def farewell(scene: ScreenScene) -> str:
    """Return what is said when the screen is left."""
    if scene.gone == "died":
        return ("the service has died: nothing controls the rig. Look that it stands; `tester tui` starts another "
                "service")  # fmt: skip
    if scene.gone == "ended":
        return "the service has ended; `tester tui` starts another"
    if scene.lost or scene.state is None:
        return "no link to a service: whether a run goes on is not known here. `tester status` looks"
    return "detached: the service and its run go on. `tester tui` comes back, `tester stop` stops the rig"


SMALLEST = (60, 15)
"""Columns and lines from which on the screens are shown."""


class SmallPanel(Panel):
    """That the run goes on, the question that waits, why the rig is in its mode."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return some lines."""
        needed = f"needed: {SMALLEST[0]} x {SMALLEST[1]}"
        texts = ["terminal too small,", gone_line(scene) or "the run continues", needed]
        if scene.state is not None:
            if scene.state.prompt is not None:
                texts.append(f"asks: {clean(scene.state.prompt.text)}")
            texts.append(clean(scene.state.mode_text))
        lines: list[Parts] = [[fit(text, width)] for text in texts[:height]]
        return rows(lines)
