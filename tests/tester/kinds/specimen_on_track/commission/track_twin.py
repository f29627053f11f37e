"""Commissioning of a track on the twin, with a machine that may differ from its rig file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from sim.machines.specimen_on_track.rig import TrackRig
from tester.kinds.specimen_on_track.commission.commission_steps import STEPS
from tester.kinds.specimen_on_track.commission.twin import TrackPerson
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.record import CommissionRecord
from tester.machine.commission.step_engine import Commissioning, CommissionOutcome
from tester.run.kind_lookup import load_rig
from tester.run.simulated import simulated_ports

RUN = {"run": "r", "rig_s": 1.0}


def believed(rig: str, *overrides: str) -> TrackConfig:
    """Return a packaged rig's file with some keys replaced."""
    return TrackConfig.of(load_rig(rig, overrides))


def scaled(rig: TrackConfig, name: str, factor: float) -> TrackConfig:
    """Return a machine whose axis goes ``factor`` times as far as the rig file says: it needs fewer counts."""
    axis = rig.drives()[name]
    counts = {
        key: getattr(axis, key) / factor for key in ("velocity_increments", "position_increments")
    }  # fmt: skip
    return replace(rig, axes=replace(rig.axes, **{name: replace(axis, **counts)}))


def no_recipe(name: str, text: str) -> Mapping[str, Any]:
    """Run nothing."""
    raise AssertionError(f"no recipe was to be run: {name}")


class TrackTwin:
    """A rig file, a machine and a person."""

    def __init__(
        self,
        path: Path,
        seed: int = 0,
        *,
        rig: TrackConfig,
        steps: tuple[str, ...],
        machine: TrackConfig | None = None,
        built: Callable[[TrackRig], None] = lambda world: None,
        person: TrackPerson | None = None,
        run_recipe: Callable[[str, str], Mapping[str, Any]] = no_recipe,
    ) -> None:
        """``machine``: the real one, ``rig`` by default; ``built``: changes to it."""
        self.rig, self.machine, self.built, self.seed = rig, machine or rig, built, seed
        self.person = person or TrackPerson()
        self.said: list[str] = []
        self.person._say = self.said.append
        self.path, self.run_recipe = path, run_recipe
        self.steps = tuple(step for step in STEPS if step.name in steps)
        self.world: TrackRig | None = None
        self.seconds = 0

    def connect(self) -> tuple[Any, Any, Any]:
        """Open the wires of a machine that was switched on anew."""
        ports, world, hands = simulated_ports(self.machine, self.seed, None)
        assert isinstance(world, TrackRig)
        self.built(world)
        self.world = world
        self.person.at(hands)
        return ports, world, hands

    def _utc(self) -> str:
        self.seconds += 1
        return f"2026-11-23T10:{self.seconds // 60:02d}:{self.seconds % 60:02d}Z"

    def run(self) -> CommissionOutcome:
        """Commission."""
        self.record = CommissionRecord(self.path, self._utc, "a test")
        walk = Commissioning(self.steps, self.rig, self.person, self.record, self.connect, self.run_recipe)
        return walk.run()
