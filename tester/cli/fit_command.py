"""`tester fit`: a law of friction fitted to measured conditions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.base.words import Json
from tester.cli.options import json_option
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.analysis.fit.fit_law import FitPoint, Law, Sourced
    from tester.analysis.fit.fit_part import FitPart
    from tester.analysis.fit.joint import GroupFit
    from tester.kinds.kind import Kind


class Conditions(NamedTuple):
    """The conditions of all sources of a command, and of which kind of rig they are."""

    kind: Kind
    points: list[FitPoint]
    left_out: list[tuple[str, str]]


@click.command()
@click.argument("sources", metavar="SOURCE...", nargs=-1, required=True)
@click.option(
    "--validate", "validation", multiple=True, metavar="SOURCE", help="Conditions to predict. May be given again."
)
@click.option(
    "--law", "law_name", metavar="LAW", default=None,
    help="Of a wheel v2 (unless told) or paper, the Eq 6; of a track wlf_bell (unless told), power, persson or greta.",
)  # fmt: skip
@click.option(
    "--hold", "holds", multiple=True, metavar="NAMES", help="Parameters not to fit: a,beta,tm as published, or tm=70."
)
@click.option("--surface", default="", metavar="NAME", help="What the track is covered with, for laws of materials.")
@click.option(
    "--given", "givens", multiple=True, metavar="NAME=VALUE", help="A figure of a law of materials, such as area=64."
)
@click.option("--force", is_flag=True, help="Print intervals and trends that are not to be relied on, too.")
@click.option("--check", is_flag=True, help="Hold the paper's own table against what has to come out.")
@json_option
def fit(
    sources: Sequence[str],
    validation: Sequence[str],
    law_name: str | None,
    holds: Sequence[str],
    surface: str,
    givens: Sequence[str],
    force: bool,
    check: bool,
    as_json: bool,
) -> int:
    """Fit a law of friction to the conditions of SOURCES: runs, or the paper's appendix-a and appendix-b.

    All parameters at once, a compound at a time (on a track, an interface and a surface, too), at the measured
    temperatures, loads and speeds. Prints first whether the law describes the conditions: its residuals beside their
    repeatability and the scatter between them, and their signs along every variable. Then the parameters with 95 %
    intervals, how far the law is off fitted, left-out and --validate conditions, and what it says: peaks, exponents,
    trends. Of a law that does not describe them, of a parameter that has no meaning for a rubber, and where nothing is
    known of the repeatability there are no intervals.

    --check, with appendix-a --validate appendix-b: the paper's table and our verdict.

    Exit code 1: a law does not describe the conditions, a parameter has no meaning, or a figure of --check misses.
    """
    from tester.analysis.fit.fit_law import FitError, by_group
    from tester.analysis.fit.joint import fit_group
    from tester.base.plugins import MissingExtraError

    fitted, others = _conditions(sources), _conditions(validation) if validation else None
    part = _part(fitted.kind)
    if others is not None and others.kind.name != fitted.kind.name:
        raise click.UsageError(f"--validate: conditions of the kind {others.kind.name}, not {fitted.kind.name}")
    if check and not part.checked(sources, validation):
        raise click.UsageError(
            f"--check: nothing is asked of this fit (expected {part.packaged[0]} --validate {part.packaged[-1]})"
        )
    both = sorted(set(sources) & set(validation))
    if both:
        raise click.UsageError(f"--validate: {', '.join(both)} is fitted, and says nothing of other conditions")
    law = _law(part, law_name)
    try:
        groups = by_group(fitted.points)
        if not groups:
            raise FitError(f"no condition of {', '.join(sources)} can be fitted{_why(fitted.left_out)}")
        figures = _figures(givens)
        fits = [
            fit_group(part.bound(law, name, surface, figures), name, own, part.cells, _held(law, name, holds))
            for name, own in groups.items()
        ]
        table = part.published_table() if check else None
    except MissingExtraError as error:
        raise click.UsageError(str(error)) from error
    except FitError as error:
        raise click.ClickException(shown(str(error))) from error
    rows = by_group(others.points) if others is not None else None
    told = _as_json(law, fits, rows, fitted, force) if as_json else {}
    if not as_json:
        _print(law, fits, rows, fitted, others, force)
    if table is not None:
        from tester.analysis.fit import as_json as plain
        from tester.analysis.fit.fit_text import table_lines

        told["check"] = plain.table(table)
        if not as_json:
            click.echo()
            for line in table_lines(table):
                click.echo(line)
    if as_json:
        dump(told)
    missed = table is not None and bool(table.missed)
    return EXIT_FAILED if missed or not all(one.sound for one in fits) else EXIT_DONE


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
    """Return the conditions of sources of one kind; what is none, or named twice, is a usage error."""
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise click.UsageError(f"{', '.join(doubled)}: named twice, and its conditions would count twice")
    found = [_source(name) for name in names]
    kinds = {kind.name: kind for kind, _ in found}
    if len(kinds) > 1:
        raise click.UsageError(f"conditions of different kinds of rigs: {', '.join(kinds)}")
    points = [point for _, one in found for point in one.points]
    left_out = [entry for _, one in found for entry in one.left_out]
    return Conditions(found[0][0], points, left_out)


def _source(name: str) -> tuple[Kind, Sourced]:
    from tester.base.source import InvalidSource
    from tester.cli.options import run_folder
    from tester.kinds import UnknownKindError, find, packaged_conditions
    from tester.store.record_schema import StoreError
    from tester.store.run_reader import RunReader

    kind = packaged_conditions().get(name)
    if kind is not None:
        return kind, _part(kind).packaged_points(name)
    folder = run_folder(name)
    try:
        with RunReader(folder) as reader:
            kind = find(reader.run().info.kind)
        return kind, _part(kind).run_points(folder)
    except (StoreError, UnknownKindError, InvalidSource) as error:
        raise click.ClickException(str(error)) from error


def _held(law: Law, group: str, holds: Sequence[str]) -> dict[str, float]:
    """Return the parameters that are held for a group: as told, or as published for it."""
    held: dict[str, float] = {}
    for text in (part.strip() for given in holds for part in given.split(",")):
        name, equals, value = text.partition("=")
        if name not in law.names:
            raise click.UsageError(f"--hold: the law {law.name} has no parameter {name!r} ({', '.join(law.names)})")
        if equals:
            held[name] = _number("--hold", text, value)
        elif group in law.published:
            held[name] = law.published[group][law.names.index(name)]
        else:
            raise click.UsageError(f"--hold {name}: nothing is published of {group} (expected {name}=VALUE)")
    return held


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
    fitted: Conditions,
    others: Conditions | None,
    force: bool,
) -> None:
    from tester.analysis.fit.fit_text import all_lines, group_lines, law_line, trend_lines, verdict_lines
    from tester.analysis.fit.joint import overall

    click.echo(law_line(law))
    for one in fits:
        for line in verdict_lines(one):
            click.echo(shown(line))
    if not force and not all(one.sound for one in fits):
        click.echo("--force prints the intervals and trends that are not to be relied on")
    click.echo()
    for one in fits:
        validation = one.errors_on(rows.get(one.group, [])) if rows is not None else None
        for line in group_lines(one, validation, force=force):
            click.echo(shown(line))
    click.echo("\nall:")
    for line in all_lines(overall(fits, rows)):
        click.echo(line)
    click.echo("\nwhat it says:")
    for line in trend_lines(fits, force=force):
        click.echo(shown(line))
    reasons: dict[str, list[str]] = {}
    for label, reason in [*fitted.left_out, *(others.left_out if others is not None else [])]:
        reasons.setdefault(reason, []).append(label)
    for reason, labels in reasons.items():
        click.echo(f"left out ({shown(reason)}): {shown(', '.join(labels))}", err=True)
    unseen = sorted(set(rows or {}) - {one.group for one in fits})
    if unseen:
        click.echo(f"not predicted, for nothing was fitted to it: {shown(', '.join(unseen))}", err=True)


def _as_json(
    law: Law, fits: Sequence[GroupFit], rows: dict[str, list[FitPoint]] | None, fitted: Conditions, force: bool
) -> dict[str, Json]:
    from tester.analysis.fit import as_json as plain
    from tester.analysis.fit.joint import overall

    every = overall(fits, rows)
    groups: list[Json] = []
    for one in fits:
        validation = one.errors_on(rows.get(one.group, [])) if rows is not None else None
        groups.append(plain.group(one, validation, force=force))
    return {
        "law": law.name,
        "formula": law.formula,
        "groups": groups,
        "all": {
            "errors": plain.errors(every.fitted),
            "left_out": plain.errors(every.left_out),
            "validation": plain.errors(every.validation),
        },
        "not_fitted": [{"condition": label, "reason": reason} for label, reason in fitted.left_out],
    }
