"""Measured moduli: points of temperature, frequency, E' and E'', with their faults and doubts.

Nothing is repaired: a table is used unchanged, refused, or used with its doubts on record.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isfinite, log10

from tester.inputs.materials.files import Findings, Place

LEAST_ROWS = 4
"""Least number of points to interpolate between [A]."""
FEW_ROWS = 12
"""A table with fewer points is doubted [A]."""
COLDEST_C, HOTTEST_C = -150.0, 400.0
SLOWEST_HZ, FASTEST_HZ = 1e-4, 1e4
"""Frequency range of instruments [A]: a value beyond it is another quantity, or was shifted already."""
SOFTEST_PA, STIFFEST_PA = 1e4, 2e10
"""Range of storage moduli of rubber and its glass [A]."""
GLASS_LEAST_PA = 1e8
"""Storage modulus between that of rubber and that of its glass [A]: a filled rubber reaches some 30 MPa."""
GLASS_PA = (3e8, 1e10)
"""Range of the storage modulus of a rubber's glass [A]: polymers' glasses have 1 to 4 GPa."""
COLD_K = 30.0
"""So far below the peak of tan delta a rubber is a glass [A]."""
PEAK_C = 100.0
"""Warmest peak of a rubber's tan delta [A]."""
FLANK_SHARE = 0.8
"""Tan delta has its peak inside a sweep if it falls below this share of it on both sides [A]."""
TAN_LEAST = 0.02
"""A rubber's tan delta exceeds this somewhere [A]."""
NOISE_K = 1.0
"""Noise of a sweep's temperatures [A]: they go back by less than this."""
ALIKE = 1.05
"""Frequencies within this ratio differ by an instrument's noise alone [A]."""
WLF_SPAN_K = 100.0
"""Range above the glass transition in which the WLF shift holds (Williams, Landel, Ferry 1955)."""
POLE_K = 51.5
"""Distance of the shift's pole below the glass transition: 50 K - 101.5 K."""


@dataclass(frozen=True, slots=True)
class ModuliRow:
    """One point: degC, Hz, and the moduli of tension in Pa."""

    temperature_c: float
    frequency_hz: float
    storage_pa: float
    loss_pa: float
    strain_percent: float | None = None
    """Amplitude of the strain; None where it is not stated."""


@dataclass(frozen=True, slots=True)
class ModuliTable:
    """Points in the order of the file."""

    rows: tuple[ModuliRow, ...]

    @property
    def frequencies_hz(self) -> tuple[float, ...]:
        """Return the frequencies, rising, each once."""
        return tuple(sorted({row.frequency_hz for row in self.rows}))

    @property
    def temperatures_c(self) -> tuple[float, float]:
        """Return the lowest and the highest temperature."""
        return min(row.temperature_c for row in self.rows), max(row.temperature_c for row in self.rows)

    @property
    def strains_percent(self) -> tuple[float, float] | None:
        """Return the least and the greatest stated strain, None where none is stated."""
        strains = [row.strain_percent for row in self.rows if row.strain_percent is not None]
        return (min(strains), max(strains)) if strains else None

    def at_strain(self, percent: float) -> ModuliTable:
        """Return the table with a strain for the points that state none."""
        rows = (row if row.strain_percent is not None else replace(row, strain_percent=percent) for row in self.rows)
        return ModuliTable(tuple(rows))

    def describe(self) -> str:
        """Return its ranges, in words."""
        low, high = self.temperatures_c
        frequencies = self.frequencies_hz
        at = f"{frequencies[0]:g} Hz" if len(frequencies) == 1 else f"{frequencies[0]:g} to {frequencies[-1]:g} Hz"
        storage = sorted(row.storage_pa for row in self.rows)
        strains = self.strains_percent
        return (
            f"{len(self.rows)} points, {low:g} to {high:g} degC, {at}, "
            f"E' {storage[0] / 1e6:.3g} to {storage[-1] / 1e6:.3g} MPa, "
            f"{f'strain {strain_words(*strains)}' if strains is not None else 'strain not stated'}"
        )


def strain_words(low: float, high: float) -> str:
    """Return a range of strains in words."""
    return f"{low:g} %" if low == high else f"{low:g} to {high:g} %"


def judge(rows: Sequence[ModuliRow], place: Place, findings: Findings) -> None:
    """Add the faults of points, and the doubts, to ``findings``."""
    if not rows:
        findings.refuse(place(0), f"no points (expected {LEAST_ROWS} or more)")
        return
    before = len(findings.problems)
    for number, row in enumerate(rows):
        for problem in _impossible(row, rows):
            findings.refuse(place(number), problem)
    _duplicates(rows, place, findings)
    if len(rows) < LEAST_ROWS:
        findings.refuse(place(0), f"{len(rows)} points are too few (expected {LEAST_ROWS} or more)")
    above = [number for number, row in enumerate(rows) if row.loss_pa > row.storage_pa]
    if len(above) == len(rows) >= LEAST_ROWS:
        findings.refuse(place(0), "E'' is above E' at every point: are the columns E' and E'' swapped?")
    if len(findings.problems) == before:
        _doubts(rows, above, place, findings)


