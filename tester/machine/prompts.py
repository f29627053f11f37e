"""Questions for a person. A prompt waits, with the drives off, until it is answered."""

from __future__ import annotations

from dataclasses import dataclass, field

DONE, NOT_YET = "yes", "no"
"""The exact words that answer a question; the second leaves it waiting."""


@dataclass(slots=True)
class Prompt:
    """One question; ``answer`` is None while it waits."""

    number: int
    at_s: float
    text: str
    answer: str | None = None
    by: str = ""
    """Who answered; "" if unknown."""


@dataclass(slots=True)
class Prompts:
    """The prompts of a run, oldest first. ``automatic``: answer "yes" at once (``--yes``).

    ``real``: on a real rig, where only a person can answer a prompt that asks them to come near the machine.
    """

    automatic: bool = False
    real: bool = False
    asked: list[Prompt] = field(default_factory=list[Prompt])

    def answers_itself(self, *, near: bool) -> bool:
        """Return whether the prompt is answered automatically. ``near``: it asks a person to come near the machine."""
        return self.automatic and not (near and self.real)

    def ask(self, now: float, text: str, *, near: bool = True) -> Prompt:
        """Ask a question and return its prompt; it may already be answered."""
        answer = "yes (automatic)" if self.answers_itself(near=near) else None
        prompt = Prompt(len(self.asked) + 1, now, text, answer)
        self.asked.append(prompt)
        return prompt

    @property
    def waiting(self) -> Prompt | None:
        """The oldest unanswered prompt."""
        for prompt in self.asked:
            if prompt.answer is None:
                return prompt
        return None
