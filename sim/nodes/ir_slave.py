"""The simulated infrared thermometer."""

from __future__ import annotations

from math import floor, isfinite
from typing import Protocol

from drivers.profiles.model import LIMITS, DeviceProfile
from sim.nodes.dither import PATTERN
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, ModbusSlave


class SurfaceSource(Protocol):
    """What the thermometer looks at."""

    def surface_measured_c(self, t: float) -> float:
        """Return the surface temperature in degC at ``t`` s; NaN where it cannot be measured."""
        ...


class IrSlave(ModbusSlave):
    """A thermometer, sampled whenever its registers are read.

    ``sensor_c`` is its own temperature; ``dither`` the phase of the last bit (see CellSlave); ``status_bits`` are set
    whatever is measured; ``frozen`` stops the sampling.
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, source: SurfaceSource, sensor_c: float = 25.0) -> None:
        """Put the registers where ``profile`` has them; ``source`` is asked at each read."""
        profile.expect("ir_thermometer")
        block = profile.blocks[0]
        registers = [(block.address, block.count)]
        if profile.identity is not None:
            registers.append((profile.identity.address, 1))
        registers += [(signal.address, signal.size) for signal in profile.writes.values()]
        super().__init__(unit_id, profile.timing.turnaround_s, registers, profile.functions)
        if profile.identity is not None:
            self.put(profile.identity.address, profile.identity.value.to_bytes(2, "big"))
        self._emissivity = profile.writes.get("emissivity")
        self.source = source
        self.sensor_c = sensor_c
        self.dither = 0
        self.status_bits = 0
        self.frozen = False
        self._block = block
        self._signals = tuple((signal.name, signal.scale, *LIMITS[signal.type]) for signal in block.signals)
        self._shown = bytes(2 * block.count)
        self.blocks = {(block.address, block.count): 0}
        self._read_only = set(range(block.address, block.address + block.count))
        if profile.identity is not None:
            self._read_only.add(profile.identity.address)
        self._error = profile.bit("measurement_error")
        self.power(True)

    def power(self, on: bool) -> None:
        """Switch the supply; it starts with an emissivity of 1 [A]."""
        self.powered = on
        if on and self._emissivity is not None:
            self.put(self._emissivity.address, round(1.0 / self._emissivity.scale).to_bytes(2, "big"))

    @property
    def emissivity(self) -> float:
        """The emissivity set, 1 after power-on; 1 where the device has none to set."""
        register = self._emissivity
        return self.get(register.address) * register.scale if register is not None else 1.0

    def refresh(self, t: float) -> None:
        """Sample at ``t`` s."""
        self.sample(0, t)

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s and return all that is read."""
        if self.frozen:
            return self._shown
        surface_c = self.source.surface_measured_c(t)
        self.dither = phase = (self.dither + 1) & 3
        status = self.status_bits
        if not isfinite(surface_c):
            status |= self._error
            surface_c = 0.0
        step = PATTERN[phase]
        counts: list[int] = []
        for name, scale, least, most in self._signals:
            if name == "status":
                counts.append(status)
                continue
            found = floor((self.sensor_c if name == "sensor" else surface_c) / scale + step)
            counts.append(found if least <= found <= most else least if found < least else most)
        self._shown = data = self._block.pack(*counts)
        self.put(self._block.address, data)
        return data

    def written(self, address: int, value: int, t: float) -> int:
        """Accept an emissivity inside the device's range; measured values cannot be written."""
        register = self._emissivity
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        if register is not None and address == register.address:
            return 0 if register.least <= value * register.scale <= register.greatest else ILLEGAL_VALUE
        return 0
