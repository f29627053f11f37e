"""Facts about this machine from past runs: the wheel on it, the load cell's zero, its heat balance."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from math import isfinite
from typing import Final

from tester.base.screen import Check
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import KnownRatio
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.store.records import PieceInfo
from tester.store.run_reader import RunReader

CELL_ZERO: Final = "zero of the load cell"


@dataclass(frozen=True, slots=True)
class WheelLeft:
    """The last wheel of a run, with its wear, and the run's newest zero of the load cell."""

    run: str
    wheel: PieceInfo | None
    tare_utc: str = ""
    """"" if no zero was taken, or its time is unknown."""

    @property
    def known(self) -> bool:
        """Whether the run mounted a wheel."""
        return self.wheel is not None

    def usable(self, rig: Rig) -> bool:
        """Return whether the wheel has at least the rig's ``least_diameter``."""
        wheel_rig = RigConfig.of(rig)
        return self.wheel is not None and self.wheel.diameter_mm >= wheel_rig.interlocks.least_diameter_mm


@dataclass(frozen=True, slots=True)
class HeatHistory:
    """Facts about the rig's heat balance from earlier runs."""

    ratio: KnownRatio

    def checks(self, rig: Rig, left: object, now_utc: str) -> tuple[Check, ...]:
        """Return this kind's lines of the pre-flight list. ``now_utc``: the wall clock."""
        wheel_left = left if isinstance(left, WheelLeft) else None
        return wheel_check(wheel_left), zero_check(wheel_left, now_utc), heat_check(self.ratio, RigConfig.of(rig))


def left_by(reader: RunReader, name: str) -> WheelLeft:
    """Return the wheel and the zero that a run of this name left on its rig. Raises StoreError."""
    wheel = max(reader.pieces(), key=lambda piece: (piece.installed_s, piece.piece), default=None)
    return WheelLeft(name, wheel, _tare_utc(reader))


def _tare_utc(reader: RunReader) -> str:
    """Return the wall-clock time of the newest zero: that of the next record after it."""
    at_s = max((tare.t_s for tare in reader.tares() if tare.kind != "check"), default=None)
    if at_s is None:
        return ""
    return next((event.utc for event in reader.events() if event.t_s >= at_s), "")


def wheel_check(left: WheelLeft | None) -> Check:
    """Return the known state of the mounted wheel; a run first asks for a new wheel."""
    wheel = left.wheel if left is not None else None
    if wheel is None or not isfinite(wheel.diameter_mm):
        return Check("wheel", None, "none on record; a fresh one comes")
    worn_mm = max(wheel.installed_diameter_mm - wheel.diameter_mm, 0.0)
    text = f"{wheel.compound}, {wheel.diameter_mm:.2f} mm, {worn_mm:.2f} mm worn off in {wheel.sliding_m:.0f} m"
    return Check("wheel", None, f"last {text}; a fresh one comes")


def zero_check(left: WheelLeft | None, now_utc: str) -> Check:
    """Return the age of the load cell's zero; a run takes one for each wheel and before each repeat."""
    anew = "taken anew before motion"
    if left is None or not left.tare_utc:
        return Check(CELL_ZERO, None, anew)
    try:
        age_s = (datetime.fromisoformat(now_utc) - datetime.fromisoformat(left.tare_utc)).total_seconds()
    except ValueError:
        return Check(CELL_ZERO, None, anew)
    return Check(CELL_ZERO, None, f"{age_words(age_s)} old; {anew}")


def heat_check(heat: KnownRatio, rig: RigConfig) -> Check:
    """Return the limit for unexplained heat; a history that does not tighten it deserves attention."""
    limits = rig.interlocks
    tighter = heat.share(limits.heat_share, limits.heat_share_known) < limits.heat_share
    return Check("heat balance", tighter or None, heat.words(limits.heat_share, limits.heat_share_known))


def age_words(seconds: float) -> str:
    """Return an age in the largest unit that it contains at least twice."""
    for size, unit in ((86400.0, "d"), (3600.0, "h")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(seconds, 0.0) / 60.0:.0f} min"
