"""A simulated sensor of any make, put together from its profile."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import floor, isfinite
from typing import Final

from drivers.profiles.model import LIMITS, DeviceProfile
from sim.nodes.dither import PATTERN
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, ModbusSlave

Quantity = Callable[[], float]
"""What a channel measures now, in the channel's unit; NaN where it cannot be measured."""


class UnknownQuantityError(ValueError):
    """A simulated sensor is to show what the plant does not have."""

    def __init__(self, name: str) -> None:
        super().__init__(f'the simulated rig has no quantity "{name}" that a sensor could show')


class PlantQuantity:
    """A number of a simulated machine's plant, by its name."""

    def __init__(self, plant: object, name: str) -> None:
        """Raise UnknownQuantityError where the plant has no such number."""
        if name.startswith("_") or not isinstance(getattr(plant, name, None), float):
            raise UnknownQuantityError(name)
        self.plant = plant
        self.name = name

    def __call__(self) -> float:
        """Return the number now."""
        return float(getattr(self.plant, self.name))


READS_ZERO: Final = 0.0
"""What a channel shows that measures nothing, in its unit; the nearest end of its range where that excludes zero."""


class ProfileSlave(ModbusSlave):
    """A sensor with the channels of a profile, sampled whenever its registers are read.

    ``dither`` is the phase of the last bit (see CellSlave); ``status_bits`` are set whatever is measured; ``frozen``
    stops the sampling. What cannot be measured sets the lowest status bit that makes a reading invalid.
    """

    def __init__(self, profile: DeviceProfile, unit_id: int, quantities: Mapping[str, Quantity | float]) -> None:
        """Put the registers where ``profile`` has them; ``quantities`` by channel are asked for at each read."""
        profile.expect_sensor()
        block = profile.blocks[0]
        registers = [(one.address, one.count) for one in profile.blocks]
        registers += [(signal.address, signal.size) for signal in profile.writes.values()]
        registers += [(write.address, 1) for write in profile.setup]
        identity = profile.identity
        if identity is not None:
            registers.append((identity.address, 1))
        super().__init__(unit_id, profile.timing.turnaround_s, registers, profile.functions)
        self._read_only = {address for one in profile.blocks for address in range(one.address, one.address + one.count)}
        if identity is not None:
            self._read_only.add(identity.address)
            self.put(identity.address, identity.value.to_bytes(2, "big"))
        self._parameters = {signal.address: signal for signal in profile.writes.values() if signal.size == 1}
        self.dither = 0
        self.status_bits = 0
        self.frozen = False
        self._block = block
        self._signals = block.signals
        self._quantities = {
            signal.name: quantities.get(signal.name, min(max(READS_ZERO, signal.least), signal.greatest))
            for signal in block.signals
        }
        self._invalid = profile.invalid_bits & -profile.invalid_bits
        self._shown = bytes(2 * block.count)
        self.blocks = {(block.address, block.count): 0}

    def refresh(self, t: float) -> None:
        """Sample at ``t`` s."""
        self.sample(0, t)

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s and return all that is read."""
        if self.frozen:
            return self._shown
        self.dither = phase = (self.dither + 1) & 3
        status = self.status_bits
        counts: list[object] = []
        status_place = -1
        for signal in self._signals:
            if signal.name == "status":
                status_place = len(counts)
                counts.append(0)
                continue
            quantity = self._quantities[signal.name]
            value = quantity if isinstance(quantity, float | int) else quantity()
            if not isfinite(value):
                status |= self._invalid
                value = 0.0
            if signal.type == "f32":
                counts.append(value / signal.scale)
                continue
            found = floor(value / signal.scale + PATTERN[phase])
            if signal.sign_bit is not None and found < 0:
                status |= 1 << signal.sign_bit
                found = -found
            least, most = LIMITS[signal.type]
            counts.append(min(max(found, least), most))
        if status_place >= 0:
            counts[status_place] = status
        self._shown = data = self._block.pack(*counts)
        self.put(self._block.address, data)
        return data

    def written(self, address: int, value: int, t: float) -> int:
        """Accept a parameter inside the device's range; measured values cannot be written."""
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        register = self._parameters.get(address)
        if register is None or register.type not in ("u16", "i16"):
            return 0
        signed = value - 0x10000 if register.type == "i16" and value > 0x7FFF else value
        return 0 if register.least <= signed * register.scale <= register.greatest else ILLEGAL_VALUE
