"""Simulated Modbus sensors, built from their profiles: a load cell, an infrared thermometer, any other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import LIMITS, DeviceProfile, Signal
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ILLEGAL_VALUE, PATTERN, ModbusSlave

Quantity = Callable[[], float]
"""Source of a channel's present value, in the channel's unit; NaN if it cannot be measured."""
READS_ZERO: Final = 0.0
"""Value of a channel without a source, in its unit; the nearest end of its range if that excludes zero."""
FORCES: Final = ("fx", "fy", "fz", "mz")
"""Channels of a load cell: forces in N, the moment in N m."""
_AS_NAMED: Final[Mapping[str, str]] = {}
_NOTHING: Final[Mapping[str, Quantity | float]] = {}


class UnknownQuantityError(ValueError):
    """A quantity of a simulated sensor that the plant does not have."""

    def __init__(self, name: str) -> None:
        super().__init__(f'the simulated rig has no quantity "{name}" that a sensor could show')


class PlantQuantity:
    """A number of a simulated machine's plant, by its name."""

    def __init__(self, plant: object, name: str) -> None:
        """Find the number. Raises UnknownQuantityError if the plant has no number of this name."""
        if name.startswith("_") or not isinstance(getattr(plant, name, None), float):
            raise UnknownQuantityError(name)
        self.plant = plant
        self.name = name

    def __call__(self) -> float:
        """Return the present number."""
        return float(getattr(self.plant, self.name))


class SensorSlave(ModbusSlave):
    """A sensor with the channels of a profile, sampled whenever its registers are read.

    ``dither`` is the phase of the last bit: set it to 0 if a run must not depend on earlier readings.
    ``status_bits`` are always set (a broken bridge); ``frozen`` stops the sampling. A value that cannot be
    measured sets the lowest status bit that makes a reading invalid.
    """

    __slots__ = (
        "_block", "_invalid", "_limits", "_overload", "_parameters", "_quantities", "_read_only", "_rows", "_shown",
        "_signals", "_status_place", "dither", "frozen", "status_bits",
    )  # fmt: skip

    def __init__(
        self, profile: DeviceProfile, unit_id: int, quantities: Mapping[str, Quantity | float] = _NOTHING
    ) -> None:
        """Place the registers as in ``profile``; the ``quantities`` by channel are called at each read."""
        profile.expect_sensor()
        block = profile.blocks[0]
        read = [(one.address, one.count) for one in profile.blocks]
        if profile.identity is not None:
            read.append((profile.identity.address, 1))
        written = [(signal.address, signal.size) for signal in profile.writes.values()]
        written += [(write.address, len(write.words)) for write in profile.setup]
        super().__init__(unit_id, profile.timing.turnaround_s, [*read, *written], profile.functions)
        if profile.identity is not None:
            self.put(profile.identity.address, profile.identity.value.to_bytes(2, "big"))
        for write in profile.setup:
            if not write.writes:  # the real device takes a while; this one has already finished
                self.put(write.address, b"".join(word.to_bytes(2, "big") for word in write.words))
        self._read_only = {address for start, count in read for address in range(start, start + count)}
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
        self._overload = profile.bit("overload")
        self._limits = tuple(_most_counts(signal) if profile.kind == "load_cell" else inf for signal in block.signals)
        names = [signal.name for signal in block.signals]
        self._status_place = names.index("status") if "status" in names else -1
        self._rows = tuple(
            (signal.scale, signal.offset, signal.type != "f32", limit,
             1 << signal.sign_bit if signal.sign_bit is not None else 0, *LIMITS[signal.type])
            for signal, limit in zip(block.signals, self._limits, strict=True)
        )
        """For each signal: scale, offset, whether counts are whole, greatest counts, bit of the sign, ends of type."""
        self._shown = bytes(2 * block.count)
        self.blocks = {(block.address, block.count): 0}

    def show(self, channel: str, source: Quantity | float) -> Quantity | float:
        """Replace the source of a channel of the first read; return the previous source."""
        before = self._quantities[channel]
        self._quantities[channel] = source
        return before

    def measure(self, t: float) -> list[float]:
        """Return the values of the first read's signals at ``t`` s, in their units; any value for the status."""
        return [
            quantity if isinstance(quantity, float | int) else quantity() for quantity in self._quantities.values()
        ]

    def refresh(self, t: float) -> None:
        """Sample at ``t`` s."""
        self.put(self._block.address, self.sample(0, t))

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s and return all registers of the first read."""
        return self._shown if self.frozen else self._encode(self.measure(t))

    def _encode(self, values: Sequence[float]) -> bytes:
        """Return the first read with these values, one for each signal, rounded by the next phase of the dither."""
        self.dither = phase = (self.dither + 1) & 3
        step, status = PATTERN[phase], self.status_bits
        counts: list[object] = []
        for (scale, offset, whole, limit, sign, least, most), value in zip(self._rows, values, strict=True):
            if len(counts) == self._status_place:
                counts.append(0)
                continue
            if not isfinite(value):
                status |= self._invalid
                value = 0.0
            count: float = (value - offset) / scale
            if whole:
                count = float(floor(count + step))
            if not -limit < count < limit:
                status |= self._overload
                count = min(max(count, -limit), limit)
            if sign and count < 0.0:
                status |= sign
                count = -count
            if whole:
                number = int(count)
                counts.append(least if number < least else most if number > most else number)
            else:
                counts.append(count)
        if self._status_place >= 0:
            counts[self._status_place] = status
        self._shown = data = self._block.pack(*counts)
        return data

    def written(self, address: int, value: int, t: float) -> int:
        """Accept a parameter inside the device's range; measured values cannot be written."""
        if address in self._read_only:
            return ILLEGAL_ADDRESS
        register = self._parameters.get(address)
        if register is None or register.type not in ("u16", "i16"):
            return 0
        signed = value - 0x10000 if register.type == "i16" and value > 0x7FFF else value
        return 0 if register.least <= signed * register.scale + register.offset <= register.greatest else ILLEGAL_VALUE


