"""Whether friction swings within a revolution, as it does where the contact sticks and slips.

The coefficient of every accepted sample is taken as a share of the mean. The part in step with the wheel's rotation
(its orders, a sine and a cosine of each) and a slow trend of each contact are fitted and removed. The remainder has a
spectrum, averaged over stretches of up to ``LONGEST_S``. Friction swings where the spectrum exceeds its level within an
octave ``PROMINENCE`` times, between ``LOWEST_HZ`` and a tenth of the sampling rate. The frequency is that of the
highest of these peaks, the amplitude sqrt(2) times the root mean square of that peak and its multiples. So a sine reads
true, and a saw-tooth 18 % low. A faster swing, up to the highest frequency that the sampling rate resolves, has a
frequency but only a lower limit of its amplitude.

The skewness of the differences between neighbouring samples distinguishes the kinds of swing: friction that rises
slowly and falls fast has a skewness far below 0, a vibration none.

An unknown swing is NaN and never 0: no contact is long enough, or the part in step with the wheel is so large that it
may be stick-slip beside an order.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Final, NamedTuple

from tester.analysis.results import NAN, Swing
from tester.analysis.trace import Trace
from tester.base.arrays import Array

LOWEST_HZ: Final = 0.8
"""Slower swings are drift, which other tests judge [A]."""
FASTEST: Final = 0.45
"""Highest frequency of the search, as a share of the sampling rate: at half of it frequencies fold [A]."""
PER_PERIOD: Final = 10.0
"""Samples in a period of the fastest swing that has an amplitude: 10 Hz of 100 Hz. Load cell and polling attenuate a
faster one by an unknown amount [A]."""
SHORTEST_S: Final = 2.5
"""A shorter contact has less than two periods of the slowest swing, which then cannot be distinguished from an order
of the wheel 0.3 Hz away [A]."""
LONGEST_S: Final = 8.0
"""Length of the stretches over which spectra are averaged, s [A]: their frequencies are 0.25 Hz apart."""
MOST_STRETCHES: Final = 40
"""Most stretches analysed: more add no information, and take time in which the rig is not scanned [A]."""
PROMINENCE: Final = 12.0
"""Power of a peak over the median of the power within an octave of it [A]. In a single stretch of noise one frequency
in 4,000 has that much (exp(-12 ln 2)); in the mean of two, one in 100,000."""
LEAST_PERCENT: Final = 1.0
"""A smaller swing counts as noise [A]."""
LIMIT_PERCENT: Final = 5.0
"""Friction that swings by more than this to either side carries a doubt [A]."""
MOST_HZ: Final = 15.0
"""Orders of the wheel are removed up to this frequency: runout, flats and seams of a tread have no more [A]."""
_LOBE: Final = 0.1
"""Half the width of a peak, as a share of its frequency: the periods of stick-slip vary [A]."""
_MULTIPLES: Final = 4
_LEVELS: Final = 16
"""Frequencies at which the surrounding level is computed; between them it is a straight line."""
_POINTS: Final = 2048
"""Points of a Fourier transform: frequencies 0.05 Hz apart at 100 Hz."""

UNKNOWN: Final = Swing(NAN, NAN, NAN)
NO_SWING: Final = Swing(0.0, NAN, NAN)


class _Stretch(NamedTuple):
    """A stretch of samples at equal times: friction as a share of its mean, less its trend; the wheel's orders."""

    friction: Array
    orders: Array


class _Spectrum(NamedTuple):
    """Power, 1/Hz, over frequency, Hz; ``width_hz``: resolution of the stretches."""

    frequency_hz: Array
    power: Array
    width_hz: float


def swing_of(trace: Trace) -> Swing:
    """Return the swing of friction: 0 where there is none, NaN where it is unknown."""
    import numpy as np

    contacts = [contact for contact in trace.contacts() if len(contact["time_s"]) > 1]
    steps = np.concatenate([np.diff(contact["time_s"]) for contact in contacts]) if contacts else np.array([])
    step_s = float(np.median(steps)) if len(steps) else inf
    if not (step_s > 0.0 and FASTEST / step_s > 2.0 * LOWEST_HZ):
        return UNKNOWN
    highest_hz, fastest_hz = 1.0 / (PER_PERIOD * step_s), FASTEST / step_s
    stretches = _stretches(contacts, step_s, _orders(contacts, min(fastest_hz, MOST_HZ)) if trace.turns else 0)
    if not stretches:
        return UNKNOWN
    rests, ordered_percent = _without_orders(stretches)
    spectrum = _spectrum(rests, step_s)
    if (found := _swing(spectrum, LOWEST_HZ, highest_hz)) is not None:
        percent, at_hz = found
        return Swing(percent, at_hz, _skewness(rests), percent)
    if (found := _swing(spectrum, max(LOWEST_HZ, highest_hz), fastest_hz)) is not None:
        percent, at_hz = found
        return Swing(NAN, at_hz, _skewness(rests), percent)
    # A large order of the wheel may hide stick-slip beside it.
    return UNKNOWN if ordered_percent > LIMIT_PERCENT else NO_SWING


def _orders(contacts: list[dict[str, Array]], highest_hz: float) -> int:
    """Return how many orders of the wheel are removed."""
    import numpy as np

    slopes = [abs(np.ptp(contact["position"]) / np.ptp(contact["time_s"])) for contact in contacts]
    turn_hz = float(np.median(slopes))
    return int(highest_hz / turn_hz) if turn_hz > 0.0 else 0


