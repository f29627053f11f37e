"""`python -m tests.campaigns.stopped [--sample]`: the heat in a contact with one part at standstill, at the worst
moments.

Rig files and recipes are drawn by seed: late scans of 20 to 150 ms, weak or strong brakes and torque limits, slow or
quick scans, any compound, load and temperature. Without a standstill relay `tester check` accepts the recipe or refuses
it. An accepted one runs on a twin that differs from its file; in its contacts the belt or the wheel jams together with
the latest allowed scan, something blocks the belt, or one part does not brake. No case may reach harm. A refused recipe
is accepted with the relay, its record must name this condition, and the same faults show the relay's purpose.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

from sim.faults import Injection
from sim.faults.common import ALWAYS, MAY
from sim.faults.drives import BrakesWeakly
from sim.faults.kinds import FaultKind
from sim.faults.language import FaultTime
from tester.inputs.recipe.loader import check
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.stopped_contact import HARMFUL_J
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal
from tests.campaigns.faults.corners import GROUND_IN
from tests.campaigns.faults.moments import Twins
from tests.campaigns.faults.recipes import language_of
from tests.campaigns.faults.stage import Stage

ACCEPTED, REFUSED = 40, 12
"""Rigs with a recipe that `check` accepts without the relay, and refuses."""
SAMPLE_ACCEPTED, SAMPLE_REFUSED = 4, 1
MOMENTS = 16
"""Moments of each run at which faults begin; half as many in a sample."""
CONTACT_S = (0.02, 3.0)
"""Between two of them in contact, s; a soak is skipped after the first."""
NO_RELAY, RELAY = "arming.standstill_relay=false", "arming.standstill_relay=true"
MOST_N, HALVINGS, HEAVIEST = 430.0, 6, 0.7
"""Greatest load; halvings of the range up to it; share of the accepted rigs with the greatest load accepted."""
FIRM = 0.8
"""Minimum share of its load at which a contact is tried: less load means less heat."""
WATCHED_S = 1.5
WEAK = {axis: FaultKind(f"{axis} brakes weakly", partial(BrakesWeakly, axis), ALWAYS, MAY, unit="%", value=2.0)
        for axis in ("wheel", "belt")}  # fmt: skip
"""Only in this campaign: the effect of a part that does not brake, together with any other fault, is bounded here."""
HELD = "belt slips on its roller 100 %"

_TEXT = """\
recipe: a contact whose wheel or belt stands
specimens: [{{compound: "{compound}"}}]
measure:
  wheel_speed: {wheel:.2f} m/s
  repeats: 1
  min_valid: 1
  window: 5 rev
  soak: {{within: 2 degC, for: 2 s}}
grids:
  - {{name: drawn, slip_velocity: {slip:.0f} mm/s, load: {load:.0f} N, temperature: {temperature:.0f} degC}}
