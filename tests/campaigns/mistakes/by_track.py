"""Mistakes that commissioning of a specimen on a track must name, for a linear track in a chamber and for a disc.

Each is commissioned on the twin, only the step that must find it (and those it needs), in virtual time.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from math import copysign, radians, sin
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final

from sim.faults.sensors import SpoiledForces, SpoiledTemperature
from sim.machines.specimen_on_track.rig import TrackRig
from sim.nodes.sensor_slave import CellSlave, ForceSource, IrSlave, SensorSlave
from tester.kinds.specimen_on_track.commission.commission_steps import STEPS
from tester.kinds.specimen_on_track.commission.height import INCH_MM
from tester.kinds.specimen_on_track.commission.twin import TrackPerson
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.scripted import words_of
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Asks, Question
from tester.run.commission_run import run_recipe
from tester.run.session_options import SessionOptions
from tests.campaigns.mistakes.mistake import Mistake
from tests.tester.kinds.specimen_on_track.commission.track_twin import TrackTwin, believed, scaled

GROSCH, DISC = "grosch", "pin-on-disc"
ON_WIRES: Final = tuple(step.name for step in STEPS if step.seat is not None)
GRAVITY: Final = 9.81
Built = Callable[[TrackRig], None]


def nothing(world: TrackRig) -> None:
    """Leave a machine unchanged."""


def look(
    seed: int,
    kind: str,
    steps: tuple[str, ...],
    *,
    built: Built = nothing,
    machine: TrackConfig | None = None,
    person: Callable[[], TrackPerson] = TrackPerson,
    keys: tuple[str, ...] = (),
) -> list[str]:
    """Commission a rig of a seed; return the findings. ``keys``: of the machine on which a recipe runs."""
    with TemporaryDirectory() as folder:

        def run(name: str, text: str) -> Mapping[str, Any]:
            options = SessionOptions("", rig=kind, overrides=keys, seed=seed, out=Path(folder), lapse=None)
            return run_recipe(options, Path(folder) / "recipes", TrackPerson(), name, text)

        twin = TrackTwin(Path(folder) / "record.jsonl", seed, rig=believed(kind), steps=steps, machine=machine,
                         built=built, person=person(), run_recipe=run)  # fmt: skip
        outcome = twin.run()
    return [] if outcome.ended is Ended.DONE else [f"{outcome.step}: {outcome.text}"]


class Wrong(TrackPerson):
    """Answers some questions for a quantity wrongly, and insists."""

    def __init__(self, begins: str | tuple[str, ...], wrong: Callable[[float], float]) -> None:
        """``begins``: beginnings of the questions' keys; ``wrong``: turns the right value into the typed one."""
        super().__init__()
        self.begins, self.wrong = begins, wrong

    def answer(self, question: Question) -> str:
        right = super().answer(question)
        wrong = question.asks is Asks.QUANTITY and " ".join(words_of(question)).startswith(self.begins)
        return f"{self.wrong(float(right)):.6g}" if wrong else right


class OtherWeights(TrackPerson):
    """Mistakes a set of weights for another."""

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        if question.key.endswith("weigh 20.0"):
            self.hands.put_on(22.0)


class Moved:
    """A cell that shows drag and run-out of the moving track."""

    def __init__(self, source: ForceSource, world: TrackRig, drag_n: float, varies_n: float) -> None:
        """``varies_n``: from peak to peak."""
        self.source, self.world = source, world
        self.drag_n, self.varies_n = drag_n, varies_n

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return the forces with both errors."""
        x, y, z, m = self.source.forces_measured(t)
        speed = self.world.track_m_s
        drag_n = copysign(self.drag_n, speed) if abs(speed) > 1e-5 else 0.0
        at = self.world.ruler("track")
        at_deg = 1.2 * at if self.world.plant.parameters.motion == "linear" else at
        return x + drag_n + 0.5 * self.varies_n * sin(radians(at_deg)), y, z, m


def _cell(world: TrackRig) -> CellSlave:
    cell = world.cell
    assert isinstance(cell, CellSlave)
    return cell


def spoil(kind: str, size: float, world: TrackRig) -> None:
    """Spoil the cell."""
    cell = _cell(world)
    cell.source = SpoiledForces(cell.source, kind, size, force="fx")


def move(drag_n: float, varies_n: float, world: TrackRig) -> None:
    """Let the moving track pull at the cell."""
    cell = _cell(world)
    cell.source = Moved(cell.source, world, drag_n, varies_n)


def warm(name: str, kelvin: float, world: TrackRig) -> None:
    """Give a thermometer, or the chamber's, an offset."""
    device: Any = world.chamber if name == "chamber" else world.devices[name]
    assert name == "chamber" or isinstance(device, IrSlave)
    device.source = SpoiledTemperature(device.source, "offset", kelvin, 0.0, 23.0, name)


