"""Deliberate disagreements: one renderer makes an error, and the comparison must detect it.

Each mutant is a text in a module's source, replaced by another while the module is imported, in a process of its own
that reads the outputs of one run again. Nothing on disk changes.
"""

from __future__ import annotations

import importlib.abc
import importlib.util
import pickle
import subprocess
import sys
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, SourceFileLoader
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType

from tests.campaigns.agreement.compare import Key, compare
from tests.campaigns.agreement.outputs import (
    COMMANDS,
    PAGE,
    REPORT,
    SCREENS,
    SEVERAL,
    TABLES,
    facts_of,
    facts_of_several,
)
from tests.campaigns.agreement.record import read_record
from tests.campaigns.agreement.runs import Made

_MODULE = "tests.campaigns.agreement.mutants"


@dataclass(frozen=True, slots=True)
class Mutant:
    """A wrong renderer: ``old`` in the source of ``module`` reads ``new``.

    ``parts``: outputs that are read to detect it (``outputs.PARTS``), besides the tables.
    """

    module: str
    old: str
    new: str
    parts: tuple[str, ...] = (COMMANDS,)


MUTANTS: Mapping[str, Mutant] = {
    "end of the run: the third decimal is one too great": Mutant(
        "tester.cli.ending", "*ending_table(results, folder)",
        '*(__import__("re").sub(r"(\\d\\.\\d\\d)(\\d)", lambda m: m[1] + str((int(m[2]) + 1) % 10), line)'
        " for line in ending_table(results, folder))",
    ),
    "terminal: the first flag of a condition is dropped": Mutant(
        "tester.cli.text_table", "shown(behind.text(row))", 'shown(behind.text(row).partition(", ")[2])'
    ),
    "show --json: a valid repeat too many": Mutant(
        "tester.cli.result_commands", "yield {**record, ", 'yield {**record, "valid": record["valid"] + 1, '
    ),
    "show --budget: U of the compound is headed as that of this wheel": Mutant(
        "tester.cli.result_commands", 'shown(f"  {line}") for line in others',
        'shown(f"  {line}".replace("U compound", "U this wheel")) for line in others',
    ),
    "tables: the column headed mu_as_measured is the coefficient at the temperature asked for": Mutant(
        "tester.results.columns", "tuple(column.key for column in stored)",
        'tuple({"mu": "mu_as_measured", "mu_as_measured": "mu"}.get(column.key, column.key) for column in stored)',
    ),
    "report: a condition with a doubt is not counted": Mutant(
        "tester.results.tally", "sum(map(bool, doubts))", "sum(map(bool, doubts[1:]))",
        (REPORT,),
    ),
    "report: tables show a make-up too many": Mutant(
        "tester.report.layout", "zip(table.rows, table.texts(), strict=True)",
        'zip(table.rows, (tuple(str(int(text) + 1) if text.isdigit() and one.heading == "make-ups" else text '
        "for one, text in zip(table.columns, cells)) for cells in table.texts()), strict=True)",
        (REPORT,),
    ),
    "charts: bars are half as long": Mutant(
        "tester.report.charts", "row.result.budget.expanded, run, kpa_per_n)",
        "0.5 * row.result.budget.expanded, run, kpa_per_n)", (REPORT,),
    ),
    "overview: points are the coefficient as measured": Mutant(
        "tester.report.overview", "Mark(condition.at, result.mu, ", "Mark(condition.at, result.mu_resultant, ",
        (REPORT,),
    ),
    "compare: the second coefficient is the one as measured": Mutant(
        "tester.results.compared", 'lambda pair: _mu(pair.second), ""',
        'lambda pair: pair.second.result.mu_resultant, ""',
        (SEVERAL,),
    ),
    "runs: a repeat is not counted": Mutant(
        "tester.cli.runs_command", "{run.repeats} repeats  {shown", "{run.repeats - 1} repeats  {shown",
        (SEVERAL,),
    ),
    "screen Results: marks are missing": Mutant(
        "tester.tui.stored", "cells = tuple(column.text(one) for", 'cells = tuple(column.text(one).rstrip("?!") for',
        (SCREENS,),
    ),
    "screen of repeats: the coefficient is that of the first repeat": Mutant(
        "tester.tui.stored", "{mu.heading} {mu.text(measured)}", "{mu.heading} {mu.text(repeats.rows[0])}",
        (SCREENS,),
    ),
    "screen Steps: U is that of the compound": Mutant(
        "tester.results.conditions_table", "{table['u_expanded'].text(row)}",
        "{table['u_expanded_compound'].text(row)}", (SCREENS,),
    ),
    "live: a condition that grows lacks its last repeat": Mutant(
        "tester.results.so_far", "rows = [*_before(reader, results, row, measured), row]",
        "rows = _before(reader, results, row, measured)", (PAGE,),
    ),
    "live: U is that of the compound": Mutant(
        "tester.service.present_results", 'return table[key].as_json(row)',
        'return table[key.replace("expanded", "expanded_compound")].as_json(row)', (PAGE,),
    ),
    "results: a workbook's numbers are rounded": Mutant(
        "tester.results.workbook", "float(written), form", "round(float(written), 1), form",
        (TABLES,),
    ),
    "replay: the time left is a minute too long": Mutant(
        "tester.tui.playback", "left_s=left_s, step_left_s", "left_s=left_s + 60.0, step_left_s",
        (SCREENS,),
    ),
}  # fmt: skip
"""By their errors."""


