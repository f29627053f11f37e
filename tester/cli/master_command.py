"""`tester master`: friction over speeds and temperatures on one curve over aT v, if it is one."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INCOMPLETE
from tester.cli.options import QuantityType, command, json_option
from tester.cli.stored_runs import of_one_kind, print_left_out, run_folder
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from sim.physics.materials import Rubber
    from tester.analysis.master_curve.fitted_curve import Master
    from tester.analysis.master_curve.points import MasterPart, MasterPoint, MasterRun
    from tester.inputs.materials.compound import LoadedCompound
    from tester.kinds.kind import Kind

FORMATS = ("csv", "png", "svg", "pdf")
GLASS = "glass"
"""Asks for Ts = Tg + 50 K."""


@command()
@click.argument("runs", metavar="RUN...", nargs=-1, required=True)
@click.option(
    "--reference", "reference_c", type=QuantityType("degC"), default=20.0, metavar="20degC",
    help="Reference temperature of the curve.  [default: 20degC]",
)
@click.option(
    "--ts", "ts_words", metavar="TS",
    help="Ts of the shift: such as -3degC, or glass, which is Tg + 50 K of the compound's file. Else it is fitted.",
)
@click.option("--compound", metavar="NAME", help="Which compound, where there are several.")
@click.option("--surface", metavar="NAME", help="Which surface, where there are several.")
@click.option("--interface", metavar="NAME", help="Which interface, where there are several: dry, wet, talc.")
@click.option("--load", metavar="LOAD", help="Which load, where there are several, such as 20N.")
@click.option("--each", is_flag=True, help="A curve for each compound, surface, interface and load, in one figure.")
@click.option("--format", "ending", type=click.Choice(FORMATS), default=None, help="By the ending of the file.")
@click.option(
    "-o", "--out", type=click.Path(dir_okay=False, path_type=Path), default=None,
    help="File that gets the table (csv) or the figure (png, svg, pdf).",
)
@json_option
def master(
    runs: Sequence[str],
    reference_c: float,
    ts_words: str | None,
    compound: str | None,
    surface: str | None,
    interface: str | None,
    load: str | None,
    each: bool,
    ending: str | None,
    out: Path | None,
    as_json: bool,
) -> int:
    """Put the conditions of RUNS on one curve over aT v, and report whether they form one.

    log10 aT = -8.86 (T - Ts) / (101.5 K + T - Ts) after Williams, Landel and Ferry. The table goes to stdout: x =
    log10(aT v) at the reference temperature, mu, measured temperature and speed, and how far mu is off the curve. The
    rest goes to stderr: first the verdict, then Ts with its 95 % interval, the scatter, the maxima with theirs, and the
    shifts between neighbouring temperatures by themselves. Runs in which friction heats the contact are refused.

    With --each, stdout has a row for each curve instead, and each of Grosch's two rules is compared with the maxima of
    all curves: of adhesion on glass and of the slower one on an abrasive, of deformation with the faster one.

    Exit code 0: it collapses; 1: it does not, or is refused; 6: these conditions cannot tell. With --each that of the
    worst curve.
    """
    from tester.analysis.master_curve.verdict import Verdict
    from tester.cli.master_each import curves_of, tell_each, write_each

    kind_of_file = _ending(ending, out)
    found = _runs(runs)
    points = [point for one in found for point in one.points]
    points = _chosen(points, compound, surface, interface, _quantity("--load", load, "N"), each=each)
    left_out = [entry for one in found for entry in one.left_out]

    one_of = partial(_curve, runs[0], reference_c, ts_words)
    made = curves_of(points, one_of) if each else [one_of(points)]
    tell_each(made, left_out, as_json) if each else _tell(made[0], left_out, as_json)
    if out is not None:
        write_each(made, out, kind_of_file) if each else _write(made[0], out, kind_of_file)
    codes = {Verdict.DOES_NOT: EXIT_FAILED, Verdict.OPEN: EXIT_INCOMPLETE, Verdict.COLLAPSES: EXIT_DONE}
    found_verdicts = {one.judged.verdict for one in made}
    return next(code for verdict, code in codes.items() if verdict in found_verdicts)


def _curve(run: str, reference_c: float, ts_words: str | None, points: Sequence[MasterPoint]) -> Master:
    """Return the curve of conditions of one compound on one track; ``run``: the materials beside it come first."""
    from tester.analysis.master_curve.fitted_curve import master_of
    from tester.cli.master_each import only_mechanism

    name = points[0].compound
    file = _compound_file(run, name)
    glass_c = file.model.Tg if file is not None else None
    only = only_mechanism(run, points[0].held)
    return master_of(points, reference_c, _ts(ts_words, name, glass_c), _rubber(file), glass_c, only=only)


def _ending(given: str | None, out: Path | None) -> str:
    """Return the format of the file; a usage error where there is a format and no file, or no format."""
    if out is None:
        if given is not None:
            raise click.UsageError(f"--format {given}: which file? (expected -o FILE.{given})")
        return ""
    written = out.suffix.removeprefix(".").lower()
    if written not in FORMATS:
        raise click.UsageError(f"-o {out}: the ending names no format (expected {', '.join(FORMATS)})")
    if given not in (None, written):
        raise click.UsageError(f"-o {out}: the ending is {written}, --format {given}")
    return written


def _quantity(option: str, text: str | None, unit: str) -> float | None:
    from tester.base.units import UnitError, parse

    try:
        return None if text is None else parse(text, unit)
    except UnitError as error:
        raise click.UsageError(f"{option}: {error}") from error


def _ts(words: str | None, compound: str, glass_c: float | None) -> float | None:
    """Return the Ts that was asked for, degC, None where it is to be looked for."""
    from sim.physics.wlf import GLASS_TO_REFERENCE_K

    if words != GLASS:
        return _quantity("--ts", words, "degC")
    if glass_c is None:
        raise click.UsageError(f"--ts {GLASS}: no file has the Tg of {shown(compound)} (expected such as --ts=-3degC)")
    return glass_c + GLASS_TO_REFERENCE_K


def _compound_file(run: str, compound: str) -> LoadedCompound | None:
    """Return a compound's file: the run's copy, else the laboratory's or the packaged one; None where there is none."""
    from sim.physics.materials import UnknownMaterialError
    from tester.base.source import InvalidSource
    from tester.inputs.materials.library import Library

    try:
        return Library.beside(run_folder(run) / "recipe.yaml").compound(compound)
    except UnknownMaterialError:
        return None
    except InvalidSource as error:
        raise click.ClickException(shown(str(error))) from error


