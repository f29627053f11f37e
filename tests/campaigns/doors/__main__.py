"""`python -m tests.campaigns.doors [--sample] [--keep DIR]`: one recipe in one process, over TCP and over ptys.

`tester sim` and `tester run` are processes of their own, in real time: this takes about three minutes a door, and time
cannot be scaled: `tester sim --speed` would shorten the devices' time-outs for a run on the real clock. `--sample` runs
one condition instead of three. Each condition's coefficient is compared with that of a run in one process with the same
seed; they may differ by both expanded uncertainties of this wheel (95 %), in quadrature. Time-outs are compared with
those of a bare echo on a pseudo-terminal that runs beside the run over ptys. Exit code 1 where one misses.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import sqlite3
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.bench import COMMAND, ROOT
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.doors.echo import Echo

OVERRIDES = ("--seed", "1")
PATIENCE_S = 7200.0
"""Time limit of a run: the quickstart takes 45 min in real time."""
ECHO_S, SAMPLE_ECHO_S = 120.0, 60.0
RECIPE = """\
recipe: doors
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 3
  min_valid: 2
  window: 20 rev
  temperature_band: 20 K
  soak: {{within: 5 degC, for: 1 s}}
  max_bursts: 3
grids:
  - name: short
    slip_velocity: {slip}
    load: 100 N
    temperature: 24.2 degC
wheel: {{replace_after: 15 mm}}
"""
SLIPS, SAMPLE_SLIPS = "[50 mm/s, 100 mm/s, 200 mm/s]", "100 mm/s"
DOORS = {"TCP": (), "ptys": ("--rtu", "--slcan")}


def tester(*arguments: str) -> list[str]:
    """Return a command line of the product under test."""
    return [sys.executable, "-c", COMMAND, *arguments]


def environment() -> dict[str, str]:
    """Return an environment that finds the product under test."""
    return os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), os.environ.get("PYTHONPATH", "")))}


def run(folder: Path, *options: str) -> Path:
    """Run the recipe to its end and return the run's folder. Raises ValueError if it has no result."""
    arguments = ["run", str(folder.parent / "recipe.yaml"), "--yes", "--out", str(folder / "runs"), *options]
    done = subprocess.run(
        tester(*arguments), env=environment(), capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )
    if done.returncode != 0:
        raise ValueError(f"exit {done.returncode}: {' | '.join(done.stderr.splitlines()[-12:])}")
    return Path(done.stdout.splitlines()[-1])


def through(folder: Path, doors: Sequence[str]) -> Path:
    """Run the recipe on a rig in a process of its own."""
    rig_file = folder / "rig.yaml"
    arguments = ["sim", *doors, *OVERRIDES, "--write-rig", str(rig_file)]
    with (folder / "sim.err").open("w", encoding="utf-8") as errors:
        sim = subprocess.Popen(
            tester(*arguments), env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors,
            text=True,
        )
    try:
        assert sim.stdout is not None
        if not sim.stdout.readline().startswith("ready: "):
            raise ValueError((folder / "sim.err").read_text(encoding="utf-8"))
        return run(folder, "--rig", str(rig_file))
    finally:
        sim.terminate()
        sim.wait(20.0)


def conditions(place: Path) -> list[tuple[str, float, float]]:
    """Return each condition's name, coefficient and expanded uncertainty of this wheel."""
    with (place / "conditions.csv").open(encoding="utf-8-sig", newline="") as file:
        return [
            (f"{row['slip_velocity_mm_s']} mm/s", float(row["mu"]), float(row["u_expanded"]))
            for row in csv.DictReader(file)
            if row["level"] == "condition"
        ]


def counted(place: Path, counter: str) -> int:
    """Return a run's counts of its Modbus lines."""
    with sqlite3.connect(place / "run.db") as store:
        asked = "select sum(value) from bus_statistic where counter = ? and bus like 'line%'"
        [found] = store.execute(asked, (counter,)).fetchone()
    return int(found or 0)


def compare(door: str, here: Path, there: Path) -> Iterator[Figure]:
    """Compare a run through a door with the one in one process."""
    known = conditions(here)
    found = conditions(there)
    yield equal(f"{door}: conditions", [name for name, _, _ in found], [name for name, _, _ in known])
    for (name, mu, u), (_, other, other_u) in zip(known, found, strict=True):
        yield at_most(f"{door}: {name}, coefficient off", abs(other - mu), math.hypot(u, other_u), digits=4)


def lateness(place: Path, echoed: tuple[int, int]) -> Iterator[Figure]:
    """Compare a run's time-outs with the echo's, by their shares."""
    requests, timeouts = counted(place, "requests"), counted(place, "timeouts")
    asked, late = echoed
    expected = late * requests / asked
    # Both counts scatter as counts do (Poisson): two standard deviations of their difference, and one count for none.
    limit = expected + 2.0 * math.sqrt(expected * (1.0 + requests / asked)) + 1.0
    yield holds("ptys: requests", requests > 0, str(requests), "some")
    yield holds("bare echo: time-outs", asked > 0, f"{late} of {asked}", "no limit")
    yield at_most("ptys: time-outs", timeouts, limit, digits=0, note=f" of {requests}, {expected:.1f} as the echo's")


def figures(folder: Path, sample: bool) -> Iterator[Figure]:
    """Measure."""
    (folder / "recipe.yaml").write_text(RECIPE.format(slip=SAMPLE_SLIPS if sample else SLIPS), encoding="utf-8")
    places = {name: folder / name for name in ("here", *DOORS)}
    for place in places.values():
        place.mkdir(parents=True)
    here = run(places["here"], *OVERRIDES)
    for door, options in DOORS.items():
        if options and not hasattr(os, "openpty"):
            print(f"{door}: skipped: this system has no pseudo-terminals")
            continue
        echo = Echo(SAMPLE_ECHO_S if sample else ECHO_S) if options else None
        try:
            there = through(places[door], options)
            yield from compare(door, here, there)
            if echo is not None:
                found = echo.result()
                yield from lateness(there, (found.requests, found.timeouts))
        except (ValueError, subprocess.TimeoutExpired) as error:
            yield holds(f"{door}: the run comes to its end", False, str(error), "exit 0")
        finally:
            if echo is not None:
                echo.close()


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.doors", description="A rig behind its doors.")
    parser.add_argument("--sample", action="store_true", help="one condition instead of three")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep runs in this new folder")
    read = parser.parse_args(arguments)
    missed = 0
    with TemporaryDirectory(prefix="doors-", ignore_cleanup_errors=True) as temporary:
        for figure in figures((read.keep or Path(temporary)).resolve(), read.sample):
            missed += not figure.ok
            print(figure, flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
