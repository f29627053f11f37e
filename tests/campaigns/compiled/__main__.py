"""`python -m tests.campaigns.compiled [--sample | --full]`: is the compiled scan its source, bit by bit?

Every case runs twice: with the installed `tester`, which must be the compiled one, and with this checkout's source.
Exit code, tables, every event with its time and every stored sample must be equal. `--sample`: recipes, some faults, a
laboratory's own kind of rig; `--full`: pin-on-disc and every fault of the catalogue too. Prints a line a figure; exit
code 1 where one misses, 2 without a compiled installation to compare with.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

from recipes import find
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tests.campaigns.acceptance.figure import Figure, equal
from tests.campaigns.compiled.worker import Case
from tests.campaigns.faults.recipes import HEATED, QUICK, SIDESLIP
from tests.extension.installing import EXAMPLES, describe
from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE, QUIET, SHORT

CHECKOUT = Path(__file__).parents[3]
WORKER = Path(__file__).with_name("worker.py")
SAMPLE_EVERY = 12
"""The sample has one in so many of the catalogue's faults."""
OWN_KIND = EXAMPLES / "kind"
"""A package with a kind of rig of a laboratory's own: its classes stay Python and inherit from compiled ones."""
FAULT_AT_S = 40.0
"""A short run slides under load at this time (s of rig time)."""


def cases(full: bool) -> list[Case]:
    """Return the cases to run on both sides."""
    quickstart = find("quickstart").read_text(encoding="utf-8")
    recipes = {"short": AT_ONCE, "quick": QUICK, "sideslip": SIDESLIP, "heated": HEATED}
    found = [_case(f"{name}, seed {seed}", text, seed) for name, text in recipes.items() for seed in (0, 1)]
    found.append(_case("short, perfect sensors", SHORT, 0, QUIET))
    found.append(_case("quickstart", quickstart, 0))
    wheel = '  - compound: "1#"\n'
    two = AT_ONCE.replace(wheel, wheel + wheel.replace("1#", "3#"))
    found.append(_case("two wheels, two processes", two, 0, jobs=2))
    own = OWN_KIND / "lab_sledge"
    own_recipe, own_rig = (own / "recipe.yaml").read_text(encoding="utf-8"), str(own / "rig.yaml")
    for faults in ((), ("step slide + 1 s: sledge jams",)):
        found.append(_case(f"own kind {faults}", own_recipe, 0, faults=faults, rig=own_rig))
    if full:
        found.append(_case("pin-on-disc", find("pin-on-disc").read_text(encoding="utf-8"), 0, rig="pin-on-disc"))
    for phrase in list(CATALOGUE)[:: 1 if full else SAMPLE_EVERY]:
        found.append(_case(f"fault: {phrase}", AT_ONCE, 0, faults=(f"t={FAULT_AT_S:g} s: {phrase}",)))
    return found


def _case(
    name: str, recipe: str, seed: int, overrides: tuple[str, ...] = (), faults: tuple[str, ...] = (),
    rig: str = "sim", jobs: int = 1,
) -> Case:  # fmt: skip
    return {
        "name": name, "rig": rig, "recipe": recipe, "seed": seed, "overrides": list(overrides), "faults": list(faults),
        "jobs": jobs,
    }  # fmt: skip


def side(file: Path, source: bool) -> subprocess.Popen[str]:
    """Start a worker on the installed `tester`, or on this checkout's."""
    own = [str(file.with_name("site")), str(OWN_KIND)]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([*own, str(CHECKOUT)] if source else own)}
    # -P: do not search the worker's own folder; outside the checkout only the installed packages are found.
    command = [sys.executable, "-P", str(WORKER), str(file)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=file.parent, env=environment)


def lines(process: subprocess.Popen[str]) -> Iterator[dict[str, object]]:
    """Yield the worker's lines; raises RuntimeError where it fails."""
    assert process.stdout is not None
    for line in process.stdout:
        yield json.loads(line)
    if process.wait():
        raise RuntimeError(f"a worker ended with exit code {process.returncode}")


def main(arguments: list[str] | None = None) -> int:
    """Compare; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.compiled", description=__doc__)
    kind = parser.add_mutually_exclusive_group(required=True)
    kind.add_argument("--sample", action="store_true", help="recipes, some faults, an own kind")
    kind.add_argument("--full", action="store_true", help="pin-on-disc and every fault too")
    options = parser.parse_args(arguments)
    todo = cases(options.full)
    with TemporaryDirectory(prefix="compiled-") as folder:
        file = Path(folder) / "cases.json"
        file.write_text(json.dumps(todo), encoding="utf-8")
        describe(OWN_KIND / "pyproject.toml", file.with_name("site"))
        with side(file, source=False) as installed, side(file, source=True) as source:
            return report(todo, lines(installed), lines(source))


def report(
    todo: list[Case], installed: Iterator[dict[str, object]], source: Iterator[dict[str, object]]
) -> int:
    """Print the comparison of both sides; return the exit code."""
    one, other = next(installed), next(source)
    if not one["compiled"] or other["compiled"]:
        print(f"nothing to compare: installed {one}, checkout {other}", file=sys.stderr)
        return 2
    print(f"compiled: {one['where']}\nsource:   {other['where']}", flush=True)
    differing: list[str] = []
    exits: Counter[str] = Counter()
    for left, right in zip(installed, source, strict=True):
        exits[str(right["exit"])] += 1
        unlike = [key for key in left.keys() | right.keys() if left.get(key) != right.get(key)]
        if unlike:
            differing.append(f"{left['name']} ({', '.join(sorted(unlike))}: {left.get('exit')}, {right.get('exit')})")
            print(f"MISS {differing[-1]}", flush=True)
    figure: Figure = equal(f"runs that differ, of {len(todo)}", len(differing), 0)
    print(f"exit codes: {', '.join(f'{code} x {count}' for code, count in sorted(exits.items()))}")
    print(figure)
    return 0 if figure.ok else 1


if __name__ == "__main__":
    sys.exit(main())
