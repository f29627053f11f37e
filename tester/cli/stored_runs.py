"""What commands read of stored runs: results, kind, values for figures, and sources of fits and master curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.analysis.fit.fit_part import FitPart, LawPlace
    from tester.base.axes import Setpoint
    from tester.inputs.kept_laws.law_value import KeptLaw
    from tester.kinds.kind import Kind
    from tester.report.charts import Material
    from tester.results.run_results import RunResults
    from tester.store.records import RunInfo

Read = TypeVar("Read")


def run_folder(name: str) -> Path:
    """Return the folder of a run; an unknown name is a usage error."""
    from tester.store.record_schema import StoreError
    from tester.store.run_folders import find_run

    try:
        return find_run(name)
    except StoreError as error:
        raise click.UsageError(str(error)) from error


def results_named(run: str) -> RunResults:
    """Return a run's results; raises StoreError."""
    from tester.results.run_results import results_of
    from tester.store.run_reader import RunReader

    with RunReader(run_folder(run)) as reader:
        return results_of(reader)


def kind_in(folder: Path) -> Kind:
    """Return the kind of a run's rig; raises StoreError, UnknownKindError."""
    from tester.kinds import find
    from tester.store.run_reader import RunReader

    with RunReader(folder) as reader:
        return find(reader.run().info.kind)


def kind_of(info: RunInfo) -> Kind | None:
    """Return the kind of a run's rig, None where it is not installed."""
    from tester.kinds import UnknownKindError, find

    try:
        return find(info.kind)
    except UnknownKindError:
        return None


def material_of(results: RunResults, law: str, published: bool) -> Material:
    """Return the material of a run's figures; an unknown law is a usage error."""
    from tester.inputs.kept_laws.law_materials import read_law
    from tester.inputs.rig.profiles import is_law_file
    from tester.report.charts import ChartValue, Material, values_of

    measured = values_of(results)
    kind = kind_of(results.run.info)
    fits = kind.fits if kind is not None else None
    if fits is None:
        if law:
            raise click.UsageError(f"--law: no law is known of the kind {results.run.info.kind}")
        return Material(measured)
    part = fits()
    beside = [ChartValue(setpoint, mu) for setpoint, mu in part.published_values()] if published else []
    if not law:
        return Material(measured, beside)
    if is_law_file(law):
        kept = read_law(Path(law))
        if results.run.info.kind != kept.model.kind:
            raise click.UsageError(f"--law: {law} is of the kind {kept.model.kind}, not {results.run.info.kind}")
        for doubt in kept.doubts:
            click.echo(f"warning: {shown(doubt)}", err=True)
        abrasive = results.run.info.metadata.get("abrasive", "")
        value, caveats = _kept_at(kept, part, abrasive)
        return Material(measured, beside, value, f"law {kept.name}", caveats)
    try:
        return Material(measured, beside, part.law_at(law), f"law {law}", part.law_caveats)
    except KeyError as error:
        known = ", ".join(part.published_laws)
        expected = f"expected {known}" if known else "of this kind of rig no law has any: fit one with tester fit"
        raise click.UsageError(f"--law: no law {law!r} with published parameters ({expected})") from error


def _kept_at(
    kept: KeptLaw, part: FitPart, abrasive: str
) -> tuple[Callable[[Setpoint], float], Callable[[Setpoint], Sequence[str]]]:
    """Return a kept law over setpoints, NaN where it is of something else, and what to take care of there."""
    model = kept.model

    def place(setpoint: Setpoint) -> LawPlace | None:
        at = part.place(setpoint)
        if at is None:
            return None
        of = at.subject
        own = (of.compound, of.interface, of.surface or (abrasive if of.interface else ""))
        return at if own == (model.compound, model.interface, model.surface) else None

    def value(setpoint: Setpoint) -> float:
        at = place(setpoint)
        return kept.mu(*at[1:]) if at is not None else float("nan")

    def caveats(setpoint: Setpoint) -> Sequence[str]:
        at = place(setpoint)
        return [*kept.beyond(*at[1:])] if at is not None else []

    return value, caveats


def of_one_kind(
    names: Sequence[str], packaged: Callable[[Kind, str], Read], stored: Callable[[Kind, Path], Read]
) -> tuple[Kind, list[Read]]:
    """Return the kind of the sources with these names, and for each source the result of its reader.

    ``packaged`` reads a packaged table, ``stored`` a run.

    A name that is given twice, or sources of different kinds, are a usage error; a run that cannot be read a
    ClickException.
    """
    from tester.base.source import InvalidSource
    from tester.kinds import packaged_conditions

    if doubled := sorted({name for name in names if names.count(name) > 1}):
        raise click.UsageError(f"{', '.join(doubled)}: named twice, and its conditions would count twice")
    kinds: dict[str, Kind] = {}
    read: list[Read] = []
    for name in names:
        kind = packaged_conditions().get(name)
        try:
            if kind is not None:
                read.append(packaged(kind, name))
            else:
                folder = run_folder(name)
                kind = kind_in(folder)
                read.append(stored(kind, folder))
        except InvalidSource as error:
            raise click.ClickException(f"{name}: {error}") from error
        kinds[kind.name] = kind
    if len(kinds) > 1:
        raise click.UsageError(f"conditions of different kinds of rigs: {', '.join(sorted(kinds))}")
    return next(iter(kinds.values())), read


def print_left_out(left_out: Iterable[tuple[str, str]]) -> None:
    """Print on stderr the conditions that are left out, a line for each reason."""
    reasons: dict[str, list[str]] = {}
    for label, reason in left_out:
        reasons.setdefault(reason, []).append(label)
    for reason, labels in reasons.items():
        click.echo(f"left out ({shown(reason)}): {shown(', '.join(labels))}", err=True)
