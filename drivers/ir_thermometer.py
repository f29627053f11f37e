"""The infrared thermometer on the rubber surface."""

from __future__ import annotations

from math import inf, nan

from drivers.modbus import Device, ModbusLink
from drivers.profiles.model import DeviceProfile, ProfileError


class IrThermometer(Device):
    """Reads the surface temperature; its emissivity is set, and read back, whenever it is connected.

    ``surface_c`` and ``sensor_c`` (the thermometer's own temperature) in degC, NaN before the first reading;
    ``counts`` is the bare number of the surface register; ``stamp_s`` is when they arrived (-inf = never).
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, link: ModbusLink, emissivity: float = 0.95) -> None:
        """Put the thermometer on ``link``; ``emissivity`` 0.95 is that of black rubber [A].

        Raises ValueError for an emissivity outside the device's range and ProfileError for a profile without status
        or surface.
        """
        profile.expect("ir_thermometer")
        super().__init__(profile, unit_id, link)
        block = profile.blocks[0]
        names = [signal.name for signal in block.signals]
        if "status" not in names or "surface" not in names:
            raise ProfileError(f"profile {profile.name}: the first read must hold surface and status")
        self._unpack = block.unpack
        self._surface = names.index("surface")
        self._status = names.index("status")
        self._sensor = names.index("sensor") if "sensor" in names else -1
        surface = profile.signal("surface")
        self._scale, self._least, self._greatest = surface.scale, surface.least, surface.greatest
        self._invalid_bits = profile.invalid_bits
        self._sensor_scale = profile.signal("sensor").scale if self._sensor >= 0 else nan
        self.emissivity = emissivity
        self.counts = 0
        self.status = 0
        self.valid = False
        self.stamp_s = -inf
        self.surface_c = self.sensor_c = nan
        register = profile.writes.get("emissivity")
        if register is not None:
            if not register.least <= emissivity <= register.greatest:
                bounds = f"{register.least:g} to {register.greatest:g}"
                raise ValueError(f"emissivity is {bounds} with {profile.title}, not {emissivity:g}")
            words = register.words(emissivity, profile.word_order)
            self.add_write("emissivity", register.address, words, read_back=True)
        self.begin()

    def take(self, block: int, data: bytes, t: float) -> None:
        """Update the readings."""
        if block:
            return
        found = self._unpack(data)
        counts, status = found[self._surface], found[self._status]
        value = counts * self._scale
        self.counts = counts
        self.status = status
        self.stamp_s = t
        self.valid = not status & self._invalid_bits and self._least <= value <= self._greatest
        self.surface_c = value
        if self._sensor >= 0:
            self.sensor_c = found[self._sensor] * self._sensor_scale

    def suspend(self) -> None:
        """Distrust the last reading."""
        self.valid = False

    def resume(self) -> None:
        """Leave the last reading distrusted until the next comes."""
