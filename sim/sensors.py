"""Thermometers and encoders of any machine: readings of true values.

Sizes of imperfections are passed in full; at 0 a sensor gives the true value (a thermometer its lagged value).
"""

from __future__ import annotations

import math

from sim.noise import NormalStream


class TemperatureSensor:
    """A thermometer with a first-order lag, a constant bias and white noise; ``gain`` is its share of a step."""

    def __init__(self, time_s: float, rms_k: float, bias_k: float, noise: NormalStream) -> None:
        """Take the sizes in full (already scaled); it reads 0 degC until ``reset``."""
        self._time_s = time_s
        self._rms_k = rms_k
        self._bias_k = bias_k
        self.gain = 0.0
        self.lagged_c = 0.0
        self.noise = noise

    def reset(self, true_c: float) -> None:
        """Settle at a temperature."""
        self.lagged_c = true_c

    def retime(self, dt_s: float) -> None:
        """Set the length of a step in s."""
        self.gain = -math.expm1(-dt_s / self._time_s)

    def follow(self, true_c: float) -> None:
        """Advance by one step at a true temperature."""
        self.lagged_c += (true_c - self.lagged_c) * self.gain

    def measure(self) -> float:
        """Return a reading in degC."""
        if self._rms_k > 0.0:
            return self.lagged_c + self._bias_k + self._rms_k * self.noise.next()
        return self.lagged_c + self._bias_k


class SpeedSensor:
    """An encoder for a line speed: an error of scale and white noise."""

    def __init__(self, factor: float, rms_m_s: float, noise: NormalStream) -> None:
        """Take ``factor`` = indicated over true speed, and the noise in full (already scaled)."""
        self.factor = factor
        self._rms_m_s = rms_m_s
        self.noise = noise

    def error(self) -> float:
        """Return one number of the white noise, m/s."""
        rms_m_s = self._rms_m_s
        if rms_m_s > 0.0:
            for number in self.noise.numbers:
                return rms_m_s * number
            return rms_m_s * self.noise.next()
        return 0.0

    def measure(self, true_m_s: float) -> float:
        """Return a reading in m/s."""
        return true_m_s * self.factor + self.error()