"""


@dataclass(frozen=True, slots=True)
class Drawn:
    """A rig file and a recipe; ``unlike``: differences of the twin."""

    text: str
    file: tuple[str, ...]
    unlike: tuple[str, ...]
    late_ms: float
    load_n: float
    name: str

    def at_load(self, load_n: float) -> Drawn:
        """Return the same at another load, N."""
        text, name = (words.replace(f"{self.load_n:.0f} N,", f"{load_n:.0f} N,") for words in (self.text, self.name))
        return replace(self, text=text, name=name, load_n=load_n)

    def heaviest(self) -> Drawn:
        """Return the same at approximately the greatest load that ``check`` accepts without the relay."""
        best, most_n = self, MOST_N
        for _ in range(HALVINGS):
            tried = self.at_load(0.5 * (best.load_n + most_n))
            best, most_n = (tried, most_n) if tried.accepted(NO_RELAY) else (best, tried.load_n)
        return best

    def accepted(self, relay: str) -> bool:
        """Return whether ``check`` accepts the recipe on the rig with this line about the relay."""
        rig = load_rig("sim", (*self.file, relay), accept_risk="drawn")
        return not check(self.text, rig, PART, "drawn.yaml")


@dataclass(slots=True)
class Outcome:
    """The result of a drawn rig: heat by fault (J, text), the conditions that its record names, and a trip before any
    fault."""

    drawn: Drawn
    heat: list[tuple[float, str]] = field(default_factory=list[tuple[float, str]])
    counts_on: str = ""
    tripped: str = ""


def draw(chooser: random.Random) -> Drawn:
    """Return a rig file and a recipe."""
    compound = chooser.choice(("1#", "2#", "3#"))
    load, wheel = 10.0 ** chooser.uniform(1.5, 2.63), chooser.uniform(0.4, 1.0)
    temperature, slip = chooser.choice((25.0, 30.0, 45.0)), 1e3 * chooser.uniform(0.05, 0.5) * wheel
    late_ms, quick = chooser.uniform(20.0, 150.0), chooser.uniform(9.0, 25.0)
    torque, enabled = chooser.choice((1000, 2000, 3000)), chooser.choice((20, 50, 100))
    file = (
        f"interlocks.late_scan={late_ms:.0f} ms", f"interlocks.late_warn={min(late_ms, 50.0):.0f} ms",
        f"axes.belt.quick_stop_deceleration={quick:.2f}", f"axes.wheel.quick_stop_deceleration={quick / 0.045:.1f}",
        f"axes.wheel.max_torque_per_mille={torque}", f"axes.belt.max_torque_per_mille={torque}",
        f"scan.enabled={enabled} Hz",
    )  # fmt: skip
    unlike = (
        f"sim.contact.reference_stiffness={145.0 * chooser.uniform(0.75, 1.3):.1f} N/mm",
        f"sim.friction_heat_fraction={0.06 * chooser.uniform(0.7, 1.3):.3f}", GROUND_IN,
    )  # fmt: skip
    text = _TEXT.format(compound=compound, wheel=wheel, slip=slip, load=load, temperature=temperature)
    name = (f"{compound}, {load:.0f} N, {wheel:.2f} m/s, {temperature:.0f} degC, scans {enabled} Hz and up to"
            f" {late_ms:.0f} ms late, brakes {quick:.0f} m/s2, torque {torque} per mille")  # fmt: skip
    return Drawn(text, file, unlike, float(f"{late_ms:.0f}"), load, name)


def faults(chooser: random.Random, drawn: Drawn) -> list[tuple[str, float]]:
    """Return faults by phrase, each with its time from the next scan, s; a weak brake comes with another."""
    stalled, jam = f"scan stalled {drawn.late_ms:.0f} ms", chooser.choice(("belt jammed", "wheel jammed"))
    after_s = chooser.uniform(0.0005, 0.01)
    turning = "wheel" if jam.startswith("belt") else "belt"
    return chooser.choice((
        [(stalled, 0.0), (jam, after_s)], [(stalled, 0.0), (jam, after_s)], [(HELD, after_s)],
        [(jam, after_s), (f"{turning} brakes weakly", 0.0)],
        [("operator fast stop", after_s), (f"{chooser.choice(('wheel', 'belt'))} brakes weakly", 0.0)],
    ))  # fmt: skip


def heat_of(stage: Stage, order: list[tuple[str, float]]) -> float:
    """Return the heat with one part standing after these faults, J."""
    for phrase, after_s in order:
        weak = next((kind for kind in WEAK.values() if kind.phrase == phrase), None)
        fault = None if weak is not None else language_of("quick").parse(f"t=0 s: {phrase}")
        kind, value = (weak, weak.value) if weak is not None else (fault.kind, fault.value)  # type: ignore[union-attr]
        stage.inject(Injection(FaultTime(at_s=stage.next_s + after_s), kind, value, text=phrase))
    stage.observer.forget()
    end_s = stage.next_s + WATCHED_S
    while stage.next_s < end_s:
        stage.tick()
    return float(stage.observer.most_standing_j)


def conduct(drawn: Drawn, relay: str, chooser: random.Random, moments: int) -> Outcome:
    """Run a recipe once; in its contacts let copies of the run go on with faults."""
    stage = Stage(drawn.text, (*drawn.file, relay, *drawn.unlike), seed=chooser.randrange(1000))
    outcome = Outcome(drawn)
    due_s, tried = 0.0, 0
    while not stage.run.finished and tried < moments:
        stage.tick()
        if stage.trip or stage.run.reason:
            outcome.tripped = stage.trip or stage.run.reason
            break
        if stage.rig.plant.force_z_n < FIRM * drawn.load_n or stage.next_s < due_s or not stage.copyable:
            continue
        tried += 1
        due_s = stage.next_s + chooser.uniform(*CONTACT_S) * (10.0 if stage.place[1] == "soak" else 1.0)
        order = faults(chooser, drawn)
        heat_j = Twins(stage, "", (), NO_HISTORY, ()).do(lambda twin, order=order: heat_of(twin, order))
        words = ", ".join(phrase for phrase, _ in order)
        outcome.heat.append((heat_j, f"{stage.place[1]} at {stage.next_s:.2f} s: {words}"))
    outcome.counts_on = next((text for text in stage.run.engine.ctx.counted_on if "COUNTED ON" in text), "")
    return outcome


def rigs(seed: int, accepted: int, refused: int) -> Iterator[tuple[Drawn, str]]:
    """Yield rigs drawn by seed, each with its line about the relay: without it where `check` accepts the recipe."""
    chooser, left = random.Random(f"{seed} rigs"), {NO_RELAY: accepted, RELAY: refused}
    while sum(left.values()):
        one = draw(chooser)
        if not one.accepted(RELAY):
            continue  # refused for another reason
        relay = NO_RELAY if one.accepted(NO_RELAY) else RELAY
        if left[relay]:
            left[relay] -= 1
            yield one.heaviest() if relay == NO_RELAY and chooser.random() < HEAVIEST else one, relay


def figures(outcomes: list[tuple[Outcome, str]], count: int) -> list[Figure]:
    """Return the figures of the outcomes."""
    alone = [one for one, relay in outcomes if relay == NO_RELAY]
    beside = [one for one, relay in outcomes if relay == RELAY]
    heat = [row for one in alone for row in one.heat]
    unnamed = [one for one in beside if not one.counts_on] + [one for one in alone if one.counts_on]
    harmed = sum(heat_j > HARMFUL_J for one in beside for heat_j, _ in one.heat)
    return [
        at_least("cases that the program holds alone", len(heat), count),
        at_most("most heat among them", max((heat_j for heat_j, _ in heat), default=0.0), HARMFUL_J, "J", 1),
        equal("honest runs that tripped", sum(bool(one.tripped) for one, _ in outcomes), 0),
        equal("records that do not name what they count on, or name it needlessly", len(unnamed), 0),
        at_least("cases beyond harm where the relay is counted on", harmed, 1),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Draw, run and judge; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.stopped", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_ACCEPTED + SAMPLE_REFUSED} rigs")
    parser.add_argument("--seed", type=int, default=29, metavar="N")
    parser.add_argument("--every", action="store_true", help="print every case")
    options = parser.parse_args(arguments)
    accepted, refused = (SAMPLE_ACCEPTED, SAMPLE_REFUSED) if options.sample else (ACCEPTED, REFUSED)
    outcomes: list[tuple[Outcome, str]] = []
    for number, (one, relay) in enumerate(rigs(options.seed, accepted, refused)):
        chooser = random.Random(f"{options.seed} {number}")
        outcome = conduct(one, relay, chooser, MOMENTS // 2 if options.sample else MOMENTS)
        outcomes.append((outcome, relay))
        most_j, where = max(outcome.heat, default=(0.0, "no contact"))
        trip = f"; TRIPPED: {outcome.tripped}" if outcome.tripped else ""
        held_by = "alone" if relay == NO_RELAY else "relay"
        print(f"     {held_by}  {one.name}: {most_j:.1f} J ({where}){trip}", flush=True)
        for heat_j, text in outcome.heat if options.every else ():
            print(f"              {heat_j:6.1f} J  {text}", flush=True)
    found = figures(outcomes, 4 * accepted)
    for figure in found:
        print(figure, flush=True)
    return 0 if all(figure.ok for figure in found) else 1


if __name__ == "__main__":
    sys.exit(main())
