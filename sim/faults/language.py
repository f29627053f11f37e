"""The language of a fault script: one line a fault.

    t=130 s: belt drive heartbeat lost for 3 s
    at scan 1200: operator stop
    step measure: load cell frozen
    step heat + 20 s: thermometer offset -15 K for 1 min
    condition 3/2 + 5 s: friction 115 %

The last fault begins 5 s after the start of the second repeat of condition 3.

A line consists of a time, a colon, the fault's phrase, its value if it has one, and its duration (else it lasts to the
end of the run). Each kind of machine defines the phrases and the steps.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from math import inf, isfinite

from sim.faults.kinds import FaultKind

_SECONDS = {"ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0}
_FACTORS: dict[str, dict[str, float]] = {
    "ms": _SECONDS,
    "N": {"N": 1.0, "kN": 1000.0},
    "K": {"K": 1.0},
    "%": {"%": 1.0},
    "mm": {"mm": 1.0, "um": 1e-3},
    "mm/s": {"mm/s": 1.0, "m/s": 1000.0},
    "m/s": {"m/s": 1.0, "mm/s": 1e-3},
    "rad/s": {"rad/s": 1.0},
    "K/s": {"K/s": 1.0},
    "N/s": {"N/s": 1.0},
    "%/min": {"%/min": 1.0, "%/s": 60.0},
    "": {"": 1.0},
}
"""Accepted units of a value, by the unit of the fault's row; times become seconds."""

_NUMBER = r"[+-]?(?:0x[0-9a-fA-F]+|\d+(?:\.\d*)?|\.\d+)"
_DURATION = re.compile(rf"^(?P<rest>.*\S)\s+for\s+(?P<number>{_NUMBER})\s*(?P<unit>[a-z]*)$")
_VALUE = re.compile(rf"^(?P<phrase>.*\S)\s+(?P<number>{_NUMBER})\s*(?P<unit>[A-Za-z%/]*)$")
_AT_TIME = re.compile(rf"^t\s*=\s*(?P<number>{_NUMBER})\s*(?P<unit>[a-z]*)$")
_AT_SCAN = re.compile(r"^at scan (?P<number>\d+)$")
_AT_CONDITION = re.compile(
    rf"^(?P<name>condition [1-9]\d*(?:/[1-9]\d*)?)(?:\s*\+\s*(?P<number>{_NUMBER})\s*(?P<unit>[a-z]*))?$"
)
_AT_STEP = re.compile(rf"^step (?P<name>[a-z-]+)(?:\s*\+\s*(?P<number>{_NUMBER})\s*(?P<unit>[a-z]*))?$")


class FaultTextError(ValueError):
    """A line of a fault script that cannot be read; the message names place, error and expected text."""


@dataclass(frozen=True, slots=True)
class FaultTime:
    """Start of a fault: at a time (s), at a scan (from 1), or a time (s) after the start of a step, a condition or a
    repeat (``step`` is its name then: ``condition 3``, ``condition 3/2``)."""

    at_s: float = inf
    scan: int = 0
    step: str = ""
    after_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Injection:
    """One line of a script."""

    when: FaultTime
    kind: FaultKind
    value: float | None = None
    lasts_s: float = inf
    text: str = ""

    def shifted(self, by_s: float) -> Injection:
        """Return the same fault later by this time, s; without a written end its kind's own end counts."""
        lasts_s = min(self.lasts_s, self.kind.lasts_s)
        return replace(self, when=replace(self.when, at_s=self.when.at_s + by_s), lasts_s=lasts_s)


