"""Mistakes that commissioning must name: a machine that differs from its rig file, a person who mistypes.

Each is commissioned on the twin up to the first refusal, in virtual time; a clean rig must pass every step that uses
the rig's wires.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.faults.sensors import SpoiledForces, SpoiledTemperature
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.kinds.wheel_on_belt.commission.jog import AXES
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Question
from tests.campaigns.mistakes.mistake import Mistake
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed

Built = Callable[[WheelRig], None]


def _found(bench: Bench) -> list[str]:
    outcome = bench.run()
    return [] if outcome.ended is Ended.DONE else [f"{outcome.step}: {outcome.text}"]


def look(
    seed: int,
    *,
    steps: tuple[str, ...] = (),
    machine: RigConfig | None = None,
    rig: RigConfig | None = None,
    built: Built | None = None,
    person: TwinPerson | None = None,
) -> list[str]:
    """Commission a rig of a seed; return the findings. ``steps``: only these; default: all that use the rig's wires."""
    wanted = tuple(step for step in STEPS if (step.name in steps if steps else step.seat is not None))
    with TemporaryDirectory() as folder:
        return _found(
            Bench(
                Path(folder) / "record.jsonl",
                seed,
                rig=rig,
                machine=machine,
                built=built or (lambda world: None),
                person=person,
                steps=wanted,
            )
        )


def scaled(name: str, factor: float) -> RigConfig:
    """Return a machine whose axis moves ``factor`` times as far as in the rig file."""
    rig = believed()
    axis = rig.axes.driven()[name]
    new = replace(
        axis,
        velocity_increments=axis.velocity_increments / factor,
        position_increments=axis.position_increments / factor,
    )
    return replace(rig, axes=replace(rig.axes, **{name: new}))


def without_deadline(name: str) -> RigConfig:
    """Return a rig whose drive waits for setpoints for ever: its file may state this only with an accepted risk."""
    rig = believed()
    new = replace(rig.axes.driven()[name], rpdo_deadline_s=0.0)
    return replace(rig, axes=replace(rig.axes, **{name: new}))


def reverse(name: str, world: WheelRig) -> None:
    """Let an axis move the wrong way round."""
    if name == "wheel":
        world.plant.wheel_speed.factor *= -1.0
    elif name == "belt":
        world.plant.belt_speed.factor *= -1.0
    else:
        world.turned.add(name)


def cross(kind: str, world: WheelRig) -> None:
    """Cross the wires of the load cell (sim.faults.sensors.CROSSED)."""
    world.cell.source = SpoiledForces(world.cell.source, kind)


def gain(percent: float, world: WheelRig) -> None:
    """Change the gain of the load cell's Fz."""
    world.cell.source = SpoiledForces(world.cell.source, "gain", percent)


def see(kind: str, size: float, world: WheelRig) -> None:
    """Change the thermometer's reading: ``gain`` is the effect of a wrong emissivity, per cent of the excess."""
    world.ir.source = SpoiledTemperature(world.ir.source, kind, size, 0.0, 23.0, "thermometer")


def swap(world: WheelRig) -> None:
    """Connect the motors of wheel and belt to each other's drives."""
    world.swapped = True


def grow(share: float, world: WheelRig) -> None:
    """Mount wheels of another diameter."""
    world.plant.set_size(share)


def misread(gain: float, world: WheelRig) -> None:
    """Change the gain of the torque measured by the press's drive."""
    world.axes["press"].misread_torque(gain, 0.0)


def weld(world: WheelRig) -> None:
    """Let the standstill relay see everything and switch nothing."""
    assert world.relay is not None
    world.relay.works = False


def deafen(name: str, world: WheelRig) -> None:
    """Let a drive accept its heartbeat consumer but not monitor it."""
    drive = world.axes[name]
    drive.store.hooks.pop(DEAF, None)


DEAF = 0x1016
"""Consumer heartbeat time (CiA 301)."""


class Mistypes(TwinPerson):
    """Types a weight ten times too great, and again when asked."""

    def answer(self, question: Question) -> str:
        right = super().answer(question)
        if question.key.endswith("hang z 200.0") or question.key.startswith("retype z"):
            return "2000"
        return right


class Silences(TwinPerson):
    """Switches a watchdog off at its device before its test."""

    def __init__(self, key: str) -> None:
        super().__init__()
        self.key = key

    def prepare(self, question: Question) -> None:
        super().prepare(question)
        if question.key != self.key:
            return
        if self.key == "watchdog heat":
            self.hands.jacket.lease_s = 0.0
        else:
            for received in self.hands.axes["belt"].pdos.rpdos:
                received.deadline_s = inf


