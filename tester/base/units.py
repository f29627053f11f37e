"""Quantities as text: ``"0.8 m/s"`` to a float in the unit that the caller asks for.

Accepts only the units listed here; anything else is rejected with the list. A kind of rig with a new kind of quantity
adds it (``add_kind``). Conversions are exact (rational arithmetic, rounded once), so ``parse("800 mm/s", "m/s") ==
0.8``. SI units: BIPM, The International System of Units, 9th edition (2019).

Absolute temperatures and temperature differences are two different kinds of field: ``Quantity("degC")`` is a
temperature, ``Quantity("K")`` a difference (where ``2 degC`` and ``2 K`` are the same).
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue
    from pydantic_core import CoreSchema


class UnitError(ValueError):
    """A text that is not a quantity of the required kind; the message lists the accepted units."""


@dataclass(frozen=True, slots=True)
class _Kind:
    """A kind of quantity: its name, an example, its units as multiples of the first."""

    name: str
    example: str
    units: Mapping[str, Fraction]


SHORE_A: Final = "Shore A"
SCALES: Final[Mapping[str, tuple[float, float]]] = {SHORE_A: (0.0, 100.0)}
"""Least and greatest value of a unit that is a scale with ends."""
_ONE = Fraction(1)
_K = Fraction(1000)
_MILLI = Fraction(1, 1000)
_DEGREE_PER_RADIAN = Fraction(180 / math.pi)  # to a float's precision: the only inexact factor here

_KINDS: tuple[_Kind, ...] = (
    _Kind("a speed", "0.8 m/s", {"m/s": _ONE, "mm/s": _MILLI}),
    _Kind("an acceleration", "2 m/s2", {"m/s2": _ONE, "mm/s2": _MILLI}),
    _Kind("a force", "200 N", {"N": _ONE, "kN": _K}),
    _Kind("a duration", "4 min", {"s": _ONE, "min": Fraction(60), "h": Fraction(3600), "ms": _MILLI}),
    _Kind("a temperature", "25 degC", {"degC": _ONE}),
    _Kind("a temperature difference", "2 K", {"K": _ONE, "degC": _ONE}),
    _Kind("an angle", "10 deg", {"deg": _ONE, "rad": _DEGREE_PER_RADIAN}),
    _Kind("an angular speed", "5 deg/s", {"deg/s": _ONE, "rad/s": _DEGREE_PER_RADIAN}),
    _Kind("an angular acceleration", "20 deg/s2", {"deg/s2": _ONE, "rad/s2": _DEGREE_PER_RADIAN}),
    _Kind("a length", "90 mm", {"mm": _ONE, "m": _K, "um": _MILLI}),
    _Kind("an area", "100 mm2", {"mm2": _ONE, "cm2": Fraction(100), "m2": Fraction(10**6)}),
    _Kind("a wave number", "2e4 1/m", {"1/m": _ONE, "1/mm": _K, "1/um": Fraction(10**6)}),
    _Kind("a spectral density of heights", "2.6e-19 m4", {"m4": _ONE}),
    _Kind("a pressure", "1.2 MPa", {
        "Pa": _ONE, "kPa": _K, "bar": Fraction(10**5), "MPa": Fraction(10**6), "GPa": Fraction(10**9),
    }),
    _Kind("a frequency", "100 Hz", {"Hz": _ONE, "kHz": _K}),
    _Kind("a power", "200 W", {"W": _ONE, "kW": _K}),
    _Kind("an energy", "40 J", {"J": _ONE, "kJ": _K}),
    _Kind("a torque", "2 N m", {"N m": _ONE}),
    _Kind("a heat capacity", "420 J/K", {"J/K": _ONE, "kJ/K": _K}),
    _Kind("a heat conductance", "0.06 W/K", {"W/K": _ONE}),
    _Kind("a density", "1120 kg/m3", {"kg/m3": _ONE}),
    _Kind("a specific heat", "1850 J/(kg K)", {"J/(kg K)": _ONE, "kJ/(kg K)": _K}),
    _Kind("a heat conductivity", "0.25 W/(m K)", {"W/(m K)": _ONE}),
    _Kind("a heat transfer coefficient", "14 W/(m2 K)", {"W/(m2 K)": _ONE}),
    _Kind("a hardness", "64 Shore A", {"Shore A": _ONE}),
    _Kind("a stiffness", "125 N/mm", {"N/mm": _ONE, "N/m": _MILLI}),
    _Kind("a damping", "400 N s/m", {"N s/m": _ONE}),
    _Kind("a wear rate", "0.08 mm3/(N m)", {"mm3/(N m)": _ONE}),
    _Kind("a growth with temperature", "0.006 mm/K", {"mm/K": _ONE, "um/K": _MILLI}),
    _Kind("a loss of height over the way", "0.0005 mm/m", {"mm/m": _ONE, "um/m": _MILLI}),
    _Kind("a rate of temperature", "0.05 K/s", {"K/s": _ONE, "K/min": Fraction(1, 60)}),
    _Kind("a drift with temperature", "0.1 N/K", {"N/K": _ONE}),
    _Kind("a rise with power", "5 K/W", {"K/W": _ONE}),
    _Kind("a change with temperature", "0.4 %/K", {"1/K": _ONE, "%/K": Fraction(1, 100)}),
    _Kind("a curvature over temperature", "0.002 1/K2", {"1/K2": _ONE}),
    _Kind("a rate of force", "100 N/s", {"N/s": _ONE}),
    _Kind("a bit rate", "500 kbit/s", {"bit/s": _ONE, "kbit/s": _K, "Mbit/s": Fraction(10**6)}),
    _Kind("a number of revolutions", "30 rev", {"rev": _ONE}),
    _Kind("a percentage", "50 %", {"%": _ONE}),
    _Kind("a ratio", "2 %", {"1": _ONE, "%": Fraction(1, 100)}),
)


def _kinds_by_unit() -> dict[str, _Kind]:
    """Return the kind of each unit: "K" means a difference, "%" a percentage."""
    table: dict[str, _Kind] = {}
    for kind in _KINDS:
        for unit in kind.units:
            table.setdefault(unit, kind)
    return table


_KIND_OF = _kinds_by_unit()


def add_kind(name: str, example: str, units: Mapping[str, float]) -> None:
    """Add a kind of quantity to the table, before its unit is first used.

    ``name`` with its article, such as "a viscosity"; ``example`` such as "50 mPa s"; ``units`` with the factor to the
    first of them, which is 1: {"mPa s": 1, "Pa s": 1000}. The same kind may be added again. Raises UnitError for a unit
    of another kind in the table, and for a factor that is not above 0.
    """
    factors = {unit: Fraction(factor) for unit, factor in units.items() if factor > 0.0 and math.isfinite(factor)}
    if len(factors) < len(units) or next(iter(factors.values()), None) != 1:
        raise UnitError(f"{name}: factors of units are above 0, that of the first is 1 (given {dict(units)})")
    kind = _Kind(name, example, factors)
    for unit in factors:
        if _KIND_OF.get(unit, kind) != kind:
            raise UnitError(f"{name}: the unit {unit} is that of {_KIND_OF[unit].name}")
    _KIND_OF.update(dict.fromkeys(factors, kind))


def known_unit(unit: str, of: str) -> None:
    """Raise UnitError unless a unit is in the table; ``of``: its user, for the message."""
    if unit not in _KIND_OF:
        near = difflib.get_close_matches(unit, [*_KIND_OF], n=1, cutoff=0.6)
        meant = f", did you mean {near[0]}?" if near else ""
        raise UnitError(
            f"{of}: the unit {shown(unit)} is not in the table{meant} (expected one of {', '.join(_KIND_OF)}; "
            "tester.base.units.add_kind adds a kind of quantity)"
        )


_SPELLINGS: dict[str, str] = {
    "°C": "degC", "℃": "degC", "deg C": "degC", "° C": "degC", "C": "degC", "celsius": "degC",
    "Celsius": "degC", "°": "deg", "degree": "deg", "degrees": "deg", "°/s": "deg/s", "°/s2": "deg/s2",
    "µm": "um", "micron": "um", "microns": "um", "m⁴": "m4", "mm²": "mm2", "cm²": "cm2", "m²": "m2", "N/mm2": "MPa",
    "1/µm": "1/um", "m⁻¹": "1/m", "mm⁻¹": "1/mm", "sec": "s", "second": "s", "seconds": "s", "minute": "min",
    "minutes": "min", "hour": "h", "hours": "h", "kelvin": "K", "newton": "N",
    "m s⁻¹": "m/s", "mm s⁻¹": "mm/s", "Nm": "N m", "Ns/m": "N s/m",
    "revs": "rev", "revolution": "rev", "revolutions": "rev", "percent": "%",
    "J/kg/K": "J/(kg K)", "J/kgK": "J/(kg K)", "J/(kgK)": "J/(kg K)", "J/kg K": "J/(kg K)",
    "W/m/K": "W/(m K)", "W/mK": "W/(m K)", "W/(mK)": "W/(m K)", "W/m K": "W/(m K)",
    "W/m2/K": "W/(m2 K)", "W/m2K": "W/(m2 K)", "W/(m2K)": "W/(m2 K)", "W/m2 K": "W/(m2 K)",
    "ShA": "Shore A", "mm3/Nm": "mm3/(N m)", "mm3/(Nm)": "mm3/(N m)", "mm3/N m": "mm3/(N m)", "mm3/N/m": "mm3/(N m)",
}  # fmt: skip
"""Other spellings of the table's units."""

