"""`tester components`: adhesion and hysteresis of what was measured dry and with a film."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

import click

from tester.base.axes import ListWords
from tester.base.words import Json, coefficient, finite
from tester.cli.options import json_option, run_folder
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.analysis.components import PartValue
    from tester.results.components_table import FilmPair, SharesMean

ASSUMED = (
    "assumed: the film takes all adhesion away, leaves all hysteresis, and does not lift the specimen",
    "U (95 %): of this specimen; what dry and film have in common counts as far as it moves the component",
    "warmer: dry contact over the other; the film's coefficient is taken to the dry one's temperature, with what is "
    "known of its sensitivity (0 +- 2.6 %/K where the run has one temperature)",
)

_WIDTH = 18
"""Of a column: a value with its U."""


@click.command()
@click.argument("run")
@json_option
def components(run: str, as_json: bool) -> None:
    """Split the coefficients of RUN into adhesion and hysteresis: dry less wet, or less talc.

    For conditions of one specimen that were measured dry and with a film at the same speed, load and temperature:
    hysteresis is the coefficient with the film, adhesion the dry one less that, each with its expanded uncertainty;
    share is that of hysteresis in the dry coefficient. Ends with the mean share of each compound.
    """
    from tester.results.components_table import film_pairs, has_interfaces, means_of
    from tester.results.run_results import results_of
    from tester.store.record_schema import StoreError
    from tester.store.run_reader import RunReader

    try:
        with RunReader(run_folder(run)) as reader:
            results = results_of(reader)
    except StoreError as error:
        raise click.ClickException(str(error)) from error
    if not has_interfaces(results):
        raise click.ClickException(f"{run}: its conditions do not say what is in the contact (no interface)")
    pairs = [*film_pairs(results)]
    means = [*means_of(pairs)]
    if as_json:
        conditions: list[Json] = [_pair_json(one) for one in pairs]
        dump({"conditions": conditions, "means": [*map(_mean_json, means)], "assumed": [*ASSUMED]})
        return
    if not pairs:
        raise click.ClickException(
            f"{run}: no condition has a value both dry and with a film on one specimen (expected interface: [dry, wet])"
        )
    words = ListWords(one.film.info.setpoint for one in pairs)
    told = [shown(words.of(one.film.info.setpoint)) for one in pairs]
    if words.common:
        click.echo(f"all at {shown(words.common)}")
    width = max(map(len, [*told, "condition"]))
    heads = "".join(f"{head:<{_WIDTH}}" for head in ("adhesion", "hysteresis", "share"))
    click.echo(f"{'condition':<{width}}  dry    film   {heads}warmer")
    for text, one in zip(told, pairs, strict=True):
        parts = one.parts
        figures = "".join(f"{_told(each):<{_WIDTH}}" for each in (parts.adhesion, parts.hysteresis, parts.share))
        mu = (one.dry.result.mu_resultant, one.film.result.mu_resultant)
        warmer = f"{parts.warmer_k:+.1f} K" if isfinite(parts.warmer_k) else "-"
        click.echo(f"{text:<{width}}  {coefficient(mu[0])}  {coefficient(mu[1])}  {figures}{warmer}")
    for mean in means:
        of = f"{mean.compound}, {mean.interface}: share of hysteresis, mean of {mean.conditions} conditions"
        click.echo(f"{shown(of)}: {_told(mean.share)}")
    if any(not isfinite(one.parts.share.expanded) for one in pairs):
        click.echo("no U: a condition measured once does not tell its repeatability (measure: repeats: 2 or more)")
    click.echo("dry, film: mu as measured, at the temperatures that were measured")
    for line in ASSUMED:
        click.echo(line)


def _told(one: PartValue) -> str:
    value = coefficient(one.value)
    return f"{value} ± {coefficient(one.expanded)}" if isfinite(one.expanded) else value


def _estimate_json(one: PartValue) -> dict[str, Json]:
    return {"value": finite(one.value), "u": finite(one.standard), "U": finite(one.expanded)}


def _pair_json(one: FilmPair) -> dict[str, Json]:
    held, parts = one.film.info.setpoint, one.parts
    return {
        "compound": held.compound,
        "specimen": one.film.info.specimen,
        "replicate": one.film.info.replicate,
        **{axis.column: axis.of(held) for axis in held.axes},
        "mu_dry_as_measured": finite(one.dry.result.mu_resultant),
        "mu_film_as_measured": finite(one.film.result.mu_resultant),
        "adhesion": _estimate_json(parts.adhesion),
        "hysteresis": _estimate_json(parts.hysteresis),
        "hysteresis_share": _estimate_json(parts.share),
        "dry_warmer_k": finite(parts.warmer_k),
    }


def _mean_json(one: SharesMean) -> dict[str, Json]:
    return {
        "compound": one.compound,
        "interface": one.interface,
        "conditions": one.conditions,
        "hysteresis_share": _estimate_json(one.share),
    }
