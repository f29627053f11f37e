"""`tester report`: a run's results as one page that can be sent, read offline and printed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.options import command
from tester.cli.stored_runs import kind_of, material_of, run_folder

if TYPE_CHECKING:
    from tester.report.charts import Material
    from tester.report.record_section import MachineWords, RunRecord
    from tester.store.records import RunInfo


@command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), default=None,
    help="File to write.  [default: reports/RUN.html, of several runs that of the first]",
)  # fmt: skip
@click.option("--law", default="", metavar="LAW", help="Draw a published law too: paper or v2.")
@click.option("--published/--no-published", default=True, show_default=True, help="Points of the paper beside.")
@click.option("--xlsx", is_flag=True, help="Also each run's tables as a workbook, RUN.xlsx beside the page.")
def report(runs: Sequence[str], out: Path | None, law: str, published: bool, xlsx: bool) -> None:
    """Write a report of each RUN into one HTML file: results with their uncertainty, figures, budgets, the record,
    and whether it is unchanged.

    The file holds everything, fetches nothing and has no script. A browser prints it, on paper or as PDF. Several runs
    are compared. The names of the files are printed.
    """
    from tester.report.page import page_of
    from tester.report.report_build import report_of
    from tester.results.formats import FORMATS, Record
    from tester.results.run_files import write_file, write_format
    from tester.store.run_reader import RunReader

    folders = [run_folder(name) for name in dict.fromkeys(runs)]
    records = [_record(folder) for folder in folders]

    def showing(record: RunRecord) -> Material:
        return material_of(record.results, law, published)

    page = page_of(report_of(records, showing))
    path = out if out is not None else Path("reports") / f"{records[0].name}.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, [page.encode()])
    click.echo(path)
    for folder in folders if xlsx else ():
        book = path.parent / f"{folder.name}.xlsx"
        with RunReader(folder) as reader:
            write_format(book, FORMATS["xlsx"], Record(reader))
        click.echo(book)


def _record(folder: Path) -> RunRecord:
    """Return the data of a run for a report; raises StoreError."""
    from tester.report.record_section import read_record
    from tester.store.run_reader import RunReader

    with RunReader(folder) as reader:
        info = reader.run().info
    return read_record(folder, _words_of(info))


def _words_of(info: RunInfo) -> MachineWords:
    """Return a kind's words for itself, and the packaged rig file most like the run's, or the kind's first."""
    from tester.kinds import load_rig, packaged_rigs, packaged_text
    from tester.report.record_section import MachineWords

    kind = kind_of(info)
    if kind is None:
        return MachineWords(info.kind, "")
    ring = kind.ring() if kind.ring is not None else None
    like = info.rig_source if info.rig_source in kind.rigs else next(iter(kind.rigs), "")
    if like not in packaged_rigs():  # the assumptions of a laboratory's own kind are in its own files
        return MachineWords(kind.title, kind.measurand, ring=ring)
    return MachineWords(kind.title, kind.measurand, packaged_text(like), load_rig(like).text, ring)
