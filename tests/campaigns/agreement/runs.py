"""Makes the runs whose outputs are read: random short recipes, each with a scene of laboratory life.

Each run is a `tester` process of its own, as a user starts it. Every seed comes from the base seed of the campaign.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from random import Random

STOPPING = Path(__file__).with_name("stopping.py")
_TIMEOUT_S = 900.0


class RunError(Exception):
    """A run of the campaign failed."""


@dataclass(frozen=True, slots=True)
class Made:
    """A run on disk. ``printed``: text output of its command; "" if the record has changed since."""

    folder: Path
    seed: int
    scene: str = ""
    printed: str = ""
    sweep: Path | None = None
    """Conditions of a sweep that has the same recipe and seed."""
    events: str = ""
    """The command's output with --json."""


@dataclass
class Laboratory:
    """Makes runs: a folder, the Python of the installation, a random source."""

    folder: Path
    python: str
    random: Random
    seed: int = 0
    rig: str = "sim"
    text: str = ""
    options: tuple[str, ...] = field(default=())

    def tester(self, *arguments: str, stop_at: float | None = None) -> subprocess.CompletedProcess[str]:
        """Carry out `tester ARGUMENTS`; ``stop_at``: share of a run after which a person stops it."""
        share = 2.0 if stop_at is None else stop_at
        command = [self.python, str(STOPPING), f"{share}", *arguments]
        return subprocess.run(
            command, cwd=self.folder, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL,
            timeout=_TIMEOUT_S,
        )  # fmt: skip

    def run(self, *options: str, stop_at: float | None = None) -> Made:
        """Run the recipe; raises RunError if no run begins."""
        recipe = self.folder / "recipe.yaml"
        recipe.write_text(self.text, encoding="utf-8")
        done = self.tester(
            "run", str(recipe), "--rig", self.rig, "--yes", "--seed", str(self.seed), "--out", "runs", *options,
            stop_at=stop_at,
        )  # fmt: skip
        return self._made(done)

    def resume(self, made: Made) -> Made:
        """Resume a run."""
        return replace(self._made(self.tester("resume", str(made.folder), "--yes")), scene=made.scene)

    def _made(self, done: subprocess.CompletedProcess[str]) -> Made:
        name = done.stdout.strip().splitlines()[-1:]
        if not name or not (self.folder / name[0] / "run.db").is_file():
            raise RunError(f"{done.args}: exit {done.returncode}: {done.stderr[-800:]}")
        events = "\n".join(line for line in done.stdout.splitlines() if line.startswith("{"))
        return Made(self.folder / name[0], self.seed, printed=done.stderr, events=events)


# -- recipes -----------------------------------------------------------------------------------------------------------


def wheel_recipe(
    random: Random, *, more: str = "", measure: str = "", compounds: int = 1, loads: int = 2, band: float = 0.0
) -> str:
    """Return a recipe of few conditions for a wheel: loads at one slip velocity and temperature, nothing ground in.

    The requested temperature is some degrees above room temperature, so that the measured mean differs.
    """
    chosen = random.sample(["1#", "2#", "3#"], compounds)
    specimens = ", ".join(f'{{compound: "{one}"}}' for one in chosen)
    load = ", ".join(f"{one} N" for one in sorted(random.sample(range(80, 300, 10), loads)))
    return (
        "recipe: agreement\n"
        f"specimens: [{specimens}]\n"
        f"{more}"
        f"measure: {{wheel_speed: 0.8 m/s, repeats: 3, window: {random.randint(5, 9)} rev, temperature_band: "
        f"{band or random.choice([2, 3, 4])} degC{measure}}}\n"
        "grids:\n"
        f"  - {{name: load, slip_velocity: {random.randrange(150, 400, 10)} mm/s, load: [{load}], "
        f"temperature: {random.randint(25, 32)} degC}}\n"
    )


def disc_recipe(random: Random, *, more: str = "", compounds: int = 1, band: float = 5.0) -> str:
    """Return a recipe of four conditions for a pin on a disc, dry and wet."""
    chosen = random.sample(["SBR", "NBR"], compounds)
    speeds = ", ".join(f"{one / 100:g} m/s" for one in sorted(random.sample(range(5, 60), 2)))
    return (
        "recipe: agreement on a disc\n"
        "kind: specimen_on_track\n"
        f"specimens: [{', '.join(f'{{compound: {one}}}' for one in chosen)}]\n"
        f"{more}"
        "abrasive: {name: road}\n"
        "measure: {repeats: 3, min_valid: 2, distance: 60 mm, at_least: 2 s, "
        f"temperature_band: {band:g} K, soak: {{within: 3 K, for: 5 s}}}}\n"
        "grids:\n"
        f"  - {{name: dry and wet, interface: [dry, wet], load: {random.choice([10, 20])} N, "
        f"temperature: {random.randint(21, 25)} degC, track_speed: [{speeds}]}}\n"
    )


def track_recipe(random: Random) -> str:
    """Return a recipe of four conditions for a block on a track in a chamber."""
    low = random.randint(5, 30)
    return (
        "recipe: agreement on a track\n"
        "kind: specimen_on_track\n"
        "specimens: [{compound: SBR}]\n"
        "abrasive: {name: silicon carbide, mesh: 180}\n"
        "measure: {repeats: 3, min_valid: 2, distance: 1 mm, at_least: 3 s, temperature_band: 1 K, "
        "soak: {within: 0.5 K, for: 1 min, at_most: 3 h}}\n"
        "grids:\n"
        f"  - {{name: speeds, load: {random.choice([10, 20, 40])} N, temperature: [{low} degC, {low + 8} degC], "
        "track_speed: [1e-3 m/s, 1e-2 m/s]}\n"
    )


