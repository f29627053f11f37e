"""Commissioning on the twin, with a machine that may differ from its rig file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.commission_step import CommissionStep
from tester.machine.commission.record import CommissionRecord
from tester.machine.commission.step_engine import Commissioning, CommissionOutcome
from tester.run.kind_lookup import load_rig
from tester.run.simulated import simulated_ports


def believed(*overrides: str) -> RigConfig:
    """Return the simulated rig's file with some keys replaced."""
    return RigConfig.of(load_rig("sim", overrides))


def nothing(world: WheelRig) -> None:
    """Leave a machine as it is."""


def no_recipe(name: str, text: str) -> Mapping[str, Any]:
    """Run nothing."""
    raise AssertionError(f"no recipe was to be run: {name}")


class Clock:
    """A wall clock that advances by a second at each reading."""

    def __init__(self) -> None:
        self.seconds = 0

    def __call__(self) -> str:
        self.seconds += 1
        return f"2026-11-23T10:{self.seconds // 60:02d}:{self.seconds % 60:02d}Z"


class Watched:
    """A simulated rig with a callback in each of its ticks, which, other than polls, does not depend on wall time."""

    def __init__(self, rig: WheelRig, look: Callable[[WheelRig], None]) -> None:
        self._rig = rig
        self._look = look

    def advance(self, now: float) -> None:
        self._rig.advance(now)
        self._look(self._rig)

    @property
    def urgent_s(self) -> float:
        return self._rig.urgent_s


class Bench:
    """A rig file, a machine and a person."""

    def __init__(
        self,
        path: Path,
        seed: int = 0,
        *,
        rig: RigConfig | None = None,
        machine: RigConfig | None = None,
        built: Callable[[WheelRig], None] = nothing,
        person: TwinPerson | None = None,
        steps: tuple[CommissionStep, ...] = STEPS,
        run_recipe: Callable[[str, str], Mapping[str, Any]] = no_recipe,
        given: Mapping[str, str] | None = None,
        look: Callable[[WheelRig], None] = nothing,
    ) -> None:
        """``machine``: the real one, ``rig`` by default; ``built``: changes to it; ``look``: callback in each of its
        ticks."""
        self.rig = rig or believed()
        self.machine = machine or self.rig
        self.said: list[str] = []
        self.person = person or TwinPerson()
        self.person._say = self.said.append
        self.path = path
        self.seed = seed
        self.built = built
        self.steps = steps
        self.run_recipe = run_recipe
        self.given = given
        self.look = look
        self.world: WheelRig | None = None

    def connect(self) -> tuple[Any, Any, Any]:
        """Open the wires of a machine that was switched on anew."""
        ports, world, hands = simulated_ports(self.machine, self.seed, None)
        assert isinstance(world, WheelRig)
        self.built(world)
        self.world = world
        self.person.at(hands)
        return ports, Watched(world, self.look), hands

    def run(self) -> CommissionOutcome:
        """Commission."""
        self.record = CommissionRecord(self.path, Clock(), "a test")
        self.walk = Commissioning(
            self.steps, self.rig, self.person, self.record, self.connect, self.run_recipe,
            given=self.given,
        )
        return self.walk.run()


def named(*names: str) -> tuple[CommissionStep, ...]:
    """Return some steps by name."""
    return tuple(step for step in STEPS if step.name in names)
