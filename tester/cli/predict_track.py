"""A law's value for a specimen on a track: laws that are given figures, or made of materials."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import click

from sim.physics import laws
from sim.physics.friction import in_range
from sim.physics.materials import Rubber, Surface, below_glass
from sim.physics.track import TrackParameters, table_span
from tester.cli.options import print_json
from tester.inputs.materials.setting import law_setting


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """A condition of a specimen on a track, and the law to evaluate."""

    law: str
    compound: str
    surface: str
    area_mm2: float
    temperature_c: float
    load_n: float
    slip_m_s: float


@dataclass(frozen=True, slots=True)
class OnePair:
    """A compound and a surface, read once, because a modulus records how far beyond its table a law has used it."""

    of_compound: Rubber
    of_surface: Surface

    def rubber(self, name: str) -> Rubber:
        """Return the compound."""
        return self.of_compound

    def surface(self, name: str) -> Surface:
        """Return the surface."""
        return self.of_surface


def predict_on_track(point: TrackPoint, *, components: bool, table: bool, as_json: bool) -> int:
    """Print the coefficient and the requested further results; return the exit code: 1 if a table's error is too large.

    Raises ValueError, InvalidSource for a file that cannot be used.
    """
    in_range(point.temperature_c, point.load_n, point.slip_m_s)
    setting = _setting(point)
    if setting is None:
        law = TrackParameters(law=point.law).law_of(point.compound, _own(point))
    else:
        law = laws.make(point.law, point.compound, setting=setting)
    at = point.temperature_c, point.load_n, point.slip_m_s
    found: dict[str, float] = {"mu": law.mu(*at)}
    if components:
        parts = laws.with_parts(point.law, law).components(*at)
        found |= {"adhesion": parts.adhesion, "hysteresis": parts.hysteresis}
    for caveat in _caveats(point, law, setting):
        click.echo(f"warning: {caveat}", err=True)
    right = True
    if table:
        if setting is None:
            raise ValueError(f"law {point.law} needs no table: it is made of figures")
        figures, right = _table(point, law, setting)
        found |= figures
    if as_json:
        print_json(found)
    else:
        click.echo(f"{found['mu']:.5f}")
        for name in ("adhesion", "hysteresis") if components else ():
            click.echo(f"{name} {found[name]:.5f}")
        if table:
            click.echo(
                f"table of {found['points']:g} points: {found['table_cpu_s']:.2f} s of processor time, greatest error"
                f" {100.0 * found['table_error']:.2f} %"
            )
    return 0 if right else 1


def _own(point: TrackPoint) -> laws.LawSetting:
    """Return the surface and the source of materials of a law of the simulated track, for which both are optional."""
    return law_setting(point.surface, Path("recipe.yaml"))  # the working folder counts as a recipe's


def _setting(point: TrackPoint) -> laws.LawSetting | None:
    """Return the materials of a law that is made of them; None for any other law."""
    if not isinstance(laws.find(point.law), laws.OfMaterials):
        return None
    if not point.surface:
        raise ValueError(f"law {point.law} is made of a compound and a surface (expected --surface NAME)")
    materials = _own(point).materials
    assert materials is not None
    pair = OnePair(materials.rubber(point.compound), materials.surface(point.surface))
    return laws.LawSetting(pair, point.surface, point.area_mm2)


def _caveats(point: TrackPoint, law: laws.FrictionLaw, setting: laws.LawSetting | None) -> Iterator[str]:
    """Yield the law's caveats at this condition, and how far moduli are extrapolated beyond the measured range."""
    from sim.physics.moduli import TabulatedModulus

    yield from laws.caveats_of(law, point.temperature_c, point.load_n, point.slip_m_s)
    if setting is None or setting.materials is None:
        return
    rubber = setting.materials.rubber(point.compound)
    yield from below_glass(rubber, point.temperature_c)
    modulus = rubber.modulus
    if isinstance(modulus, TabulatedModulus) and modulus.beyond_decades > 0.0:
        low_hz, high_hz = modulus.limits_hz(point.temperature_c)
        yield (
            f"the moduli of {point.compound} at {point.temperature_c:g} degC are measured from {low_hz:.3g} to"
            f" {high_hz:.3g} Hz, and extrapolated {modulus.beyond_decades:.1f} decades beyond"
        )


def _table(point: TrackPoint, law: laws.FrictionLaw, setting: laws.LawSetting) -> tuple[dict[str, float], bool]:
    """Return size, CPU time and error of a table of the law, and whether the error is within its limit."""
    from sim.physics.tabulated import ALLOWED, build

    began_s = time.process_time()
    made = build(laws.with_parts(point.law, law), table_span(setting, point.compound))[0]
    cpu_s = time.process_time() - began_s
    speeds, temperatures, loads = made.points
    figures = {"points": float(speeds * temperatures * loads), "table_cpu_s": cpu_s, "table_error": made.error}
    return figures, made.error < ALLOWED
