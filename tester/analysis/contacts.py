"""The contacts of a run, from its samples: where the rubber was touched, and how far it was pressed in from then on.

A contact begins with a touch, the first sample with ``TOUCH_N`` after the contact was open, and ends when it opens. Its
samples are averaged over half seconds. Beside force, depth and temperature each average has the loads that the rubber
remembers, and the load times distance since the touch.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import TYPE_CHECKING, Final, NamedTuple

from tester.base.quantities import KEY, TIME, Roles

if TYPE_CHECKING:
    from tester.base.arrays import Array, Places

OPEN_N: Final = 5.0
"""A contact below this force is open, N [A]: above the noise and the drift of a cell's zero between two repeats."""
TOUCH_N: Final = 10.0
"""Force of a touch, N [A]: the press moves at 2 mm/s then, and the depth is some tenths of a millimetre."""
LOADED_N: Final = 30.0
"""Least force of an average that counts, N [A]."""
SETTLED_S: Final = 2.0
"""Time after a touch in which the load is being applied, s [A]."""
FOLD_S: Final = 0.5
"""Length of an average, s."""
SAME_TOUCH_S: Final = 0.1
"""Greatest time between a touch and the sample before it, s [A]: at 2 mm/s they are 0.2 mm apart."""
GAP_S: Final = 5.0
"""Without samples for longer than this a contact is over, s: an interruption."""
PER_CONTACT: Final = 60
"""Most averages of a contact that are used; they are spread evenly over the logarithm of time."""
OVER_S: Final = (1.0, 10.0, 100.0, 1e3, 1e4)
"""Times over which rubber remembers loads, s."""


class Remembered(NamedTuple):
    """The loads of the last hours, N: the sum of their averages over 1 s to 10,000 s, and of the averages of that sum.

    Rubber that relaxes by a share p in a decade carries F and lacks p (once + p twice): what it remembers is the load
    that it would carry if it did not relax.
    """

    once_n: float = 0.0
    twice_n: float = 0.0


class Averages(NamedTuple):
    """Averages of a contact, arrays of shape (n) in order of time. Times in s since the touch, depth in mm beyond the
    touch, loads in N.
    """

    since_s: Array
    force_n: Array
    deeper_mm: Array
    body_c: Array
    """Mean temperature of the rubber."""
    once_n: Array
    twice_n: Array
    """What the rubber remembers (``Remembered``)."""
    slid_n_m: Array
    """Load times distance since the touch."""
    repeat_key: Array

    def at(self, places: Places) -> Averages:
        """Return some of them."""
        return Averages(*(one[places] for one in self))


@dataclass(slots=True)
class PressedContact:
    """One contact: its touch, and its averages."""

    at_s: float
    touch_mm: float
    touch_n: float
    body_c: float
    remembered: Remembered
    rows: array[float] = field(default_factory=lambda: array("d"))
    """The averages, one after the other: a day's run has hundreds of thousands."""

    @property
    def loaded(self) -> Averages:
        """Return the averages."""
        import numpy as np

        return Averages(*np.frombuffer(self.rows).reshape(-1, len(Averages._fields)).T)

    @property
    def repeat_key(self) -> int:
        """Return the first repeat in it, 0 for none."""
        return int(next((key for key in self.loaded.repeat_key if key), 0))

    def thinned(self) -> Averages:
        """Return at most ``PER_CONTACT`` averages, evenly spread over the logarithm of time."""
        import numpy as np

        loaded = self.loaded
        count = len(loaded.since_s)
        if count <= PER_CONTACT:
            return loaded
        places = {round(count ** (step / (PER_CONTACT - 1.0))) - 1 for step in range(PER_CONTACT)}
        return loaded.at(np.array(sorted(places)))


