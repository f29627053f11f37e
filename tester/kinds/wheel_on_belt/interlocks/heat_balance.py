"""The heat balance: the heater's energy less what the temperatures shown explain as stored or lost.

A hub sensor that reads low, late or loose, or shares a supply with the thermometer, makes the controller put in heat
that no temperature shows. ``HeatBalance`` sums up that heat. The sum grows by the heater's output, shrinks by the heat
that the temperatures explain and by an allowance for wrong parameters, and never falls below zero. Parameters that are
off by less than the allowance leave it at zero; a larger error adds up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan
from statistics import median
from typing import Final

SMOOTHED_S: Final = 10.0
"""Powers are smoothed over this, s [A]: 0.05 K of noise of a hub of 420 J/K is 2 W then."""
STILL_K: Final = 0.15
"""A reading within this of an earlier one has not moved, K [A]: one count of 0.1 K, and what a float of it is off."""
LONGEST_S: Final = 5.0
"""Looked at more rarely than this, s, nothing is compared with what was before."""


@dataclass(slots=True)
class HeatBalance:
    """The sum of heat that is not shown, and the powers that it is made from."""

    capacity_j_k: float
    """``observer.thermal.hub_capacity``."""
    shaft_w_k: float
    """``observer.thermal.hub_to_shaft``."""
    power_w: float
    """``observer.thermal.jacket_power``: of the heater at 100 %."""
    ambient_c: float
    share: float
    """Allowed error of the parameters, a share of the heat stored and lost; tightened by a history (KnownRatio)."""
    leak_w: float
    """Allowed further loss, W."""
    unseen_k: float = 0.0
    """Heat not shown, as the kelvin by which it warms the hub."""
    put_w: float = 0.0
    """Smoothed power of the heater ..."""
    shown_w: float = 0.0
    """... and the same of the heat that the temperatures explain."""
    put_j: float = 0.0
    """Heat of the heater since the comparison began ..."""
    shown_j: float = 0.0
    """... and the part that the temperatures explain."""
    still_k: float = 0.0
    """While the reading does not move: heat beyond the least output meanwhile, and beyond the losses, as the kelvin by
    which it warms the hub.

    A hub at a constant temperature loses what it lost then: an error of the steady losses drops out.
    """
    _still_c: float = nan
    """The reading when it last moved."""
    _least_w: float = inf
    """The least given since it moved (smoothed) ..."""
    _least_lost_w: float = 0.0
    """... and the losses to rubber and shaft with it."""
    _lost_w: float = 0.0
    """Smoothed heat to rubber and shaft."""
    begun: int = 0
    """How often the comparison has begun anew."""
    _stored_w: float = 0.0
    _smoothing: bool = False
    _at_s: float = nan
    _hub_c: float = nan

    def forget(self) -> None:
        """Restart: a person was at the wheel and its hub, or another wheel is on."""
        self.unseen_k = self.put_w = self.shown_w = self._stored_w = self.put_j = self.shown_j = 0.0
        self.still_k = self._lost_w = 0.0
        self._smoothing = False
        self._still_c = nan  # so that all else begins anew
        self._at_s = self._hub_c = nan
        self.begun += 1

    def update(self, now_s: float, hub_c: float, output_percent: float, rubber_j: float) -> None:
        """Take in the hub's temperature, the heater's output behind its contactor, %, and the heat from hub to rubber
        since the last call, J."""
        dt = now_s - self._at_s
        before_c, self._at_s, self._hub_c = self._hub_c, now_s, hub_c
        if not (0.0 < dt <= LONGEST_S and before_c == before_c and hub_c == hub_c):
            return
        put_w = 0.01 * output_percent * self.power_w
        stored_w = self.capacity_j_k * (hub_c - before_c) / dt
        rubber_w = rubber_j / dt
        shaft_w = self.shaft_w_k * (hub_c - self.ambient_c)
        shown_w = stored_w + rubber_w + shaft_w
        # What is smoothed begins with its first value: from zero it would look like a heater that gives more and more.
        smooth = dt / (SMOOTHED_S + dt) if self._smoothing else 1.0
        self._smoothing = True
        self._stored_w += (stored_w - self._stored_w) * smooth
        self.put_w += (put_w - self.put_w) * smooth
        self.shown_w += (shown_w - self.shown_w) * smooth
        self._lost_w += (rubber_w + shaft_w - self._lost_w) * smooth
        self._follow_still(hub_c, dt)
        self.put_j += put_w * dt
        self.shown_j += shown_w * dt
        moved_w = abs(self._stored_w) + abs(rubber_w) + abs(shaft_w)
        unseen_k = self.unseen_k + (put_w - shown_w - self.share * moved_w - self.leak_w) * dt / self.capacity_j_k
        self.unseen_k = 0.0 if unseen_k < 0.0 else unseen_k

    def _follow_still(self, hub_c: float, dt: float) -> None:
        """Add up the heat that a hub takes without moving."""
        if not (-STILL_K <= hub_c - self._still_c <= STILL_K):
            self.still_k, self._still_c, self._least_w = 0.0, hub_c, inf
        if self.put_w < self._least_w:
            self._least_w, self._least_lost_w = self.put_w, self._lost_w
        taken_w = (1.0 + self.share) * (self._lost_w - self._least_lost_w)  # by a rubber that has got colder
        astray_w = self.leak_w + (taken_w if taken_w > 0.0 else 0.0)
        still_k = self.still_k + (self.put_w - self._least_w - astray_w) * dt / self.capacity_j_k
        self.still_k = 0.0 if still_k < 0.0 else still_k


FIRST: Final = 3
"""So many heatings in a row that agree make a history [A]: one may be odd, two may be odd the same way."""
NEWEST: Final = 20
"""So many of the newest are looked at [A]: some weeks of runs."""
LEAST_SHARE: Final = 0.06
"""A ratio below 1 tightens to this at most [A]: a hub that holds its temperature is balanced by what it loses,
which heating up hardly shows."""


@dataclass(frozen=True, slots=True)
class KnownRatio:
    """The history of a rig's heatings: their number, their ratio, and by how much the newest differ."""

    count: int = 0
    ratio: float = nan
    apart: float = 0.0
    """Greatest less least of the newest."""

    def share(self, widest: float, known: float) -> float:
        """Return by how much more heat may be put in than is shown.

        ``widest`` (``heat_share``) without a history, and never more than that; ``known`` (``heat_share_known``) beyond
        the ratio with one, and never less than LEAST_SHARE.
        """
        if self.count == 0:
            return widest
        return min(widest, max(self.ratio * (1.0 + known) - 1.0, LEAST_SHARE))

    def words(self, widest: float, known: float) -> str:
        """Return the history and the share that follows from it, in words."""
        share = self.share(widest, known)
        row = f"a row tells from {100.0 * share:.0f} %"
        if self.count == 0:
            return f"no history yet; {row}"
        text = f"known from {self.count} heatings, ratio {self.ratio:.2f}, {self.apart:.2f} apart; {row}"
        return text if share < widest else f"{text}: measure observer.thermal, or check the sensors"


NO_HISTORY: Final = KnownRatio()


def known_ratio(ratios: Sequence[float], widest: float, known: float) -> KnownRatio:
    """Return the history of a rig by the ratios of its heatings, oldest first; ``widest``, ``known``: as in ``share``.

    The ratio is the median of the newest, but never more than that of the first ones that agree within ``known``. A
    supply that drifts by 1 % a run would shift the newest, so that each run agrees with the one before it; the first
    ones stay. (A supply that was wrong from the first heating on is in them as well: its ratio is then beyond what the
    parameters explain, or looks like a hub of more heat capacity.)
    """
    sound = [ratio for ratio in ratios if 1.0 - widest <= ratio <= 1.0 + widest]
    for begin in range(len(sound) - FIRST + 1):
        first = sound[begin : begin + FIRST]
        if max(first) - min(first) <= known:
            newest = sound[begin:][-NEWEST:]
            ratio = min(median(first), median(newest))
            return KnownRatio(len(newest), ratio, max(newest) - min(newest))
    return NO_HISTORY
