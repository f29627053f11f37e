"""A load cell of several transmitters: each measures some of its forces, on a line and at an address of its own.

What belongs together is read one after the other. How far apart that was, the skew, the time stamps of the readings
say; a reading of the cell is whole only where its parts lie within a limit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, nan
from operator import attrgetter
from typing import Final, TypeAlias

from drivers.modbus import ModbusLink
from drivers.profiles.model import DeviceProfile
from drivers.sensor import Sensor

PERIOD_S: Final = 0.01
"""Every transmitter is asked this often, or as often as its line carries: as one alone is in the fastest scans [A]."""
STILL_N: Final = 5.0
"""A transmitter that shows less may show the same for long: it is not taken for one that repeats itself [A]."""

_STAMP: Final = attrgetter("stamp_s")


class Transmitter(Sensor):
    """One of a cell's transmitters, under the name that people know it by.

    It is read every ``PERIOD_S`` whatever the scan's rate, so that the parts of a reading lie close together.
    """

    def __init__(
        self,
        title: str,
        profile: DeviceProfile,
        unit_id: int,
        link: ModbusLink,
        channels: Mapping[str, str],
        parameters: Mapping[str, float],
    ) -> None:
        """Put it on ``link``; ``channels``: the cell's names of the profile's channels, where they differ.

        Raises ProfileError and ValueError as a sensor does.
        """
        super().__init__(profile, unit_id, link, (), parameters)
        self.title = title
        self.forces: tuple[str, ...] = tuple(channels.get(name, name) for name in self.channels)
        """What it measures of the cell, in the order of its values."""
        self.cell: JoinedCell | None = None
        poll = self._poll
        poll.period_s, poll.slack_s = PERIOD_S, 0.0
        self.exchange_s: float = poll.expected_s
        """Usual time of one reading on its line, s."""

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings, and those of the cell."""
        Sensor.take(self, block, data, t)
        if block == 0 and self.cell is not None:
            self.cell.join()

    def suspend(self) -> None:
        """Distrust the last reading, and that of the cell."""
        self.valid = False
        if self.cell is not None:
            self.cell.valid = False


