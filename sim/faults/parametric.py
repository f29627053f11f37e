"""Faults with a magnitude, and those that no row of the interlock table is asked for yet.

``PARAMETRIC`` says between which values a fault can lie, and which one is no fault at all: a search goes from there to
either end. ``UNANSWERED`` are faults of the machine's assembly without a magnitude. Neither is injected by the campaign
over the catalogue: some of them do harm today. All of them can be written (``FAULTS``).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

from sim.faults import machine as k
from sim.faults import sensors as s
from sim.faults.catalogue import CATALOGUE
from sim.faults.kinds import Exposure, FaultKind, Reaction
from sim.faults.scene import Effect

_NOTE = "no row of the interlock table is asked for it yet"


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
        """The greatest magnitudes of either sign."""
        return tuple(end for end in (self.least, self.most) if end != self.normal)

    def between(self, end: float, share: float) -> float:
        """Return the magnitude at a share (0 to 1) of the way from ``normal`` to one of ``ends``."""
        return self.normal + share * (end - self.normal)

    def text(self, value: float) -> str:
        """Return the fault as a script has it, without its time."""
        unit = self.kind.unit or ""
        return f"{self.kind.phrase} {value:.6g} {'s' if unit == 'ms' else unit}".rstrip()


def _new(phrase: str, make: type[Effect] | partial[Effect], unit: str | None = None, value: float = 0.0) -> FaultKind:
    return FaultKind(phrase, make, Exposure.ALWAYS, Reaction.MAY, 0.0, unit, value, slow=True, note=_NOTE)


def _sensors() -> Iterator[Parametric]:
    yield Parametric(CATALOGUE["load cell offset"], -200.0, 200.0)
    yield Parametric(CATALOGUE["load cell drift"], -5.0, 5.0)
    yield Parametric(_new("load cell gain", partial(s.CellFault, "gain"), "%", 70.0), 50.0, 150.0, 100.0)
    yield Parametric(CATALOGUE["hub sensor offset"], -40.0, 40.0)
    yield Parametric(_new("hub sensor gain", partial(s.HubFault, "gain"), "%", 80.0), 60.0, 140.0, 100.0)
    yield Parametric(CATALOGUE["thermometer offset"], -40.0, 40.0)
    yield Parametric(CATALOGUE["thermometer drift"], -1.0, 1.0)
    yield Parametric(_new("thermometer gain", partial(s.SurfaceFault, "gain"), "%", 80.0), 60.0, 140.0, 100.0)
    common = _new("common supply of hub sensor and thermometer", s.CommonSupplyFault, "%", 80.0)
    yield Parametric(common, 60.0, 140.0, 100.0)
    for name, make, lag_s in (
        ("load cell", s.CellFault, 1.0), ("thermometer", s.SurfaceFault, 1.5), ("hub sensor", s.HubFault, 10.0),
    ):  # fmt: skip
        yield Parametric(_new(f"{name} lag", partial(make, "lag"), "ms", lag_s), 0.0, 4.0 * lag_s)
        yield Parametric(_new(f"{name} delay", partial(make, "delay"), "ms", 0.5 * lag_s), 0.0, 4.0 * lag_s)


def _mechanics() -> Iterator[Parametric]:
    for axis in ("wheel", "belt"):
        yield Parametric(_new(f"{axis} speed scale", partial(k.SpeedScale, axis), "%", 110.0), 50.0, 200.0, 100.0)
    yield Parametric(_new("wheel diameter", k.DiameterOff, "%", 110.0), 85.0, 115.0, 100.0)
    yield Parametric(CATALOGUE["belt slips on its roller"], 0.0, 100.0)
    yield Parametric(_new("rubber detached", k.RubberDetached, "mm", 0.3), 0.0, 1.0)
    yield Parametric(_new("rubber relaxation", k.RubberRelaxes, "%", 10.0), 3.0, 15.0, 3.0)
    yield Parametric(CATALOGUE["CAN frames late"], 0.0, 1.0)


PARAMETRIC: dict[str, Parametric] = {row.kind.phrase: row for row in (*_sensors(), *_mechanics())}
"""Every fault with a range of magnitudes by its phrase."""

UNANSWERED: dict[str, FaultKind] = {
    row.phrase: row
    for row in (
        _new("load cell Fx and Fz exchanged", partial(s.CellFault, "exchanged x z")),
        _new("load cell Fx reversed", partial(s.CellFault, "reversed x")),
        _new("load cell Fy reversed", partial(s.CellFault, "reversed y")),
        _new("load cell Fz reversed", partial(s.CellFault, "reversed z")),
        _new("wheel drive reversed", partial(k.Reversed, "wheel")),
        _new("belt drive reversed", partial(k.Reversed, "belt")),
        _new("wheel and belt drives swapped", k.DrivesSwapped),
    )
}
"""Faults without a magnitude that are not in the catalogue, by phrase."""

FAULTS: dict[str, FaultKind] = CATALOGUE | UNANSWERED | {name: row.kind for name, row in PARAMETRIC.items()}
"""Every fault that can be written, by its phrase."""
