"""The faults of a wheel on a belt whose magnitude matters, each with its range; and those of its assembly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from sim.faults.kinds import FaultKind
from tests.campaigns.faults.recipes import GRID, language_of

ASSEMBLY = (
    "wheel drive reversed", "belt drive reversed", "wheel speed", "belt speed", "wheel and belt drives swapped",
    "wheel diameter",
)  # fmt: skip
"""Beginnings of the phrases of assembly faults of the machine: none begins during a run."""
_LAGS = {"load cell": 4.0, "thermometer": 6.0, "hub sensor": 40.0}
"""Greatest time constant, or delay, of a sensor in a search, s."""
_OF_SHARES = {" gain": (60.0, 140.0, 100.0), " offset": (-30.0, 30.0, 0.0), " drift": (-10.0, 10.0, 0.0)}
"""Ranges of common failures, by the end of the phrase: percent of the reading, of the span, of the span in a minute."""


@dataclass(frozen=True, slots=True)
class Parametric:
    """A fault whose magnitude lies between ``least`` and ``most`` (the kind's unit); ``normal`` is no fault."""

    kind: FaultKind
    least: float
    most: float
    normal: float = 0.0

    def __post_init__(self) -> None:
        """Raise ValueError unless least <= normal <= most leaves something to search, and the kind takes a value."""
        if not self.least <= self.normal <= self.most or self.least == self.most or self.kind.unit is None:
            raise ValueError(f"{self.kind.phrase}: {self.least:g} to {self.most:g} around {self.normal:g}")

    @property
    def ends(self) -> tuple[float, ...]:
        """Return ``least`` and ``most``, except an end that equals ``normal``."""
        return tuple(end for end in (self.least, self.most) if end != self.normal)

    def between(self, end: float, share: float) -> float:
        """Return the magnitude at a share (0 to 1) of the way from ``normal`` to one of ``ends``."""
        return self.normal + share * (end - self.normal)

    def text(self, value: float) -> str:
        """Return the fault as in a script, without its time."""
        unit = self.kind.unit or ""
        return f"{self.kind.phrase} {value:.6g} {'s' if unit == 'ms' else unit}".rstrip()


def _ranges() -> Iterator[tuple[str, float, float, float]]:
    """Yield phrase, least and greatest magnitude, and the faultless magnitude, at which a search begins."""
    yield "load cell offset", -200.0, 200.0, 0.0
    yield "load cell drift", -5.0, 5.0, 0.0
    yield "load cell gain", 50.0, 150.0, 100.0
    yield "hub sensor offset", -40.0, 40.0, 0.0
    yield "hub sensor gain", 60.0, 140.0, 100.0
    yield "hub sensor partly detached", 60.0, 100.0, 100.0
    yield "thermometer offset", -40.0, 40.0, 0.0
    yield "thermometer drift", -1.0, 1.0, 0.0
    yield "thermometer gain", 60.0, 140.0, 100.0
    yield "hub sensor drift", -10.0 / 60.0, 10.0 / 60.0, 0.0
    for name in ("load cell", "thermometer", "hub sensor"):
        for slow in ("lag", "delay"):
            yield f"{name} {slow}", 0.0, _LAGS[name], 0.0
    for axis in ("wheel", "belt"):
        yield f"{axis} speed scale", 50.0, 200.0, 100.0
    yield "wheel diameter", 85.0, 115.0, 100.0
    yield "belt slips on its roller", 0.0, 100.0, 0.0
    yield "rubber detached", 0.0, 1.0, 0.0
    yield "rubber relaxation", 3.0, 15.0, 3.0
    yield "CAN frames late", 0.0, 1.0, 0.0
    for phrase in CATALOGUE:
        of_share = next((_OF_SHARES[end] for end in _OF_SHARES if phrase.endswith(end)), None)
        if of_share and phrase.startswith("common "):
            yield phrase, *of_share


CATALOGUE = language_of(GRID[0]).catalogue
PARAMETRIC: dict[str, Parametric] = {
    phrase: Parametric(CATALOGUE[phrase], least, most, normal) for phrase, least, most, normal in _ranges()
}
"""The rows of the catalogue whose magnitude matters, each with its range, by phrase."""


def range_of(phrase: str) -> str:
    """Return the range of a fault's magnitude in words, "" for a fault without one."""
    row = PARAMETRIC.get(phrase)
    if row is None:
        return ""
    return f"; {row.least:g} to {row.most:g} {row.kind.unit}, without a fault {row.normal:g}"
