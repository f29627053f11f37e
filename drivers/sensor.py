"""A Modbus sensor of any make: its profile states its channels, registers and status bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import floor, inf, nan, nextafter
from typing import Any, Final

from drivers.modbus import Device, ModbusLink, Request
from drivers.profiles.model import DeviceProfile
from drivers.profiles.registers import RegisterBlock, Signal

STALE_PERIODS: Final = 3.0
"""Number of poll periods without a reading before the last one is stale [A]."""
STALE_LEAST_S: Final = 0.5
"""Least age at which a reading is stale, s, however often the sensor is asked [A]."""
STALE_INPUTS_S: Final = 0.25
"""The same for a sensor with digital inputs, s [A]: as that of the drive with the safety inputs."""
_NO_PARAMETERS: Final[dict[str, float]] = {}


class Sensor(Device):
    """Reads channels, each scaled to its unit.

    ``values`` are the readings less ``tare`` in the order of ``channels``, NaN before the first reading and always for
    a channel that the sensor does not have. ``raw`` are the same without tare, ``counts`` the bare numbers of the
    registers (0 for a missing channel). ``valid``: the last reading has no invalid status bit and every channel is
    within its range. ``stamp_s`` is its arrival; ``changed_s`` is the time at which a count last differed from the one
    before (-inf = never). The profile's parameters are written, and read back, at every connection.
    """

    def __init__(
        self,
        profile: DeviceProfile,
        unit_id: int,
        link: ModbusLink,
        channels: Sequence[str] = (),
        parameters: Mapping[str, float] = _NO_PARAMETERS,
    ) -> None:
        """Put the sensor on ``link``.

        ``channels``: the wanted channels in this order, by default all of the profile. ``parameters``: values of the
        profile's ``writes`` by name; names that the profile does not have are ignored. Raises ProfileError for the
        profile of another kind of device and ValueError for a parameter that is missing or out of its range.
        """
        profile.expect_sensor()
        super().__init__(profile, unit_id, link)
        self.channels: tuple[str, ...] = tuple(channels) or profile.channels
        self._reads: tuple[_SensorRead, ...] = tuple(
            _SensorRead(block, self.channels, profile.saturated) for block in profile.blocks
        )
        self._in_one = len(self._reads) == 1
        self._invalid_bits = profile.invalid_bits
        self._poll = self._polls[0]
        inputs = any(profile.signal(name).type == "bit" for name in self.channels if profile.has(name))
        least_s = STALE_INPUTS_S if inputs else STALE_LEAST_S
        self.stale_s: float = max(least_s, STALE_PERIODS * max(block.period_s for block in profile.blocks))
        """Age above which a reading is stale, s."""
        size = len(self.channels)
        self.counts: list[float] = [0.0] * size
        self.raw: list[float] = [nan] * size
        self.values: list[float] = [nan] * size
        self.tare: tuple[float, ...] = (0.0,) * size
        self.status = 0
        self.changed_s: float = -inf
        for write in profile.setup:
            self.add_setup(write)
        for name, register in profile.writes.items():
            value = _parameter(profile, register, parameters.get(name))
            self.add_write(name, register.address, register.words(value, profile.order), read_back=True)
        self.begin()

    @property
    def period_s(self) -> float:
        """Time between two reads in s; 0 = with every scan."""
        return self._poll.period_s

    @period_s.setter
    def period_s(self, period_s: float) -> None:
        if period_s != self._poll.period_s:
            self.link.retime(self._poll, period_s)

    def set_tare(self, values: tuple[float, ...]) -> None:
        """Subtract ``values``, one a channel, from every later reading: usually the mean of unloaded ``raw`` readings.

        Raises ValueError for another number of values, and for a sensor whose profile allows no tare.
        """
        if not self.profile.tare or len(values) != len(self.channels):
            raise ValueError(f"{self.profile.title}: no tare of {len(values)} values can be taken")
        self.tare = values
        self.values = [raw - zero for raw, zero in zip(self.raw, values, strict=True)]

    def fresh(self, now: float) -> bool:
        """Return whether the last reading is valid and, at ``now`` s, not stale."""
        return self.valid and now - self.stamp_s <= self.stale_s

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Process a good reply; the usual reading takes a short path."""
        if request is self._poll and self.ready:
            self.take(0, data, t)
        else:
            Device.received(self, request, data, t)

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings from the registers of a block; they are as old as the oldest block."""
        read = self._reads[block]
        unpack = read.unpack  # an attribute that is called as a method is looked up anew (CPython 3.11)
        found: tuple[Any, ...] = unpack(data)  # whole numbers, and floats of f32
        if read.cell and self._in_one:
            # A load cell, which is read in every scan: its four channels without a loop.
            x, y, z, m, status = found
            sx, sy, sz, sm = read.scales
            lx, ly, lz, lm = read.lows
            hx, hy, hz, hm = read.highs
            tx, ty, tz, tm = self.tare
            counts: list[float] = [x, y, z, m]
            if counts != self.counts:
                self.counts = counts
                self.changed_s = t
            fx: float = x * sx
            fy: float = y * sy
            fz: float = z * sz
            mz: float = m * sm
            self.raw = [fx, fy, fz, mz]
            self.values = [fx - tx, fy - ty, fz - tz, mz - tm]
            self.status = bits = int(status)
            self.valid = (
                lx < fx < hx and ly < fy < hy and lz < fz < hz and lm < mz < hm and not bits & self._invalid_bits
            )
            self.stamp_s = t
            return
        if read.status_place >= 0:
            self.status = int(found[read.status_place])
        status = self.status
        counts, raw, values, tare = self.counts, self.raw, self.values, self.tare
        valid = True
        for number, place, sign, scale, offset, low, high in read.rows:
            count = float(found[place])
            if sign and status & sign:
                count = -count
            value = count * scale + offset
            if not low < value < high:
                valid = False
            if number < 0:
                continue  # it guards a channel
            if count != counts[number]:
                counts[number] = count
                self.changed_s = t
            raw[number] = value
            values[number] = value - tare[number]
        if self._in_one:
            self.valid = valid and not status & self._invalid_bits
            self.stamp_s = t
            return
        read.plausible, read.stamp_s = valid, t
        stamp_s = t
        for one in self._reads:
            valid = valid and one.plausible
            if one.stamp_s < stamp_s:
                stamp_s = one.stamp_s
        self.valid = valid and not status & self._invalid_bits
        self.stamp_s = stamp_s

    def suspend(self) -> None:
        """Mark the last reading as invalid."""
        self.valid = False
        for one in self._reads:
            one.plausible = False

    def resume(self) -> None:
        """Leave the last reading invalid until the next one comes."""


class _SensorRead:
    """One block of a sensor's registers: how its numbers become values, and the state of the last reading of it."""

    def __init__(self, block: RegisterBlock, channels: Sequence[str], saturated: float | None) -> None:
        names = [signal.name for signal in block.signals]
        self.unpack = block.unpack
        self.status_place: int = names.index("status") if "status" in names else -1
        self.rows: tuple[tuple[int, int, int, float, float, float, float], ...] = tuple(
            _row(number, names.index(name), block.signals[names.index(name)], saturated)
            for number, name in enumerate(channels)
            if name in names
        ) + tuple(
            _row(-1, place, signal, None) for place, signal in enumerate(block.signals) if signal.guards in channels
        )
        rows = self.rows
        self.cell = names[4:] == ["status"] and len(rows) == 4 and all(
            row[:3] == (place, place, 0) and row[4] == 0.0 for place, row in enumerate(rows)
        )
        """Whether it holds four channels and the status, each channel a count times its scale."""
        self.scales: tuple[float, ...] = tuple(row[3] for row in rows)
        self.lows: tuple[float, ...] = tuple(row[5] for row in rows)
        self.highs: tuple[float, ...] = tuple(row[6] for row in rows)
        self.plausible = False
        self.stamp_s: float = -inf


def _row(
    number: int, place: int, signal: Signal, saturated: float | None
) -> tuple[int, int, int, float, float, float, float]:
    """Return a channel's number, place in the block, sign bit's mask, scale, offset, and the bounds of its values."""
    sign = 1 << signal.sign_bit if signal.sign_bit is not None else 0
    if saturated is None:
        low, high = nextafter(signal.least, -inf), nextafter(signal.greatest, inf)
    else:
        high = floor(saturated * signal.greatest / signal.scale) * signal.scale if signal.greatest < inf else inf
        low = -high
    return number, place, sign, signal.scale, signal.offset, low, high


def _parameter(profile: DeviceProfile, register: Signal, given: float | None) -> float:
    """Return the value for a register: the given value, or the profile's."""
    value = register.default if given is None else given
    bounds = f"{register.least:g} to {register.greatest:g}"
    if value is None:
        raise ValueError(f"{register.name} is to be stated: {bounds} with {profile.title}")
    if not register.least <= value <= register.greatest:
        raise ValueError(f"{register.name} is {bounds} with {profile.title}, not {value:g}")
    return value
