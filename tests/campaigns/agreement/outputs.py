"""Requests and reads every output of a stored run: commands, tables, page, drawings, screens."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from traceback import extract_tb

from tests.campaigns.agreement.call import CallError, called
from tests.campaigns.agreement.facts import Facts
from tests.campaigns.agreement.read_figures import canvases, read_canvases
from tests.campaigns.agreement.read_json import read_compare_json, read_events, read_runs_json, read_show_json, times_of
from tests.campaigns.agreement.read_page import read_page
from tests.campaigns.agreement.read_stored import read_live, read_stored
from tests.campaigns.agreement.read_tables import read_table, sheets_of, sweep_facts
from tests.campaigns.agreement.read_text import read_budget, read_compare, read_ending, read_runs, read_show
from tests.campaigns.agreement.record import Record, read_record
from tests.campaigns.agreement.runs import Made
from tests.campaigns.agreement.screens import screens

COMMANDS, TABLES, REPORT, SCREENS, PAGE = "commands", "tables", "report", "screens", "page"
PARTS = (COMMANDS, TABLES, REPORT, SCREENS, PAGE)
"""Outputs of one run, by how they are made."""
SEVERAL = "several"
"""Outputs that compare runs."""
REPORTED = 4
"""One in so many compared pairs of runs also gets a report."""
FORMATS = ("appendix", "conditions", "budget", "repeats", "directions", "wheel", "pieces", "wear", "reference")
WORN = {"wheel_on_belt": "wheel", "specimen_on_track": "specimen"}


def facts_of(made: Made, reports: Path, parts: Sequence[str] = PARTS) -> Iterator[Facts]:
    """Yield the facts of every output of a run; for an output that fails, the failure."""
    record = read_record(made.folder)
    worn = WORN[record.kind]
    page = reports / f"{record.name}.html"
    readers: Mapping[str, Callable[[], Iterator[Facts]]] = {
        COMMANDS: partial(_commands, made, record, worn),
        TABLES: partial(_tables, record, worn),
        REPORT: partial(_report, [record], page, "report"),
        SCREENS: partial(screens, record, worn),
        PAGE: partial(_stored, record, worn),
    }
    for name in parts:
        if name in readers:
            yield from _whole(readers[name], f"{name} of {record.name}")


def _whole(read: Callable[[], Iterator[Facts]], name: str) -> Iterator[Facts]:
    """Yield what a reader yields; an output that cannot be made or read counts as a disagreement."""
    try:
        yield from read()
    except Exception as error:  # noqa: BLE001 - the campaign looks for any failure of an output
        last = extract_tb(error.__traceback__)[-1]
        yield Facts(name, strange=[f"fails: {error!r} at {Path(last.filename).name}:{last.lineno}"])


def _commands(made: Made, record: Record, worn: str) -> Iterator[Facts]:
    folder = str(made.folder)
    yield read_ending(record, worn, _ending(made.folder), "end of the run")
    if made.printed:
        yield read_ending(record, worn, made.printed.splitlines(), "end of the run as it was printed")
    if made.events:
        yield read_events(record, made.events, "run --json")
        yield times_of(record, made.events)
    yield read_show(record, worn, called("show", folder).out, "show")
    yield read_budget(record, worn, called("show", "--budget", folder).out, "show --budget")
    yield read_show_json(record, worn, called("show", "--json", folder).out, "show --json")
    if made.sweep is not None:
        yield sweep_facts(record, worn, made.sweep.read_text("utf-8"), "sweep conditions.csv", made.seed)


def _tables(record: Record, worn: str) -> Iterator[Facts]:
    for name in FORMATS:
        exported = called("export", str(record.folder), "--format", name).out
        yield read_table(record, worn, name, exported, f"export {name}")
        kept = record.folder / f"{name}.csv"
        if kept.is_file():
            yield read_table(record, worn, name, kept.read_text("utf-8"), kept.name)
    with TemporaryDirectory() as folder:
        book = Path(folder) / "tables.xlsx"
        called("export", str(record.folder), "--format", "xlsx", "--out", str(book))
        sheets = sheets_of(book)
    for name in FORMATS:
        if name in sheets and name != "appendix":  # a cell has no trailing zeros to show its number of digits
            yield read_table(record, worn, name, sheets[name], f"xlsx {name}")


def _stored(record: Record, worn: str) -> Iterator[Facts]:
    yield read_stored(record, "page in a browser")
    yield read_live(record, worn, "live results")


def _ending(folder: Path) -> list[str]:
    from tester.cli.ending import ending_lines

    return ending_lines(folder)


def _report(records: Sequence[Record], path: Path, name: str) -> Iterator[Facts]:
    folders = [str(record.folder) for record in records]
    with canvases() as drawn:
        called("report", *folders, "--out", str(path))
    worn = [WORN[record.kind] for record in records]
    yield read_page(records, worn, path.read_text("utf-8"), f"{name}")
    together = [one for one in drawn if len(records) == 1 or _of_all(one)]
    yield read_canvases(records, together, f"drawings of the {name}")


def _of_all(canvas: object) -> bool:
    title = str(canvas.get_suptitle())  # type: ignore[attr-defined]
    return "of each run" in title or title.startswith("runs, one after")


def facts_of_several(made: Sequence[Made], reports: Path) -> Iterator[Facts]:
    """Yield the facts of outputs that compare the runs of one folder: list, comparisons, report of several."""
    records = [read_record(one.folder) for one in made]
    yield from _whole(partial(_listed, records), "runs")
    alike = sorted(records, key=lambda record: record.kind)
    for number, (first, second) in enumerate(pairwise(alike)):
        if first.kind == second.kind:
            page = reports if number % REPORTED == 0 else None
            yield from _whole(partial(_pair, first, second, page), f"{first.name} beside {second.name}")


def _listed(records: Sequence[Record]) -> Iterator[Facts]:
    under = str(records[0].folder.parent)
    yield read_runs(records, called("runs", "--out", under).out, "runs")
    yield read_runs_json(records, called("runs", "--out", under, "--json").out, "runs --json")


def _pair(first: Record, second: Record, reports: Path | None) -> Iterator[Facts]:
    both = [str(first.folder), str(second.folder)]
    yield read_compare([first, second], called("compare", *both).out, "compare")
    yield read_compare_json([first, second], called("compare", *both, "--json").out, "compare --json")
    if reports is not None:
        yield from _report([first, second], reports / f"{first.name}+{second.name}.html", "report of two runs")


def figures_of(made: Made, folder: Path) -> Iterator[Facts]:
    """Yield the facts of `tester figure`."""
    yield from _whole(partial(_figures, read_record(made.folder), folder), f"figures of {made.folder.name}")


def _figures(record: Record, folder: Path) -> Iterator[Facts]:
    with canvases() as drawn:
        try:
            called("figure", str(record.folder), "--out", str(folder))
        except CallError as error:
            if "nothing to draw" not in str(error):
                raise
    yield read_canvases([record], drawn, "figure")
