"""Faults whose magnitude matters: between which values one can lie, and which one is none at all."""

from __future__ import annotations

from dataclasses import dataclass

from sim.faults.kinds import FaultKind


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