_TYPOGRAPHY = str.maketrans(
    {"·": " ", "⋅": " ", "*": " ", "²": "2", "³": "3", "^": None, "μ": "µ", "\u00a0": " ", "\u202f": " "}
)
_NUMBER = r"[+\-−]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+\-]?[0-9]{1,2})?"
_QUANTITY = re.compile(rf"\s*(?P<number>{_NUMBER})\s*(?P<unit>.*?)\s*", re.DOTALL)
_HUGE = re.compile(r"\s*[+\-−]?[0-9.]+[eE][+\-]?[0-9]{3}")
"""A number with more digits in its exponent than any quantity has."""
_DECIMAL_COMMA = re.compile(r"\s*[+\-−]?[0-9]+,[0-9]")
_LONGEST = 80
"""Longest text that is parsed, in characters: any real quantity is a quarter of this."""
_REMEMBERED = 32_768
"""Number of texts whose value is cached: a file's quantities are read by the schema and again against the rig's
limits."""


def shown(text: str) -> str:
    """Return a user's text quoted for a message: one line, at most 40 characters."""
    line = " ".join(text.split())
    return f'"{line[:37]}..."' if len(line) > 40 else f'"{line}"'


def units_like(unit: str) -> tuple[str, ...]:
    """Return the units accepted for ``unit``; raises KeyError if it is not in the table."""
    return tuple(_KIND_OF[unit].units)