class Uncalibrated(TwinPerson):
    """Reads the belt's ruler in centimetres."""

    def answer(self, question: Question) -> str:
        right = super().answer(question)
        return f"{0.1 * float(right):.3f}" if question.key.endswith("jog belt whole read") else right


def _mistakes() -> tuple[Mistake, ...]:
    found: list[Mistake] = []
    for axis in AXES:
        name, only = axis.name, (f"jog {axis.name}",)
        found.append(Mistake(f"{name} axis reversed", rf"the {name} axis is reversed",
                             partial(look, steps=only, built=partial(reverse, name))))
        for factor in (1.1, 2.0, 10.0) if name in ("wheel", "belt", "press") else (1.1,):
            found.append(Mistake(f"{name} scale x {factor:g}", rf"scale of the {name} axis",
                                 partial(look, steps=only, machine=scaled(name, factor))))
    cell = partial(look, steps=("cell",))
    found += [
        Mistake("wheel and belt drives swapped", r"node ids or motors are swapped|not the one that moves",
                partial(look, steps=("jog wheel",), built=swap)),
        Mistake("cell channels swapped", r"channels are swapped", partial(cell, built=partial(cross, "exchanged x z"))),
        *(Mistake(f"cell sign of F{c} reversed", rf"sign of the load cell's F{c} is reversed",
                  partial(cell, built=partial(cross, f"reversed {c}"))) for c in "xyz"),
        Mistake("cell gain 10 % off", r"gain of the load cell's Fz", partial(cell, built=partial(gain, 110.0))),
        Mistake("a weight typed ten times too great", r"the weight typed as 2000 N does not fit",
                lambda seed: look(seed, steps=("cell",), person=Mistypes())),
        Mistake("a ruler read in centimetres", r"scale of the belt axis",
                lambda seed: look(seed, steps=("jog belt",), person=Uncalibrated())),
        *(Mistake(f"lifting spring: {key}", r"lifting spring of the press: .*screw.spring",
                  partial(look, steps=("spring",), machine=believed(f"sim.drives.press_spring{key}")))
          for key in ("=43.5 N", "=52 N", "_rate=0.8 N/mm")),
        Mistake("torque of the press's drive 10 % low", r"gain of the press's torque",
                partial(look, steps=("spring",), built=partial(misread, 0.9))),
        Mistake("wheel diameter 5 % off", r"wheel diameter",
                partial(look, steps=("touch",), built=partial(grow, 1.05))),
        Mistake("belt roller 0.9 % off, within the jog's tolerance", r"speed ratio",
                partial(look, steps=("rolling",), machine=scaled("belt", 1.009 * 1.003))),
        Mistake("emissivity 0.95 of a tread with 0.76", r"emissivity",
                partial(look, steps=("thermometer",), built=partial(see, "gain", 80.0))),
        Mistake("thermometer offset of 4 K", r"thermometer offset",
                partial(look, steps=("thermometer",), built=partial(see, "offset", 4.0))),
        Mistake("heartbeat watchdog of the belt drive not armed", r"belt drive did not stop with EMCY 0x8130",
                partial(look, steps=("watchdogs",), built=partial(deafen, "belt"))),
        Mistake("setpoints' deadline of the belt drive not armed", r"belt drive did not stop with EMCY 0x8250",
                lambda seed: look(seed, steps=("watchdogs",), person=Silences("watchdog setpoints"))),
        Mistake("lease of the jacket not armed", r"jacket's lease did not end its heat",
                lambda seed: look(seed, steps=("watchdogs",), person=Silences("watchdog heat"))),
        Mistake("standstill relay stuck", r"standstill relay: .*not confirmed",
                partial(look, steps=("relay",), built=weld)),
        Mistake("no standstill relay", r"standstill relay: .*not confirmed",
                partial(look, steps=("relay",), machine=believed("sim.standstill_relay=false"))),
        Mistake("no deadline for setpoints", r"no deadline for setpoints.*belt",
                lambda seed: look(seed, steps=("watchdogs",), rig=without_deadline("belt"))),
    ]  # fmt: skip
    return tuple(found)


MISTAKES: tuple[Mistake, ...] = _mistakes()


def clean(seed: int) -> list[str]:
    """Return the findings about a rig without a mistake: none."""
    return look(seed)
