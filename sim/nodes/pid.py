"""The PID loop inside the simulated temperature controller."""

from __future__ import annotations


class Pid:
    """Output 0..100 % from setpoint and measurement; derivative on the measurement, integral that does not wind up.

    Defaults are tuned for the jacket of the simulated rig: 200 W on a hub of 420 J/K with 20 W/K to the rubber, sensor
    lag 1 s. [A]
    """

    __slots__ = (
        "_derivative",
        "_last_pv",
        "band_k",
        "derivative_s",
        "filter_s",
        "integral",
        "integral_s",
        "output",
    )

    def __init__(
        self, band_k: float = 2.5, integral_s: float = 60.0, derivative_s: float = 1.0, filter_s: float = 2.0
    ) -> None:
        """Take the proportional band in K (100 % over it), the integral and derivative times and the filter in s."""
        self.band_k = band_k
        self.integral_s = integral_s
        self.derivative_s = derivative_s
        self.filter_s = filter_s
        self.reset()

    def reset(self) -> None:
        """Forget everything: output 0."""
        self.integral = 0.0
        self.output = 0.0
        self._derivative = 0.0
        self._last_pv: float | None = None

    def step(self, setpoint: float, pv: float, dt: float) -> float:
        """Move on by ``dt`` s and return the output in %."""
        if self._last_pv is not None:
            rate = (pv - self._last_pv) / dt
            self._derivative += (rate - self._derivative) * dt / (self.filter_s + dt)
        self._last_pv = pv
        gain = 100.0 / self.band_k
        error = setpoint - pv
        direct = gain * (error - self.derivative_s * self._derivative)
        wanted = direct + self.integral
        # The integral rests while the output is at its end and the error would drive it further there.
        driven_up, driven_down = wanted >= 100.0 and error > 0.0, wanted <= 0.0 and error < 0.0
        if not driven_up and not driven_down:
            self.integral += gain * error * dt / self.integral_s
            self.integral = min(max(self.integral, 0.0), 100.0)
        self.output = min(max(direct + self.integral, 0.0), 100.0)
        return self.output