@cache
def expected(*units: str) -> str:
    """Return the expected form, e.g. ``a speed such as "0.8 m/s"; units accepted: m/s, mm/s``."""
    kinds = list(dict.fromkeys(_KIND_OF[unit].name for unit in units))
    example = _KIND_OF[units[0]].example
    accepted = dict.fromkeys(
        accepted_unit for unit in units for accepted_unit in units_like(unit) if accepted_unit != "1"
    )
    return f'{" or ".join(kinds)} such as "{example}"; units accepted: {", ".join(accepted)}'


def parse(text: str, unit: str) -> float:
    """Return a quantity's value in ``unit``.

    ``unit`` is in the table; the text may use any unit of the same kind and its usual spellings. A ratio (unit "1")
    needs no unit. Raises UnitError with a message for the user, KeyError for an unknown ``unit``.
    """
    return parse_one_of(text, (unit,))[0]


def rig_speed(text: str) -> float | None:
    """Return a simulated rig's seconds per second, None for ``max``; raises ValueError for any other text."""
    if text.strip().lower() == "max":
        return None
    try:
        speed = float(text)
    except ValueError:
        speed = 0.0
    if not 0.0 < speed <= 1e6:
        raise ValueError(f'expected "max" or a number above 0 (rig seconds per second), got "{text}"')
    return speed


def parse_one_of(text: str, units: tuple[str, ...]) -> tuple[float, str]:
    """Return (value, unit) of a quantity that may be of several kinds, e.g. ``("rev", "s")``.

    The returned unit is the one of ``units`` whose kind fits; the value is in it. Raises as ``parse`` does.
    """
    if len(text) > _LONGEST:
        raise UnitError(f"{shown(text)} is too long for a quantity (expected {expected(*units)})")
    return _parsed(text, units)


@lru_cache(maxsize=_REMEMBERED)
def _parsed(text: str, units: tuple[str, ...]) -> tuple[float, str]:
    """Return (value, unit) as ``parse_one_of`` does, of a text that is not too long."""
    hint = expected(*units)
    if _DECIMAL_COMMA.match(text):
        raise UnitError(f"{shown(text)} has a decimal comma, write a point (expected {hint})")
    if huge := _HUGE.match(text):
        how = "small" if "-" in huge[0].lstrip().lstrip("-") else "large"
        raise UnitError(f"{shown(text)} is too {how} (expected {hint})")
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise UnitError(f"{shown(text)} is not a number with a unit (expected {hint})")
    number, written = match["number"].replace("−", "-"), match["unit"]
    name = _canonical(written)
    for unit in units:
        kind = _KIND_OF[unit]
        factor = kind.units.get(name or "1")
        if factor is not None:
            target = kind.units[unit]
            exact = float(number) if factor is target else float(Fraction(number) * factor / target)
            # + 0.0 turns a negative zero into zero: -0 mm/s is the same condition as 0 mm/s.
            return exact + 0.0, unit
    if not written:
        raise UnitError(f"{shown(text)} has no unit (expected {hint})")
    raise UnitError(f"{shown(text)} has {_unit_problem(written, name, units)} (expected {hint})")


