"""`tester compare`: the conditions of two runs side by side."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING

import click

from tester.cli.finding import run_folder
from tester.cli.showing import Json, dump, shown

if TYPE_CHECKING:
    from tester.catalogue.entries import ConditionEntry

Setpoints = tuple[str, float, float, float, float, float, float, int]


@click.command()
@click.argument("run1")
@click.argument("run2")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def compare(run1: str, run2: str, as_json: bool) -> None:
    """Hold the conditions of RUN1 and RUN2 against each other: coefficients, difference, uncertainty, z.

    z is the difference over its standard uncertainty (both runs' combined); beyond 2 it is not chance alone.
    Behind a coefficient ! says that it is not to be trusted, ? that it carries a doubt (`tester show` says which).
    """
    from tester.catalogue.entries import fingerprint, read_entries

    sides: list[dict[Setpoints, ConditionEntry]] = []
    for name in (run1, run2):
        folder = run_folder(name)
        entry, conditions = read_entries(folder, "", fingerprint(folder))
        if entry.problem:
            raise click.ClickException(entry.problem)
        sides.append({_setpoints(one): one for one in conditions})
    first, second = sides
    rows = [_row(first.get(key), second.get(key)) for key in dict.fromkeys([*first, *second])]
    if as_json:
        dump([*rows])
        return
    click.echo("compound  mm/s  N  deg  degC    mu 1    mu 2    diff    u       z")
    for row in rows:
        setpoints = f"{shown(str(row['compound']))}  {row['slip_velocity_mm_s']:g}  {row['load_n']:g}"
        setpoints += f"  {row['sideslip_deg']:g}  {row['temperature_c']:g}"
        figures = (f"{_cell(row[name], digits)}{row.get(f'mark_{name[-1]}') or ''}" for name, digits in _FIGURES)
        click.echo(f"{setpoints}  {'  '.join(figures)}")


_FIGURES = (("mu_1", 4), ("mu_2", 4), ("difference", 4), ("u_difference", 4), ("z", 2))


def _cell(value: Json, digits: int) -> str:
    return f"{value:+.{digits}f}" if isinstance(value, float) else "-"


def _mark(side: ConditionEntry | None) -> str:
    from tester.analysis.trust import mark_of

    return mark_of(side.status, side.flags) if side is not None and side.mu is not None else ""


def _setpoints(one: ConditionEntry) -> Setpoints:
    return (
        one.compound,
        one.slip_velocity_mm_s,
        one.load_n,
        one.sideslip_deg,
        one.camber_deg,
        one.temperature_c,
        one.wheel_speed_m_s,
        one.replicate,
    )


def _row(first: ConditionEntry | None, second: ConditionEntry | None) -> dict[str, Json]:
    one = first or second
    assert one is not None
    mu_1, mu_2 = (side.mu if side is not None else None for side in (first, second))
    u_1, u_2 = (side.u_standard if side is not None else None for side in (first, second))
    difference = mu_2 - mu_1 if mu_1 is not None and mu_2 is not None else None
    u = hypot(u_1, u_2) if u_1 is not None and u_2 is not None else None
    return {
        "compound": one.compound,
        "replicate": one.replicate,
        "slip_velocity_mm_s": one.slip_velocity_mm_s,
        "load_n": one.load_n,
        "sideslip_deg": one.sideslip_deg,
        "camber_deg": one.camber_deg,
        "temperature_c": one.temperature_c,
        "wheel_speed_m_s": one.wheel_speed_m_s,
        "mu_1": mu_1,
        "mu_2": mu_2,
        "mark_1": _mark(first),
        "mark_2": _mark(second),
        "difference": difference,
        "u_difference": u,
        "z": difference / u if difference is not None and u else None,
    }
