"""`tester components`: adhesion and hysteresis of conditions that were measured dry and with a film."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

import click

from tester.base.axes import ListWords
from tester.base.words import Json, coefficient, finite
from tester.cli.options import command, json_option
from tester.cli.stored_runs import results_named
from tester.cli.text_table import dump, plain_lines, shown

if TYPE_CHECKING:
    from tester.analysis.components import PartValue
    from tester.results.components_table import FilmPair, SharesMean

ASSUMED = (
    "assumed: the film takes all adhesion away, leaves all hysteresis, and does not lift the specimen",
    "U (95 %): of this specimen; what dry and film have in common counts as far as it moves the component",
    "warmer: dry contact over the other; the film's coefficient is taken to the dry one's temperature, with what is "
    "known of its sensitivity (0 +- 2.6 %/K where the run has one temperature)",
)


@command()
@click.argument("run")
@json_option
def components(run: str, as_json: bool) -> None:
    """Split the coefficients of RUN into adhesion and hysteresis: dry less wet, or less talc.

    For conditions of one specimen that were measured dry and with a film at the same speed, load and temperature:
    hysteresis is the coefficient with the film, adhesion the dry one less that, each with its expanded uncertainty;
    share is that of hysteresis in the dry coefficient. Ends with the mean share of each compound.
    """
    from tester.results.components_table import film_pairs, has_interfaces, means_of

    results = results_named(run)
    if not has_interfaces(results):
        raise click.ClickException(f"{run}: its conditions do not say what is in the contact (no interface)")
    pairs = [*film_pairs(results)]
    means = [*means_of(pairs)]
    if as_json:
        conditions: list[Json] = [*map(_pair_json, pairs)]
        dump({"conditions": conditions, "means": [*map(_mean_json, means)], "assumed": [*ASSUMED]})
        return
    if not pairs:
        raise click.ClickException(
            f"{run}: no condition has a value both dry and with a film on one specimen (expected interface: [dry, wet])"
        )
    for line in _lines(pairs, means):
        click.echo(line)


def _lines(pairs: Sequence[FilmPair], means: Sequence[SharesMean]) -> Iterator[str]:
    """Yield the setpoints that all pairs share, a row for each pair, the means, and the assumptions."""
    from tester.results.columns import Column, Table
    from tester.results.components_table import FilmPair

    words = ListWords(pair.film.info.setpoint for pair in pairs)
    if words.common:
        yield f"all at {shown(words.common)}"
    columns = (
        Column[FilmPair]("condition", "condition", lambda pair: words.of(pair.film.info.setpoint)),
        Column[FilmPair]("dry", "dry", lambda pair: coefficient(pair.dry.result.mu_resultant)),
        Column[FilmPair]("film", "film", lambda pair: coefficient(pair.film.result.mu_resultant)),
        Column[FilmPair]("adhesion", "adhesion", lambda pair: _with_u(pair.parts.adhesion)),
        Column[FilmPair]("hysteresis", "hysteresis", lambda pair: _with_u(pair.parts.hysteresis)),
        Column[FilmPair]("share", "share", lambda pair: _with_u(pair.parts.share)),
        Column[FilmPair]("warmer", "warmer (K)", lambda pair: pair.parts.warmer_k, decimals=1),
    )
    yield from plain_lines(Table(columns, tuple(pairs)))
    for mean in means:
        on = f" on {mean.surface}" if mean.surface else ""
        of = f"{mean.compound}, {mean.interface}{on}: share of hysteresis, mean of {mean.conditions} conditions"
        yield f"{shown(of)}: {_with_u(mean.share)}"
    if any(not isfinite(pair.parts.share.expanded) for pair in pairs):
        yield "no U: a condition measured once does not show its repeatability (measure: repeats: 2 or more)"
    yield "dry, film: mu as measured, at the temperatures that were measured"
    yield from ASSUMED


def _with_u(part: PartValue) -> str:
    value = coefficient(part.value)
    return f"{value} ± {coefficient(part.expanded)}" if isfinite(part.expanded) else value


def _estimate_json(part: PartValue) -> dict[str, Json]:
    return {"value": finite(part.value), "u": finite(part.standard), "U": finite(part.expanded)}


def _pair_json(pair: FilmPair) -> dict[str, Json]:
    info, parts = pair.film.info, pair.parts
    return {
        "compound": info.setpoint.compound,
        "specimen": info.specimen,
        "replicate": info.replicate,
        **{axis.column: axis.of(info.setpoint) for axis in info.setpoint.axes},
        "mu_dry_as_measured": finite(pair.dry.result.mu_resultant),
        "mu_film_as_measured": finite(pair.film.result.mu_resultant),
        "adhesion": _estimate_json(parts.adhesion),
        "hysteresis": _estimate_json(parts.hysteresis),
        "hysteresis_share": _estimate_json(parts.share),
        "dry_warmer_k": finite(parts.warmer_k),
    }


def _mean_json(mean: SharesMean) -> dict[str, Json]:
    return {
        "compound": mean.compound,
        "interface": mean.interface,
        "surface": mean.surface,
        "conditions": mean.conditions,
        "hysteresis_share": _estimate_json(mean.share),
    }