@lru_cache(maxsize=256)
def _canonical(written: str) -> str:
    """Return the table's spelling of a unit; a unit outside the table comes back unchanged."""
    tidy = re.sub(r"\s*([/()])\s*", r"\1", written.translate(_TYPOGRAPHY))
    tidy = re.sub(r"\s+", " ", tidy).strip()
    tidy = re.sub(r"/\((\w+)\)$", r"/\1", tidy)
    return _SPELLINGS.get(tidy, tidy)


def _unit_problem(written: str, name: str, units: tuple[str, ...]) -> str:
    """Return the fault of a unit: of another kind, misspelt, or unknown."""
    if name == "K" and "degC" in units:
        return "the unit K, which is for temperature differences here"
    if name in _KIND_OF:
        return f"the unit of {_KIND_OF[name].name.split(' ', 1)[1]}"
    accepted = [accepted_unit for unit in units for accepted_unit in units_like(unit)]
    near = [accepted_unit for accepted_unit in accepted if accepted_unit.casefold() == name.casefold()]
    near = near or difflib.get_close_matches(name, accepted, n=1, cutoff=0.6)
    meant = f", did you mean {near[0]}?" if near else ""
    return f"the unknown unit {shown(written)}{meant}"


def show(value: float, unit: str) -> str:
    """Return a value with its unit for people, with at most six significant digits."""
    return f"{value:.6g} {unit}"


def as_text(value: float, unit: str) -> str:
    """Return a value in a form that ``parse`` reads back without loss: ``as_text(0.3, "m/s") == "0.3 m/s"``."""
    return f"{int(value) if value == int(value) and abs(value) < 1e15 else value} {unit}"


@dataclass(frozen=True, slots=True)
class Quantity:
    """Mark a pydantic field as a quantity in ``unit``: ``Annotated[float, Quantity("m/s", ge=0)]``.

    A bare number is refused, naming the units accepted, unless ``bare`` is set (then it counts in ``unit``;
    a ratio, unit "1", may always be bare). ``gt``, ``ge``, ``lt``, ``le`` bound the value, in ``unit``.
    """

    unit: str
    bare: bool = False
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None

    def read(self, value: object) -> float:
        """Return the value in ``unit`` of a file's entry; raises UnitError."""
        if isinstance(value, str):
            number = parse(value, self.unit)
        elif isinstance(value, bool) or not isinstance(value, int | float):
            raise UnitError(f"expected {expected(self.unit)}")
        elif self.bare or self.unit == "1":
            number = float(value)
        else:
            raise UnitError(f"{value:g} has no unit (expected {expected(self.unit)})")
        self._bound(number)
        return number

    def _bound(self, number: float) -> None:
        unit = "" if self.unit == "1" else f" {self.unit}"
        text = f"{number:.6g}{unit}"
        if not math.isfinite(number):
            raise UnitError(f"{text} is not a finite number (expected {expected(self.unit)})")
        if self.gt is not None and number <= self.gt:
            raise UnitError(f"{text} is too small (expected more than {self.gt:g}{unit})")
        if self.ge is not None and number < self.ge:
            raise UnitError(f"{text} is too small (expected at least {self.ge:g}{unit})")
        if self.lt is not None and number >= self.lt:
            raise UnitError(f"{text} is too large (expected less than {self.lt:g}{unit})")
        if self.le is not None and number > self.le:
            raise UnitError(f"{text} is too large (expected at most {self.le:g}{unit})")

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return a validator of text for pydantic, imported here so that units cost no pydantic."""
        from pydantic_core import PydanticCustomError, core_schema

        def validate(value: object) -> float:
            try:
                return self.read(value)
            except UnitError as error:
                # The text is passed as a value: a user's braces never reach a format string.
                raise PydanticCustomError("quantity", "{message}", {"message": str(error)}) from error

        if self.bare or self.unit == "1":
            return core_schema.no_info_plain_validator_function(validate)
        # In JSON a quantity has the form of the file.
        in_json = core_schema.plain_serializer_function_ser_schema(self._written, when_used="json")
        return core_schema.no_info_plain_validator_function(validate, serialization=in_json)

    def _written(self, value: float) -> str:
        return as_text(value, self.unit)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return the schema for editors: a text with a number and a unit, or a number where it needs no unit."""
        quantity: JsonSchemaValue = {
            "type": "string",
            "pattern": rf"^\s*{_NUMBER}\s*[^0-9\s].*$",
            "description": expected(self.unit),
            "examples": [_KIND_OF[self.unit].example],
        }
        if self.bare or self.unit == "1":
            return {"anyOf": [quantity, {"type": "number"}]}
        return quantity