class JoinedCell:
    """Reads a cell's channels from its transmitters; to its machine it is what a sensor with all of them is.

    ``values`` and ``raw`` (without tare) are in the order of ``channels``, NaN for one that no transmitter has.
    ``valid``: every transmitter's last reading is. ``stamp_s`` is when the oldest part of the last whole reading
    arrived: it stays where parts lie farther apart than ``most_skew_s``. ``changed_s`` is when the transmitter that
    has repeated itself for longest last did not.
    """

    def __init__(self, transmitters: Sequence[Transmitter], channels: Sequence[str], most_skew_s: float) -> None:
        """Join them; the parts of a whole reading arrived within ``most_skew_s``.

        Raises ValueError where there is none, or where two measure the same.
        """
        if not transmitters:
            raise ValueError("a load cell has one transmitter at least")
        self.transmitters: tuple[Transmitter, ...] = tuple(transmitters)
        self.channels: tuple[str, ...] = tuple(channels)
        self.most_skew_s = most_skew_s
        self._places: tuple[tuple[Transmitter, int, int], ...] = tuple(
            (one, number, self.channels.index(force))
            for one in self.transmitters
            for number, force in enumerate(one.forces)
            if force in self.channels
        )
        taken = [place for _, _, place in self._places]
        for place in taken:
            if taken.count(place) > 1:
                raise ValueError(f"two transmitters measure {self.channels[place]}")
        size = len(self.channels)
        self.raw: list[float] = [nan] * size
        self.values: list[float] = [nan] * size
        self.tare: tuple[float, ...] = (0.0,) * size
        self.valid = False
        self.stamp_s: float = -inf
        self.changed_s: float = -inf
        self.skew_s: float = inf
        """Between the oldest and the newest part as they are now, s."""
        self.greatest_skew_s: float = 0.0
        """Of a whole reading, since the start, s."""
        self.apart = 0
        """How often a part came while another was older than the skew allows."""
        for one in self.transmitters:
            one.cell = self

    @property
    def ready(self) -> bool:
        """Every transmitter is set up and being read."""
        return all(one.ready for one in self.transmitters)

    @property
    def links(self) -> tuple[ModbusLink, ...]:
        """The lines that it is on, each once."""
        return tuple(dict.fromkeys(one.link for one in self.transmitters))

    @property
    def usual_skew_s(self) -> float:
        """Skew at the usual times: those on one line are read in turn, those on two within a period, s."""
        rounds: list[float] = []
        for link in self.links:
            times = [one.exchange_s for one in self.transmitters if one.link is link]
            rounds.append(sum(times) - min(times))
        between_s = PERIOD_S if len(rounds) > 1 else 0.0
        return max(rounds) + between_s

    def set_tare(self, values: tuple[float, ...]) -> None:
        """Take ``values``, one a channel, off every reading from now on. Raises ValueError for another number."""
        if len(values) != len(self.channels):
            raise ValueError(f"no tare of {len(values)} values can be taken from {len(self.channels)} channels")
        self.tare = values
        self.values = [raw - zero for raw, zero in zip(self.raw, values, strict=True)]

    def join(self) -> None:
        """Take in what a transmitter has just read: it makes a whole reading where the others are near enough."""
        oldest, newest, changed, valid = inf, -inf, inf, True
        for one in self.transmitters:
            stamp = one.stamp_s
            if stamp < oldest:
                oldest = stamp
            if stamp > newest:
                newest = stamp
            valid = valid and one.valid
            moved = one.changed_s if _bears(one) else stamp
            if moved < changed:
                changed = moved
        self.valid = valid
        self.skew_s = skew = newest - oldest
        if not skew <= self.most_skew_s:
            self.apart += 1
            return
        if skew > self.greatest_skew_s:
            self.greatest_skew_s = skew
        raw, values, tare = self.raw, self.values, self.tare
        for one, number, place in self._places:
            raw[place] = value = one.raw[number]
            values[place] = value - tare[place]
        self.stamp_s, self.changed_s = oldest, changed

    def blame(self, now: float, limit_s: float) -> str:
        """Return which transmitter keeps the cell from being read at ``now`` s, and why; "" = none does.

        ``limit_s``: how old a reading may be. Of those on one line that are too old the oldest holds the line up: it
        alone is named, with those that are known not to answer.
        """
        found: list[str] = []
        oldest = {one.link: one for one in sorted(self.transmitters, key=_STAMP, reverse=True)}
        for one in self.transmitters:
            age_s = now - one.stamp_s
            if one.refused is not None:
                found.append(f"{one.title}: {one.refused}")
            elif not age_s <= limit_s:
                if oldest[one.link] is not one and not one.station.misses:
                    continue
                found.append(f"{one.title}: {f'no reading for {1e3 * age_s:.0f} ms' if age_s < inf else 'no answer'}")
            elif not one.valid:
                found.append(f"{one.title}: reading not valid (status 0x{one.status:X})")
        if found:
            return ", ".join(found)
        if not self.skew_s <= self.most_skew_s:
            first, last = min(self.transmitters, key=_STAMP), max(self.transmitters, key=_STAMP)
            apart = f"{1e3 * self.skew_s:.0f} ms apart, at most {1e3 * self.most_skew_s:.0f} ms"
            return f"{first.title} and {last.title} are read {apart}"
        same = [one for one in self.transmitters if _bears(one)]
        if same:
            stuck = min(same, key=attrgetter("changed_s"))
            if now - stuck.changed_s > FROZEN_SAID_S:
                return f"{stuck.title}: the same counts for {1e3 * (now - stuck.changed_s):.0f} ms"
        return ""


FROZEN_SAID_S: Final = 0.3
"""From then on a transmitter that repeats itself is named, s [A]: below ``frozen_cell`` of a rig file."""

LoadCell: TypeAlias = Sensor | JoinedCell
"""A load cell: one transmitter with all channels, or several."""


def links_of(cell: LoadCell) -> tuple[ModbusLink, ...]:
    """Return the lines that a load cell is on, each once."""
    return cell.links if isinstance(cell, JoinedCell) else (cell.link,)


def _bears(one: Transmitter) -> bool:
    """Return whether it shows a force that cannot stand still while a wheel turns under it."""
    return any(not -STILL_N < value < STILL_N for value in one.raw)