def turn(name: str, world: TrackRig) -> None:
    """Let an axis move the wrong way round."""
    world.turned.add(name)


def swap(world: TrackRig) -> None:
    """Connect the motors of track and lift to each other's drives."""
    world.swapped = True


def unbalance(newtons: float, world: TrackRig) -> None:
    """Let the arm press by itself."""
    world.plant.arm_n = newtons


def deaden(world: TrackRig) -> None:
    """Let the end switches switch nothing."""
    world.switches_work = False


def loosen(world: TrackRig) -> None:
    """Let the coupling between motor and disc slip."""
    world.metres = 0.0


def shift(radius_mm: float, world: TrackRig) -> None:
    """Put the specimen at another radius."""
    world.radius_mm = radius_mm


def show(scale: float, offset_mm: float, world: TrackRig) -> None:
    """Change scale and zero of the arm's height sensor."""
    sensor = world.devices["height sensor"]
    assert isinstance(sensor, SensorSlave)
    plant = world.plant
    sensor.show("height", lambda: scale * plant.height_measured() + offset_mm)


class LeaseOff(TrackPerson):
    """Switches the chamber's lease off before its test."""

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        if question.key == "watchdog heat":
            self.hands.chamber.lease_s = 0.0


def _of_any(kind: str) -> list[Mistake]:
    """Return the mistakes that both kinds of track can have."""
    rig = believed(kind)
    at = partial(Mistake)
    force, load = partial(look, kind=kind, steps=("force",)), partial(look, kind=kind, steps=("load",))
    zero, jog = partial(look, kind=kind, steps=("jog track", "zero")), partial(look, kind=kind, steps=("jog track",))
    kilograms = "kilograms for newtons"
    return [
        at(f"{kind}: track reversed", "the track axis is reversed", partial(jog, built=partial(turn, "track"))),
        *(at(f"{kind}: track scale x {factor:g}", "scale of the track axis: .*" + words,
             partial(jog, machine=scaled(rig, "track", factor)))
          for factor, words in ((1.1, "velocity_increments"), (2.0, "gear of 2|diameter"), (10.0, "gear of 10"))),
        at(f"{kind}: cell sign reversed", "sign of the load cell's force forward is reversed",
           partial(force, built=partial(spoil, "reversed x", 0.0))),
        *(at(f"{kind}: cell gain {percent / 100:g}", f"Multiply .* by {percent / 100:g}|gain of the load cell's force",
             partial(force, built=partial(spoil, "gain", percent))) for percent in (90.0, 110.0)),
        at(f"{kind}: transmitter set to kilograms", kilograms,
           partial(force, built=partial(spoil, "gain", 100.0 / GRAVITY))),
        at(f"{kind}: hung weights typed in kilograms", kilograms,
           partial(force, person=lambda: Wrong("hang", lambda n: n / GRAVITY))),
        at(f"{kind}: hung weights typed in grams", "grams for newtons",
           partial(force, person=lambda: Wrong("hang", lambda n: 1000.0 * n / GRAVITY))),
        at(f"{kind}: a hung weight mistyped", "does not fit the others",
           partial(force, person=lambda: Wrong(("hang forward 50.0", "retype forward"), lambda n: 10.0 * n))),
        at(f"{kind}: cell zero off by 8 N", "zero of the load cell",
           partial(force, built=partial(spoil, "offset", 8.0))),
        at(f"{kind}: arm not balanced", "the arm is not balanced", partial(load, built=partial(unbalance, 1.0))),
        at(f"{kind}: another set of weights", "weights of 20 N press with 22", partial(load, person=OtherWeights)),
        at(f"{kind}: balance read in kilograms", "kilograms or grams for newtons",
           partial(load, person=lambda: Wrong("weigh", lambda n: n / GRAVITY))),
        at(f"{kind}: drag", "^zero: drag", partial(zero, built=partial(move, 1.0, 0.0))),
        at(f"{kind}: run-out", "^zero: run-out", partial(zero, built=partial(move, 0.0, 0.5))),
    ]  # fmt: skip


