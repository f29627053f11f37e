"""`python -m tests.campaigns.rehearsal [--sample] [--keep DIR]`: every kind of machine on wires, killed and resumed.

`tester sim` and `tester run --hands` are processes of their own, in real time, over TCP and over pseudo-terminals. At a
drawn moment one of them receives SIGKILL; then the run is resumed on the same machine, or on a restarted one. Compared
with the run in one process with the same seed: each condition's coefficient, within both expanded uncertainties of this
specimen (95 %) in quadrature; the repeats from before the kill, which must be unchanged. `--sample` rehearses a disc
whose run is killed, and at the same time a block whose machine is killed; `--fast` longer recipes of both over TCP,
with the clocks of machine and run 5 times as fast (drives' data may then be 5 ms old). Exit code 1 if a figure misses.
"""

from __future__ import annotations

import argparse
import csv
import math
import sqlite3
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from tester.base import clock
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.rehearsal.machines import BLOCK, DISC, EVERY, Machine, Rehearsed, fast

TRIES = 3
UNBROKEN, RUN, MACHINE = "unbroken", "run killed", "machine killed"
Repeat = tuple[int, int, float]
"""Condition, repeat, coefficient of the repeat."""


@dataclass(frozen=True, slots=True)
class Scene:
    """One rehearsal; ``share``: share of the run's time at which something is killed."""

    of: Rehearsed
    door: str
    killed: str
    share: float

    @property
    def name(self) -> str:
        """Its name in a line of the report."""
        at = "" if self.killed == UNBROKEN else f" at {100.0 * self.share:.0f} %"
        return f"{self.of.name}, {self.door}, {self.killed}{at}"


def scenes(sample: bool, quick: bool, seed: int) -> list[Scene]:
    """Return the rehearsals in order; ``quick``: with fast clocks."""
    at = Random(f"rehearsal {seed}")
    if quick:
        return [Scene(of, "TCP", UNBROKEN, 0.0) for of in fast()]
    if sample:
        return [Scene(DISC, "TCP", RUN, at.uniform(0.6, 0.9)), Scene(BLOCK, "ptys", MACHINE, at.uniform(0.6, 0.9))]
    return [
        Scene(of, door, killed, at.uniform(0.3, 0.95))
        for of in EVERY for door in ("TCP", "ptys") for killed in (UNBROKEN, RUN, MACHINE)
    ]  # fmt: skip


def rehearse(scene: Scene, folder: Path, seed: int) -> list[Figure]:
    """Run a scene and return its figures."""
    machine = Machine(folder, scene.of, scene.door, seed)
    try:
        here = ended(machine.here(folder / "here"), folder / "here.err", scene.of.longest_s)
        machine.start()
        run = machine.run()
        if scene.killed == UNBROKEN:
            run.wait(scene.of.longest_s)
            (left,) = (folder / "runs").iterdir()
            return list(compare(scene, here, left if run.returncode == 0 else resumed(machine, left), repeats(left)))
        until_s = clock.monotonic() + scene.share * rig_seconds(here)
        while run.poll() is None and clock.monotonic() < until_s:
            clock.sleep_until(min(until_s, clock.monotonic() + 0.1))
        if run.poll() == 0:
            raise ValueError("the run ended before it was killed")
        if scene.killed == RUN:
            run.kill()
        else:
            machine.kill()
        run.wait(scene.of.longest_s)
        (left,) = (folder / "runs").iterdir()
        before = repeats(left)
        if scene.killed == MACHINE:
            machine.start()
        elif scene.of.by_hand:
            machine.command("raise")
        return list(compare(scene, here, resumed(machine, left), before))
    except (ValueError, OSError, subprocess.TimeoutExpired) as error:
        written = folder / "run.err"
        trips = words(written, "tripped").split(" | ") if written.exists() else [""]
        late = all("was late by" in trip for trip in trips)  # a slow computer is only reported
        return [holds(f"{scene.name}: comes to its end, or names the late computer", late, str(error), "one of both")]
    finally:
        machine.kill()


