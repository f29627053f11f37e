"""Wrong answers to commissioning, on a machine that matches its file: none may pass, or become advice.

A person types a wrong value at a question: ten times too much or too little (mm and cm), newtons as kilograms, the
other sign, only the distance since the last key, swapped digits, nothing at all, or takes an answer back. A person who
notices it at the second question passes the step with the right values. A person who insists is refused, and no line
for the rig file is advised, unless the factor is one that a gear can have, or that a diameter explains.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, Final

from drivers.gearing import gear_ratio
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.jog_axis import ROLLER_SHARE
from tester.machine.commission.stages import ONCE_MORE
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import BACK, Asks, Prompt, Question
from tests.campaigns.mistakes.mistake import Mistake
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench

ASKING: Final = tuple(step for step in STEPS if step.seat is not None and step.name not in ("rolling", "thermometer"))
"""The steps with questions for quantities."""
WRONG: Final[Mapping[str, Callable[[float, float], float]]] = {
    "ten times too much": lambda right, last: 10.0 * right,
    "a tenth": lambda right, last: 0.1 * right,
    "kilograms": lambda right, last: right / 9.81,
    "the other sign": lambda right, last: -right,
    "only since the last key": lambda right, last: right - last,
    "digits exchanged": lambda right, last: _exchanged(right),
}
"""Wrong values, computed from the right one and the reading before the last key."""
BACK_SHARE: Final = 0.1
MOST_BACKS: Final = 40
PARTS: Final = {"first": ("direction", "first read"), "further": ("whole read",)}
"""Quantities read again after each motion."""
PASSES: Final = 5e-3
"""Greatest allowed error of a recorded scale or gain."""


def _exchanged(right: float) -> float:
    """Return a number with its first two digits swapped."""
    digits = f"{abs(right):.2f}"
    places = [place for place, one in enumerate(digits) if one.isdigit()][:2]
    first, second = places
    turned = digits[:first] + digits[second] + digits[first + 1 : second] + digits[first] + digits[second + 1 :]
    return float(turned) * (1.0 if right >= 0.0 else -1.0)


class Errs(TwinPerson):
    """Answers some questions wrongly, by a seed, and corrects the answer when asked again; or insists at one
    question."""

    def __init__(self, seed: int, insists_at: str = "", wrong: str = "") -> None:
        """``insists_at``: the key of the question that is always answered with ``wrong``; "": every third,
        corrected."""
        super().__init__()
        self.random = Random(seed)
        self.insists_at, self.wrong = insists_at, wrong
        self.typed: list[tuple[str, str, float, float]] = []
        """Key, kind, right and typed value of every wrong answer."""
        self._last: dict[str, float] = {}
        self._backs = 0
        self._read: dict[str, str] = {}

    def attend(self, prompts: Any) -> None:
        prompt: Prompt | None = prompts.waiting
        if prompt is not None and prompt.question.asks is Asks.KEY:
            words = prompt.question.key.split()
            if words[0] == "jog" and self.hands is not None:
                self._last[words[1]] = self.hands.ruler(words[1]) - self._from.get(words[1], 0.0)
        super().attend(prompts)

    def answer(self, question: Question) -> str:
        if not self.insists_at and question.back and self._backs < MOST_BACKS and self.random.random() < BACK_SHARE:
            self._backs += 1
            return BACK
        right = self._right(question)
        if self.insists_at:
            words, at = question.key.removeprefix(ONCE_MORE).split(), self.insists_at.split()
            same = words == at or (words[0] == "retype" and at[0] == "hang" and words[1] == at[1])
            return self._err(question, right, self.wrong) if same and question.asks is Asks.QUANTITY else right
        if question.asks is Asks.QUANTITY and not question.key.startswith((ONCE_MORE, "retype")):
            if self.random.random() < 0.05:
                return ""
            if self.random.random() < 0.33:
                return self._err(question, right, self.random.choice(list(WRONG)))
        return right

    def _right(self, question: Question) -> str:
        """Return the right answer; a distance read before its instrument was set to zero stays as read."""
        key = question.key.removeprefix(ONCE_MORE)
        words = key.split()
        if words[0] != "jog":
            return super().answer(question)
        if question.asks is Asks.KEY:
            for part in PARTS.get(words[2], ()):
                self._read.pop(f"jog {words[1]} {part}", None)
            return super().answer(question)
        if key not in self._read or words[2] == "mark":
            self._read[key] = super().answer(question)
        return self._read[key]

    def _err(self, question: Question, right: str, kind: str) -> str:
        key = question.key.removeprefix(ONCE_MORE)
        value = float(right)
        typed = WRONG[kind](value, self._last.get(key.split()[1], 0.0) if key.startswith("jog") else value)
        self.typed.append((key, kind, value, typed))
        return f"{typed:.6g}"


def commissioned(seed: int, person: Errs, names: tuple[str, ...] = ()) -> tuple[Bench, str]:
    """Commission a clean machine; return its bench, and how it ended."""
    steps = tuple(step for step in ASKING if not names or step.name in names)
    with TemporaryDirectory() as folder:
        bench = Bench(Path(folder) / "record.jsonl", seed, person=person, steps=steps)
        outcome = bench.run()
    return bench, "" if outcome.ended is Ended.DONE else f"{outcome.step}: {outcome.text}"


def mended(seed: int) -> list[str]:
    """Return the faults after a person corrects every wrong answer: steps not done, or values off."""
    person = Errs(seed)
    bench, ended = commissioned(seed, person)
    wrong = [ended] if ended else []
    for step in ASKING:
        entry = bench.record.last(step.name)
        values = dict(entry.values) if entry is not None else {}
        off = values.get("scale_error", 0.0)
        if abs(off) > max(PASSES, 3.0 * values.get("standard_uncertainty", 0.0)):
            wrong.append(f"{step.name}: scale off by {off:.3g}")
        gains: dict[str, float] = values.get("gains", {})
        wrong += [f"F{name}: gain {gain:.4f}" for name, gain in gains.items() if abs(gain - 1.0) > 0.01]
    return wrong


QUESTIONS: Final = (
    *((f"jog {axis}", f"jog {axis} {part} read") for axis in ("wheel", "belt", "press", "sideslip", "camber")
      for part in ("first", "whole")),
    *(("cell", f"hang {channel} 100.0") for channel in "zxy"),
    ("spring", "spring weighed"),
    ("home", "angle sideslip"),
    ("touch", "diameter"),
)  # fmt: skip
"""Each question for a quantity that matters, with its step."""


def insisted(seed: int, step: str, key: str, kind: str) -> str:
    """Return the fault in the outcome of a wrong answer that a person insists on; "" if it is properly refused."""
    person = Errs(seed, key, kind)
    needed = ("touch", "home") if step == "touch" else (step,)
    _, ended = commissioned(seed, person, needed)
    if not person.typed:
        return f"{key} was not asked"
    _, _, right, typed = person.typed[-1]
    share = typed / right if right else 1.0
    if not ended:
        close = abs(share - 1.0) < 0.06 or abs(typed - right) < 0.5
        return "" if close else f"{key}, {kind}: {typed:g} passed where {right:g} is right"
    advised = re.search(r"[Ii]n the rig file: |Multiply ", ended)
    if advised is None or (share <= 0.0 and not ended.startswith("home")):
        return f"{key}, {kind}: advice from another sign: {ended}" if advised and share <= 0.0 else ""
    explained = 1.0 / ROLLER_SHARE <= share <= ROLLER_SHARE or (share > 0.0 and gear_ratio(share, 0.05) is not None)
    return "" if explained or ended.startswith("home") else f"{key}, {kind}: advice by a factor of {share:.3g}: {ended}"


def _all_of(seed: int) -> list[str]:
    """Insist on one kind of wrong value at every question."""
    drawn = Random(seed)
    found = [insisted(seed, step, key, drawn.choice(list(WRONG))) for step, key in QUESTIONS]
    return [one for one in found if one] or ["every wrong answer is refused, without unsound advice"]


def _all_mended(seed: int) -> list[str]:
    return mended(seed) or ["every step passes with the right values"]


MISTAKES: Final[tuple[Mistake, ...]] = (
    Mistake("wrong answers at every third question, mended when asked once more", "^every step passes", _all_mended),
    Mistake("a wrong answer at each question, insisted on", "^every wrong answer is refused", _all_of),
)


def clean(seed: int) -> list[str]:
    """Return the findings about a person without errors: none."""
    _, ended = commissioned(seed, Errs(seed, "nowhere"), ("identify", "jog belt"))
    return [ended] if ended else []
