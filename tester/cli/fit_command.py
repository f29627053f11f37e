"""`tester fit`: a law of friction fitted to measured conditions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.base.words import Json
from tester.cli.options import QuantityType, command, json_option
from tester.cli.stored_runs import of_one_kind, print_left_out
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.analysis.fit.fit_law import FitPoint, Law, Sourced
    from tester.analysis.fit.fit_part import FitPart, PublishedTable
    from tester.analysis.fit.joint import Errors, GroupFit
    from tester.kinds.kind import Kind


class Conditions(NamedTuple):
    """The conditions of all sources of a command, their kind of rig, and its laws with the materials of the runs."""

    kind: Kind
    part: FitPart
    points: list[FitPoint]
    left_out: list[tuple[str, str]]

    def under(self, law: Law) -> Conditions:
        """Return those at which a law has a value."""
        if law.leaves_out is None:
            return self
        reasons = [law.leaves_out(point.nominal) for point in self.points]
        left_out = [(point.label, why) for point, why in zip(self.points, reasons, strict=True) if why]
        points = [point for point, why in zip(self.points, reasons, strict=True) if not why]
        return self._replace(points=points, left_out=[*self.left_out, *left_out])


@command()
@click.argument("sources", metavar="SOURCE...", nargs=-1, required=True)
@click.option(
    "--validate", "validation", multiple=True, metavar="SOURCE", help="Conditions to predict. May be given again."
)
@click.option(
    "--law", "law_name", metavar="LAW", default=None,
    help="Of a wheel v2 (default), paper, the Eq 6, or power; of a track wlf_bell (default), power, persson or greta.",
)  # fmt: skip
@click.option(
    "--hold", "holds", multiple=True, metavar="NAMES", help="Parameters not to fit: a,beta,tm as published, or tm=70."
)
@click.option("--surface", default="", metavar="NAME", help="Surface of the track, for laws of materials.")
@click.option(
    "--given", "givens", multiple=True, metavar="NAME=VALUE", help="A figure of a law of materials, such as area=64."
)
@click.option("--force", is_flag=True, help="Also print intervals not to be relied on; replace the file of -o.")
@click.option(
    "-o", "--out", type=click.Path(dir_okay=False, path_type=Path), default=None, metavar="FILE",
    help="Keep the law in FILE, of several compounds one file each.",
)  # fmt: skip
@click.option("--area", type=QuantityType("mm2"), default=None, help="Nominal area of contact, kept with the law.")
@click.option("--check", is_flag=True, help="Compare the paper's own table with the expected verdict.")
@json_option
def fit(
    sources: Sequence[str], validation: Sequence[str], law_name: str | None, holds: Sequence[str], surface: str,
    givens: Sequence[str], force: bool, out: Path | None, area: float | None, check: bool, as_json: bool,
) -> int:  # fmt: skip
    """Fit a law of friction to the conditions of SOURCES: runs, or the paper's appendix-a and appendix-b.

    All parameters at once, a compound at a time (on a track also an interface and a surface at a time), at the measured
    temperatures, loads and speeds. Prints first whether the law describes the conditions: its residuals beside their
    repeatability and the scatter between them, and their signs along every variable. Then the parameters with 95 %
    intervals, how far the law is off fitted, left-out and --validate conditions, and its consequences: peaks,
    exponents, trends. There are no intervals for a law that does not describe the conditions, for a parameter that has
    no meaning for a rubber, and where the repeatability is unknown.

    -o keeps the law for `tester predict`, `compare`, `figure`, `export` and a simulated rig. --check, with appendix-a
    --validate appendix-b: the paper's table and our verdict.

    Exit code 1: a law does not describe the conditions, a parameter has no meaning, or a figure of --check misses.
    """
    from tester.analysis.fit.fit_law import FitError, by_group
    from tester.analysis.fit.joint import fit_group
    from tester.cli.keep_law import Given, keep

    fitted, others = _conditions(sources), _conditions(validation) if validation else None
    part = fitted.part
    _refuse_mixed(fitted, sources, others, validation)
    _refuse_unchecked(part, sources, validation, check=check)
    law = _law(part, law_name)
    fitted, others = fitted.under(law), others.under(law) if others is not None else None
    groups = by_group(fitted.points)
    if not groups:
        raise FitError(f"no condition of {', '.join(sources)} can be fitted{_why(fitted.left_out)}")
    figures, cells = _figures(givens), part.cells
    bound = {name: part.bound(law, name, surface, figures) for name in groups}
    fits = [fit_group(bound[name], name, own, cells, _held(law, name, holds)) for name, own in groups.items()]
    rows = by_group(others.points) if others is not None else None
    table = part.published_table() if check else None
    if out is not None:
        keep(out, fits, fitted.kind.name, part, area, force, Given(surface, figures))
    if as_json:
        dump(_as_json(law, fits, rows, fitted, force, table))
    else:
        _print(law, fits, rows, [*fitted.left_out, *(others.left_out if others is not None else [])], force, table)
    missed = table is not None and bool(table.missed)
    return EXIT_FAILED if missed or not all(one.sound for one in fits) else EXIT_DONE


def _refuse_unchecked(part: FitPart, sources: Sequence[str], validation: Sequence[str], *, check: bool) -> None:
    """Raise UsageError where --check is asked for and no verdict is known for these sources."""
    if check and not part.checked(sources, validation):
        raise click.UsageError(
            f"--check: nothing is asked of this fit (expected {part.packaged[0]} --validate {part.packaged[-1]})"
        )


def _refuse_mixed(
    fitted: Conditions, sources: Sequence[str], others: Conditions | None, validation: Sequence[str]
) -> None:
    """Raise UsageError where --validate names conditions of another kind, or conditions that are fitted."""
    if others is not None and others.kind.name != fitted.kind.name:
        raise click.UsageError(f"--validate: conditions of the kind {others.kind.name}, not {fitted.kind.name}")
    if both := sorted(set(sources) & set(validation)):
        raise click.UsageError(f"--validate: {', '.join(both)} is fitted, and shows nothing of other conditions")


def _part(kind: Kind) -> FitPart:
    if kind.fits is None:
        raise click.UsageError(f"no law can be fitted to conditions of the kind {kind.name}: it brings none")
    return kind.fits()


def _law(part: FitPart, name: str | None) -> Law:
    if name is None:
        return next(iter(part.laws.values()))
    if name not in part.laws:
        raise click.UsageError(f"no law {name!r} can be fitted (expected {', '.join(part.laws)})")
    return part.laws[name]


def _conditions(names: Sequence[str]) -> Conditions:
    """Return the conditions of sources of one kind."""
    folders: list[Path] = []

    def points_of(kind: Kind, folder: Path) -> Sourced:
        folders.append(folder)
        return _part(kind).run_points(folder)

    kind, found = of_one_kind(names, lambda kind, name: _part(kind).packaged_points(name), points_of)
    points = [point for one in found for point in one.points]
    left_out = [entry for one in found for entry in one.left_out]
    return Conditions(kind, _part(kind).of_runs(folders), points, left_out)


def _held(law: Law, group: str, holds: Sequence[str]) -> dict[str, float]:
    """Return the parameters that are not fitted to a group: as given, or as published for it."""
    values: dict[str, float] = {}
    for text in (part.strip() for given in holds for part in given.split(",")):
        name, equals, value = text.partition("=")
        if name not in law.names:
            raise click.UsageError(f"--hold: the law {law.name} has no parameter {name!r} ({', '.join(law.names)})")
        if equals:
            values[name] = _number("--hold", text, value)
        elif group in law.published:
            values[name] = law.published[group][law.names.index(name)]
        else:
            raise click.UsageError(f"--hold {name}: nothing is published of {group} (expected {name}=VALUE)")
    return values


def _figures(givens: Sequence[str]) -> dict[str, float]:
    pairs = [(text, *text.partition("=")) for given in givens for text in given.split(",")]
    return {name.strip(): _number("--given", text, value) for text, name, _, value in pairs}


def _number(option: str, text: str, value: str) -> float:
    from math import isfinite

    try:
        number = float(value)
    except ValueError:
        number = float("nan")
    if not isfinite(number):
        raise click.UsageError(f"{option} {text}: {value!r} is no number (expected such as tm=70)")
    return number


def _why(left_out: Sequence[tuple[str, str]]) -> str:
    reasons = sorted({reason for _, reason in left_out})
    return f": left out for {'; '.join(reasons)}" if reasons else ""


def _print(
    law: Law,
    fits: Sequence[GroupFit],
    rows: dict[str, list[FitPoint]] | None,
    left_out: Sequence[tuple[str, str]],
    force: bool,
    table: PublishedTable | None,
) -> None:
    from tester.analysis.fit.fit_text import all_lines, group_lines, law_line, table_lines, trend_lines, verdict_lines
    from tester.analysis.fit.joint import overall

    lines = [law_line(law), *(line for one in fits for line in verdict_lines(one))]
    if not force and not all(one.sound for one in fits):
        lines.append("--force prints the intervals and trends that are not to be relied on")
    lines.append("")
    for one in fits:
        lines += group_lines(one, _errors(one, rows), force=force)
    lines += ["", "all:", *all_lines(overall(fits, rows)), "", "consequences:", *trend_lines(fits, force=force)]
    for line in lines:
        click.echo(shown(line))
    print_left_out(left_out)
    unseen = sorted(set(rows or {}) - {one.group for one in fits})
    if unseen:
        click.echo(f"not predicted, for nothing was fitted to it: {shown(', '.join(unseen))}", err=True)
    for line in ["", *table_lines(table)] if table is not None else ():
        click.echo(line)


def _errors(fit: GroupFit, rows: dict[str, list[FitPoint]] | None) -> Errors | None:
    """Return the errors of a fit on those conditions of its group that were not fitted."""
    return fit.errors_on(rows.get(fit.group, [])) if rows is not None else None


def _as_json(
    law: Law,
    fits: Sequence[GroupFit],
    rows: dict[str, list[FitPoint]] | None,
    fitted: Conditions,
    force: bool,
    table: PublishedTable | None,
) -> dict[str, Json]:
    from tester.analysis.fit import as_json as plain
    from tester.analysis.fit.joint import overall

    every = overall(fits, rows)
    groups: list[Json] = [plain.group(one, _errors(one, rows), force=force) for one in fits]
    errors = {"errors": every.fitted, "left_out": every.left_out, "validation": every.validation}
    return {
        "law": law.name,
        "formula": law.formula,
        "groups": groups,
        "all": {name: plain.errors(each) for name, each in errors.items()},
        "not_fitted": [{"condition": label, "reason": reason} for label, reason in fitted.left_out],
        **({"check": plain.table(table)} if table is not None else {}),
    }
