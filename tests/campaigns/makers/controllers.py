"""Cases of a temperature controller: its setpoint is commanded while it reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from math import inf, isfinite, nan

from drivers.modbus import ModbusLink
from drivers.temperature_controller import TemperatureController
from tests.campaigns.makers.cases import SET_UP_S, Cases
from tests.campaigns.makers.seat import Driver, Seat, narrowed, placed

STOPPED = "stopped"
"""A controller that can be stopped has this number; it is 1 while stopped."""
STALE_S = 1.0
"""Age above which a controller's reading is not valid, s."""


class ControllerCases(Cases):
    """Cases of a temperature controller, drawn from a source."""

    def _driver(self, link: ModbusLink, parameters: Mapping[str, float]) -> Driver:
        return TemperatureController("jacket", self.profile, 1, link)

    def _numbers(self, driver: Driver) -> dict[str, float]:
        assert isinstance(driver, TemperatureController)
        return {"pv": driver.measured_c, "setpoint": driver.setpoint_c, "output": driver.output_percent}

    def _believed(self, seat: Seat) -> bool:
        driver = seat.driver
        assert isinstance(driver, TemperatureController)
        return driver.valid and isfinite(driver.measured_c) and seat.now - driver.stamp_s <= STALE_S

    def _command(self, seat: Seat, celsius: float, on: bool) -> None:
        """Command the controller in every scan from now on."""
        driver = seat.driver
        assert isinstance(driver, TemperatureController)

        def each() -> None:
            driver.enable(on)
            driver.set_setpoint(celsius)

        seat.each = each

    @contextmanager
    def _seat(self, parameters: Mapping[str, float] = {}, ready: bool = True) -> Iterator[Seat]:
        """Command the parameter ``setpoint`` once the controller reads."""
        with super()._seat({}, ready) as seat:
            for celsius in parameters.values():
                self._command(seat, celsius, on=True)
                self._settle(seat)
            yield seat

    def _write(self, name: str) -> None:
        """Command setpoints, standby, and a setpoint again after a silence."""
        register_name, factor = self.place.table.parameters[name]
        register = self.place.table[register_name]
        with self._seat() as seat:
            value = self.source.choice([register.greatest, *self._drawn(register.least + 1.0, register.greatest)])
            for on, text in ((True, "commanded"), (False, "standby"), (True, "commanded again")):
                self._command(seat, value * factor, on)
                self._settle(seat)
                if STOPPED in self.place.slave.kept:
                    stopped = self.place.slave.get(STOPPED)
                    self._judge("write", stopped == (not on), f"{text}: stopped {stopped:g}")
                if on or STOPPED not in self.place.slave.kept:
                    self._arrived(register_name, value if on else register.least, text)
                self._compare(seat, "write", text)
            self.place.slave.silent = True
            seat.run(SET_UP_S)
            self.place.slave.power_up()
            seat.run(2.0 * SET_UP_S)
            self._arrived(register_name, value, "after a silence")

    def _arrived(self, register_name: str, value: float, text: str) -> None:
        held = self.place.slave.get(register_name)
        register = self.place.table[register_name]
        rounding = 1e-6 * abs(register.greatest) + (0.0 if register.type == "f32" else 0.5)
        self._judge("write", abs(held - value) <= rounding, f"{text}: {register_name} {value!r} arrived as {held!r}")

    def _refuse_value(self, name: str, register_name: str, factor: float) -> None:
        """Command values beyond the maker's range, non-numbers, and values that this particular device does not
        accept."""
        register = self.place.table[register_name]
        bound = register.least
        with self._seat() as seat:
            for value in (register.greatest + self.source.uniform(1.0, 500.0), -self.source.uniform(1.0, 500.0)):
                self._command(seat, value * factor, on=True)
                self._settle(seat)
                bound = min(max(value, register.least), register.greatest)
                self._arrived(register_name, bound, f"{name} {value:g} is kept in its range")
            driver = seat.driver
            assert isinstance(driver, TemperatureController)
            for value in (nan, inf, -inf):
                with suppress(ValueError):
                    driver.set_setpoint(value)
                    self._judge("refuse", False, f"{name} {value}: accepted")
                self._judge("refuse", self.place.slave.get(register_name) == bound, f"{name} {value} arrived")
        half = register.least + 0.5 * (register.greatest - register.least)
        with placed(narrowed(self.place.table, register_name, half)) as narrow:
            narrow.slave.power_up()
            with narrow.seat(lambda link: self._driver(link, {})) as seat:
                self._command(seat, self.source.uniform(half + 1.0, register.greatest) * factor, on=True)
                seat.run(SET_UP_S)
                shown, (true, step) = self._numbers(seat.driver)[name], narrow.truth(name)
                right = abs(shown - true) <= step
                self._judge("refuse", right, f"a {name} that it does not take is shown as {shown}, not {true}")
