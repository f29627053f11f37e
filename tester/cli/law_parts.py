"""Charts of `tester figure --components`: the parts of a law of materials, over roughness, speed or pressure."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import click

if TYPE_CHECKING:
    from sim.physics.materials import Components, Sinusoid, Surface
    from tester.report.chart import Chart

OVERS: Final = ("ra", "speed", "pressure")
POINTS: Final = 61
AREA_MM2: Final = 100.0
"""Area of the contact; the charts depend on the pressure alone."""


class At(NamedTuple):
    """Arguments of a law, except the one it is drawn over."""

    temperature_c: float
    pressure_pa: float
    speed_m_s: float


def parts_chart(law: str, compound: str, surface: str, over: str, at: At) -> Chart:
    """Return the chart; an impossible law is a usage error."""
    from sim.physics import laws
    from sim.physics.greta import found_waves
    from tester.base.source import InvalidSource
    from tester.inputs.materials.library import Library
    from tester.report.law_charts import components_chart

    try:
        maker = laws.find(law)
        if not isinstance(maker, laws.OfMaterials):
            raise ValueError(f"law {law!r} is not made of materials and has no parts")
        library = Library.beside()
        rubber, track = library.rubber(compound), library.surface(surface)
        name, unit, scale, middle, decades = _axis(over, track, at)
        x = [scale * middle * 10.0 ** (decades * (2.0 * i / (POINTS - 1) - 1.0)) for i in range(POINTS)]

        def value(shown: float) -> Components:
            changed, place = _at(over, shown / scale, track, at)
            load_n = 1e-6 * place.pressure_pa * AREA_MM2
            made = maker.make(rubber, changed, AREA_MM2, laws.NO_FIGURES)
            return laws.with_parts(law, made).components(place.temperature_c, load_n, place.speed_m_s)

        title = f"{law}: {rubber.name} on {track.name}"
        notes = [_note(over, at), *([remark] if (remark := found_waves(track)) else [])]
        return components_chart(value, x, f"{name} ({unit})", title, "; ".join(notes))
    except (ValueError, InvalidSource) as error:
        raise click.UsageError(str(error)) from error


def _axis(over: str, track: Surface, at: At) -> tuple[str, str, float, float, float]:
    """Return name, unit and scale of the drawn variable, the middle of its range, and decades to either end."""
    if over == "speed":
        return "sliding speed", "mm/s", 1e3, at.speed_m_s, 3.0
    if over == "pressure":
        return "pressure", "kPa", 1e-3, at.pressure_pa, 1.0
    if track.coarse is None or track.fine is None:
        raise ValueError(f"surface {track.name!r} has no waves, whose roughness could be changed")
    return "roughness Ra of the coarse wave", "mm", 1e3, track.coarse.ra_m, 0.6


def _at(over: str, value: float, track: Surface, at: At) -> tuple[Surface, At]:
    """Return the surface and the condition for a value of the drawn variable."""
    if over == "speed":
        return track, at._replace(speed_m_s=value)
    if over == "pressure":
        return track, at._replace(pressure_pa=value)
    assert track.coarse is not None and track.fine is not None
    factor = value / track.coarse.ra_m
    return replace(track, coarse=_rougher(track.coarse, factor), fine=_rougher(track.fine, factor)), at


def _rougher(wave: Sinusoid, factor: float) -> Sinusoid:
    return replace(wave, ra_m=factor * wave.ra_m)


def _note(over: str, at: At) -> str:
    values = {
        "speed": f"{1e3 * at.speed_m_s:g} mm/s",
        "pressure": f"{1e-3 * at.pressure_pa:g} kPa",
        "temperature": f"{at.temperature_c:g} degC",
    }
    others = ", ".join(text for name, text in values.items() if name != over)
    return f"at {others}; both waves change alike" if over == "ra" else f"at {others}"
