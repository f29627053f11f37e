"""The multi-axis load cell behind a Modbus transmitter."""

from __future__ import annotations

from math import floor, inf, nan
from typing import Final

from drivers.modbus import Device, ModbusLink, Request
from drivers.profiles.model import DeviceProfile, ProfileError

CHANNELS: Final = ("fx", "fy", "fz", "mz")
"""Longitudinal, lateral and normal force (N), moment about the vertical (N m), in the wheel's frame."""

SATURATED_SHARE: Final = 0.98
"""Share of the range from which a channel counts as saturated (safety page)."""

Vector = tuple[float, float, float, float]


class LoadCell(Device):
    """Reads forces and moment. A channel that the transmitter does not have reads NaN.

    ``fx_n, fy_n, fz_n`` (N) and ``mz_nm`` (N m) are the raw values less ``tare``; ``counts`` are the bare numbers of
    the registers in the order of CHANNELS; ``stamp_s`` is when they arrived (-inf = never).
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, link: ModbusLink) -> None:
        """Put the cell on ``link``. Raises ProfileError for a profile without status or any force."""
        profile.expect("load_cell")
        super().__init__(profile, unit_id, link)
        block = profile.blocks[0]
        names = [signal.name for signal in block.signals]
        if "status" not in names or not any(name in CHANNELS for name in names):
            raise ProfileError(f"profile {profile.name}: the first read must hold status and at least one force")
        present = [profile.signal(name) if name in names else None for name in CHANNELS]
        self._unpack = block.unpack
        self._places = tuple(names.index(name) if name in names else -1 for name in CHANNELS)
        self._status_place = names.index("status")
        self._signs = tuple(
            1 << signal.sign_bit if signal is not None and signal.sign_bit is not None else 0 for signal in present
        )
        self._scales: Vector = _four([signal.scale if signal is not None else nan for signal in present])
        self._limits: Vector = _four([_limit(signal.greatest, signal.scale) if signal else inf for signal in present])
        self._invalid_bits = profile.invalid_bits
        self._poll = self._polls[0]
        self._usual = self._poll if tuple(names) == (*CHANNELS, "status") else None
        self._found: tuple[int, ...] = (0, 0, 0, 0, 0)
        self.status = 0
        self.valid = False
        self.stamp_s = -inf
        self.fx_n = self.fy_n = self.fz_n = self.mz_nm = nan
        self.tare: Vector = (0.0, 0.0, 0.0, 0.0)
        self.begin()

    @property
    def counts(self) -> tuple[int, int, int, int]:
        """The bare numbers of the registers."""
        cx, cy, cz, cm, _ = self._found
        return cx, cy, cz, cm

    @property
    def raw(self) -> Vector:
        """Forces in N and moment in N m without tare; NaN before the first reading."""
        if self.stamp_s == -inf:
            return nan, nan, nan, nan
        (cx, cy, cz, cm), (sx, sy, sz, sm) = self.counts, self._scales
        return cx * sx, cy * sy, cz * sz, cm * sm

    @property
    def period_s(self) -> float:
        """Time between two reads in s; 0 = with every scan."""
        return self._poll.period_s

    @period_s.setter
    def period_s(self, period_s: float) -> None:
        if period_s != self._poll.period_s:
            self.link.retime(self._poll, period_s)

    def set_tare(self, values: Vector) -> None:
        """Take ``values`` (N, N, N, N m) off every reading from now on: usually the mean of unloaded ``raw`` ones."""
        self.tare = values
        self._update()

    def received(self, request: Request, data: bytes, t: float) -> None:
        """Take a good reply; the way of the usual reading is short."""
        if request is self._usual and self.ready:
            self._store(self._unpack(data), t)
        else:
            Device.received(self, request, data, t)

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings from registers in any order, with signs in the status."""
        if block:
            return
        found = self._unpack(data)
        status = found[self._status_place]
        cx, cy, cz, cm = (
            (-found[place] if status & sign else found[place]) if place >= 0 else 0
            for place, sign in zip(self._places, self._signs, strict=True)
        )
        self._store((cx, cy, cz, cm, status), t)

    def suspend(self) -> None:
        """Distrust the last reading."""
        self.valid = False

    def resume(self) -> None:
        """Leave the last reading distrusted until the next comes."""

    def _store(self, found: tuple[int, ...], t: float) -> None:
        """Take the counts of the four channels and the status."""
        cx, cy, cz, cm, status = found
        self._found = found
        self.status = status
        self.stamp_s = t
        lx, ly, lz, lm = self._limits
        self.valid = (
            not status & self._invalid_bits
            and -lx < cx < lx
            and -ly < cy < ly
            and -lz < cz < lz
            and -lm < cm < lm
        )
        sx, sy, sz, sm = self._scales
        tx, ty, tz, tm = self.tare
        self.fx_n = cx * sx - tx
        self.fy_n = cy * sy - ty
        self.fz_n = cz * sz - tz
        self.mz_nm = cm * sm - tm

    def _update(self) -> None:
        if self.stamp_s != -inf:
            x, y, z, m = self.raw
            tx, ty, tz, tm = self.tare
            self.fx_n, self.fy_n, self.fz_n, self.mz_nm = x - tx, y - ty, z - tz, m - tm


def _limit(greatest: float, scale: float) -> float:
    """Return the counts from which a channel is saturated."""
    return floor(SATURATED_SHARE * greatest / scale) if greatest < inf else inf


def _four(values: list[float]) -> Vector:
    x, y, z, m = values
    return x, y, z, m