def resumed(machine: Machine, run: Path) -> Path:
    """Resume a run until it finishes, as a person does after a trip: a busy computer makes scans late. Raises
    ValueError with the output of the last of TRIES.
    """
    errors = machine.folder / "run.err"
    for left in reversed(range(TRIES)):
        try:
            return ended(machine.resume(run), errors, machine.of.longest_s)
        except ValueError:
            if not left:
                raise
            print(f"{machine.of.name}: resumed again: {words(errors, 'tripped')}", flush=True)
            if machine.of.by_hand:
                machine.command("raise")
    raise AssertionError


def compare(scene: Scene, here: Path, there: Path, before: Sequence[Repeat]) -> Iterator[Figure]:
    """Yield the figures of a finished run, compared with the one in one process."""
    known, found = conditions(here), conditions(there)
    yield equal(f"{scene.name}: conditions", list(found), list(known))
    shares = [abs(found[name][0] - mu) / math.hypot(u, found[name][1]) for name, (mu, u) in known.items()]
    yield at_most(f"{scene.name}: largest difference, of U", max(shares, default=math.nan), 1.0)
    after, ours = repeats(there), repeats(here)
    once = [(condition, repeat) for condition, repeat, _ in after]
    yield equal(f"{scene.name}: repeats, each once", once, [(condition, repeat) for condition, repeat, _ in ours])
    kept = f"{sum(one in after for one in before)} of {len(before)}"
    yield equal(f"{scene.name}: repeats from before, as they were", kept, f"{len(before)} of {len(before)}")


def ended(process: subprocess.Popen[str], errors: Path, longest_s: float) -> Path:
    """Wait for a run and return its folder; raises ValueError with its output if it failed."""
    out, _ = process.communicate(timeout=longest_s)
    if process.returncode != 0:
        raise ValueError(f"exit {process.returncode}: {words(errors)}")
    return Path(out.splitlines()[-1])


def words(errors: Path, of: str = "") -> str:
    """Return the last lines with a word in them of a process's text output."""
    lines = [line for line in errors.read_text(encoding="utf-8").splitlines() if of in line]
    return " | ".join(lines[-6:])


def conditions(run: Path) -> dict[str, tuple[float, float]]:
    """Return each condition's coefficient and expanded uncertainty of this specimen."""
    with (run / "conditions.csv").open(encoding="utf-8-sig", newline="") as file:
        return {
            row["condition"]: (float(row["mu"] or "nan"), float(row["u_expanded"] or "nan"))
            for row in csv.DictReader(file)
            if row["level"] == "condition"
        }


def repeats(run: Path) -> list[Repeat]:
    """Return a run's valid repeats."""
    with closing(sqlite3.connect(run / "run.db")) as store:
        asked = "select condition, repeat, mu_resultant from repeat where status = 'valid' order by condition, repeat"
        return list(store.execute(asked))


def rig_seconds(run: Path) -> float:
    """Return how long a run took, s of the rig."""
    with closing(sqlite3.connect(run / "run.db")) as store:
        [seconds] = store.execute("select rig_seconds from run").fetchone()
    return float(seconds)


def main(arguments: list[str] | None = None) -> int:
    """Rehearse; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.rehearsal", description="Machines on wires.")
    parser.add_argument("--sample", action="store_true", help="two kinds beside each other, each killed once")
    parser.add_argument("--fast", action="store_true", help="longer recipes, with clocks 5 times as fast")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the machines and the drawn moments (1)")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep runs in this new folder")
    read = parser.parse_args(arguments)
    missed, every = 0, scenes(read.sample, read.fast, read.seed)
    with TemporaryDirectory(prefix="rehearsal-", ignore_cleanup_errors=True) as temporary:
        root = (read.keep or Path(temporary)).resolve()
        with ThreadPoolExecutor(len(every) if read.sample else 1) as pool:
            places = [root / str(number) for number in range(1, len(every) + 1)]
            for figures in pool.map(rehearse, every, places, repeat(read.seed)):
                for figure in figures:
                    missed += not figure.ok
                    print(figure, flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
