"""The table in an instrument's file: its delimiter, its row of headings, their quantities and units in makers' words.

``Storage Modulus [MPa]``, ``E' / MPa``, ``Temp./degC``, ``omega (rad/s)``, ``Tan Delta``.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from types import MappingProxyType
from typing import Final

from tester.base.words import listed

ZERO_C = 273.15

QUANTITIES: Final = ("temperature", "frequency", "omega", "E'", 'E"', "G'", 'G"', "tan", "strain")
"""Quantities of columns; ``E"`` may also be written as ``E''``."""

_NAMES: Final[Mapping[str, frozenset[str]]] = MappingProxyType({
    "temperature": frozenset({"temperature", "temp", "ts", "sampletemperature", "sampletemp"}),
    "frequency": frozenset({"frequency", "freq"}),
    "omega": frozenset({"omega", "angularfrequency", "angfrequency", "angularfreq"}),
    "E'": frozenset({"e'", "m'", "storagemodulus", "storage", "storagemodulus(e')", "tensilestoragemodulus"}),
    'E"': frozenset({'e"', 'm"', "lossmodulus", "loss", "tensilelossmodulus"}),
    "G'": frozenset({"g'", "shearstoragemodulus", "storageshearmodulus"}),
    'G"': frozenset({'g"', "shearlossmodulus", "lossshearmodulus"}),
    "tan": frozenset({"tan", "tandelta", "tanδ", "tand", "lossfactor", "dampingfactor", "tan(delta)", "tan(δ)"}),
    "strain": frozenset({f"{kind}{what}" for kind in ("", "dyn", "dynamic", "shear", "tensile", "oscillation")
                         for what in ("strain", "deformation", "strainamplitude")}),
})

_LETTERS: Final = {"T": "temperature", "f": "frequency", "w": "omega", "ω": "omega"}
"""Names of one letter, case-sensitive: t is a time, F a force."""
_MODULUS_UNITS = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9}
_UNITS: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType({
    "temperature": ("degC", "K"),
    "frequency": ("Hz", "kHz", "rad/s"),
    "omega": ("rad/s",),
    **{modulus: tuple(_MODULUS_UNITS) for modulus in ("E'", 'E"', "G'", 'G"')},
    "tan": ("1",),
    "strain": ("%", "1"),
})
"""Units of each quantity."""

_SPELLINGS: Final = {
    "°c": "degC", "℃": "degC", "c": "degC", "degc": "degC", "deg c": "degC", "celsius": "degC", "k": "K",
    "kelvin": "K", "hz": "Hz", "khz": "kHz", "rad/s": "rad/s", "rad/sec": "rad/s", "rad s-1": "rad/s",
    "rad·s⁻¹": "rad/s", "pa": "Pa", "kpa": "kPa", "n/mm2": "MPa", "n/mm²": "MPa", "gpa": "GPa",
    "-": "1", "1": "1", "": "1", "--": "1", "%": "%", "percent": "%", "per cent": "%",
}  # fmt: skip
"""Makers' spellings of units, in small letters; MPa is handled apart, because mPa is not accepted."""
_BRACKETED = re.compile(r"^(?P<name>.*?)\s*[\[({](?P<unit>[^\[\](){}]*)[\])}]\s*$")
_SLASHED = re.compile(r"^(?P<name>.*?)\s*(?:/|,)\s*(?P<unit>\S.*?)\s*$")
_LAST_WORD = re.compile(r"^(?P<name>.+?)\s+(?P<unit>\S+)\s*$")
_QUOTES = str.maketrans({"′": "'", "’": "'", "‘": "'", "´": "'", "`": "'", "″": '"', "”": '"', "“": '"'})


class UnitRefusedError(ValueError):
    """A unit that does not fit its quantity; the message lists those that do."""


@dataclass(frozen=True, slots=True)
class Heading:
    """A column's heading: ``text`` as in the file, its quantity ("" if unknown), its unit."""

    text: str
    quantity: str
    unit: str = ""
    """From the table of units; "" where the heading has none."""
    index: int = 0
    """Its column in the file, from 0."""


def heading(text: str) -> Heading:
    """Return quantity and unit of a heading. Raises UnitRefusedError for a unit that does not fit the quantity."""
    clean = text.strip()
    for form in (_BRACKETED, _SLASHED, _LAST_WORD):
        match = form.match(clean)
        quantity = quantity_of(match["name"]) if match else ""
        if match is None or not quantity:
            continue
        if form is _LAST_WORD and not is_unit(match["unit"]):
            continue
        return Heading(clean, quantity, unit_of(quantity, match["unit"], clean))
    quantity = quantity_of(clean)
    return Heading(clean, quantity, "1" if quantity == "tan" else "")


def quantity_of(name: str) -> str:
    """Return the quantity of a name, "" for none."""
    if name.strip() in _LETTERS:
        return _LETTERS[name.strip()]
    tidy = re.sub(r"[\s._:\-*|]+", "", name.translate(_QUOTES).casefold()).replace("''", '"')
    return next((quantity for quantity, names in _NAMES.items() if tidy in names), "")


def heading_quantity(text: str) -> str:
    """Return the quantity of a heading whatever its unit, "" for none."""
    return quantity_of(re.split(r"[\[(/{,]", text)[0])


