"""`tester commission RIG --tui`: a screen that guides a person; the engine runs in a separate thread."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import ClassVar

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical
from textual.content import Content
from textual.events import Resize
from textual.screen import Screen
from textual.types import CSSPathType
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from tester.base import clock, keys
from tester.base.trouble import in_words
from tester.machine.commission.record import RecordError
from tester.machine.prompts import BACK, Asks, Question
from tester.tui.dialogs.dialog import Dialog, TextDialog
from tester.tui.formatting import clean
from tester.tui.guide.guide import Guide, GuideView
from tester.tui.guide.panels import (
    EndLine,
    GuideLine,
    GuidePanel,
    HintPanel,
    QuestionPanel,
    ReadingsPanel,
    SaidPanel,
    step_row,
)
from tester.tui.screen_scene import ScreenScene
from tester.tui.stop_line import stopping
from tester.tui.theme import STYLES, LookApp
from tester.tui.widgets.head import KeyLine

DRAWN_S = 0.1
"""Period for reading the engine's state, s."""
SEEN_S = 0.3
"""Time after a question appears within which an answer counts as typed before it, s [A]."""
KEYS = (("Enter", "Answer"), ("Tab", "Steps"), ("space", "Hold"), ("r", "Continue"), ("F1", "Help"), ("^C", "Leave"))
HELP = """\
F12, Ctrl+X  STOP: gives up the step at once, without asking; everything comes to rest. The step starts again later.
F9, Ctrl+F   FAST STOP, the same way.
space  HOLD of a recipe that runs, r ends it. Any other step cannot be held: space is STOP while something may move.

Enter  answers. A word may be shortened while it is unambiguous: y for yes. Motion needs the whole word go.
Tab    to the steps and back; Enter on a step shows its record.
r      begins, or continues at the first open step; it reads the rig file again.
Ctrl+C  leaves. A step under way is stopped first, and starts again the next time.

On a real rig STOP is no emergency stop: that is hardware.
"""