class ContactFinder:
    """Finds the contacts in the blocks of a record, one after the other, in bounded memory.

    Where a record is cut into blocks depends on the computer's speed; what is found does not.
    """

    def __init__(self, roles: Roles, mounted_s: Iterable[float]) -> None:
        """``roles``: with ``depth`` and ``core``; ``mounted_s``: times at which new rubber was mounted, s."""
        self.roles = roles
        self._contacts: list[PressedContact] = []
        self._held: Array | None = None
        """The samples of the half second that the last block ended in."""
        self._mounted_s = sorted(mounted_s)
        self._averages_n = [0.0] * len(OVER_S)
        self._further_n = [0.0] * len(OVER_S)
        self._last_s = nan
        self._closed = True
        """Whether the contact was closed, or never known to be open."""
        self._contact: PressedContact | None = None
        self._slid_n_m = 0.0

    def add(self, columns: Mapping[str, Sequence[float]]) -> None:
        """Add a block of samples by channel."""
        import numpy as np

        roles = self.roles
        names = (TIME, roles.normal, roles.depth, roles.temperature, roles.core, roles.sliding, KEY)
        table = np.stack([np.asarray(columns[name]) for name in names])
        if self._held is not None:
            table = np.concatenate((self._held, table), axis=1)
        over = np.flatnonzero(np.diff(table[0] // FOLD_S)) + 1
        end = int(over[-1]) if len(over) else 0
        self._held = table[:, end:]
        self._add_parts(table[:, :end])

    def ended(self) -> list[PressedContact]:
        """Return the contacts: no block follows."""
        if self._held is not None:
            self._add_parts(self._held)
            self._held = None
        return self._contacts

    def _add_parts(self, table: Array) -> None:
        """Add samples, the channels in rows, between gaps."""
        import numpy as np

        for part in np.split(table, np.flatnonzero(np.diff(table[0]) > GAP_S) + 1, axis=1):
            if part.size:
                self._add(*part)

    def _add(
        self, at_s: Array, force: Array, depth: Array, surface: Array, core: Array, sliding: Array, keys: Array
    ) -> None:
        """Add samples without a gap between them."""
        import numpy as np

        steps = np.diff(at_s, prepend=self._last_s if isfinite(self._last_s) else at_s[0])
        if not 0.0 <= steps[0] <= GAP_S:
            self._interrupted(float(steps[0]))
            steps[0] = 0.0
        self._last_s = float(at_s[-1])
        touches = self._touches(force, steps)
        edges = np.unique(np.concatenate(([0], np.flatnonzero(np.diff(at_s // FOLD_S)) + 1, touches)))
        known = np.where(np.isfinite(force), np.maximum(force, 0.0), 0.0)
        sums = [np.add.reduceat(one, edges) for one in (steps, known * steps, known * np.nan_to_num(sliding) * steps)]
        counts = np.diff(edges, append=len(at_s))
        means = [np.add.reduceat(one, edges) / counts for one in (force, depth, 0.5 * (surface + core))]
        least = np.minimum.reduceat(np.where(np.isfinite(force), force, -1.0), edges)
        begun = set(touches.tolist())
        averages = (one.tolist() for one in (edges, at_s[edges], *sums, least, *means, keys[edges]))
        for edge, now_s, for_s, sum_n_s, slid, least_n, force_n, depth_mm, body_c, key in zip(*averages, strict=True):
            self._mount(now_s)
            if edge in begun:
                touched_c = float(0.5 * (surface[edge] + core[edge]))
                self._touch(now_s, float(depth[edge]), float(force[edge]), touched_c)
            self._fold(for_s, sum_n_s)
            self._slid_n_m += slid
            if not least_n >= OPEN_N:
                self._contact = None
            self._take(now_s, force_n, depth_mm, body_c, int(key))

    def _touches(self, force: Array, steps: Array) -> Places:
        """Return the places of the touches in a block."""
        import numpy as np

        events = np.flatnonzero((force < OPEN_N) | (force >= TOUCH_N))
        closed = force[events] >= TOUCH_N
        before = np.concatenate(([self._closed], closed[:-1]))
        if len(events):
            self._closed = bool(closed[-1])
        touches = events[closed & ~before[: len(events)]]
        return touches[steps[touches] < SAME_TOUCH_S]

    def _interrupted(self, for_s: float) -> None:
        """End the contact; the rubber forgets for the time without samples."""
        self._contact, self._closed = None, True
        if for_s > 0.0:
            self._fold(for_s, 0.0)

    def _mount(self, now_s: float) -> None:
        """Begin with new rubber, which remembers no load."""
        while self._mounted_s and now_s >= self._mounted_s[0]:
            self._mounted_s.pop(0)
            self._averages_n, self._further_n = [0.0] * len(OVER_S), [0.0] * len(OVER_S)
            self._contact = None

    def _touch(self, now_s: float, depth_mm: float, force_n: float, body_c: float) -> None:
        self._slid_n_m = 0.0
        self._contact = PressedContact(now_s, depth_mm, force_n, body_c, self._remembered())
        if not (isfinite(depth_mm) and isfinite(body_c)):
            self._contact = None

    def _fold(self, for_s: float, sum_n_s: float) -> None:
        """Bring the averages of the load up to date."""
        if not for_s > 0.0:
            return
        self._averages_n = _followed(self._averages_n, sum_n_s / for_s, for_s)
        self._further_n = _followed(self._further_n, sum(self._averages_n), for_s)

    def _remembered(self) -> Remembered:
        return Remembered(sum(self._averages_n), sum(self._further_n))

    def _take(self, now_s: float, force_n: float, depth_mm: float, body_c: float, key: int) -> None:
        """Add an average to the contact."""
        contact = self._contact
        if contact is None or not now_s - contact.at_s > SETTLED_S:
            return
        if not (force_n >= LOADED_N and isfinite(depth_mm) and isfinite(body_c)):
            return
        if not contact.rows:
            self._contacts.append(contact)
        since_s, deeper_mm = now_s - contact.at_s, depth_mm - contact.touch_mm
        contact.rows.extend((since_s, force_n, deeper_mm, body_c, *self._remembered(), self._slid_n_m, key))


def _followed(averages_n: Sequence[float], load_n: float, for_s: float) -> list[float]:
    """Return averages after a load has acted for a time."""
    return [n + (load_n - n) * for_s / (over_s + for_s) for n, over_s in zip(averages_n, OVER_S, strict=True)]
