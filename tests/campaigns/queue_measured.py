"""Durations of runs on the twin, measured for ``tests.campaigns.queue``: recipes to train with, and held-out ones.

Constants of the prediction may be fitted to ``TRAINING``; only ``HELD_OUT`` judges it. A *world* is the true state of
the twin together with the beliefs of its rig file: all items of a queue run in one world.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory

import recipes
from tester.inputs.recipe.time_estimate import Estimate
from tester.machine.run import Outcome
from tester.run.preconditions import prepared
from tester.run.sweep.case import run_case
from tester.run.sweep.grid import axis_of
from tester.run.sweep.sweep import SweepOptions, prepare_sweep
from tests.campaigns.seeds import recipes as texts
from tests.campaigns.seeds.rubber import REAL_RUBBER
from tests.campaigns.seeds.topics import BELIEFS

HERE = Path(__file__).parent
TRAINING, HELD_OUT = HERE / "queue_training.json", HERE / "queue_held_out.json"

WHEEL_WORLDS: dict[str, tuple[str, ...]] = {
    "as believed": (),
    "real rubber": REAL_RUBBER,
    "beliefs high": (*REAL_RUBBER, *BELIEFS),
    "beliefs low": (
        *REAL_RUBBER, "wear.rate=0.03", "observer.friction_heat_fraction=0.045", "sim.wheel.outer_diameter=90.3",
    ),
}  # fmt: skip
"""Wear rate, share of friction heat and diameter as in the rig file, and with errors to both sides of the twin's
truth."""
TRACK_WORLDS: dict[str, tuple[str, ...]] = {
    "as believed": (),
    "beliefs high": ("heat.rise=0.65 K/W", "sim.ambient=21.5 degC"),
    "beliefs low": ("heat.rise=0.35 K/W", "sim.ambient=24 degC", "sim.scatter=1.5"),
}
WORLDS = {"sim": WHEEL_WORLDS, "grosch": TRACK_WORLDS, "pin-on-disc": TRACK_WORLDS}

_TRACK = """\
recipe: {name}
kind: specimen_on_track
specimens: [{specimens}]
abrasive: {{name: {abrasive}}}
measure:
  repeats: {repeats}
  min_valid: {repeats}
  distance: {distance}
  at_least: 5 s
  temperature_band: {band} K
  soak: {{within: {within} K, for: {soak}}}
grids:
  - name: grid
"""


def _track(name: str, compounds: Sequence[str], abrasive: str, grid: str, repeats: int, *, slow: bool) -> str:
    specimens = ", ".join(f"{{compound: {compound}}}" for compound in compounds)
    how = {"distance": "0.25 mm", "band": "1", "within": "0.5", "soak": "30 min, at_most: 3 h"} if slow else {
        "distance": "300 mm", "band": "5", "within": "3", "soak": "5 s"}  # fmt: skip
    lines = "".join(f"    {line}\n" for line in grid.split("; "))
    return _TRACK.format(name=name, specimens=specimens, abrasive=abrasive, repeats=repeats, **how) + lines


def _wheel(name: str, compounds: tuple[str, ...], grid: str, repeats: int = 3) -> str:
    lines = "".join(f"    {line}\n" for line in grid.split("; "))
    return texts.recipe(name, compounds, f"  - name: grid\n{lines}", repeats)


@dataclass(frozen=True, slots=True)
class Measured:
    """A recipe in a world. ``recipe``: a shipped recipe's name or a text; ``seeds``: in a whole measurement."""

    name: str
    rig: str
    recipe: str
    world: str = ""
    took_s: tuple[float, ...] = field(default=())

    @property
    def overrides(self) -> tuple[str, ...]:
        """Values of the rig file, as for ``--set``."""
        return WORLDS[self.rig][self.world]

    @property
    def text(self) -> str:
        """The recipe's text."""
        return self.recipe if "\n" in self.recipe else recipes.find(self.recipe).read_text(encoding="utf-8")

    @property
    def made_of(self) -> str:
        """Hash of recipe and rig: the entry is valid only for these."""
        return sha256("\n".join((self.rig, *self.overrides, self.text)).encode()).hexdigest()[:16]

    def expected(self, folder: Path) -> Estimate:
        """Return the plan's estimate now."""
        return prepared(self.file(folder), self.rig, self.overrides).expected

    def file(self, folder: Path) -> str:
        """Return the recipe's name for a command; a text becomes a file in ``folder``."""
        if "\n" not in self.recipe:
            return self.recipe
        path = folder / f"{self.name.replace(' ', '-')}.yaml"
        path.write_text(self.recipe, encoding="utf-8")
        return str(path)


