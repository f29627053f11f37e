"""The simulated person of the wheel's rig."""

from __future__ import annotations

from typing import Final

from tester.kinds.wheel_on_belt.commission.jog import AXES as JOGGED
from tester.machine.commission.scripted import ScriptedPerson, words_of
from tester.machine.prompts import Asks, Question

STILL_M_S: Final = 0.002
"""Slowest motion that a person sees, m/s [A]."""


class TwinPerson(ScriptedPerson):
    """Reads the instruments of a simulated wheel rig (sim.machines.wheel_on_belt.rig.WheelRig)."""

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        if words_of(question)[0] == "hang":
            self.hands.hang(*self.hung(question))

    def hung(self, question: Question) -> tuple[float, float, float]:
        """Return the forces of the weight in a question, N: key ``hang CHANNEL NEWTONS``."""
        _, channel, newtons = words_of(question)
        force = float(newtons)
        return (force, 0.0, 0.0) if channel == "x" else (0.0, force, 0.0) if channel == "y" else (0.0, 0.0, force)

    def answer(self, question: Question) -> str:
        words = words_of(question)
        if question.asks is Asks.KEY:
            return super().answer(question)
        if words[0] == "hang":
            return repr(abs(sum(self.hung(question))))
        if words[0] == "angle":
            return f"{self.hands.ruler(words[1]):.1f}"
        if words[0] == "watchdog":
            still = abs(self.hands.rim_m_s) < STILL_M_S and abs(self.hands.belt_m_s) < STILL_M_S
            return question.choices[0 if still else 1]
        if words[0] == "compound" and question.asks is Asks.TEXT:
            return "1#"
        if words[0] == "diameter":
            return f"{self.hands.ruler('diameter'):.2f}"
        if words[0] == "spring":
            return f"{self.hands.ruler('spring'):.1f}"
        return super().answer(question)

    def others_move(self) -> bool:
        return any(abs(self.hands.ruler(axis.name)) > 1e-6 for axis in JOGGED)
