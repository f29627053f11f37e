"""A load cell of several transmitters: each measures some of its forces, on a line and at an address of its own.

The transmitters are read one after the other. The time stamps of the readings give the time between them, the skew. A
reading of the cell is whole only if its parts lie within a limit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, nan
from operator import attrgetter
from typing import Final, TypeAlias

from drivers.modbus import ModbusLink
from drivers.modbus.schedule import POLL_S
from drivers.profiles.model import DeviceProfile
from drivers.sensor import Sensor

PERIOD_S: Final = 0.01
"""Polling period of every transmitter, or what its line allows: that of one transmitter in the fastest scans [A]."""
STILL_N: Final = 5.0
"""A transmitter below this force may show the same value for long: this does not count as a repeated reading [A]."""

_STAMP: Final = attrgetter("stamp_s")


class Transmitter(Sensor):
    """One of a cell's transmitters; ``title`` is its name for people.

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
        """Put it on ``link``; ``channels``: the cell's names of the profile's channels, if they differ.

        Raises ProfileError and ValueError as a sensor does.
        """
        super().__init__(profile, unit_id, link, (), parameters)
        self.title = title
        self.forces: tuple[str, ...] = tuple(channels.get(name, name) for name in self.channels)
        """Channels of the cell that it measures, in the order of its values."""
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
        """Mark the last reading, and that of the cell, as invalid."""
        self.valid = False
        if self.cell is not None:
            self.cell.valid = False


class JoinedCell:
    """Reads a cell's channels from its transmitters; its machine uses it like one sensor with all channels.

    ``values`` and ``raw`` (without tare) are in the order of ``channels``, NaN for a channel that no transmitter has.
    ``valid``: the last reading of every transmitter is valid. ``stamp_s`` is the arrival of the oldest part of the last
    whole reading: it stays while parts lie farther apart than ``most_skew_s``. ``changed_s`` is the earliest of the
    transmitters' last changes: the time since when one of them has repeated itself.
    """

    def __init__(self, transmitters: Sequence[Transmitter], channels: Sequence[str], most_skew_s: float) -> None:
        """Join the transmitters; the parts of a whole reading arrived within ``most_skew_s``.

        Raises ValueError for no transmitters, or for two that measure the same channel.
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
        """Time between the oldest and the newest part now, s."""
        self.greatest_skew_s: float = 0.0
        """Greatest skew of a whole reading since the start, s."""
        self.apart = 0
        """Number of parts that came while another was older than the skew allows."""
        for one in self.transmitters:
            one.cell = self

    @property
    def ready(self) -> bool:
        """Whether every transmitter is set up and being read."""
        return all(one.ready for one in self.transmitters)

    @property
    def links(self) -> tuple[ModbusLink, ...]:
        """The cell's lines, each once."""
        return tuple(dict.fromkeys(one.link for one in self.transmitters))

    @property
    def usual_skew_s(self) -> float:
        """Usual skew, s: transmitters on one line are read in turn, those on two lines within a period."""
        rounds: list[float] = []
        for link in self.links:
            times = [one.exchange_s for one in self.transmitters if one.link is link]
            rounds.append(sum(times) - min(times))
        between_s = PERIOD_S if len(rounds) > 1 else 0.0
        return max(rounds) + between_s

    @property
    def measured_skew_s(self) -> float:
        """Skew at the measured reply times, s: each exchange is followed by a silence and by a look at the line."""
        rounds: list[float] = []
        for link in self.links:
            stations = [one.station for one in self.transmitters if one.link is link]
            turns = [link.exchange_s(station) + link.gap_s + POLL_S for station in stations]
            rounds.append(sum(turns) - min(turns))
        return max(rounds) + (PERIOD_S if len(rounds) > 1 else 0.0)

    def set_tare(self, values: tuple[float, ...]) -> None:
        """Subtract ``values``, one a channel, from every reading from now on. Raises ValueError for another number."""
        if len(values) != len(self.channels):
            raise ValueError(f"no tare of {len(values)} values can be taken from {len(self.channels)} channels")
        self.tare = values
        self.values = [raw - zero for raw, zero in zip(self.raw, values, strict=True)]

    def join(self) -> None:
        """Use a transmitter's new reading: it completes a whole reading if the others are near enough in time."""
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
        """Return the transmitter that keeps the cell from being read at ``now`` s, and the reason; "" = no transmitter
        does.

        ``limit_s``: greatest age of a reading. Where several readings of one line are older, the transmitter with the
        oldest blocks the line. It alone is named, besides transmitters that are known not to answer.
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
"""A transmitter that has repeated itself this long is named, s [A]: below ``frozen_cell`` of a rig file."""

LoadCell: TypeAlias = Sensor | JoinedCell
"""A load cell: one transmitter with all channels, or several."""


def links_of(cell: LoadCell) -> tuple[ModbusLink, ...]:
    """Return the lines of a load cell, each once."""
    return cell.links if isinstance(cell, JoinedCell) else (cell.link,)


def _bears(one: Transmitter) -> bool:
    """Return whether a transmitter shows a force that cannot stay constant while a wheel turns under it."""
    return any(not -STILL_N < value < STILL_N for value in one.raw)