def _rubber(file: LoadedCompound | None) -> Rubber | None:
    from tester.inputs.materials.library import MissingModuliError, rubber_of

    try:
        return rubber_of(file) if file is not None else None
    except MissingModuliError:
        return None


def _runs(names: Sequence[str]) -> list[MasterRun]:
    """Return the conditions of all runs; raises ClickException for a run that is refused."""
    _, runs = of_one_kind(
        names, lambda kind, name: _part(kind).packaged(name), lambda kind, folder: _part(kind).run(folder)
    )
    refused = [f"{name} is refused: {run.refusal}" for name, run in zip(names, runs, strict=True) if run.refusal]
    if refused:
        raise click.ClickException("\n".join(map(shown, refused)))
    return runs


def _part(kind: Kind) -> MasterPart:
    if kind.masters is None:
        raise click.ClickException(f"the kind {kind.name} has no master curves")
    return kind.masters()


def _chosen(
    points: Iterable[MasterPoint],
    compound: str | None,
    surface: str | None,
    interface: str | None,
    load_n: float | None,
    *,
    each: bool,
) -> list[MasterPoint]:
    """Return the conditions that were asked for; a usage error where they differ in more than speed and temperature,
    unless ``each`` has its curve.
    """
    left = [*points]
    load = None if load_n is None else f"{load_n:g} N"
    wanted = {"compound": compound, "surface": surface, "interface": interface, "load": load}
    for name, value in wanted.items():
        there = sorted({_held(one, name) for one in left} - {""})
        if value is not None:
            if value not in there:
                raise click.UsageError(f"--{name}: no condition of {value!r} (there are {', '.join(there) or 'none'})")
            left = [one for one in left if _held(one, name) == value]
        elif len(there) > 1 and not each:
            which = f"several values of {name}: {', '.join(there)}"
            raise click.UsageError(f"conditions of {which}; choose with --{name}, or --each")
    if not left:
        raise click.ClickException("no condition has a value to rely on")
    return left


def _held(point: MasterPoint, name: str) -> str:
    return point.compound if name == "compound" else point.held.get(name, "")


def _tell(made: Master, left_out: Sequence[tuple[str, str]], as_json: bool) -> None:
    from tester.analysis.master_curve.text import plain, summary_lines, table_lines, verdict_lines

    if as_json:
        dump({**plain(made), "left_out": [{"condition": label, "reason": reason} for label, reason in left_out]})
        return
    for line in verdict_lines(made):
        click.echo(shown(line), err=True)
    for line in table_lines(made):
        click.echo(line)
    for line in summary_lines(made):
        click.echo(shown(line), err=True)
    print_left_out(left_out)
    click.echo(next(verdict_lines(made)), err=True)  # again, below a table that has pushed the first one out of sight


def _write(made: Master, path: Path, ending: str) -> None:
    """Write the table or the figure."""
    from tester.analysis.master_curve.text import csv_text
    from tester.report.draw import draw
    from tester.report.law_charts import master_chart

    try:
        if ending == "csv":
            path.write_text(csv_text(made), encoding="utf-8", newline="")
        else:
            draw(master_chart(made), path)
    except OSError as error:
        raise click.ClickException(f"{path}: {error.strerror or error}") from error
    click.echo(f"written: {path}", err=True)
