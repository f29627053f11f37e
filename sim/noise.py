"""All random numbers of the simulated rig, from one seed.

A stream of numbers belongs to a key (seed, stream name, and its place: specimen, wheel, condition,
repeat, attempt) and never depends on the order of drawing. So if a run is resumed, split over processes or has
one repeat redone, every other repeat still draws the same numbers. Keys pass through numpy's SeedSequence into
Philox, whose bits are the same on every platform; names enter by their CRC-32.
"""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator
from copy import copy
from operator import length_hint
from typing import Final

import numpy as np

_SEED_MASK: Final = 0xFFFF_FFFF_FFFF_FFFF
BLOCKS: Final = (128, 1024)
"""Numbers in a block, the first and every later one (multiples of four): the hot path steps through a list."""


def _generator(seed: int, stream: str, place: tuple[int, ...]) -> np.random.Generator:
    """Return the generator of one key; ``place`` holds integers of at least 0."""
    entropy = [seed & _SEED_MASK, zlib.crc32(stream.encode()), len(place), *place]
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(entropy)))


def normal(seed: int, stream: str, *place: int) -> float:
    """Return one standard normal number of a key."""
    return float(_generator(seed, stream, place).standard_normal())


def uniforms(count: int, seed: int, stream: str, *place: int) -> list[float]:
    """Return ``count`` numbers of a key, evenly spread over -1 to 1."""
    return [float(x) for x in _generator(seed, stream, place).uniform(-1.0, 1.0, count)]


class NormalStream:
    """Standard normal numbers of one key, without end.

    Each block has a key of its own, so the state is a block's number and a position: cheap to copy. ``numbers`` and
    ``fours`` iterate over the rest of the present block. One step of a loop over them is the fastest way to the next
    number; at their end ``next`` or ``next4`` returns it.
    """

    def __init__(self, seed: int, stream: str, *place: int) -> None:
        """Start at the key's first number; nothing is drawn before it is asked for."""
        self._seed = seed
        self._stream = stream
        self._place = place
        self._block = 0
        self._hold(iter(()))

    def next(self) -> float:
        """Return the next number."""
        for number in self.numbers:
            return number
        self._draw()
        return next(self.numbers)

    def next4(self) -> tuple[float, float, float, float]:
        """Return the next four numbers (of a stream that is only read in fours)."""
        for four in self.fours:
            return four
        self._draw()
        return next(self.fours)

    @property
    def drawn(self) -> int:
        """How many numbers have been drawn."""
        first, later = BLOCKS
        return 0 if not self._block else first + (self._block - 1) * later - length_hint(self.numbers)

    def skip(self, count: int) -> None:
        """Draw ``count`` numbers, at least 0, and forget them."""
        for _ in range(count):
            self.next()

    def _hold(self, numbers: Iterator[float]) -> None:
        self.numbers = numbers
        self.fours = zip(numbers, numbers, numbers, numbers, strict=False)

    def _draw(self) -> None:
        """Draw the next block."""
        generator = _generator(self._seed, self._stream, (*self._place, self._block))
        self._hold(iter(generator.standard_normal(BLOCKS[self._block > 0]).tolist()))
        self._block += 1

    def __deepcopy__(self, memo: dict[int, object]) -> NormalStream:
        """Return an independent stream at the same position; it shares the block, which never changes."""
        twin = NormalStream(self._seed, self._stream, *self._place)
        twin._block = self._block
        twin._hold(copy(self.numbers))
        return twin


class Autoregressive:
    """First-order autoregressive fluctuation with a standard deviation and a correlation time, exact for any step.

    A step sets ``value`` to ``keep`` times itself plus ``kick`` times a standard normal number.
    """

    def __init__(self, sigma: float, time_s: float) -> None:
        """Start at zero without a step length; ``retime`` must come before ``step``."""
        self._sigma = sigma
        self._time_s = time_s
        self.keep = 1.0
        self.kick = 0.0
        self.value = 0.0

    def retime(self, dt_s: float) -> None:
        """Set the length of a step in s."""
        self.keep = math.exp(-dt_s / self._time_s)
        self.kick = self._sigma * math.sqrt(1.0 - self.keep * self.keep)

    def restart(self, number: float) -> None:
        """Start anew from a standard normal number, in the stationary distribution."""
        self.value = self._sigma * number

    def step(self, number: float) -> float:
        """Advance by one step with a standard normal number and return the value."""
        self.value = value = self.keep * self.value + self.kick * number
        return value


SLIP_SHARE: Final = 0.15
"""Share of a period in which friction falls back [A]."""
PERIOD_SIGMA: Final = 0.03
"""Relative standard deviation of a period [A]."""
_LEAST_PERIOD: Final = 0.5
"""Least length of a drawn period, as a share of the mean period."""


class StickSlip:
    """The factor of stick-slip on friction: it rises while the contact sticks and falls back as it slips.

    It is a saw-tooth about the mean: a slow rise, then a fall within ``SLIP_SHARE`` of the period. The periods
    differ: a stream of noise determines them.
    """

    def __init__(self, share: float, frequency_hz: float, noise: NormalStream) -> None:
        """Swing by ``share`` to either side of the mean, ``frequency_hz`` times a second in the mean (above 0)."""
        self._share = share
        self._frequency_hz = self._rate_hz = frequency_hz
        self._at = 0.0
        self._noise = noise

    def restart(self, noise: NormalStream) -> None:
        """Draw the future periods from another stream."""
        self._noise = noise

    def factor(self, dt: float) -> float:
        """Return the factor after ``dt`` s more, 1 - share to 1 + share; its mean is 1."""
        self._at = at = self._at + self._rate_hz * dt
        if at >= 1.0:
            self._at = at = at % 1.0
            period = 1.0 + PERIOD_SIGMA * self._noise.next()
            self._rate_hz = self._frequency_hz / (period if period > _LEAST_PERIOD else _LEAST_PERIOD)
        rising = 1.0 - SLIP_SHARE
        wave = 2.0 * at / rising - 1.0 if at < rising else 1.0 - 2.0 * (at - rising) / SLIP_SHARE
        return 1.0 + self._share * wave
