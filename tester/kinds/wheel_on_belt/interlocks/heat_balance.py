"""The heat balance: the heater's energy less the heat that the measured temperatures explain as stored or lost.

A hub sensor that reads low or late, is loose, or shares a faulty supply with the thermometer makes the controller put
in heat that no temperature shows. ``HeatBalance`` sums up that heat. The sum grows by the heater's output, shrinks by
the heat that the temperatures explain and by an allowance for wrong parameters, and never falls below zero. Parameter
errors within the allowance leave it at zero; a larger error adds up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan
from statistics import median
from typing import Final, NamedTuple

SMOOTHED_S: Final = 10.0
"""Smoothing time of powers, s [A]: 0.05 K of noise on a hub of 420 J/K then makes 2 W."""
STILL_K: Final = 0.15
"""A reading that differs by less has not moved, K [A]: one count of 0.1 K, and the error of its float."""
FADES_S: Final = 900.0
"""Time constant with which ``lack_j`` forgets, s [A]: a heating up takes about ten minutes."""
LEAST_LACK_J: Final = 2e3
"""Least allowance that ``lack_j`` is compared with, J: a sensor late by 5 s hides 1 kJ at 200 W."""
LONGEST_S: Final = 12.0
"""Longest time between two updates, s: after a longer gap the comparison begins anew. A simulated rig's leaps with the
heat off are shorter (``tester.machine.leaps``).
"""


@dataclass(slots=True)
class HeatBalance:
    """The sum of heat that is not shown, and the powers that make it."""

    capacity_j_k: float
    """``observer.thermal.hub_capacity``."""
    shaft_w_k: float
    """``observer.thermal.hub_to_shaft``."""
    power_w: float
    """``observer.thermal.jacket_power``: the heater's power at 100 %."""
    ambient_c: float
    share: float
    """Allowed error of the parameters, as a share of the heat stored and lost; a history tightens it (KnownRatio)."""
    leak_w: float
    """Allowed further loss, W."""
    ungiven_share: float = 0.3
    """Allowed error where more heat shows than is put in: a history moves it the other way."""
    unseen_k: float = 0.0
    """Heat not shown, in K of hub ..."""
    ungiven_k: float = 0.0
    """... and heat shown that the heater's output does not explain."""
    put_w: float = 0.0
    """Smoothed power of the heater ..."""
    shown_w: float = 0.0
    """... and of the heat that the temperatures explain."""
    put_j: float = 0.0
    """Heat of the heater since the comparison began ..."""
    shown_j: float = 0.0
    """... and the part that the temperatures explain."""
    ratio: float = 1.0
    """Ratio of heat put in to heat shown that a rig's history expects ..."""
    spread: float = 0.3
    """... and the error of the parameters beyond it, a share."""
    lack_j: float = 0.0
    """Heat put in beyond the ratio's, less what is older than some FADES_S ..."""
    may_lack_j: float = 0.0
    """... and the part that ``spread`` and ``leak_w`` allow."""
    still_k: float = 0.0
    """Heat while the reading does not move, beyond the least output and the losses in that time, in K of hub.

    A hub at a constant temperature has constant losses: an error of the steady losses cancels.
    """
    _still_c: float = nan
    """The reading when it last moved."""
    _least_w: float = inf
    """The least heater power since the reading moved (smoothed) ..."""
    _least_lost_w: float = 0.0
    """... and the losses to rubber and shaft at that time."""
    _lost_w: float = 0.0
    """Smoothed heat to rubber and shaft."""
    begun: int = 0
    """Number of restarts of the comparison."""
    _stored_w: float = 0.0
    _smoothing: bool = False
    _at_s: float = nan
    _hub_c: float = nan

    def forget(self) -> None:
        """Restart: a person was at the wheel and its hub, or another wheel is mounted."""
        self.unseen_k = self.ungiven_k = self.put_w = self.shown_w = self._stored_w = self.put_j = self.shown_j = 0.0
        self.still_k = self._lost_w = self.lack_j = self.may_lack_j = 0.0
        self._smoothing = False
        self._still_c = nan  # so that the rest also restarts
        self._at_s = self._hub_c = nan
        self.begun += 1

    def update(self, now_s: float, hub_c: float, output_percent: float, rubber_j: float) -> None:
        """Process the hub's temperature, the heater's output after its contactor, %, and the heat from hub to rubber
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
        # Smoothing starts at the first value: from zero it would look like a heater with rising output.
        smooth = dt / (SMOOTHED_S + dt) if self._smoothing else 1.0
        self._smoothing = True
        self._stored_w += (stored_w - self._stored_w) * smooth
        self.put_w += (put_w - self.put_w) * smooth
        self.shown_w += (shown_w - self.shown_w) * smooth
        self._lost_w += (rubber_w + shaft_w - self._lost_w) * smooth
        self._follow_still(hub_c, dt)
        self.put_j += put_w * dt
        self.shown_j += shown_w * dt
        fades = 1.0 - dt / FADES_S
        self.lack_j = self.lack_j * fades + (put_w - self.ratio * shown_w) * dt
        self.may_lack_j = self.may_lack_j * fades + (self.spread * put_w + self.leak_w) * dt
        moved_w = abs(self._stored_w) + abs(rubber_w) + abs(shaft_w)
        per_w = dt / self.capacity_j_k
        unseen_k = self.unseen_k + (put_w - shown_w - self.share * moved_w - self.leak_w) * per_w
        ungiven_k = self.ungiven_k + (shown_w - put_w - self.ungiven_share * moved_w - self.leak_w) * per_w
        self.unseen_k = 0.0 if unseen_k < 0.0 else unseen_k
        self.ungiven_k = 0.0 if ungiven_k < 0.0 else ungiven_k

    @property
    def lack(self) -> float:
        """Heat that is missing from what the temperatures show, as a multiple of its allowance; 0 where none is."""
        lack_j, may_j = self.lack_j, self.may_lack_j
        return 0.0 if lack_j < 0.0 else lack_j / (may_j if may_j > LEAST_LACK_J else LEAST_LACK_J)

    def _follow_still(self, hub_c: float, dt: float) -> None:
        """Add up the heat that a hub takes while its reading does not move."""
        if not (-STILL_K <= hub_c - self._still_c <= STILL_K):
            self.still_k, self._still_c, self._least_w = 0.0, hub_c, inf
        if self.put_w < self._least_w:
            self._least_w, self._least_lost_w = self.put_w, self._lost_w
        taken_w = (1.0 + self.share) * (self._lost_w - self._least_lost_w)  # the rubber got colder
        astray_w = self.leak_w + (taken_w if taken_w > 0.0 else 0.0)
        still_k = self.still_k + (self.put_w - self._least_w - astray_w) * dt / self.capacity_j_k
        self.still_k = 0.0 if still_k < 0.0 else still_k


FIRST: Final = 3
"""Number of successive heatings that must agree to make a history [A]: two may be wrong in the same way."""
NEWEST: Final = 20
"""Number of newest heatings that count [A]: some weeks of runs."""
LEAST_SHARE: Final = 0.06
"""Least share to which a ratio below 1 tightens [A]: at constant temperature the losses dominate, and heating up hardly
shows them."""


class KnownRatio(NamedTuple):
    """The history of a rig's heatings: their number, their ratio, and the spread of the newest."""

    # Processes of a run in parts get it: a frozen dataclass that is compiled cannot be read from a pickle.
    heatings: int = 0
    ratio: float = nan
    apart: float = 0.0
    """Greatest less least ratio of the newest heatings."""

    def share(self, widest: float, known: float) -> float:
        """Return the share by which the heat put in may exceed the heat shown.

        Without a history it is ``widest`` (``heat_share``), which is also its maximum. With a history it is ``known``
        (``heat_share_known``) beyond the ratio, but at least LEAST_SHARE.
        """
        if self.heatings == 0:
            return widest
        return min(widest, max(self.ratio * (1.0 + known) - 1.0, LEAST_SHARE))

    def ungiven_share(self, widest: float, known: float) -> float:
        """Return the share by which the heat put in may fall short of the heat shown: ``known`` below the ratio."""
        if self.heatings == 0:
            return widest
        return min(widest, max(1.0 - self.ratio * (1.0 - known), LEAST_SHARE))

    def words(self, widest: float, known: float) -> str:
        """Return the history and its share, in words."""
        share = self.share(widest, known)
        row = f"a row tells from {100.0 * share:.0f} %"
        if self.heatings == 0:
            return f"no history yet; {row}"
        text = f"known from {self.heatings} heatings, ratio {self.ratio:.2f}, {self.apart:.2f} apart; {row}"
        return text if share < widest else f"{text}: measure observer.thermal, or check the sensors"


NO_HISTORY: Final = KnownRatio()


def known_ratio(ratios: Sequence[float], widest: float, known: float) -> KnownRatio:
    """Return a rig's history from the ratios of its heatings, oldest first; ``widest``, ``known``: as in ``share``.

    The ratio is the median of the newest, but never more than that of the first that agree within ``known``. A
    supply that drifts by 1 % per run would shift the newest, so that each run agrees with the previous run; the first
    ratios stay. (A supply that was wrong from the first heating on also affects them: the ratio is then beyond the
    parameters' errors, or looks like a hub of more heat capacity.)
    """
    sound = [ratio for ratio in ratios if 1.0 - widest <= ratio <= 1.0 + widest]
    for begin in range(len(sound) - FIRST + 1):
        first = sound[begin : begin + FIRST]
        if max(first) - min(first) <= known:
            newest = sound[begin:][-NEWEST:]
            ratio = min(median(first), median(newest))
            return KnownRatio(len(newest), ratio, max(newest) - min(newest))
    return NO_HISTORY
