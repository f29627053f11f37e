"""The drawn commissioning screen, compared with golden/: `TESTER_GOLDEN=write` rewrites it."""

from __future__ import annotations

import asyncio
import os
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import pytest

from tester.machine.commission.commission_step import CommissionStep, StepReading
from tester.machine.commission.record import DONE, REFUSED, RecordEntry, StepStanding
from tester.machine.commission.step_engine import CommissionOutcome, Ended
from tester.machine.prompts import Asks, Question
from tester.tui.guide.guide import GuideView
from tester.tui.guide.guide_app import GuideApp
from tester.tui.guide.guide_person import Live, ScreenPerson
from tests.tester.service.views import HOSTILE
from tests.tester.tui.stage import screen_text

GOLDEN = Path(__file__).parent / "golden"
SIZES = {"80x24": (80, 24), "120x40": (120, 40)}
NAMES = ("identify", "jog wheel", "jog belt", "jog press", "cell", "home", "first")


def standing(name: str, what: str) -> StepStanding:
    entry = RecordEntry("2026-11-23T10:00:00Z", "A. Name", "mine", "", "", name, what, "passed", {"rig_s": 41.5})
    step = CommissionStep(name, f"title of {name}", ())
    return StepStanding(step, entry if what == DONE else None, entry if what else None)


READINGS = (
    StepReading("belt speed", 12.344, "mm/s", 2, "has power"),
    StepReading("moved in all", nan, "mm", 2),
    StepReading("guard, safety chain", nan, "", 0, "closed"),
    StepReading("Fz, raw", -0.149, "N", 2),
)
QUESTION = Question("jog belt direction", "did the belt, and only it, move so that its upper side goes the way of the "
                    "arrow? (reversed: the other way; other: another axis moved; nothing: nothing did)", Asks.CHOICE,
                    ("yes", "reversed", "other", "nothing"))  # fmt: skip
ASKED = GuideView(
    "my rig", False, tuple(standing(name, DONE if at < 2 else "") for at, name in enumerate(NAMES)), "jog belt",
    "jog press", {"identify": 2.3, "jog wheel": 41.5}, Live("jog belt", 12.0, READINGS), QUESTION,
    ("1/7 title of identify: done (2026-11-23, A. Name): 8 devices", "> go"), True, None, "",
)  # fmt: skip
MOVING = replace(ASKED, question=None)
REFUSAL = ("scale of the belt axis: it moved 1.25 times as far as its drive reports, more than 1 % off. In the rig"
           " file: axes.belt.velocity_increments: 1234567 (now 1543209)")  # fmt: skip
ENDED = replace(
    MOVING,
    steps=tuple(
        standing(name, DONE if at < 2 else REFUSED if at == 2 else "") for at, name in enumerate(NAMES)
    ),
    now="", next="jog belt", live=None, running=False, outcome=CommissionOutcome(Ended.REFUSED, "jog belt", REFUSAL),
    messages=(*ASKED.messages, f"REFUSED: {REFUSAL}"),
)  # fmt: skip
VIEWS = {"asked": ASKED, "moving": MOVING, "refused": ENDED}


class StillGuide:
    """Shows one view for ever."""

    running = moving = recipe_runs = False

    def __init__(self, view: GuideView) -> None:
        self.person = ScreenPerson(time_stands=True)
        self.shown = view

    def view(self) -> GuideView:
        return self.shown

    def begin(self) -> None:
        """Nothing."""


def drawn(view: GuideView, size: tuple[int, int], **kind: Any) -> str:
    async def main() -> str:
        app = GuideApp(StillGuide(view), theme="dark", **kind)  # type: ignore[arg-type]
        async with app.run_test(size=size) as pilot:
            await pilot.pause()
            app.look()
            await pilot.pause()
            return screen_text(app)  # type: ignore[arg-type]

    return asyncio.run(main())


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", VIEWS)
def test_the_screen_looks_as_it_did(name: str, size: str) -> None:
    file, text = GOLDEN / f"{name}-{size}.txt", drawn(VIEWS[name], SIZES[size])
    if os.environ.get("TESTER_GOLDEN") == "write":
        file.write_text(text + "\n", encoding="utf-8")
    assert text + "\n" == file.read_text(encoding="utf-8")


def test_every_size_has_the_question_or_how_it_ended_and_stop() -> None:
    for size in ((200, 50), (80, 24), (59, 14), (40, 10)):
        for view, words in ((ASKED, "did the belt"), (ENDED, "refused at jog belt")):
            text = drawn(view, size)
            assert words in text and "STOP" in text.split("\n")[-1], text


def test_with_ascii_nothing_else_leaves() -> None:
    assert drawn(ASKED, SIZES["120x40"], plain=True).isascii()


def test_hostile_text_is_shown_and_never_obeyed() -> None:
    view = replace(
        ENDED, rig=HOSTILE, messages=(HOSTILE,), trouble=HOSTILE, running=True,
        question=replace(QUESTION, text=HOSTILE, choices=(HOSTILE,)),
        live=Live(HOSTILE, 1.0, (StepReading(HOSTILE, 1.0, HOSTILE, 1, HOSTILE),)),
    )  # fmt: skip
    text = drawn(view, SIZES["120x40"])
    assert "[/x] [bold]" in text and not any(sign in text for sign in "\x1b\x00\u202e")