def _stretches(contacts: list[dict[str, Array]], step_s: float, orders: int) -> list[_Stretch]:
    """Return the stretches of sufficient length, evenly spread where there are more than ``MOST_STRETCHES``."""
    import numpy as np

    cut: list[dict[str, Array]] = []
    for contact in contacts:
        pieces = max(1, round((contact["time_s"][-1] - contact["time_s"][0]) / LONGEST_S))
        for part in np.array_split(np.arange(len(contact["time_s"])), pieces):
            piece = {name: column[part] for name, column in contact.items()}
            if len(part) and float(np.ptp(piece["time_s"])) >= SHORTEST_S and float(np.min(piece["normal"])) > 0.0:
                cut.append(piece)
    if len(cut) > MOST_STRETCHES:
        cut = [cut[i * len(cut) // MOST_STRETCHES] for i in range(MOST_STRETCHES)]
    return [_stretch(contact, step_s, orders) for contact in cut]


def _stretch(contact: dict[str, Array], step_s: float, orders: int) -> _Stretch:
    """Return a stretch at equal times, without a trend of second degree."""
    import numpy as np

    mu: Array = np.hypot(contact["along"], contact["across"]) / contact["normal"]
    begins, ends = float(contact["time_s"][0]), float(contact["time_s"][-1])
    times: Array = begins + step_s * np.arange(int((ends - begins) / step_s + 1.5), dtype=np.float64)
    turned = 2.0 * np.pi * _at(times, contact["time_s"], contact["position"])
    friction = _at(times, contact["time_s"], mu)
    waves: list[Array] = []
    for order in range(1, orders + 1):
        waves += [np.cos(order * turned), np.sin(order * turned)]
    columns: Array = np.column_stack([friction / float(np.mean(friction)), *waves])
    trend = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, len(times)), 3))[0]
    columns -= trend @ (trend.T @ columns)
    return _Stretch(columns[:, 0], columns[:, 1:])


def _at(times: Array, there: Array, values: Array) -> Array:
    """Return values at other times, interpolated linearly."""
    import numpy as np

    interpolated: Array = np.asarray(np.interp(times, there, values), dtype=np.float64)  # pyright: ignore[reportUnknownMemberType]
    return interpolated


def _without_orders(stretches: list[_Stretch]) -> tuple[list[Array], float]:
    """Return the stretches without the part in step with the wheel's rotation, and the amplitude of that, per cent."""
    import numpy as np

    orders = np.vstack([stretch.orders for stretch in stretches])
    friction = np.concatenate([stretch.friction for stretch in stretches])
    if not orders.shape[1]:
        return [stretch.friction for stretch in stretches], 0.0
    # Thousands of samples, a few columns of sines and cosines that are nearly orthogonal: the normal equations lose no
    # digit that counts, in a tenth of the time.
    fitted = np.linalg.lstsq(orders.T @ orders, orders.T @ friction, rcond=None)[0]
    swing = 100.0 * sqrt(2.0 * float(np.mean((orders @ fitted) ** 2)))
    return [stretch.friction - stretch.orders @ fitted for stretch in stretches], swing


def _spectrum(rests: list[Array], step_s: float) -> _Spectrum:
    """Return the mean spectrum of the stretches, each through a Hann window."""
    import numpy as np

    points = max(_POINTS, 1 << (max(map(len, rests)) - 1).bit_length())
    power = np.zeros(points // 2 + 1)
    for rest in rests:
        window = np.hanning(len(rest))
        power += len(rest) * 2.0 * step_s * np.abs(np.fft.rfft(window * rest, points)) ** 2 / (window @ window)
    count = sum(map(len, rests))
    frequency: Array = np.arange(points // 2 + 1) / (points * step_s)
    return _Spectrum(frequency, power / count, 2.0 * len(rests) / (count * step_s))


def _swing(spectrum: _Spectrum, lowest_hz: float, highest_hz: float) -> tuple[float, float] | None:
    """Return amplitude (per cent) and frequency (Hz) of the highest prominent peak between two frequencies; None where
    there is none, or nothing between them."""
    import numpy as np

    if lowest_hz >= highest_hz:
        return None
    frequency, power = spectrum.frequency_hz, spectrum.power
    marks = np.geomspace(lowest_hz, highest_hz, _LEVELS)
    level = np.interp(frequency, marks, [_level(spectrum, float(mark)) for mark in marks])
    prominent = (frequency >= lowest_hz) & (frequency <= highest_hz) & (power > PROMINENCE * level)
    if not prominent.any():
        return None
    at_hz = float(frequency[np.argmax(np.where(prominent, power, 0.0))])
    variance = 0.0
    for multiple in range(1, _MULTIPLES + 1):
        middle = multiple * at_hz
        if middle > frequency[-1]:
            break
        half = min(max(spectrum.width_hz, _LOBE * middle), 0.5 * at_hz)
        lobe = (frequency > middle - half) & (frequency <= middle + half)
        variance += max(float(np.sum(power[lobe] - _level(spectrum, middle))) * float(frequency[1]), 0.0)
    amplitude = 100.0 * sqrt(2.0 * variance)
    return (amplitude, at_hz) if amplitude >= LEAST_PERCENT else None


def _level(spectrum: _Spectrum, at_hz: float) -> float:
    """Return the median of the power within an octave of a frequency."""
    import numpy as np

    frequency = spectrum.frequency_hz
    return float(np.median(spectrum.power[(frequency >= at_hz / 2.0) & (frequency <= at_hz * 2.0)]))


def _skewness(rests: list[Array]) -> float:
    """Return the skewness of the differences between neighbouring samples."""
    import numpy as np

    steps: Array = np.concatenate([rest[1:] - rest[:-1] for rest in rests])
    steps = steps - float(np.mean(steps))
    return float(np.mean(steps**3) / np.mean(steps**2) ** 1.5)
