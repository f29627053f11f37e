"""What a rig's own heatings say of its heat balance, and how far that tightens the row "heat not shown".

The ratio of a heating is the heater's energy over what the temperatures showed of it: 1 where the beliefs of
``observer`` are right. A rig that has shown its ratio needs no allowance for beliefs any more, but only for how ratios
scatter: what reads low later stands out from it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from statistics import median
from typing import Final

FIRST: Final = 3
"""So many heatings in a row that agree make a history [A]: one may be odd, two may be odd the same way."""
NEWEST: Final = 20
"""So many of the newest are looked at [A]: some weeks of runs."""
LEAST_SHARE: Final = 0.06
"""A ratio below 1 tightens to this at most [A]: a hub that holds its temperature is balanced by what it loses, of which
heating up says little."""


@dataclass(frozen=True, slots=True)
class KnownRatio:
    """What the heatings of a rig have shown: how many count, their ratio, and by how much the newest lie apart."""

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

    def told(self, widest: float, known: float) -> str:
        """Return it in words."""
        share = self.share(widest, known)
        row = f"a row tells from {100.0 * share:.0f} %"
        if self.count == 0:
            return f"no history yet; {row}"
        text = f"known from {self.count} heatings, ratio {self.ratio:.2f}, {self.apart:.2f} apart; {row}"
        return text if share < widest else f"{text}: measure observer.thermal, or check the sensors"


NO_HISTORY: Final = KnownRatio()


def known_ratio(ratios: Sequence[float], widest: float, known: float) -> KnownRatio:
    """Return what the ratios of a rig's heatings, the oldest first, make known; ``widest``, ``known``: as in ``share``.

    The ratio is the median of the newest, but never more than that of the first ones that agree within ``known``: a
    supply that drifts by 1 % a run takes the newest along, and each of its runs would pass beside the one before. The
    first ones stay where they are. (A wrong supply that was there from the first heating on is in them too: its ratio
    is then beyond what the beliefs explain, or looks like a hub of more heat capacity.)
    """
    sound = [ratio for ratio in ratios if 1.0 - widest <= ratio <= 1.0 + widest]
    for begin in range(len(sound) - FIRST + 1):
        first = sound[begin : begin + FIRST]
        if max(first) - min(first) <= known:
            newest = sound[begin:][-NEWEST:]
            ratio = min(median(first), median(newest))
            return KnownRatio(len(newest), ratio, max(newest) - min(newest))
    return NO_HISTORY
