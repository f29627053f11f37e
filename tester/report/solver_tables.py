"""A kept law as the friction table of a finite element program: coefficient over speed, pressure and temperature.

Every table is within the law's range, on axes that ascend. SI units: m/s, Pa; degC. The keywords are those of the
programs' manuals:

- Abaqus, ``*FRICTION``: a line is coefficient, rate of sliding, contact pressure, temperature; the rate varies first.
- Ansys, ``TB,FRIC`` with ``TBFIELD`` of TEMP, NPRES and SLRV, then ``TBDATA``.
- LS-DYNA, ``*DEFINE_TABLE`` of pressures, each with a ``*DEFINE_CURVE`` of the coefficient over the relative velocity,
  for ``*CONTACT`` with FS = 2 and FD = the table. It knows no temperature: there is a table for each, and a curve of
  the coefficient's factor over temperature (``*CONTACT_..._THERMAL_FRICTION``, LCFST and LCFDT).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from textwrap import wrap
from typing import Final, NamedTuple

from tester.inputs.kept_laws.law_value import KeptLaw, Predicted

WIDE: Final = 20.0
"""Ratio of the ends of a range of speeds from which the points are in equal ratios [A]."""
TABLE_ID: Final = 1000
"""Identity of the first table of LS-DYNA; its curves follow it."""
PER_TABLE: Final = 1000
"""Identities that a table of LS-DYNA takes: itself, and its curves."""


class Points(NamedTuple):
    """Number of points on each axis."""

    speeds: int = 20
    pressures: int = 20
    temperatures: int = 10


USUAL: Final = Points()


@dataclass(frozen=True, slots=True)
class SolverTable:
    """The coefficients of a law on a grid, speeds in m/s, pressures in Pa, temperatures in degC, each ascending.

    ``values``: [temperature][pressure][speed].
    """

    law: KeptLaw
    area_mm2: float
    area_source: str
    speeds: tuple[float, ...]
    pressures: tuple[float, ...]
    temperatures: tuple[float, ...]
    values: tuple[tuple[tuple[Predicted, ...], ...], ...]

    def rows(self) -> Iterator[tuple[Predicted, float, float, float]]:
        """Yield coefficient, speed, pressure and temperature; the speed varies first, the temperature last."""
        for temperature_c, plane in zip(self.temperatures, self.values, strict=True):
            for pressure_pa, line in zip(self.pressures, plane, strict=True):
                for speed_m_s, found in zip(self.speeds, line, strict=True):
                    yield found, speed_m_s, pressure_pa, temperature_c


def solver_table(law: KeptLaw, points: Points = USUAL, area_mm2: float | None = None) -> SolverTable:
    """Return the table of a law; ``area_mm2``: nominal area of contact, None: that of the law's file.

    Raises ValueError without an area.
    """
    model = law.model
    source = "given to the export (--area)" if area_mm2 is not None else model.area_source or "of the law's file"
    area = area_mm2 if area_mm2 is not None else model.area
    if area is None:
        raise ValueError(
            f"{law.name} knows no area of contact, which makes a pressure of a load (expected --area, as '540 mm2')"
        )
    speeds = _axis(model.range.speed, points.speeds)
    loads = _axis(model.range.load, points.pressures, even=True)
    temperatures = _axis(model.range.temperature, points.temperatures, even=True)
    values = tuple(tuple(tuple(law.predict(t, n, v) for v in speeds) for n in loads) for t in temperatures)
    pressures = tuple(1e6 * load_n / area for load_n in loads)
    return SolverTable(law, area, source, speeds, pressures, temperatures, values)


def _axis(ends: Sequence[float], points: int, *, even: bool = False) -> tuple[float, ...]:
    """Return points from the least to the greatest value, one where both are the same."""
    low, high = ends
    if high == low:
        return (low,)
    if even or not low > 0.0 or high / low < WIDE:
        return (low, *(low + (high - low) * i / (points - 1) for i in range(1, points - 1)), high)
    return (low, *(low * (high / low) ** (i / (points - 1)) for i in range(1, points - 1)), high)


def _notes(table: SolverTable, cut: str) -> list[str]:
    """Return what every file states of itself, a line each."""
    model = table.law.model
    of = ", ".join(text for text in (model.compound, model.interface, model.surface) if text)
    known = model.range
    sources = ", ".join(f"{one.source} ({one.rows} rows)" for one in model.data)
    return [
        f"Friction of {of} by the law {model.form} of {table.law.name}: {model.formula}",
        f"Fitted to {sources}. Content {model.content[:16]}.",
        "Units: m/s, Pa, degC, coefficient 1. CHECK that the model has these units, or change them here.",
        f"Pressure: load over the nominal area {table.area_mm2:g} mm2, {table.area_source}.",
        f"Range: {_span(known.speed)} m/s, {_span(table.pressures)} Pa ({_span(known.load)} N),"
        f" {_span(known.temperature)} degC.",
        f"Cut: {cut}",
        *(f"Doubt: {doubt}" for doubt in table.law.doubts),
    ]


def _span(values: Sequence[float]) -> str:
    return f"{values[0]:.4g} to {values[-1]:.4g}"


def _commented(mark: str, table: SolverTable, cut: str) -> Iterator[str]:
    """Yield the notes as comments, in lines that every program reads."""
    for note in _notes(table, cut):
        yield from (f"{mark} {line}" for line in wrap(note, 76, break_long_words=False, break_on_hyphens=False))


_ENDS: Final = "nothing is known beyond the range; what the program takes there is its own (mostly the end's value)"


def abaqus(table: SolverTable) -> Iterator[str]:
    """Yield the lines of an Abaqus input file."""
    yield from _commented("**", table, f"{_ENDS}. Put *FRICTION below *SURFACE INTERACTION.")
    yield "** coefficient, rate of sliding, contact pressure, temperature"
    yield "*FRICTION"
    for found, speed, pressure, temperature in table.rows():
        yield f"{found.mu:.6g}, {speed:.8g}, {pressure:.8g}, {temperature:.8g}"


def ansys(table: SolverTable) -> Iterator[str]:
    """Yield the lines of Ansys Mechanical APDL commands, for material 1."""
    yield from _commented("!", table, f"{_ENDS}. Material 1 is that of the contact elements.")
    yield "TB,FRIC,1,,,ISO"
    for temperature, plane in zip(table.temperatures, table.values, strict=True):
        yield f"TBFIELD,TEMP,{temperature:.8g}"
        for pressure, line in zip(table.pressures, plane, strict=True):
            yield f"TBFIELD,NPRES,{pressure:.8g}"
            for speed, found in zip(table.speeds, line, strict=True):
                yield f"TBFIELD,SLRV,{speed:.8g}"
                yield f"TBDATA,1,{found.mu:.6g}"


def lsdyna(table: SolverTable) -> Iterator[str]:
    """Yield the lines of LS-DYNA keywords."""
    cut = "the tables know no temperature: choose the table of yours, or scale one by the curve of factors at the end"
    yield "*KEYWORD"
    yield from _commented("$", table, f"{cut}; {_ENDS}")
    yield "$ *CONTACT: FS = 2, FD = the table"
    for number, (temperature, plane) in enumerate(zip(table.temperatures, table.values, strict=True)):
        first = TABLE_ID + PER_TABLE * number
        yield f"$ {temperature:.6g} degC"
        yield "*DEFINE_TABLE"
        yield f"{first:>10d}"
        yield from (f"{pressure:>20.8g}{first + i:>20d}" for i, pressure in enumerate(table.pressures, start=1))
        for i, line in enumerate(plane, start=1):
            yield from _curve(first + i, ((v, found.mu) for v, found in zip(table.speeds, line, strict=True)))
    yield "$ factor of the coefficient over temperature, against the first table, at the"
    yield "$ middle pressure and speed: LCFST, LCFDT of *CONTACT_..._THERMAL_FRICTION"
    at_p, at_v = len(table.pressures) // 2, len(table.speeds) // 2
    middle = [plane[at_p][at_v].mu for plane in table.values]
    factors = ((t, mu / middle[0]) for t, mu in zip(table.temperatures, middle, strict=True))
    yield from _curve(TABLE_ID + PER_TABLE * len(table.temperatures), factors)
    yield "*END"


def _curve(identity: int, points: Iterator[tuple[float, float]]) -> Iterator[str]:
    yield "*DEFINE_CURVE"
    yield f"{identity:>10d}"
    yield from (f"{x:>20.8g}{y:>20.6g}" for x, y in points)


def plain_csv(table: SolverTable) -> Iterator[str]:
    """Yield the lines of a CSV file, with the interval of each coefficient."""
    yield from _commented("#", table, _ENDS)
    yield "speed_m_s,pressure_pa,temperature_c,mu,mu_low_95,mu_high_95"
    for found, speed, pressure, temperature in table.rows():
        of_speed = f"{speed:.8g},{pressure:.8g},{temperature:.8g}"
        yield f"{of_speed},{found.mu:.6g},{found.low:.6g},{found.high:.6g}"


SOLVERS: Final[Mapping[str, Callable[[SolverTable], Iterator[str]]]] = {
    "abaqus": abaqus,
    "ansys": ansys,
    "lsdyna": lsdyna,
    "csv": plain_csv,
}
"""Formats of a law, by the names that `tester export` takes."""