# -- scenes ------------------------------------------------------------------------------------------------------------

Scene = Callable[[Laboratory], Made]


def _plain(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random)
    return lab.run()


def _both_directions(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, measure=", both_directions: true").replace("repeats: 3", "repeats: 4")
    return lab.run("--json")


def _references(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, more="reference: {every: 1, temperature: 28 degC, repeats: 2}\n")
    return lab.run("--json")


def _replicates(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, more="replicates: 2\n")
    return lab.run("--json")


def _parts(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, compounds=2)
    return lab.run("--jobs", "2")


def _tight(lab: Laboratory) -> Made:
    """Request a temperature band that friction leaves at once: a condition without a value."""
    hurry = ", max_bursts: 3, soak: {within: 0.2 degC, for: 20 s, at_most: 10 min}"
    lab.text = wheel_recipe(lab.random, measure=hurry, band=0.3)
    return lab.run()


def _stopped(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, loads=3)
    return lab.run(stop_at=lab.random.uniform(0.3, 0.8))


def _tripped(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, loads=3)
    return lab.run("--fault", f"step measure + {lab.random.uniform(20, 500):.1f} s: belt drive heartbeat lost")


def _resumed(lab: Laboratory) -> Made:
    return lab.resume(_stopped(lab))


def _two_wheels_resumed(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random, compounds=2)
    return lab.resume(lab.run(stop_at=lab.random.uniform(0.3, 0.9)))


def _excluded(lab: Laboratory) -> Made:
    return _leave_out(lab, _plain(lab))


def _swept(lab: Laboratory) -> Made:
    lab.text = wheel_recipe(lab.random)
    return _sweep(lab, lab.run())


def _disc(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random, compounds=2), "pin-on-disc"
    return lab.run("--json")


def _disc_replicates(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random, more="replicates: 2\n"), "pin-on-disc"
    return lab.run("--json")


def _disc_parts(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random, compounds=2), "pin-on-disc"
    return lab.run("--jobs", "2")


def _disc_stopped(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random), "pin-on-disc"
    return lab.run(stop_at=lab.random.uniform(0.3, 0.8))


def _disc_tripped(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random), "pin-on-disc"
    return lab.run("--fault", f"step slide + {lab.random.uniform(1, 60):.1f} s: track drive heartbeat lost")


def _disc_resumed(lab: Laboratory) -> Made:
    return lab.resume(_disc_stopped(lab))


def _disc_excluded(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random), "pin-on-disc"
    return _leave_out(lab, lab.run())


def _disc_swept(lab: Laboratory) -> Made:
    lab.text, lab.rig = disc_recipe(lab.random), "pin-on-disc"
    return _sweep(lab, lab.run())


def _track(lab: Laboratory) -> Made:
    lab.text, lab.rig = track_recipe(lab.random), "grosch"
    return lab.run()


def _leave_out(lab: Laboratory, made: Made) -> Made:
    """Leave a repeat of the first condition out by hand."""
    target = f"1/{lab.random.randint(1, 3)}"
    done = lab.tester("results", "exclude", str(made.folder), target, "--reason", "a; b, c", "--operator", "campaign")
    if done.returncode:
        raise RunError(f"exclude {target}: {done.stderr}")
    return replace(made, printed="")


def _sweep(lab: Laboratory, made: Made) -> Made:
    done = lab.tester(
        "sweep", "recipe.yaml", "--rig", lab.rig, "--seeds", "1", "--seed", str(lab.seed), "--jobs", "1", "--out",
        "sweeps",
    )  # fmt: skip
    name = done.stdout.strip().splitlines()[-1:]
    if not name:
        raise RunError(f"sweep: exit {done.returncode}: {done.stderr[-500:]}")
    return replace(made, sweep=lab.folder / name[0] / "conditions.csv")


SCENES: dict[str, Scene] = {
    "one wheel": _plain,
    "disc, two compounds": _disc,
    "both directions": _both_directions,
    "disc, stopped": _disc_stopped,
    "references": _references,
    "track": _track,
    "replicates": _replicates,
    "disc, a repeat excluded": _disc_excluded,
    "stopped": _stopped,
    "disc, replicates": _disc_replicates,
    "tripped": _tripped,
    "disc, resumed": _disc_resumed,
    "resumed": _resumed,
    "disc, parts side by side": _disc_parts,
    "a repeat excluded": _excluded,
    "disc, tripped": _disc_tripped,
    "parts side by side": _parts,
    "two wheels, resumed": _two_wheels_resumed,
    "a condition without a value": _tight,
    "disc, swept": _disc_swept,
    "swept": _swept,
}
"""Scenes by name; runs take them in turn."""


def make_runs(folder: Path, base: int, names: Iterator[str], python: str = sys.executable) -> Iterator[Made]:
    """Yield runs, one for each name of a scene, made in ``folder``; raises RunError."""
    for number, name in enumerate(names):
        random = Random(f"agreement {base} {number}")
        lab = Laboratory(folder, python, random, seed=random.randrange(10**6))
        yield replace(SCENES[name](lab), scene=name)