class GuideApp(LookApp):
    """Steps on the left; readings, question and messages on the right."""

    TITLE = "friction-tester"
    CSS_PATH: ClassVar[CSSPathType | None] = [STYLES, Path(__file__).with_name("guide.tcss")]
    ENABLE_COMMAND_PALETTE = True
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c,ctrl+q", "leave", "Leave", priority=True, show=False),
        Binding("q", "leave", "Leave", show=False),
        Binding("space", "hold", "Hold", show=False),
        Binding("r", "go_on", "Continue", show=False),
        Binding("f1", "help", "Help", show=False),
    ]

    def __init__(
        self, guide: Guide, *, theme: str = "", plain: bool = False, now: Callable[[], float] = clock.monotonic
    ) -> None:
        """``now`` returns seconds, by default of tester.base.clock.monotonic."""
        super().__init__(theme, plain=plain)
        self.guide = guide
        self.driver_class = stopping(self.driver_class, guide.person)
        self.seen: GuideView = guide.view()
        self._now = now
        self._asked: Question | None = None
        self._asked_s = 0.0
        self._leaving = False
        self._listed: list[tuple[str, str]] = []

    def compose(self) -> ComposeResult:
        """Lay out the panels."""
        yield GuideLine(id="state")
        yield EndLine(id="tabs")
        with Horizontal(id="guide"):
            steps = OptionList(id="guide-steps", markup=False)
            steps.border_title = "Steps"
            yield steps
            with Vertical(id="guide-right"):
                yield ReadingsPanel(id="guide-readings", classes="box", title="The rig shows")
                with Vertical(id="guide-question", classes="box") as question:
                    question.border_title = "Question"
                    yield QuestionPanel(id="guide-text")
                    yield HintPanel(id="guide-hint")
                    yield Input(id="guide-answer", compact=True, max_length=200, disabled=True)
                yield SaidPanel(id="guide-said", classes="box", title="Messages")
        yield KeyLine(id="keys")

    def on_mount(self) -> None:
        """Start the engine, which connects nothing before a person answers yes to a step."""
        self.choose_colours()
        line = self.query_one(KeyLine)
        line.keys = KEYS
        line.show(ScreenScene())
        self.query_one("#guide-steps").focus()
        self.guide.begin()
        self.set_interval(DRAWN_S, self.look)
        self.look()

    def on_resize(self, event: Resize) -> None:
        """Lay out for the new size."""
        self.size_classes(event, "-small")

    def look(self) -> None:
        """Show the engine's state."""
        base = self.screen_stack[0] if self.screen_stack else None
        if base is None or not base.query("#keys"):
            return
        seen = self.seen = self.guide.view()
        if self._leaving and not seen.running:
            self.exit("")
            return
        if seen.question is not self._asked:
            self._ask(base, seen.question)
        base.set_class(not seen.running, "-ended")
        for panel in base.query(GuidePanel):
            panel.see(seen)
        self._list(base, seen)

    def _ask(self, base: Screen[object], question: Question | None) -> None:
        """Show another question, and discard text typed for the previous one."""
        self._asked, self._asked_s = question, self._now()
        base.query_one(HintPanel).refusal = ""
        field = base.query_one("#guide-answer", Input)
        field.value = ""
        field.disabled = question is None
        if question is None:
            base.query_one("#guide-steps").focus()
        else:
            field.focus()

    def _list(self, base: Screen[object], seen: GuideView) -> None:
        listed = base.query_one("#guide-steps", OptionList)
        width = max(listed.scrollable_content_region.width, 20)
        drawn = [step_row(step, seen, width) for step in seen.steps]
        labels = [part if isinstance(part, tuple) else (part, "") for part in drawn]
        if labels == self._listed:
            return
        at, self._listed = listed.highlighted, labels
        options = [
            Option(Content.assemble(part), id=step.step.name) for part, step in zip(labels, seen.steps, strict=True)
        ]
        listed.set_options(options)
        listed.highlighted = at if at is not None else 0

    # -- answers ----------------------------------------------------------------------------------------------

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Answer the question, if the answer is valid."""
        event.stop()
        question = self._asked
        if question is None or self._now() - self._asked_s < SEEN_S:
            return
        answer = completed(question, event.value)
        refusal = question.refusal(answer)
        hint = self.screen_stack[0].query_one(HintPanel)
        hint.refusal = refusal
        hint.redraw()
        if not refusal and self.guide.person.answer(question, answer):
            self.guide.person.message(f"> {answer}")
            event.input.value = ""
            self.look()

    def on_input_changed(self, event: Input.Changed) -> None:
        """Remove the refusal when another answer is typed."""
        hint = self.screen_stack[0].query_one(HintPanel)
        if event.value and hint.refusal:
            hint.refusal = ""
            hint.redraw()

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Show the record of a step."""
        event.stop()
        name = event.option.id or ""
        try:
            text = self.guide.on_record(name)
        except (RecordError, OSError) as error:
            self.say(in_words(error), problem=True)
            return
        step = next(shown for shown in self.seen.steps if shown.step.name == name)
        about = f"{clean(step.step.title)}: {clean(step.words)}"
        self.push_screen(TextDialog(f"On record: {name}", "\n\n".join([about, *map(clean_text, text.split("\n\n"))])))

    # -- keys -------------------------------------------------------------------------------------------------

    def action_stop(self) -> None:
        """STOP, without a confirmation, in every dialog; the terminal's thread has already sent it."""
        self._stop(fast=False)

    def action_fast_stop(self) -> None:
        """Stop with a quick stop of the drives."""
        self._stop(fast=True)

    def _stop(self, *, fast: bool) -> None:
        if not self.guide.running:
            self.say("nothing is under way")
            return
        self.guide.person.press(fast=fast)
        self.say("FAST STOP taken" if fast else "STOP taken")

    def action_hold(self) -> None:
        """HOLD a recipe. Any other step cannot be held: stop it if something may move."""
        guide = self.guide
        if guide.running and guide.recipe_runs and guide.person.asked is None:
            guide.person.command(keys.HOLD.command)
        elif guide.moving:
            self._stop(fast=False)
        else:
            self.say("nothing moves before you answer")

    def action_go_on(self) -> None:
        """End HOLD, or continue at the first step that is not done."""
        if self.guide.running:
            if self.guide.recipe_runs:
                self.guide.person.command(keys.RELEASE.command)
            return
        self.guide.begin()
        self.look()

    def action_leave(self) -> None:
        """Leave the screen; first stop a step under way."""
        if not self.guide.running:
            self.exit("")
            return
        self._leaving = True
        question = self.guide.person.asked
        if self.seen.now or question is None or not self.guide.person.answer(question, "no"):
            self.guide.person.press()

    def action_help(self) -> None:
        """Show the keys."""
        if not isinstance(self.screen, Dialog):
            self.push_screen(TextDialog("Help", HELP))

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """Return the commands of the palette (Ctrl+P)."""
        yield SystemCommand("STOP", "Give the step up, at once (F12, Ctrl+X)", self.action_stop)
        yield SystemCommand("FAST STOP", "The same, fast (F9, Ctrl+F)", self.action_fast_stop)
        yield SystemCommand("Continue", "Begin, or continue at the first open step (r)", self.action_go_on)
        yield SystemCommand("Help", "Keys of this screen (F1)", self.action_help)
        yield SystemCommand("Leave", "A step under way is stopped first (Ctrl+C)", self.action_leave)


def completed(question: Question, typed: str) -> str:
    """Return an answer, completing a word if exactly one choice begins with it."""
    text = typed.strip()
    if question.asks is not Asks.CHOICE or not text or text in question.choices:
        return text
    words = (*question.choices, BACK) if question.back else question.choices
    matching = [choice for choice in words if choice.startswith(text)]
    return matching[0] if len(matching) == 1 else text


def clean_text(paragraph: str) -> str:
    """Return a paragraph of the record as displayable text, keeping its lines."""
    return "\n".join(clean(line) for line in paragraph.split("\n"))
