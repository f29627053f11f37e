"""The simulated load-cell transmitter."""

from __future__ import annotations

from collections.abc import Mapping
from math import floor, inf
from typing import Final, Protocol

from drivers.profiles.model import LIMITS, DeviceProfile
from sim.nodes.dither import PATTERN
from sim.nodes.modbus_slave import ILLEGAL_ADDRESS, ModbusSlave

_AS_NAMED: Final[Mapping[str, str]] = {}


class ForceSource(Protocol):
    """What the cell measures."""

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return Fx, Fy, Fz in N and the moment in N m at ``t`` s."""
        ...


class CellSlave(ModbusSlave):
    """A transmitter with any of the channels fx, fy, fz, mz, by whatever names its profile has them.

    They are sampled whenever its registers are read.

    ``dither`` is the phase of the last bit: set it to 0 where a run must not depend on what was before.
    ``status_bits`` are set in the status whatever is measured (a broken bridge); ``frozen`` stops the sampling.
    """

    def __init__(
        self, profile: DeviceProfile, unit_id: int, source: ForceSource, forces: Mapping[str, str] = _AS_NAMED
    ) -> None:
        """Put the registers where ``profile`` has them; ``source`` is asked at each read.

        ``forces``: which of them a channel of the profile is, where its name does not say it.
        """
        profile.expect("load_cell")
        block = profile.blocks[0]
        registers = [(block.address, block.count)]
        if profile.identity is not None:
            registers.append((profile.identity.address, 1))
        super().__init__(unit_id, profile.timing.turnaround_s, registers, profile.functions)
        if profile.identity is not None:
            self.put(profile.identity.address, profile.identity.value.to_bytes(2, "big"))
        self.source = source
        self.dither = 0
        self.status_bits = 0
        self.frozen = False
        names = [signal.name for signal in block.signals]
        self._plain = names == ["fx", "fy", "fz", "mz", "status"]
        self._signals = block.signals
        self.forces: tuple[str, ...] = tuple(forces.get(name, name) for name in names)
        """What its channels show, in the order of the block; its status among them."""
        self._scales = tuple(signal.scale for signal in block.signals)
        self._limits = tuple(_most_counts(signal.greatest, signal.scale) for signal in block.signals)
        self._overload = profile.bit("overload")
        self._pack = block.pack
        window = self.window(block.address, block.count)
        assert window is not None
        self._data = window.data
        self._at = 2 * (block.address - window.start)
        self._end = self._at + 2 * block.count
        self.blocks = {(block.address, block.count): 0}

    def refresh(self, t: float) -> None:
        """Sample at ``t`` s."""
        self.sample(0, t)

    def sample(self, block: int, t: float) -> bytes:
        """Sample at ``t`` s and return all channels and the status."""
        if self.frozen:
            return bytes(self._data[self._at : self._end])
        forces = self.source.forces_measured(t)
        self.dither = phase = (self.dither + 1) & 3
        if not self._plain:
            data = self._encode(forces, phase)
        else:
            step = PATTERN[phase]
            x, y, z, m = forces
            sx, sy, sz, sm, _ = self._scales
            lx, ly, lz, lm, _ = self._limits
            cx, cy, cz, cm = floor(x / sx + step), floor(y / sy + step), floor(z / sz + step), floor(m / sm + step)
            status = self.status_bits
            if not (-lx < cx < lx and -ly < cy < ly and -lz < cz < lz and -lm < cm < lm):
                status |= self._overload
                cx, cy, cz, cm = _bound(cx, lx), _bound(cy, ly), _bound(cz, lz), _bound(cm, lm)
            data = self._pack(cx, cy, cz, cm, status)
        self._data[self._at : self._end] = data
        return data

    def written(self, address: int, value: int, t: float) -> int:
        """Refuse: nothing can be written; the tare is the computer's."""
        return ILLEGAL_ADDRESS

    def _encode(self, forces: tuple[float, float, float, float], phase: int) -> bytes:
        """Return registers in any order, with signs in the status."""
        x, y, z, m = forces
        values: dict[str, float] = {"fx": x, "fy": y, "fz": z, "mz": m}
        status = self.status_bits
        counts: list[int] = []
        for force, signal, scale, limit in zip(self.forces, self._signals, self._scales, self._limits, strict=True):
            found = floor(values.get(force, 0.0) / scale + PATTERN[phase])
            if not -limit < found < limit:
                status |= self._overload
                found = _bound(found, limit)
            if signal.sign_bit is not None and found < 0:
                status |= 1 << signal.sign_bit
                found = -found
            counts.append(found)
        for place, signal in enumerate(self._signals):
            if signal.name == "status":
                counts[place] = status
            else:
                least, most = LIMITS[signal.type]
                counts[place] = min(max(counts[place], least), most)
        return self._pack(*counts)


def _most_counts(greatest: float, scale: float) -> int:
    """Return the counts at the end of a channel's range; those of 32 bits where the profile states none."""
    return round(greatest / scale) if greatest < inf else LIMITS["i32"][1]


def _bound(counts: int, limit: int) -> int:
    return min(max(counts, -limit), limit)