class Patched(importlib.abc.MetaPathFinder, SourceFileLoader):
    """Imports one module with its source changed."""

    def __init__(self, mutant: Mutant) -> None:
        """Come before the other finders; raises LookupError unless the source has the text exactly once."""
        package, *inner = mutant.module.split(".")
        found = importlib.util.find_spec(package)  # the module's own spec would import it
        if found is None or found.origin is None:
            raise LookupError(f"no source of {mutant.module}")
        source = Path(found.origin).parent.joinpath(*inner).with_suffix(".py")
        super().__init__(mutant.module, str(source))
        self.mutant = mutant
        text = source.read_text(encoding="utf-8")
        if text.count(mutant.old) != 1:
            raise LookupError(f"{mutant.old!r} is {text.count(mutant.old)} times in {mutant.module}")
        self.text = text.replace(mutant.old, mutant.new)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return the module's specification, None for every other module."""
        return importlib.util.spec_from_loader(fullname, self) if fullname == self.mutant.module else None

    def get_code(self, fullname: str):
        """Return the changed source, compiled."""
        return compile(self.text, self.path, "exec")


def survivors(names: Sequence[str], made: Sequence[Made], known: Set[Key], folder: Path) -> list[str]:
    """Return the mutants that no run's comparison detects, beyond what is ``known`` without them.

    Runs are tried in turn: a run without a doubt cannot show that a doubt is dropped. Raises RuntimeError if a mutant
    cannot be tried.
    """
    return [name for name in names if not any(_noticed(name, one, folder) - known for one in made)]


def _noticed(name: str, made: Made, folder: Path) -> Set[Key]:
    """Return the contradictions between a run's outputs with a mutant in place."""
    chosen = folder / "mutated.pickle"
    chosen.write_bytes(pickle.dumps(made))
    command = [sys.executable, "-m", _MODULE, name, str(chosen)]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{name}: exit {done.returncode}: {done.stderr.decode()[-1500:]}")
    return pickle.loads(chosen.with_suffix(".noticed").read_bytes())  # noqa: S301 - the campaign's own


def _main(name: str, chosen: Path) -> None:
    mutant = MUTANTS[name]
    if mutant.module in sys.modules:
        raise LookupError(f"{mutant.module} is imported already: its change would have no effect")
    sys.meta_path.insert(0, Patched(mutant))
    made: Made = pickle.loads(chosen.read_bytes())  # noqa: S301 - the campaign's own
    with TemporaryDirectory() as reports:
        read = [*facts_of(made, Path(reports), (TABLES, *mutant.parts))]
        if SEVERAL in mutant.parts:
            # A run is compared with itself: that is enough to see a comparison err.
            read += facts_of_several([made, made], Path(reports))
    found = compare(read, [read_record(made.folder)])
    chosen.with_suffix(".noticed").write_bytes(pickle.dumps({one.key for one in found.disagreements}))


if __name__ == "__main__":
    _main(sys.argv[1], Path(sys.argv[2]))