TRAIN: tuple[Measured, ...] = (
    Measured("quickstart", "sim", "quickstart"),
    Measured("angles", "sim", texts.ANGLES),
    Measured("four conditions", "sim", texts.FOUR),
    Measured("pin-on-disc", "pin-on-disc", "pin-on-disc"),
    Measured("track 10 to 30 degC", "grosch", _track(
        "track", ["SBR"], "wavy glass",
        "load: 20 N; temperature: [10 degC, 20 degC, 30 degC]; track_speed: [1e-4 m/s, 1e-3 m/s]", 1, slow=True)),
    Measured("track cold", "grosch", _track(
        "cold", ["butyl"], "silicon carbide",
        "load: 10 N; temperature: [-30 degC, -10 degC]; track_speed: [1e-5 m/s, 1e-2 m/s]", 1, slow=True)),
)  # fmt: skip
HOLD_OUT: tuple[Measured, ...] = (
    Measured("hot", "sim", _wheel("hot", ("3#",), "slip_velocity: 200 mm/s; load: 150 N; temperature: 70 degC")),
    Measured("cool slips", "sim", _wheel(
        "cool slips", ("2#",), "slip_velocity: [100 mm/s, 250 mm/s]; load: 250 N; temperature: 27 degC", 4)),
    Measured("two compounds", "sim", _wheel(
        "two compounds", ("1#", "3#"), "slip_velocity: 150 mm/s; load: 120 N; temperature: 45 degC")),
    Measured("one angle", "sim", _wheel(
        "one angle", ("2#",), "slip_velocity: 350 mm/s; load: 250 N; sideslip: 15 deg; temperature: 50 degC")),
    Measured("to a precision", "sim", _wheel(
        "to a precision", ("1#",), "slip_velocity: 300 mm/s; load: 300 N; temperature: 35 degC").replace(
            "repeats: 3", "repeats: {at_least: 3, at_most: 12}\n  until: 4 %")),
    Measured("wear checked", "sim", _wheel(
        "wear checked", ("3#",), "slip_velocity: 300 mm/s; load: 200 N; temperature: [30 degC, 40 degC]").replace(
            "repeats: 3", "repeats: 3\n  wear_check: each_condition")),
    Measured("pre-grind", "sim", "pre-grind"),
    Measured("wet NBR", "pin-on-disc", _track(
        "wet NBR", ["NBR"], "road",
        "interface: wet; load: [10 N, 20 N]; temperature: 23 degC; track_speed: [0.1 m/s, 0.4 m/s, 0.8 m/s]", 3,
        slow=False)),
    Measured("dry, slow", "pin-on-disc", _track(
        "dry slow", ["SBR", "NBR"], "road",
        "load: 10 N; temperature: 23 degC; track_speed: [0.06 m/s, 0.09 m/s]", 3, slow=False)),
    Measured("track warm", "grosch", _track(
        "warm", ["INR"], "wavy glass",
        "load: [10 N, 40 N]; temperature: [40 degC, 60 degC]; track_speed: [3e-5 m/s, 3e-3 m/s]", 1, slow=True)),
    Measured("track 0 to 50 degC", "grosch", _track(
        "wide", ["ABR"], "silicon carbide",
        "load: 20 N; temperature: [0 degC, 25 degC, 50 degC]; track_speed: [1e-5 m/s, 1e-3 m/s]", 1, slow=True)),
    Measured("talc", "grosch", _track(
        "talc", ["SBR"], "silicon carbide",
        "interface: talc; load: 20 N; temperature: [-20 degC, 15 degC]; track_speed: 1e-4 m/s", 2, slow=True)),
)  # fmt: skip


def in_worlds(measured: Sequence[Measured]) -> Iterator[Measured]:
    """Yield every recipe in every world of its rig."""
    for one in measured:
        for world in WORLDS[one.rig]:
            yield Measured(one.name, one.rig, one.recipe, world)


def read(path: Path) -> dict[tuple[str, str], tuple[str, tuple[float, ...]]]:
    """Return the entries of a file: hash and rig seconds, by recipe and world."""
    rows = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    return {(row["recipe"], row["world"]): (row["made_of"], tuple(row["took_s"])) for row in rows}


def measure(runs: int) -> None:
    """Run every recipe in every world with so many fresh seeds; both files are written after each run."""
    with TemporaryDirectory(prefix="queue-") as name:
        folder = Path(name)
        for path in (TRAINING, HELD_OUT):
            path.unlink(missing_ok=True)
        for number in range(runs):
            for path, measured in ((TRAINING, TRAIN), (HELD_OUT, HOLD_OUT)):
                for place, one in enumerate(in_worlds(measured)):
                    seed = 1000 * place + number + (500_000 if path == HELD_OUT else 0)
                    _add(path, one, _took_s(one, folder, seed))


def _took_s(one: Measured, folder: Path, seed: int) -> float | None:
    """Return the rig seconds of a finished run, with or without all values; None for another end."""
    axes = tuple(axis_of(override) for override in one.overrides)
    sweep = prepare_sweep(SweepOptions(one.file(folder), one.rig, axes, 1, seed))
    result = run_case(sweep.tasks[0])
    ended = result.outcome == Outcome.DONE.value
    words = f"{result.rig_seconds:,.0f} s" if ended else f"{result.outcome}: {result.reason}"
    print(f"{one.name}, {one.world}, seed {seed}: {words}", flush=True)
    return round(result.rig_seconds, 1) if ended else None


def _add(path: Path, one: Measured, took_s: float | None) -> None:
    known = read(path)
    _, before = known.get((one.name, one.world), ("", ()))
    known[one.name, one.world] = one.made_of, before if took_s is None else (*before, took_s)
    rows = [
        {"recipe": name, "world": world, "made_of": made_of, "took_s": times}
        for (name, world), (made_of, times) in known.items()
    ]
    lines = ",\n".join(json.dumps(row) for row in rows)
    path.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
