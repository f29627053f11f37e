"""Reads moduli from an instrument's file of dynamic mechanical analysis: columns under headings.

Lines above the headings are skipped. Cells are separated by a tab, a semicolon or a comma; numbers have a point or a
comma. Units are in the headings or in a row below them. Unrecognised columns and units raise a question, never a guess;
conversions are noted, doubts are kept.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence, Set
from difflib import get_close_matches
from math import isfinite, nan

from tester.inputs.materials.files import Findings
from tester.inputs.materials.headings import (
    DmaLayout,
    DmaOptions,
    Heading,
    UnitRefusedError,
    accepted,
    conversion,
    first_unit,
    heading,
    heading_quantity,
    is_unit,
    layout_of,
    quantity_of,
    unit_of,
    without_brackets,
)
from tester.inputs.materials.measured_moduli import ALIKE, ModuliRow, ModuliTable, judge, strain_words


def tell_unused(layout: DmaLayout, used: Set[int], result: Findings) -> None:
    """Note the unused columns; a strain without a known unit is one of them."""
    unused = [(at, text) for at, text in enumerate(layout.headings) if text and at not in used]
    if unused:
        result.notes.append("columns not used: " + ", ".join(f'"{text}"' for _, text in unused))
    for _, text in unused:
        if heading_quantity(text) == "strain":
            result.notes.append(f'strain: "{text}" has no unit of a strain and is not used ({accepted("strain")})')


MAX_BYTES = 16 * 1024 * 1024
TAN_PERCENT, TAN_LEAST = 2.0, 5e-4
"""A column of loss factors agrees with the moduli within this share, or this difference [A]."""

Point = tuple[int, Mapping[str, float]]
"""The line of a row, from 0, and its numbers by quantity."""
_WITH_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}")


def read_dma(text: str, options: DmaOptions, findings: Findings) -> ModuliTable:
    """Return the moduli of a file's text; adds to ``findings``. Raises InvalidSource with every problem."""
    layout = layout_of(text.splitlines(), options.columns.values())
    if layout is None:
        asked = options.ask_column.format(quantity="E'")
        findings.refuse_now(
            (1, 1), f"no row of headings is recognised (expected temperature, frequency, E', E''; {asked})"
        )
    return _Reading(layout, options, findings).table()


def _is_strain(cell: str, comma: bool) -> bool:
    """Return whether a cell holds a strain other than 0."""
    try:
        return float(cell.replace(",", ".") if comma else cell) != 0.0
    except ValueError:
        return False


