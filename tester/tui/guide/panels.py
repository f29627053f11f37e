"""Panels of the commissioning screen: fixed lines, steps, the rig's readings, the question, messages."""

from __future__ import annotations

from math import isfinite
from textwrap import wrap
from typing import Final

from tester.base.words import NONE, decimal, duration
from tester.machine.commission.commission_step import StepReading
from tester.machine.commission.record import StepStanding
from tester.machine.commission.step_engine import Ended
from tester.tui.formatting import clean, fit
from tester.tui.guide.guide import GuideView
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.panel_base import ABNORMAL, FAINT, NOTICE, WARNING, Panel, Part, Parts, rows

TIME: Final = 8
"""Width of a step's time, columns."""
LABEL: Final = 19
CELL: Final = 9
BAD: Final = frozenset({Ended.REFUSED, Ended.FAILED, Ended.STOPPED})


class GuidePanel(Panel):
    """Shows a part of a GuideView."""

    seen: GuideView | None = None

    def see(self, seen: GuideView) -> None:
        """Use this view from now on."""
        self.seen = seen
        self.show(self.scene or ScreenScene())

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the panel's content for ``width`` columns and ``height`` rows."""
        return [] if self.seen is None else self.drawn(self.seen, width, height)

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        """Return the content for a view."""
        return []


class GuideLine(GuidePanel):
    """Line 1: the rig, the number of steps done, and the rig time of all steps, including the one under way."""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        total = sum(seen.rig_s.values()) + (seen.live.now_s if seen.live is not None else 0.0)
        simulated = ", simulated" if seen.simulated else ""
        text = f"  {seen.stand} of {len(seen.steps)} steps stand   rig time {duration(total)}   {clean(seen.rig, 40)}"
        title = " COMMISSIONING "
        return [(title, "bold reverse"), fit(f"{text}{simulated}", width - len(title))]


class EndLine(GuidePanel):
    """Line 2: the present activity; once the engine has ended, the outcome and how to resume."""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        text, style = end_words(seen)
        return [(fit(f" {text}", width).ljust(width), style)]


def end_words(seen: GuideView) -> tuple[str, str]:
    """Return the present activity or outcome in words, and its style."""
    if seen.trouble:
        return f"{clean(seen.trouble)} (r tries again)", ABNORMAL
    outcome = seen.outcome
    if outcome is not None:
        at = f" at {outcome.step}" if outcome.step else ""
        why = f": {clean(outcome.text)}" if outcome.text else ""
        again = "" if outcome.ended is Ended.DONE else ". r continues at the first open step"
        return f"{outcome.ended.value}{at}{why}{again}", ABNORMAL if outcome.ended in BAD else "bold"
    if not seen.now:
        return f"nothing is connected, nothing moves. Next: {seen.next or NONE}", ""
    if seen.question is not None:
        return f"{seen.now}: waits for your answer", "bold"
    return f"{seen.now}: under way", NOTICE


def step_row(one: StepStanding, seen: GuideView, width: int) -> Part:
    """Return a step as a row: sign, name, its rig time or state."""
    name, style, sign, word = one.step.name, "", "·", ""
    if name == seen.now:
        sign, style, word = "▶", "bold", f"now {duration(seen.live.now_s)}" if seen.live is not None else "now"
    elif one.stands is not None:
        sign, style, word = "✔", FAINT, duration(seen.rig_s.get(name, 0.0))
    elif name == seen.next:
        sign, style, word = "▸", "bold", "next"
        sign = "✘" if one.last is not None else sign
    elif one.last is not None:
        sign, word = "✘", "again"
    room = max(width - TIME - 3, 4)
    return f"{sign} {fit(clean(name), room).ljust(room)} {word:>{TIME}}", style


class ReadingsPanel(GuidePanel):
    """The rig's readings that are relevant to the step."""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        if seen.live is None:
            return [("the rig is not connected", FAINT)]
        if not seen.live.readings:
            return [("connecting, or nothing to show in this step", FAINT)]
        return rows([reading_row(reading, width) for reading in seen.live.readings[:height]])


def reading_row(one: StepReading, width: int) -> Parts:
    """Return a reading as a row: label, value, unit, words."""
    value = decimal(one.value, one.decimals) if isfinite(one.value) else "" if one.words and not one.unit else NONE
    text = f"{fit(clean(one.label), LABEL):<{LABEL}}{value:>{CELL}} {clean(one.unit, 5):<5} {clean(one.words)}"
    return [fit(text.rstrip(), width)]


class QuestionPanel(GuidePanel):
    """The waiting question."""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        if seen.question is not None:
            text, style = clean(seen.question.text), "bold"
        elif seen.running:
            text, style = "no question: the step is under way" if seen.now else "", FAINT
        else:
            text, style = end_words(seen)[0], "bold"
        return rows([[(line, style)] for line in wrap(text, width)[:height]])


class HintPanel(GuidePanel):
    """The valid answers, or why the last answer was refused."""

    refusal = ""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        if self.refusal:
            return [(fit(f" {clean(self.refusal)}", width), WARNING)]
        return [(fit(f"[{clean(seen.question.hint)}]", width), FAINT)] if seen.question is not None else []


class SaidPanel(GuidePanel):
    """The engine's messages, newest last."""

    def drawn(self, seen: GuideView, width: int, height: int) -> Parts:
        lines: list[Parts] = []
        for text in reversed(seen.messages):
            style = said_style(text)
            for line in reversed(wrap(clean(text), width, subsequent_indent="  ") or [""]):
                lines.append([(line, style)])
            if len(lines) >= height:
                break
        return rows(list(reversed(lines[:height])))


def said_style(text: str) -> str:
    """Return the style of a message."""
    if text.startswith(("REFUSED", "FAILED")):
        return ABNORMAL
    return FAINT if text.startswith("  on record") else "bold" if text.startswith("passed") else ""