def _impossible(row: ModuliRow, rows: Sequence[ModuliRow]) -> Iterator[str]:
    values = (row.temperature_c, row.frequency_hz, row.storage_pa, row.loss_pa)
    if not all(map(isfinite, values)):
        yield "a number is missing or not finite"
        return
    if row.frequency_hz <= 0.0:
        swapped = all(each.temperature_c > 0.0 for each in rows)
        asked = ": are temperature and frequency swapped?" if swapped else ""
        yield f"frequency: {row.frequency_hz:g} Hz is not above 0{asked}"
    if not COLDEST_C <= row.temperature_c <= HOTTEST_C:
        yield f"temperature: {row.temperature_c:g} degC is out of range (expected {COLDEST_C:g} to {HOTTEST_C:g} degC)"
    if row.storage_pa <= 0.0:
        yield f"E': {row.storage_pa:g} Pa is not above 0"
    if row.loss_pa <= 0.0:
        yield f"E'': {row.loss_pa:g} Pa is not above 0"


def _duplicates(rows: Sequence[ModuliRow], place: Place, findings: Findings) -> None:
    seen: dict[tuple[float, float], int] = {}
    for number, row in enumerate(rows):
        point = (row.temperature_c, row.frequency_hz)
        if point in seen:
            line = place(seen[point])[0]
            duplicate = f"{row.temperature_c:g} degC and {row.frequency_hz:g} Hz are already in line {line}"
            findings.refuse(place(number), duplicate)
        seen.setdefault(point, number)


def _doubts(rows: Sequence[ModuliRow], above: Sequence[int], place: Place, findings: Findings) -> None:
    if above:
        first = rows[above[0]]
        ratio = first.loss_pa / first.storage_pa
        doubt = f"E'' is above E' at {len(above)} of {len(rows)} points, first tan delta {ratio:.2f}"
        findings.doubt(place(above[0]), doubt)
    if len(rows) < FEW_ROWS:
        findings.doubt(place(0), f"{len(rows)} points only (expected {FEW_ROWS} or more): much lies between them")
    _swapped_doubt(rows, place, findings)
    _order_doubt(rows, place, findings)
    beyond = [number for number, row in enumerate(rows) if not SLOWEST_HZ <= row.frequency_hz <= FASTEST_HZ]
    if beyond:
        frequency = f"frequency: {rows[beyond[0]].frequency_hz:g} Hz"
        doubt = f"{frequency} is beyond {SLOWEST_HZ:g} to {FASTEST_HZ:g} Hz of instruments"
        findings.doubt(place(beyond[0]), f"{doubt}: was it shifted, or is its unit another?")
    unlike = [number for number, row in enumerate(rows) if not SOFTEST_PA <= row.storage_pa <= STIFFEST_PA]
    if unlike:
        doubt = f"E': {rows[unlike[0]].storage_pa:g} Pa is not that of a rubber"
        findings.doubt(place(unlike[0]), f"{doubt} ({SOFTEST_PA:g} to {STIFFEST_PA:g} Pa): is the unit right?")
    else:
        _units_doubt(rows, place, findings)


def _units_doubt(rows: Sequence[ModuliRow], place: Place, findings: Findings) -> None:
    """Add doubts where height or place of tan delta's peak, or the glass below it, are not those of a rubber."""
    slowest = min(row.frequency_hz for row in rows)
    sweep = [number for number, row in enumerate(rows) if row.frequency_hz <= ALIKE * slowest]
    top = max(sweep, key=lambda number: rows[number].loss_pa / rows[number].storage_pa)
    tan, peak_c = rows[top].loss_pa / rows[top].storage_pa, rows[top].temperature_c
    if tan < TAN_LEAST:
        findings.doubt(place(top), f"tan delta is {tan:.2g} at most: is E'' in the unit of E'?")
        return
    ends = (rows[find(sweep, key=lambda number: rows[number].temperature_c)] for find in (min, max))
    if any(row.loss_pa > FLANK_SHARE * tan * row.storage_pa for row in ends):
        return  # no peak within the sweep
    if peak_c > PEAK_C:
        findings.doubt(place(top), f"tan delta is greatest at {peak_c:g} degC: are the temperatures in K?")
    cold = [number for number in sweep if rows[number].temperature_c <= peak_c - COLD_K]
    glass = max(cold, key=lambda number: rows[number].storage_pa, default=None)
    if glass is not None and not GLASS_PA[0] <= rows[glass].storage_pa <= GLASS_PA[1]:
        findings.doubt(
            place(glass),
            f"E' is {rows[glass].storage_pa / 1e6:.3g} MPa at most {COLD_K:g} K and more below the peak of tan delta at"
            f" {peak_c:g} degC; a rubber's glass has {GLASS_PA[0] / 1e6:g} to {GLASS_PA[1] / 1e6:g} MPa: is the unit"
            " right?",
        )