def _linear() -> list[Mistake]:
    rig = believed(GROSCH)
    travel, air = partial(look, kind=GROSCH, steps=("travel",)), partial(look, kind=GROSCH, steps=("air",))
    lift = partial(look, kind=GROSCH, steps=("jog lift",))
    off = "end of the travel: .*In the rig file: limits.travel_high"
    cold = replace(rig, sim=replace(rig.sim, heat=replace(rig.sim.heat, chamber_rate=1e-4)))
    return [
        Mistake(f"{GROSCH}: lift reversed", "the lift axis is reversed", partial(lift, built=partial(turn, "lift"))),
        Mistake(f"{GROSCH}: lift scale x 2", "scale of the lift axis: .*gear of 2",
                partial(lift, machine=scaled(rig, "lift", 2.0))),
        Mistake(f"{GROSCH}: drives of track and lift swapped", "node ids or motors are swapped",
                partial(look, kind=GROSCH, steps=("jog track",), built=swap)),
        Mistake(f"{GROSCH}: travel shorter than its limits", off,
                partial(travel, machine=replace(rig, sim=replace(rig.sim, travel=280.0)))),
        Mistake(f"{GROSCH}: switches too near to the soft ends", off.replace("_high", "_(high|low)"),
                partial(travel, machine=replace(rig, sim=replace(rig.sim, switches=12.0)))),
        Mistake(f"{GROSCH}: end switches dead", "does not open the safety chain", partial(travel, built=deaden)),
        Mistake(f"{GROSCH}: chamber's sensor 4 K off", "thermometer offset: the air",
                partial(air, built=partial(warm, "chamber", 4.0))),
        Mistake(f"{GROSCH}: chamber does not heat", "chamber: .*does not heat", partial(air, machine=cold)),
        Mistake(f"{GROSCH}: lease of the chamber off", "chamber's lease did not end",
                partial(look, kind=GROSCH, steps=("lease",), person=LeaseOff)),
        Mistake(f"{GROSCH}: specimen of another compound", "off what its model gives",
                partial(look, kind=GROSCH, steps=("load", "first"), keys=("sim.rubbers.SBR.t_ref=25 degC",))),
    ]  # fmt: skip


SHOWN: Final = (
    ("dead", "height sensor: it does not follow the arm", 0.0, 0.1),
    ("reversed, out of its range", "not up after 90 s: height sensor", -1.0, 0.0),
    ("reversed, on a lever", "height sensor: it falls when the arm rises", -0.3, 0.0),
    ("in inches", "height sensor: .* inches for millimetres", 1.0 / INCH_MM, 0.0),
    ("scale x 1.5", "height sensor: .* scale in its profile", 1.5, 0.0),
    ("zero off by 0.4 mm", "height sensor: its zero is", 1.0, 0.4),
    ("set with a thinner specimen", "height sensor: its zero is", 1.0, -0.4),
)
"""Faults of the arm's height sensor: name, expected finding, scale, and zero in mm."""


def _disc() -> list[Mistake]:
    rig = believed(DISC)
    jog, air = partial(look, kind=DISC, steps=("jog track",)), partial(look, kind=DISC, steps=("air",))
    return [
        Mistake(f"{DISC}: specimen at another radius", "scale of the track axis",
                partial(jog, machine=scaled(rig, "track", 72.0 / 60.0), built=partial(shift, 72.0))),
        Mistake(f"{DISC}: diameter typed for the radius", "A diameter in place of a radius",
                partial(jog, person=lambda: Wrong("jog track radius", lambda mm: 2.0 * mm))),
        Mistake(f"{DISC}: angle read in radians", "scale of the track axis",
                partial(jog, person=lambda: Wrong("jog track whole read", radians))),
        Mistake(f"{DISC}: coupling slips", "does not move although", partial(jog, built=loosen)),
        Mistake(f"{DISC}: thermometer 4 K off", "thermometer offset: the air",
                partial(air, built=partial(warm, "thermometer", 4.0))),
        Mistake(f"{DISC}: pyrometer 5 K off", "thermometer offset: the pyrometer",
                partial(air, built=partial(warm, "pyrometer", 5.0))),
        *(Mistake(f"{DISC}: height sensor {name}", words,
                  partial(look, kind=DISC, steps=("height",), built=partial(show, scale, offset_mm)))
          for name, words, scale, offset_mm in SHOWN),
        Mistake(f"{DISC}: greasy track", "off what its model gives",
                partial(look, kind=DISC, steps=("load", "first"), keys=("sim.rubbers.SBR.mu_max=0.7",))),
    ]  # fmt: skip


MISTAKES: Final[tuple[Mistake, ...]] = (*_of_any(GROSCH), *_linear(), *_of_any(DISC), *_disc())


def clean(seed: int) -> list[str]:
    """Return the findings on clean rigs of both kinds: none."""
    return [text for kind in (GROSCH, DISC) for text in look(seed, kind, (*ON_WIRES, "first"))]