def quantity_named(text: str) -> str:
    """Return a quantity by its own name, from an option or a file; "" for an unknown one."""
    tidy = text.strip().translate(_QUOTES).replace("''", '"')
    return tidy if tidy in QUANTITIES else ""


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of some quantity here."""
    return text.strip() in ("MPa", "Mpa") or text.strip().casefold() in _SPELLINGS


def unit_of(quantity: str, text: str, where: str = "") -> str:
    """Return the table's unit for a text and a quantity. Raises UnitRefusedError."""
    tidy = text.strip()
    unit = "MPa" if tidy in ("MPa", "Mpa") else _SPELLINGS.get(tidy.casefold(), "")
    if quantity and unit not in _UNITS[quantity]:
        of = f'"{where}": ' if where else ""
        raise UnitRefusedError(f'{of}the unit "{tidy}" is none of {quantity} (expected {accepted(quantity)})')
    return unit


def accepted(quantity: str) -> str:
    """Return the units of a quantity in words."""
    return listed(_UNITS[quantity], "or")


def first_unit(quantity: str) -> str:
    """Return a unit of a quantity, for an example."""
    return _UNITS[quantity][0]


def heading_problems(texts: Sequence[str]) -> Iterator[str]:
    """Yield the faults of the headings in a compound's own table."""
    seen: set[str] = set()
    for text in texts:
        try:
            parsed = heading(text)
        except UnitRefusedError as error:
            yield str(error)
            continue
        if not parsed.quantity:
            known = ", ".join(QUANTITIES)
            yield f'"{text}" is no heading of a table of moduli (expected one of {known}, with its unit)'
        elif not parsed.unit:
            such = f"{text} {first_unit(parsed.quantity)}"
            yield f'"{text}" has no unit (expected {accepted(parsed.quantity)}, such as "{such}")'
        elif parsed.quantity in seen:
            yield f"{parsed.quantity} is there twice"
        seen.add(parsed.quantity)


def conversion(quantity: str, unit: str) -> Callable[[float], float]:
    """Return the conversion of a number in a unit into degC, Hz, Pa, per cent (strain) or a plain number."""
    if unit == "K":
        return lambda value: value - ZERO_C
    if quantity == "strain":
        return lambda value: abs(value) * (1.0 if unit == "%" else 100.0)
    if quantity in ("frequency", "omega"):
        factor = {"Hz": 1.0, "kHz": 1e3, "rad/s": 1.0 / (2.0 * pi)}[unit]
    else:
        factor = _MODULUS_UNITS.get(unit, 1.0)
    return lambda value: value * factor


@dataclass(frozen=True, slots=True)
class DmaOptions:
    """A person's options for a file, beside its content. ``columns``: heading by quantity; ``units``: by heading."""

    columns: Mapping[str, str] = field(default_factory=dict[str, str])
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    frequency_hz: float | None = None
    temperature_c: float | None = None
    poisson: float = 0.5
    strain_percent: float | None = None
    ask_column: str = '--columns "{quantity}=HEADING"'
    ask_unit: str = '--unit "{heading}={unit}"'
    ask_value: str = '--{quantity} "{example}"'
    """Templates of the options, for messages."""


LOOKED_AT = 400
"""Lines at the beginning that are searched for the headings."""

_DELIMITERS = ("\t", ";", ",")
_IN_BRACKETS = re.compile(r"^[\[({](.*)[\])}]$")


@dataclass(frozen=True, slots=True)
class DmaLayout:
    """Places of headings, units and rows; lines count from 0."""

    lines: Sequence[str]
    delimiter: str
    at: int
    headings: Sequence[str]
    units: Sequence[str] | None

    def cells(self, line: int) -> list[str]:
        """Return the cells of a line."""
        return _split(self.lines[line], self.delimiter)

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line and cells of every row that is not empty."""
        for line in range(self.at + (2 if self.units is not None else 1), len(self.lines)):
            cells = self.cells(line)
            if any(cells):
                yield line, cells


def _split(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cells in csv.reader([line], delimiter=delimiter) for cell in cells]


def layout_of(lines: Sequence[str], headings: Iterable[str]) -> DmaLayout | None:
    """Return the row with the most recognised quantities, at least two; None where there is none.

    ``headings``: headings that a person has named.
    """
    named = {text.casefold() for text in headings}
    best: tuple[int, int, str] | None = None
    for delimiter in _DELIMITERS:
        for at, line in enumerate(lines[:LOOKED_AT]):
            cells = _split(line, delimiter)
            score = len({_named(cell) or cell for cell in cells if _named(cell) or cell.casefold() in named})
            if len(cells) >= 2 and score >= 2 and (best is None or score > best[0]):
                best = (score, at, delimiter)
    if best is None:
        return None
    _, at, delimiter = best
    units = None
    if at + 1 < len(lines):
        below = [without_brackets(cell) for cell in _split(lines[at + 1], delimiter)]
        if any(below) and all(is_unit(cell) for cell in below) and not all(_numeric(cell) for cell in below if cell):
            units = below
    return DmaLayout(lines, delimiter, at, _split(lines[at], delimiter), units)


def _numeric(cell: str) -> bool:
    return bool(re.fullmatch(r"[-+]?[0-9.]+", cell))


def _named(cell: str) -> str:
    try:
        return heading(cell).quantity
    except UnitRefusedError:
        return "a unit that is refused"


def without_brackets(text: str) -> str:
    """Return a unit without its brackets."""
    return _IN_BRACKETS.sub(r"\1", text.strip())