@dataclass(frozen=True, slots=True)
class FaultLanguage:
    """Language for the scripts of one kind of machine: its faults by phrase, and the steps that they can wait for."""

    catalogue: Mapping[str, FaultKind]
    steps: Sequence[str]

    def parse_script(self, texts: Iterable[str]) -> list[Injection]:
        """Return the faults of a script. Raises FaultTextError with every line that cannot be read."""
        found: list[Injection] = []
        problems: list[str] = []
        for text in texts:
            try:
                found.append(self.parse(text))
            except FaultTextError as error:
                problems.append(str(error))
        if problems:
            raise FaultTextError("\n".join(problems))
        return found

    def parse(self, text: str) -> Injection:
        """Return one line's fault. Raises FaultTextError."""
        when_text, colon, what = text.partition(":")
        if not colon:
            raise _error(text, 'expected "WHEN: FAULT", e.g. "t=130 s: emergency stop pressed"')
        when = self._when(text, " ".join(when_text.split()))
        what = " ".join(what.split())
        lasts_s = inf
        duration = _DURATION.match(what)
        if duration is not None:
            what = duration["rest"]
            lasts_s = _seconds(text, duration["number"], duration["unit"])
            if lasts_s <= 0.0:
                raise _error(text, "a duration is above 0 s")
        kind, value = self._what(text, what)
        return Injection(when, kind, value, lasts_s, text.strip())

    def _when(self, text: str, when: str) -> FaultTime:
        at_time = _AT_TIME.match(when)
        if at_time is not None:
            seconds = _seconds(text, at_time["number"], at_time["unit"])
            if seconds < 0.0:
                raise _error(text, "a run begins at t=0 s")
            return FaultTime(at_s=seconds)
        at_scan = _AT_SCAN.match(when)
        if at_scan is not None:
            if int(at_scan["number"]) < 1:
                raise _error(text, "scans count from 1")
            return FaultTime(scan=int(at_scan["number"]))
        at_condition = _AT_CONDITION.match(when)
        at_step = at_condition or _AT_STEP.match(when)
        if at_step is not None:
            if at_condition is None and at_step["name"] not in self.steps:
                near = _nearest(at_step["name"], self.steps)
                raise _error(text, f"unknown step {at_step['name']!r}{near}; {_listed(self.steps)}")
            after_s = _seconds(text, at_step["number"], at_step["unit"]) if at_step["number"] else 0.0
            return FaultTime(step=at_step["name"], after_s=after_s)
        raise _error(text, f'{when!r} is no time: expected "t=130 s", "at scan 1200", "step measure + 2 s" or'
                     ' "condition 3/2 + 5 s"')

    def _what(self, text: str, what: str) -> tuple[FaultKind, float | None]:
        kind = self.catalogue.get(what)
        if kind is not None:
            return kind, None
        match = _VALUE.match(what)
        if match is None or match["phrase"] not in self.catalogue:
            phrase = match["phrase"] if match is not None else what
            raise _error(text, f"unknown fault {phrase!r}{_nearest(phrase, self.catalogue)}")
        kind = self.catalogue[match["phrase"]]
        if kind.unit is None:
            raise _error(text, f"{kind.phrase!r} takes no value")
        factors = _FACTORS[kind.unit]
        if match["unit"] not in factors:
            expected = " or ".join(factors) if kind.unit else "a plain number"
            raise _error(text, f"{kind.phrase!r}: unit {match['unit']!r}, expected {expected}")
        return kind, _number(match["number"]) * factors[match["unit"]]


def _number(text: str) -> float:
    return float(int(text, 16)) if "0x" in text.lower() else float(text)


def _seconds(text: str, number: str, unit: str) -> float:
    if unit not in _SECONDS:
        raise _error(text, f"unit {unit!r} of a time, expected {' or '.join(_SECONDS)}")
    seconds = _number(number) * _SECONDS[unit]
    if not isfinite(seconds):
        raise _error(text, f"{number} is no time")
    return seconds


def _nearest(word: str, known: Iterable[str]) -> str:
    near = get_close_matches(word, list(known), 1, 0.5)
    return f", nearest is {near[0]!r}" if near else ""


def _listed(names: Iterable[str]) -> str:
    return "known: " + ", ".join(names)


def _error(text: str, why: str) -> FaultTextError:
    return FaultTextError(f"fault {text.strip()!r}: {why}")
