"""Runs cases with whichever `tester` it finds, and prints a line of digests for each: a file, not a module of `tests`.

    python -P worker.py CASES.json

A case is {"name", "rig", "recipe", "seed", "overrides", "faults", "jobs"}. The first line states where `tester` is and
whether its scan is compiled.
"""

from __future__ import annotations

import json
import sys
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypedDict

import tester.kinds.wheel_on_belt.control.step
from tester.run.endings import CannotStartError
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader

TABLES = ("appendix", "conditions", "repeats")


class Case(TypedDict):
    """One run."""

    name: str
    rig: str
    recipe: str
    seed: int
    overrides: list[str]
    faults: list[str]
    jobs: int


class Silent(ReportScreen):
    """A session's screen that shows nothing."""

    answer_yes = True

    def __init__(self) -> None:
        self.messages: list[str] = []

    def message(self, text: str) -> None:
        """Store the message."""
        self.messages.append(text)


def digest(data: str) -> str:
    """Return a short digest of a text."""
    return sha256(data.encode()).hexdigest()[:16]


def digests(case: Case) -> dict[str, str]:
    """Run a case and return the digests of its results: exit code, tables, journal, every sample."""
    with TemporaryDirectory(prefix="compiled-", ignore_cleanup_errors=True) as folder:
        recipe = Path(folder) / "recipe.yaml"
        recipe.write_text(case["recipe"], encoding="utf-8")
        screen = Silent()
        options = SessionOptions(
            recipe=str(recipe),
            rig=case["rig"],
            out=Path(folder) / "runs",
            seed=case["seed"],
            overrides=tuple(case["overrides"]),
            faults=tuple(case["faults"]),
            jobs=case["jobs"],
        )
        session = Session(options, screen)
        try:
            found = {"exit": str(session.run())}
        except CannotStartError as error:
            return {"exit": f"cannot start: {error}"}
        if session.folder is None:
            return found | {"said": digest("\n".join(screen.messages))}
        for name in TABLES:
            table = session.folder / f"{name}.csv"
            found[name] = digest(table.read_text(encoding="utf-8")) if table.exists() else ""
        with RunReader(session.folder / "run.db") as run:
            events = [(e.t_s, e.kind, e.severity, e.text) for e in run.events()]
            found["events"] = f"{len(events)} {digest(repr(events))}"
            samples = {name: list(column) for name, column in run.samples().items()}
            found["samples"] = digest(repr(samples))
        return found


def main() -> None:
    """Run the cases of the file named and print their digests."""
    origin = Path(str(tester.kinds.wheel_on_belt.control.step.__file__))
    print(json.dumps({"compiled": origin.suffix != ".py", "where": str(origin.parents[2])}), flush=True)
    for case in json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")):
        print(json.dumps({"name": case["name"]} | digests(case)), flush=True)


if __name__ == "__main__":
    main()
