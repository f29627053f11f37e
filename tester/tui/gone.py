"""Texts about a lost service: what happened to it, what the devices do by themselves, what to do."""

from __future__ import annotations

from tester.tui.formatting import clean, fit
from tester.tui.screen_scene import UNDER_WAY, ScreenScene
from tester.tui.theme import SMALLEST
from tester.tui.widgets.panel_base import Panel, Parts, rows

TITLE = "The service has died"
SHORT = "the service has died: nothing controls the rig. Use the machine's own stop"


def gone_line(scene: ScreenScene) -> str:
    """Return as a line what happened to the service; "" if unknown."""
    if scene.gone == "died":
        return SHORT
    return "the service has ended: `tester tui` starts another" if scene.gone == "ended" else ""


def death_text(scene: ScreenScene) -> str:
    """Return, in paragraphs, what a person must know and do after the service has died."""
    state = scene.state
    rig = clean(state.alone) if state is not None else ""
    lines = [
        "The process that owned the rig has died unexpectedly. Nothing controls the rig any more, and no STOP from "
        "here can reach it.",
        "",
        rig,
        "",
    ]
    todo = [
        f"Look at the machine: {clean(scene.machine.moves)} must not move. Otherwise, or in doubt, use the machine's "
        "emergency stop.",
        *(clean(check) for check in scene.machine.look),
        "Leave this screen (q) and start `tester tui` again: it starts another service. Nothing moves.",
    ]
    if state is not None and state.run is not None and state.run.outcome == UNDER_WAY:
        name = clean(state.run.name)
        todo.append(f"{name} is interrupted. Its committed data is kept: `r`, or `tester resume {name}`, resumes it.")
    return "\n".join([*lines, *(f"{number}. {item}" for number, item in enumerate(todo, 1))])


def stop_failed(scene: ScreenScene, error: str) -> str:
    """Return why STOP has failed, and what to do."""
    look = f"Use the machine's own stop, and check that {clean(scene.machine.moves)} do not move."
    if scene.gone == "died":
        rig = f" {clean(scene.state.alone)}" if scene.state is not None else ""
        return f"STOP cannot be taken: the service has died.{rig} {look}"
    if scene.gone == "ended":
        return f"STOP has nothing to stop: the service ended on request, and left the rig at standstill. {look}"
    return f"STOP has not reached the service: {error}. Use the machine's own stop."


def farewell(scene: ScreenScene) -> str:
    """Return the message to print on leaving the screen."""
    if scene.gone == "died":
        return ("the service has died: nothing controls the rig. Check that it is at rest; `tester tui` starts another "
                "service")  # fmt: skip
    if scene.gone == "ended":
        return "the service has ended; `tester tui` starts another"
    if scene.lost or scene.state is None:
        return "no link to a service: a run may still be under way. `tester status` shows it"
    return "detached: the service and its run continue. `tester tui` comes back, `tester stop` stops the rig"


class SmallPanel(Panel):
    """Shows whether the run continues, the waiting question, and the reason for the rig's mode."""

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
