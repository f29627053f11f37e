"""The simulated person of a specimen on a track."""

from __future__ import annotations

from tester.kinds.specimen_on_track.commission.axes_to_jog import LIFT
from tester.machine.commission.scripted import ScriptedPerson, words_of
from tester.machine.prompts import Asks, Question


class TrackPerson(ScriptedPerson):
    """Reads the instruments of a simulated track (sim.machines.specimen_on_track.rig.TrackRig)."""

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        words = words_of(question)
        if words[0] == "jog":
            for axis in ("track", LIFT.name):
                self._stood.setdefault(axis, self.hands.ruler(axis))
        elif words[0] == "hang":
            self.hands.hang(float(words[2]) * (-1.0 if words[1] == "back" else 1.0))
        elif words[0] == "weigh":
            self.hands.put_on(float(words[1]))
        elif words[0] == "block":
            if not self.hands.mounted[1]:
                self.hands.install(1, "SBR")
            self.hands.put_on(0.0)
            self.hands.gauge(float(words[1]))
        elif words[0] == "keep":
            self.hands.gauge(None)
        elif words[0] == "switch":
            self.hands.hold_switch(words[2] == "held")

    def at(self, hands: object) -> None:
        super().at(hands)
        self._stood: dict[str, float] = {}
        """Places of the axes when the step began to jog."""

    def answer(self, question: Question) -> str:
        words = words_of(question)
        if question.asks is Asks.KEY:
            return super().answer(question)
        if words[0] == "jog" and words[2] == "radius":
            return f"{self.hands.ruler('radius'):.1f}"
        if words[0] == "hang":
            return words[2]
        if words[0] == "weigh":
            return f"{self.hands.ruler('load'):.2f}"
        if words[0] == "left":
            return f"{self.hands.ruler('left'):.1f}"
        if words[0] == "second":
            return f"{self.hands.ruler('air'):.1f}"
        if words[0] == "compound" and question.asks is Asks.TEXT:
            return "SBR"
        return super().answer(question)

    def others_move(self) -> bool:
        return any(abs(self.hands.ruler(axis) - stood) > 1e-6 for axis, stood in self._stood.items())
