"""The load by weighing the arm: a spring balance at the specimen lifts it off its rest, without weights and with each.

The load enters every coefficient, and no sensor of the rig measures it.
"""

from __future__ import annotations

from functools import partial
from typing import Final

from sim.physics.track_bells import RUBBERS
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Dialogue, Notes, StepRefused
from tester.machine.commission.compound import ask_compound
from tester.machine.commission.hung_channel import GRAVITY, UNIT_SHARE
from tester.machine.commission.quiet_seat import QuietSeat
from tester.machine.commission.stages import in_stages, measured_twice

LOAD_SHARE: Final = 0.02
"""Tolerance of a load [A]: a coefficient is off by as much; a spring balance is good to 1 %."""
READING_N: Final = 0.1
"""What a balance is read to, N [A]."""


def weigh(seat: QuietSeat, notes: Notes) -> Dialogue:
    """Weigh the arm; raises StepRefused."""
    weighed = _Weighed(TrackConfig.of(seat.believed), notes)
    points = (partial(weighed.point, weight_n) for weight_n in weighed.rig.weights)
    yield from in_stages(notes, weighed.empty, *points, weighed.specimen)


class _Weighed:
    """The stages of the weighing."""

    def __init__(self, rig: TrackConfig, notes: Notes) -> None:
        """Nothing is weighed yet."""
        self.rig, self.notes = rig, notes
        self.loads_n: dict[float, float] = {}
        self.arm_n = 0.0

    def empty(self) -> Dialogue:
        """Ask for the load of the arm alone, which has to be balanced."""
        most_n = LOAD_SHARE * self.rig.weights[0]
        text = (
            "no weights on the arm, specimen in: lift it at the specimen by a spring balance until it floats; what does"
            " the balance show (below 0: the arm rises by itself)?"
        )
        why = f"a balanced arm has 0 within {most_n:g} N"
        self.arm_n = yield from measured_twice("weigh 0.0", text, "N", lambda n: "" if abs(n) <= most_n else why)
        if not abs(self.arm_n) <= most_n:
            raise StepRefused(
                f"the arm is not balanced: it presses with {self.arm_n:+.2f} N without weights, at most {most_n:g} N is"
                f" {100 * LOAD_SHARE:g} % of the least load (weights). Shift its counterweight; a cable may pull at it"
            )

    def _most_n(self, weight_n: float) -> float:
        return LOAD_SHARE * weight_n + READING_N

    def point(self, weight_n: float) -> Dialogue:
        """Ask for the load with a set of weights on the arm."""
        most_n = self._most_n(weight_n)
        text = f"weights of {weight_n:g} N on the arm: lift it at the specimen until it floats; what does it show?"
        read = yield from measured_twice(
            f"weigh {weight_n}", text, "N", lambda n: "" if abs(n - weight_n) <= most_n else f"{weight_n:g} N expected"
        )
        self.loads_n[weight_n] = read
        self.notes.read(f"weights of {weight_n:g} N", {"weighed_n": read})
        if abs(read - weight_n) <= most_n:
            return
        found = f"load: the weights of {weight_n:g} N press with {read:g} N, more than {most_n:.2f} N off."
        share = read / weight_n
        if any(abs(share / unit - 1.0) <= UNIT_SHARE for unit in (1.0 / GRAVITY, GRAVITY, 1000.0 / GRAVITY)):
            raise StepRefused(f"{found} That is kilograms or grams for newtons, of the balance or in weights")
        raise StepRefused(
            f"{found} The lever from weights to specimen, the masses, or a bearing that rubs. If the balance is right:"
            f" the rig file's weights with {read:g} for {weight_n:g}"
        )

    def specimen(self) -> Dialogue:
        """Ask for the specimen's compound, and record what was found."""
        compound = yield from ask_compound(self.notes, RUBBERS, "specimen")
        loads = {f"{weight_n:g}": read for weight_n, read in self.loads_n.items()}
        self.notes.values = {"arm_n": self.arm_n, "loads_n": loads, "compound": compound}
        off = max(abs(read / weight_n - 1.0) for weight_n, read in self.loads_n.items())
        self.notes.text = (
            f"arm {self.arm_n:+.2f} N without weights; loads within {100 * off:.1f} % of the weights"
            f" (standard uncertainty {50 * READING_N / self.rig.weights[0]:.1f} % of the least); specimen of {compound}"
        )
