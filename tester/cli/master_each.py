"""`tester master --each`: a curve for each compound and track, and Grosch's rules over all of them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Final

import click

from tester.analysis.master_curve.points import MasterError
from tester.analysis.master_curve.rules import WITHIN_DECADES, Mechanism, RuleVerdict
from tester.base.words import Json
from tester.cli.stored_runs import print_left_out, run_folder
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.analysis.master_curve.fitted_curve import Master
    from tester.analysis.master_curve.points import MasterPoint
    from tester.analysis.master_curve.rules import Rule

SMOOTH: Final = 0.1
"""Rms slope below which a surface is smooth [A]: glass has 0.001, polished steel 0.04, silicon carbide 1.25."""
HEADER: Final = f"{'curve':<41} {'verdict':<17} {'Ts degC (95 %)':<22} maxima m/s (95 %), mu"


def only_mechanism(run: str, held: Mapping[str, str]) -> Mechanism | None:
    """Return the mechanism of a curve's only maximum, by its track: the surface's file, and the interface."""
    from sim.physics.materials import UnknownMaterialError
    from tester.base.source import InvalidSource
    from tester.inputs.materials.library import Library

    if held.get("interface") == "talc":
        return Mechanism.DEFORMATION
    try:
        spectrum = Library.beside(run_folder(run) / "recipe.yaml").surface(held.get("surface", "")).spectrum
    except (UnknownMaterialError, InvalidSource):
        return None
    return Mechanism.ADHESION if spectrum is not None and spectrum.rms_slope < SMOOTH else None


def curves_of(points: Sequence[MasterPoint], one_of: Callable[[Sequence[MasterPoint]], Master]) -> list[Master]:
    """Return the curve of each compound, surface, interface and load; raises MasterError, naming the curve."""
    groups: defaultdict[tuple[object, ...], list[MasterPoint]] = defaultdict(list)
    for point in points:
        groups[point.compound, *point.held.items()].append(point)
    found: list[Master] = []
    for own in groups.values():
        try:
            found.append(one_of(own))
        except MasterError as error:
            raise MasterError(f"{_words(own[0])}: {error}") from error
    return found


def _words(point: MasterPoint) -> str:
    return ", ".join((point.compound, *point.held.values()))


def tell_each(curves: Sequence[Master], left_out: Sequence[tuple[str, str]], as_json: bool) -> None:
    """Print a row for each curve, and the rules."""
    from tester.analysis.master_curve.text import choice_words, plain

    if as_json:
        reasons: list[Json] = [{"condition": label, "reason": reason} for label, reason in left_out]
        dump({"curves": [plain(one) for one in curves], "left_out": reasons})
        return
    click.echo(HEADER)
    for one in curves:
        click.echo(shown(_row(one)))
    for one in curves:
        name = _words(one.points[0])
        for reason in one.judged.reasons:
            click.echo(shown(f"{name}: {reason}"), err=True)
        if one.choice is not None:
            click.echo(shown(f"{name}: {choice_words(one.choice)}"), err=True)
    for mechanism in Mechanism:
        for line in rule_lines(curves, mechanism):
            click.echo(shown(line), err=True)
    print_left_out(left_out)


def _row(one: Master) -> str:
    c = one.collapse
    ts = f"{c.ts_c:.1f} ({c.interval[0]:.1f} to {c.interval[1]:.1f})" if c.searched else f"{c.ts_c:.1f} given"
    maxima = "; ".join(
        f"{peak.speed_m_s:.3g} ({peak.interval_m_s[0]:.3g} to {peak.interval_m_s[1]:.3g}), {peak.mu:.2f}"
        for peak in one.peaks
    )
    return f"{_words(one.points[0]):<41} {one.judged.verdict.value:<17} {ts:<22} {maxima or 'none'}"


def rule_lines(curves: Sequence[Master], mechanism: Mechanism) -> Iterator[str]:
    """Yield a rule's outcome over all curves: how far each maximum is from it, and whether compounds agree."""
    compared = [
        (_words(one.points[0]), one.points[0].compound, rule)
        for one in curves
        for rule in one.rules
        if rule.mechanism is mechanism and rule.assigned
    ]
    if not compared:
        yield f"rule of {mechanism.value}: no maximum to compare it with"
        return
    verdicts = {rule.verdict for _, _, rule in compared}
    outcome = verdicts.pop() if len(verdicts) == 1 else None
    if outcome is None:
        outcome = RuleVerdict.DOES_NOT if RuleVerdict.DOES_NOT in verdicts else RuleVerdict.OPEN
    asked = f"within {WITHIN_DECADES:g} decades expected"
    yield f"rule of {mechanism.value}, {compared[0][2].name}: {outcome.value} ({asked})"
    for name, _, rule in compared:
        low, high = rule.interval
        yield f"  {name}: {rule.decades:+.2f} decades from it (95 %: {low:+.2f} to {high:+.2f}): {rule.verdict.value}"
    yield from _between_compounds([(compound, rule) for _, compound, rule in compared])


def _between_compounds(compared: Sequence[tuple[str, Rule]]) -> Iterator[str]:
    """Yield whether the ratio to the frequency is the same for all compounds, as far as intervals show it."""
    pairs = [(a, b) for (x, a), (y, b) in combinations(compared, 2) if x != y and isfinite(a.decades + b.decades)]
    if not pairs:
        return
    most = max(abs(a.decades - b.decades) for a, b in pairs)
    apart = any(a.interval[0] > b.interval[1] or b.interval[0] > a.interval[1] for a, b in pairs)
    yield f"  between compounds: {most:.2f} decades at most, intervals {'do not all overlap' if apart else 'overlap'}"


def write_each(curves: Sequence[Master], path: Path, ending: str) -> None:
    """Write the figure; raises ClickException for a table, and where the file cannot be written."""
    from tester.report.draw import draw
    from tester.report.law_charts import masters_chart

    if ending == "csv":
        raise click.UsageError(f"-o {path}: a table has one curve (expected png, svg or pdf with --each)")
    try:
        draw(masters_chart(curves), path)
    except OSError as error:
        raise click.ClickException(f"{path}: {error.strerror or error}") from error
    click.echo(f"written: {path}", err=True)
