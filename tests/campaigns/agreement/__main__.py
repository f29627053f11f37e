"""`python -m tests.campaigns.agreement [--sample] [--seed N] [--runs N]`: do a run's outputs contradict one another?

Makes short runs of both kinds of rig, reads every output of each back into facts, and compares these to the printed
digits. Then one renderer at a time is changed to make an error, which the comparison must detect. One line a figure;
exit status 0 when every figure is what is asked for, 1 when one misses it.
"""

from __future__ import annotations

import argparse
import pickle
import shutil
import sys
from collections.abc import Iterator, Sequence
from itertools import cycle, islice
from pathlib import Path
from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal
from tests.campaigns.agreement.compare import Comparison, compare
from tests.campaigns.agreement.facts import Facts
from tests.campaigns.agreement.mutants import MUTANTS, survivors
from tests.campaigns.agreement.outputs import facts_of, facts_of_several, figures_of
from tests.campaigns.agreement.record import read_record
from tests.campaigns.agreement.runs import SCENES, Made, make_runs

RUNS = 40
SAMPLE = ("a repeat excluded", "disc, stopped")
"""The scenes of the short form."""
DRAWN = 5
"""Interval of runs that `tester figure` draws; the report draws the figures of all runs."""
KEPT = "made.pickle"
"""File beside the runs: how each was made."""
SHOWN = 12
"""Number of disagreements printed of each kind."""
TRIED = 12
"""At least one of these runs must show a mutant."""
SAMPLE_EVERY = 4
"""The short form tries one mutant in so many."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Make runs, compare, hunt mutants; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.agreement", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="the short form, for every change: two runs")
    parser.add_argument("--runs", type=int, default=RUNS, metavar="N", help=f"how many (default {RUNS})")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="from which the runs' seeds are drawn")
    parser.add_argument("--python", default=sys.executable, metavar="FILE",
                        help="of the installation that makes the runs, such as a compiled one")  # fmt: skip
    parser.add_argument("--keep", type=Path, metavar="DIR", help="new folder for the runs, which are kept there")
    parser.add_argument("--again", type=Path, metavar="DIR", help="compare the runs that --keep left, make none")
    parser.add_argument("--scene", action="append", choices=[*SCENES], help="only this; may be given again")
    parser.add_argument("--no-mutants", action="store_true", help="compare only")
    options = parser.parse_args(arguments)
    names: Sequence[str] = options.scene or (SAMPLE if options.sample else [*SCENES])
    count = len(names) if options.sample or options.scene else options.runs
    with TemporaryDirectory() as name:
        folder = options.again or options.keep or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        missed = 0
        hunted = [] if options.no_mutants else [*MUTANTS][:: SAMPLE_EVERY if options.sample else 1]
        wanted = [*islice(cycle(names), count)]
        made = _kept(folder) if options.again else _made(folder, options.seed, wanted, options.python)
        for figure in _figures(made, folder, hunted):
            print(figure, flush=True)
            missed += not figure.ok
    print(f"     CPU time {_cpu_s():.0f} s")
    return 1 if missed else 0


def _made(folder: Path, base: int, names: Sequence[str], python: str) -> list[Made]:
    """Return the runs, made one after the other."""
    begun, made = _cpu_s(), list[Made]()
    for one in make_runs(folder, base, iter(names), python):
        print(f"     {one.folder.name}  seed {one.seed}  {one.scene}", flush=True)
        made.append(one)
        (folder / KEPT).write_bytes(pickle.dumps(made))
    rig_h = sum(read_record(one.folder).rig_seconds for one in made) / 3600.0
    print(f"     {len(made)} runs made: {rig_h:.1f} h of rig time in {_cpu_s() - begun:.0f} s of CPU time", flush=True)
    return made


def _kept(folder: Path) -> list[Made]:
    return pickle.loads((folder / KEPT).read_bytes())  # noqa: S301 - the campaign's own


def _figures(made: Sequence[Made], folder: Path, hunted: Sequence[str]) -> Iterator[Figure]:
    found = compare([*_read(made, folder / "reports")], [read_record(one.folder) for one in made])
    _print(found)
    yield at_least(f"of {len(made)} runs: statements compared with another output's", found.compared, 300 * len(made))
    yield at_most("disagreements", len(found.disagreements), 0, digits=0)
    if hunted:
        alive = survivors(hunted, made[:TRIED], {one.key for one in found.disagreements}, folder)
        yield equal(f"deliberate disagreements found, of {len(hunted)}", len(hunted) - len(alive), len(hunted))
        for name in alive:
            print(f"     not found: {name}", flush=True)


def _read(made: Sequence[Made], reports: Path) -> Iterator[Facts]:
    reports.mkdir(exist_ok=True)
    for number, one in enumerate(made):
        yield from facts_of(one, reports)
        if number % DRAWN == 0:
            yield from figures_of(one, reports / "figures")
    yield from facts_of_several(made, reports)
    shutil.rmtree(reports)


def _print(found: Comparison) -> None:
    """Print some disagreements of each kind, and the quantities that only one output prints."""
    kinds: dict[tuple[str, str], list[str]] = {}
    for one in found.disagreements:
        kinds.setdefault((str(one.subject[0]), one.quantity), []).append(str(one))
    for lines in kinds.values():
        for line in lines[:SHOWN]:
            print(f"     {line}", flush=True)
        if len(lines) > SHOWN:
            print(f"     ... and {len(lines) - SHOWN} more like it", flush=True)
    alone = ", ".join(sorted(found.alone))
    print(f"     printed by one output alone: {alone or 'nothing'}", flush=True)


def _cpu_s() -> float:
    """Return CPU time of this process and its finished children, s."""
    used = [getrusage(who) for who in (RUSAGE_SELF, RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


if __name__ == "__main__":
    sys.exit(main())