def strain_doubts(table: ModuliTable) -> Iterator[str]:
    """Yield doubts on the strain of a table, on which the moduli of a filled rubber depend (paper S, Fig 11)."""
    strains = table.strains_percent
    if strains is None:
        yield "the strain is not stated: moduli of filled rubber fall with strain (state it as moduli: {strain: 0.1 %})"
        return
    unstated = sum(row.strain_percent is None for row in table.rows)
    if unstated:
        yield f"the strain is not stated at {unstated} of {len(table.rows)} points"
    if strains[1] > ALIKE * strains[0]:
        phrase = strain_words(*strains)
        yield f"measured at strains of {phrase}: moduli of filled rubber fall with strain, and laws assume one strain"


def _swapped_doubt(rows: Sequence[ModuliRow], place: Place, findings: Findings) -> None:
    """Add a doubt for temperatures spaced in decades with frequencies in even steps: they may be swapped."""
    temperatures = sorted({row.temperature_c for row in rows})
    frequencies = sorted({row.frequency_hz for row in rows})
    if len(temperatures) < 3 or len(frequencies) < 3 or temperatures[0] <= 0.0:
        return
    ratios = [log10(b / a) for a, b in pairwise(temperatures)]
    steps = [b - a for a, b in pairwise(frequencies)]
    in_decades = max(ratios) - min(ratios) < 0.05 and sum(ratios) >= 1.0
    in_steps = max(steps) - min(steps) < 0.05 * max(steps)
    if in_decades and in_steps:
        doubt = f"temperature goes in decades ({temperatures[0]:g} to {temperatures[-1]:g} degC)"
        findings.doubt(place(0), f"{doubt}, frequency in even steps: are temperature and frequency swapped?")


def _order_doubt(rows: Sequence[ModuliRow], place: Place, findings: Findings) -> None:
    """Add a doubt where temperatures at one frequency rise and fall again, as in heating and then cooling."""
    sweeps: dict[int, list[int]] = {}
    for number, row in enumerate(rows):
        sweeps.setdefault(round(log10(row.frequency_hz) / log10(ALIKE)), []).append(number)
    for numbers in sweeps.values():
        turn = _turn([rows[number].temperature_c for number in numbers])
        if turn is not None:
            at = rows[numbers[turn]]
            doubt = (
                f"the grid is not monotone: at {at.frequency_hz:g} Hz temperatures turn at {at.temperature_c:g} degC"
            )
            findings.doubt(place(numbers[turn]), f"{doubt}: are two sweeps in one table?")
            return


def _turn(temperatures_c: Sequence[float]) -> int | None:
    """Return the index at which temperatures have gone back by more than a chamber's noise; None if they never do."""
    lowest = highest = temperatures_c[0]
    for number, temperature_c in enumerate(temperatures_c):
        lowest, highest = min(lowest, temperature_c), max(highest, temperature_c)
        if temperature_c - lowest > NOISE_K and highest - temperature_c > NOISE_K:
            return number
    return None


def shift_doubts(table: ModuliTable, glass_c: float | None, decade_k: float | None) -> Iterator[str]:
    """Yield doubts on the extrapolation of a table to frequencies that were not measured.

    ``decade_k`` converts temperatures at one frequency to decades of frequency (paper G, Eq 9). The WLF shift of Tg +
    50 K puts several frequencies on one curve.
    """
    low, high = table.temperatures_c
    frequencies = table.frequencies_hz
    if len(frequencies) == 1:
        if decade_k is None:
            yield f"measured at {frequencies[0]:g} Hz alone, and decade_k is missing: 8 K a decade (paper G) counts"
        if high - low < 2.0 * (decade_k or 8.0):
            yield f"{high - low:g} K at one frequency are equivalent to less than two decades"
        return
    if frequencies[-1] < ALIKE * frequencies[0]:
        span = f"{frequencies[0]:g} to {frequencies[-1]:g} Hz"
        yield f"frequencies of {span} are taken for several: if it is one sweep, state its frequency"
    if glass_c is None:
        yield "Tg is missing: without it several frequencies are not put on one curve, and no law can use them"
    elif low <= glass_c - POLE_K:
        ends = f"{glass_c - POLE_K:g} degC, where the WLF shift of Tg + 50 K ends"
        yield f"{low:g} degC is not above {ends}: no law can use it"
    elif low < glass_c or high > glass_c + WLF_SPAN_K:
        yield (
            f"measured from {low:g} to {high:g} degC; the WLF shift holds from Tg to Tg + 100 K, "
            f"{glass_c:g} to {glass_c + WLF_SPAN_K:g} degC"
        )