class _Reading:
    """Reader of one file, from its headings to its points."""

    def __init__(self, layout: DmaLayout, options: DmaOptions, findings: Findings) -> None:
        self.layout = layout
        self.options = options
        self.findings = findings
        self.place = (layout.at + 1, 1)
        self.columns: dict[str, Heading] = {}

    def table(self) -> ModuliTable:
        self._choose()
        self._complete()
        self.findings.end()
        points = self._numbers()
        self.findings.end()
        self._check_frequency(points)
        self.findings.end()
        rows = [self._row(values) for _, values in points]
        judge(rows, lambda number: (points[number][0] + 1 if points else self.place[0], 1), self.findings)
        self.findings.end()
        self._cross_check(points)
        tell_unused(self.layout, {column.index for column in self.columns.values()}, self.findings)
        return self._strained(ModuliTable(tuple(rows)))

    def _strained(self, table: ModuliTable) -> ModuliTable:
        """Return the table with its strain: that of its column, else the option's."""
        strains, stated = table.strains_percent, self.options.strain_percent
        if strains is not None:
            self.findings.notes.append(f'strain: {strain_words(*strains)}, from "{self.columns["strain"].text}"')
        if stated is None:
            return table
        if strains is not None and not strains[0] / ALIKE < stated < strains[1] * ALIKE:
            where = f"the file has {strain_words(*strains)}, which counts"
            self.findings.doubt(self.place, f"strain: {stated:g} % is stated; {where}", lasting=True)
        return table.at_strain(stated)

    # -- columns ----------------------------------------------------------------------------------------------

    def _choose(self) -> None:
        """Assign columns to quantities, by a person's options, else by their headings."""
        named_columns: dict[int, str] = {}
        for quantity, name in self.options.columns.items():
            index = self._index(name)
            if index is None:
                near = get_close_matches(name, self.layout.headings, 1, 0.5)
                meant = f', did you mean "{near[0]}"?' if near else ""
                there = ", ".join(f'"{heading}"' for heading in self.layout.headings if heading)
                self.findings.refuse(self.place, f'no heading "{name}"{meant} (there are {there})')
            else:
                named_columns[index] = quantity
        several: dict[str, list[str]] = {}
        for index, text in enumerate(self.layout.headings):
            column = self._heading(index, text, named_columns.get(index))
            if column is None or (index not in named_columns and column.quantity in named_columns.values()):
                continue
            several.setdefault(column.quantity, []).append(text)
            self.columns[column.quantity] = column
        for quantity, texts in several.items():
            if len(texts) > 1:
                asked = self.options.ask_column.format(quantity=quantity)
                listed = ", ".join(f'"{column}"' for column in texts)
                self.findings.refuse(self.place, f"{listed}: which of them is {quantity}? ({asked})")

    def _index(self, name: str) -> int | None:
        folded = [text.casefold() for text in self.layout.headings]
        if name.casefold() in folded:
            return folded.index(name.casefold())
        start = re.compile(rf"{re.escape(name.casefold())}\s*[\[(/{{,]")
        bare = [index for index, text in enumerate(folded) if start.match(text)]
        return bare[0] if len(bare) == 1 else None

    def _heading(self, index: int, text: str, quantity: str | None) -> Heading | None:
        """Return a column's heading with its unit; None for an unknown quantity, or a missing unit."""
        refused = ""
        try:
            known = heading(text)
        except UnitRefusedError as error:
            known, refused = Heading(text, heading_quantity(text)), str(error)
        unit = known.unit
        if quantity is not None and quantity != known.quantity:
            known, unit = Heading(text, quantity), self._bracketed(text, quantity)
        if not known.quantity:
            return None
        below = self.layout.units[index] if self.layout.units is not None and index < len(self.layout.units) else ""
        if below and (known.quantity != "strain" or below in ("%", "-", "1")):
            unit, refused = self._unit(known.quantity, below, text) or unit, ""
        for name, option in self.options.units.items():
            if self._index(name) == index:
                unit, refused = self._unit(known.quantity, option, text), ""
        if not unit and known.quantity == "strain":
            return None  # such as a displacement in um; noted with the unused columns
        if not unit and known.quantity != "tan":
            asked = self.options.ask_unit.format(heading=text, unit=first_unit(known.quantity))
            missing = f'"{text}" has no unit (expected {accepted(known.quantity)}; {asked})'
            self.findings.refuse(self.place, refused or missing)
        return Heading(text, known.quantity, unit or "1", index)

    def _bracketed(self, text: str, quantity: str) -> str:
        """Return the unit in the heading of a column whose quantity a person has set; "" where there is none."""
        match = re.search(r"[\[({/,]\s*([^\[\](){}/,]+(?:/s)?)\s*[\])}]?\s*$", text)
        if match is None or not is_unit(match[1]):
            return ""
        return self._unit(quantity, match[1], text)

    def _unit(self, quantity: str, text: str, where: str) -> str:
        try:
            return unit_of(quantity, without_brackets(text), where)
        except UnitRefusedError as error:
            self.findings.refuse(self.place, str(error))
            return "1"

    def _complete(self) -> None:
        """Refuse missing columns; note the assumptions."""
        has, options = self.columns, self.options
        if ("E'" in has or 'E"' in has) and ("G'" in has or 'G"' in has):
            asked = options.ask_column.format(quantity="E'")
            self.findings.refuse(
                self.place, f"moduli of tension (E) and of shear (G) are there: which count? ({asked})"
            )
        letter = "G" if "G'" in has else "E"
        if f"{letter}'" not in has:
            self._missing("E'", "storage modulus")
        elif f'{letter}"' not in has and "tan" not in has:
            self._missing("E''", "loss modulus, or tan delta")
        if "temperature" not in has and options.temperature_c is None:
            self._missing("temperature", "temperature", "25 degC")
        if "frequency" not in has and "omega" not in has and options.frequency_hz is None:
            self._missing("frequency", "frequency", "1 Hz")
        storage = has.get(f"{letter}'")
        by_name = storage is not None and quantity_of(storage.text[:2]) == "" and "'" not in storage.text
        if storage is not None and letter == "E" and "E'" not in options.columns:
            if storage.text.upper().startswith("M"):
                assumption = f'"{storage.text}" is taken for the modulus of tension, E\''
                self.findings.doubt(self.place, assumption, lasting=True)
            elif by_name and "tensile" not in storage.text.casefold():
                asked = options.ask_column.format(quantity="G'")
                assumption = f'"{storage.text}" does not say of which deformation: taken for tension, E\''
                self.findings.doubt(self.place, f"{assumption} ({asked} for shear)", lasting=True)

    def _missing(self, quantity: str, words: str, example: str = "") -> None:
        there = ", ".join(f'"{heading}"' for heading in self.layout.headings if heading)
        asked = self.options.ask_column.format(quantity=quantity)
        value = f", or {self.options.ask_value.format(quantity=quantity, example=example)}" if example else ""
        self.findings.refuse(self.place, f"no column is recognised as {words} (there are {there}; {asked}{value})")

    # -- numbers ----------------------------------------------------------------------------------------------

    def _numbers(self) -> list[Point]:
        """Return the line of each row, and its numbers in degC, Hz and Pa, by quantity."""
        comma = self._comma()
        points: list[Point] = []
        for line, cells in self.layout.rows():
            values: dict[str, float] = {}
            for column in self.columns.values():
                cell = cells[column.index] if column.index < len(cells) else ""
                if column.quantity == "strain" and not _is_strain(cell, comma):
                    continue  # doubted with the table
                number = self._number(cell, column, line, comma)
                values[column.quantity] = conversion(column.quantity, column.unit)(number)
            points.append((line, values))
        return points

    def _comma(self) -> bool:
        """Return whether numbers have a decimal comma; refuse a file that mixes commas and points."""
        if self.layout.delimiter == ",":
            return False
        cells = [
            (line, cells[column.index])
            for line, cells in self.layout.rows()
            for column in self.columns.values()
            if column.index < len(cells)
        ]
        with_comma = [(line, cell) for line, cell in cells if "," in cell]
        with_point = [(line, cell) for line, cell in cells if "." in cell]
        if with_comma and with_point:
            line, cell = with_comma[0]
            other = with_point[0]
            conflict = f'"{cell}" has a comma, "{other[1]}" in line {other[0] + 1} a point: which of them is decimal?'
            self.findings.refuse((line + 1, 1), conflict)
        elif with_comma and all(_THOUSANDS.fullmatch(cell) for _, cell in with_comma):
            line, cell = with_comma[0]
            conflict = f'"{cell}" is read as {cell.replace(",", ".")}: its comma may mean thousands'
            self.findings.doubt((line + 1, 1), conflict, lasting=True)
        if with_comma:
            self.findings.notes.append("numbers have a decimal comma")
        return bool(with_comma)

    def _number(self, cell: str, column: Heading, line: int, comma: bool) -> float:
        text = cell.replace(",", ".") if comma and _WITH_COMMA.fullmatch(cell) else cell
        try:
            value = nan if "_" in text else float(text)  # Python's digit groups are not valid in such a file
        except ValueError:
            value = nan
        if not isfinite(value):
            fault = f'"{cell}" is not a number' if cell else "nothing is there"
            self.findings.refuse((line + 1, 1), f"{column.text}: {fault}")
        return value

    def _row(self, values: Mapping[str, float]) -> ModuliRow:
        """Return one point in degC, Hz and Pa of tension."""
        temperature = values.get("temperature", self.options.temperature_c)
        frequency = values.get("frequency", values.get("omega", self.options.frequency_hz))
        if self.options.frequency_hz is not None:
            frequency = self.options.frequency_hz
        assert temperature is not None and frequency is not None
        letter, factor = ("G", 2.0 * (1.0 + self.options.poisson)) if "G'" in values else ("E", 1.0)
        storage = values[f"{letter}'"]
        loss = values[f'{letter}"'] if f'{letter}"' in values else storage * values["tan"]
        return ModuliRow(temperature, frequency, factor * storage, factor * loss, values.get("strain"))

    def _check_frequency(self, points: Sequence[Point]) -> None:
        """Compare the frequency that a person has set for every point with the file's column, if there is one."""
        stated = self.options.frequency_hz
        name = "frequency" if "frequency" in self.columns else "omega"
        if stated is None or name not in self.columns:
            return
        for line, values in points:
            frequency = values[name]
            if not stated / ALIKE < frequency < stated * ALIKE:
                self.findings.refuse(
                    (line + 1, 1), f"frequency: {frequency:g} Hz is not the {stated:g} Hz that is set for all"
                )
        self.findings.notes.append(
            f"frequency: {stated:g} Hz, as set, for rows of the file within {ALIKE:g} times of it"
        )

    def _cross_check(self, points: Sequence[Point]) -> None:
        """Compare a column of tan delta with E'' over E', and note the conversions."""
        note = self.findings.notes.append
        used = ", ".join(f'{name} from "{column.text}"' for name, column in self.columns.items())
        note(f"columns: {used}")
        if "G'" in self.columns:
            factor = 2.0 * (1.0 + self.options.poisson)
            note(f"shear: E = 2 (1 + nu) G = {factor:g} G, nu = {self.options.poisson:g}")
        if "omega" in self.columns and "frequency" not in self.columns:
            note("angular frequency: f = omega / 2 pi")
        letter = "G" if "G'" in self.columns else "E"
        if "tan" not in self.columns:
            return
        if f'{letter}"' not in self.columns:
            note(f"{letter}'' is {letter}' times tan delta: the file has no column of it")
            return
        off: list[tuple[float, int, float, float]] = []
        for line, values in points:
            ratio = values[f'{letter}"'] / values[f"{letter}'"]
            apart = abs(ratio - values["tan"])
            if apart > max(TAN_PERCENT / 100.0 * abs(ratio), TAN_LEAST):
                off.append((apart, line, values["tan"], ratio))
        if off:
            _, line, tan, ratio = max(off)
            difference = f"tan delta {tan:g} is not {letter}''/{letter}' = {ratio:.4g}"
            more = f" (the worst of {len(off)} of {len(points)} points)"
            self.findings.doubt((line + 1, 1), f"{difference}{more}: the moduli count", lasting=True)
        else:
            note(f"tan delta agrees with {letter}''/{letter}' within {TAN_PERCENT:g} %")