class ForceSource(Protocol):
    """Source of a load cell's readings."""

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return Fx, Fy, Fz in N and the moment in N m at ``t`` s."""
        ...


class CellSlave(SensorSlave):
    """A load cell's transmitter, with any of the channels fx, fy, fz, mz under any names of its profile."""

    def __init__(
        self, profile: DeviceProfile, unit_id: int, source: ForceSource, forces: Mapping[str, str] = _AS_NAMED
    ) -> None:
        """Place the registers as in ``profile``; ``source`` is called at each read.

        ``forces``: the force of each channel whose name in the profile does not name it.
        """
        profile.expect("load_cell")
        super().__init__(profile, unit_id)
        self.source = source
        names = [signal.name for signal in self._signals]
        self.forces: tuple[str, ...] = tuple(forces.get(name, name) for name in names)
        """Forces of its channels, in the order of the block, with its status among them."""
        self._plain = names == [*FORCES, "status"] and not any(signal.offset for signal in self._signals)
        self._places = tuple(FORCES.index(force) if force in FORCES else -1 for force in self.forces)
        self._scales = tuple(signal.scale for signal in self._signals)
        self._pack = self._block.pack

    def measure(self, t: float) -> list[float]:
        """Return each channel's force at ``t`` s, 0 for a channel without one."""
        forces = self.source.forces_measured(t)
        return [forces[place] if place >= 0 else 0.0 for place in self._places]

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s; the usual case, four channels within range asked for in every scan, takes a short path."""
        if not self._plain or self.frozen:
            return super().sample(block, t)
        x, y, z, m = forces = self.source.forces_measured(t)
        phase = (self.dither + 1) & 3
        step = PATTERN[phase]
        sx, sy, sz, sm, _ = self._scales
        lx, ly, lz, lm, _ = self._limits
        cx, cy, cz, cm = floor(x / sx + step), floor(y / sy + step), floor(z / sz + step), floor(m / sm + step)
        if not (-lx < cx < lx and -ly < cy < ly and -lz < cz < lz and -lm < cm < lm):
            return self._encode((*forces, 0.0))
        self.dither = phase
        self._shown = data = self._pack(cx, cy, cz, cm, self.status_bits)
        return data


class SurfaceSource(Protocol):
    """Source of an infrared thermometer's reading."""

    def surface_measured_c(self, t: float) -> float:
        """Return the surface temperature in degC at ``t`` s; NaN where it cannot be measured."""
        ...


class IrSlave(SensorSlave):
    """An infrared thermometer; ``sensor_c`` is its own temperature, degC."""

    def __init__(self, profile: DeviceProfile, unit_id: int, source: SurfaceSource, sensor_c: float = 25.0) -> None:
        """Place the registers as in ``profile``; ``source`` is called at each read."""
        profile.expect("ir_thermometer")
        super().__init__(profile, unit_id)
        self._emissivity = profile.writes.get("emissivity")
        self._order = profile.order
        self.source = source
        self.sensor_c = sensor_c
        self._of_itself = tuple(signal.name == "sensor" for signal in self._signals)
        self.power(True)

    def power(self, on: bool) -> None:
        """Switch the supply; the thermometer starts with an emissivity of 1 [A]."""
        self.powered = on
        if on and self._emissivity is not None:
            words = self._emissivity.words(1.0, self._order)
            self.put(self._emissivity.address, b"".join(word.to_bytes(2, "big") for word in words))

    @property
    def emissivity(self) -> float:
        """The present emissivity: 1 after power-on, and for a device without this setting."""
        register = self._emissivity
        if register is None:
            return 1.0
        words = (self.get(register.address + place).to_bytes(2, "big") for place in range(register.size))
        return register.value(b"".join(words), self._order)

    def measure(self, t: float) -> list[float]:
        """Return the surface's temperature at ``t`` s on every channel except that of the device's own temperature."""
        surface_c = self.source.surface_measured_c(t)
        return [self.sensor_c if of_itself else surface_c for of_itself in self._of_itself]


def _most_counts(signal: Signal) -> float:
    """Return the counts at a load cell channel's full scale; the greatest 32-bit value if the profile states none."""
    return float(round(signal.greatest / signal.scale)) if signal.greatest < inf else LIMITS["i32"][1]
