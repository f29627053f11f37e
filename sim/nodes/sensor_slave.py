"""Simulated Modbus sensors, built from their profiles: a load cell, an infrared thermometer, any other."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import floor, inf, isfinite
from typing import Final, Protocol

from drivers.profiles.model import DeviceProfile
from drivers.profiles.numbers import BIT_READS, LIMITS, on_wire
from drivers.profiles.registers import RegisterBlock, Signal
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


class _Shown:
    """One block of a profile, as the slave fills it."""

    def __init__(self, block: RegisterBlock, limits: Sequence[float]) -> None:
        self.block = block
        self.of_bits: bool = block.function in BIT_READS
        names = [signal.name for signal in block.signals]
        self.status_place: int = names.index("status") if "status" in names else -1
        self.rows = tuple(
            (signal.scale, signal.offset, signal.type != "f32", signal.type in ("bit", "u8"), limit,
             1 << signal.sign_bit if signal.sign_bit is not None else 0, *LIMITS[signal.type])
            for signal, limit in zip(block.signals, limits, strict=True)
        )  # fmt: skip
        """For each signal: scale, offset, whether counts are whole, and never dithered, greatest counts, bit of the
        sign, ends of type."""
        self.data: bytes = bytes(block.size)
        self.condition = 0
        """Status bits that its last values set."""


class SensorSlave(ModbusSlave):
    """A sensor with the channels of a profile, sampled whenever its registers are read.

    ``dither`` is the phase of the last bit: set it to 0 if a run must not depend on earlier readings.
    ``status_bits`` are always set (a broken bridge); ``frozen`` stops the sampling. A value that cannot be
    measured sets the lowest status bit that makes a reading invalid.
    """

    __slots__ = (
        "_block", "_invalid", "_overload", "_parameters", "_quantities", "_read_only", "_shown", "_signals",
        "dither", "frozen", "status_bits",
    )  # fmt: skip

    def __init__(
        self, profile: DeviceProfile, unit_id: int, quantities: Mapping[str, Quantity | float] = _NOTHING
    ) -> None:
        """Place the registers as in ``profile``; the ``quantities`` by channel are called at each read."""
        profile.expect_sensor()
        block = profile.blocks[0]
        read = [(one.address, one.count) for one in profile.blocks if one.function not in BIT_READS]
        if profile.identity is not None:
            read.append((profile.identity.address, 1))
        written = [(signal.address, signal.size) for signal in profile.writes.values() if signal.type != "bit"]
        written += [(write.address, write.count) for write in profile.setup if write.read not in BIT_READS]
        super().__init__(unit_id, profile.timing.turnaround_s, [*read, *written], profile.functions)
        if profile.identity is not None:
            self.put(profile.identity.address, profile.identity.value.to_bytes(2, "big"))
        self._add_bits(profile)
        for write in profile.setup:
            if not write.writes and write.read not in BIT_READS:
                self.put(write.address, on_wire(write.words))  # the real device takes a while; this one has finished
        self._read_only = {address for start, count in read for address in range(start, start + count)}
        self._parameters = {signal.address: signal for signal in profile.writes.values() if signal.size == 1}
        self.dither = 0
        self.status_bits = 0
        self.frozen = False
        self._block = block
        self._signals = block.signals
        self._quantities = {
            signal.name: quantities.get(signal.name, min(max(READS_ZERO, signal.least), signal.greatest))
            for one in profile.blocks
            for signal in one.signals
        }
        self._invalid = profile.invalid_bits & -profile.invalid_bits
        self._overload = profile.bit("overload")
        most = _most_counts if profile.kind == "load_cell" else _no_limit
        self._shown = tuple(_Shown(one, [most(signal) for signal in one.signals]) for one in profile.blocks)
        self.blocks = {
            (one.block.address, one.block.count): number for number, one in enumerate(self._shown) if not one.of_bits
        }

    def _add_bits(self, profile: DeviceProfile) -> None:
        """Place coils and discrete inputs, those of a wait as it ends."""
        for one in profile.blocks:
            if one.function in BIT_READS:
                self.bits.update(dict.fromkeys(range(one.address, one.address + one.count), 0))
        self.bits.update({signal.address: 0 for signal in profile.writes.values() if signal.type == "bit"})
        for write in profile.setup:
            if write.read in BIT_READS:
                held = 0 if write.writes else write.words[0]
                self.bits.update({write.address + place: held >> place & 1 for place in range(write.count)})

    def show(self, channel: str, source: Quantity | float) -> Quantity | float:
        """Replace the source of a channel of the first read; return the previous source."""
        before = self._quantities[channel]
        self._quantities[channel] = source
        return before

    def measure(self, t: float, block: RegisterBlock) -> list[float]:
        """Return the values of a read's signals at ``t`` s, in their units; any value for the status."""
        found = [self._quantities[signal.name] for signal in block.signals]
        return [quantity if isinstance(quantity, float | int) else quantity() for quantity in found]

    def draw(self, block: int, count: int, t: float) -> None:
        registers = self._shown[block].block
        for _ in range(count):
            self.measure(t, registers)
        self.dither = (self.dither + count) & 3

    def refresh(self, t: float) -> None:
        """Sample at ``t`` s."""
        for number, one in enumerate(self._shown):
            data, block = self.sample(number, t), one.block
            if one.of_bits:
                held = int.from_bytes(data, "little")
                for place in range(block.count):
                    self.bits[block.address + place] = held >> place & 1
            else:
                self.put(block.address, data)

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s and return all registers of a read."""
        one = self._shown[block]
        return one.data if self.frozen else self._encode(one, self.measure(t, one.block))

    def _encode(self, one: _Shown, values: Sequence[float]) -> bytes:
        """Return a read with these values, one for each signal, rounded by the next phase of the dither."""
        self.dither = phase = (self.dither + 1) & 3
        step, status = PATTERN[phase], 0
        counts: list[object] = []
        for (scale, offset, whole, flag, limit, sign, least, most), value in zip(one.rows, values, strict=True):
            if len(counts) == one.status_place:
                counts.append(0)
                continue
            if not isfinite(value):
                status |= self._invalid
                value = 0.0
            count: float = (value - offset) / scale
            if whole:
                count = float(floor(count + (0.5 if flag else step)))
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
        one.condition = status
        if one.status_place >= 0:
            for other in self._shown:
                status |= other.condition
            counts[one.status_place] = status | self.status_bits
        one.data = data = one.block.pack(*counts)
        return data

    def coil_written(self, address: int, value: int, t: float) -> int:
        """Accept coils that are not read as inputs."""
        shown = any(one.of_bits and 0 <= address - one.block.address < one.block.count for one in self._shown)
        return ILLEGAL_ADDRESS if shown else 0

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
        self._limits = tuple(int(_most_counts(signal)) for signal in self._signals)

    def measure(self, t: float, block: RegisterBlock) -> list[float]:
        """Return each channel's force at ``t`` s, 0 for a channel without one; further reads hold no force."""
        if block is not self._block:
            return [0.0] * len(block.signals)
        forces = self.source.forces_measured(t)
        return [forces[place] if place >= 0 else 0.0 for place in self._places]

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s; the usual case, four channels within range asked for in every scan, takes a short path."""
        if not self._plain or self.frozen or block:
            return super().sample(block, t)
        x, y, z, m = forces = self.source.forces_measured(t)
        phase = (self.dither + 1) & 3
        step = PATTERN[phase]
        sx, sy, sz, sm, _ = self._scales
        lx, ly, lz, lm, _ = self._limits
        cx, cy, cz, cm = floor(x / sx + step), floor(y / sy + step), floor(z / sz + step), floor(m / sm + step)
        if not (-lx < cx < lx and -ly < cy < ly and -lz < cz < lz and -lm < cm < lm):
            return self._encode(self._shown[0], (*forces, 0.0))
        self.dither = phase
        pack = self._pack  # an attribute that is called as a method is looked up anew (CPython 3.11)
        self._shown[0].data = data = pack(cx, cy, cz, cm, self.status_bits)
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
        self.power(True)

    def power(self, on: bool) -> None:
        """Switch the supply; the thermometer starts with an emissivity of 1 [A]."""
        self.powered = on
        if on and self._emissivity is not None:
            words = self._emissivity.words(1.0, self._order)
            self.put(self._emissivity.address, on_wire(words))

    @property
    def emissivity(self) -> float:
        """The present emissivity: 1 after power-on, and for a device without this setting."""
        register = self._emissivity
        if register is None:
            return 1.0
        words = [self.get(register.address + place) for place in range(register.size)]
        return register.value(on_wire(words), self._order)

    def measure(self, t: float, block: RegisterBlock) -> list[float]:
        """Return the surface's temperature at ``t`` s on every channel except that of the device's own temperature."""
        surface_c = self.source.surface_measured_c(t)
        return [self.sensor_c if signal.name == "sensor" else surface_c for signal in block.signals]


def _no_limit(signal: Signal) -> float:
    """Return that the counts have no limit but their type's."""
    return inf


def _most_counts(signal: Signal) -> float:
    """Return the counts at a load cell channel's full scale; the greatest 32-bit value if the profile states none."""
    return float(round(signal.greatest / signal.scale)) if signal.greatest < inf else LIMITS["i32"][1]
