"""Cases of one device: our driver's handling of its numbers, writes, refusals and faults."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from drivers.modbus import ModbusLink
from drivers.profiles import DeviceProfile
from drivers.sensor import Sensor
from tests.campaigns.makers.seat import NAMED, PASSING, READS, WRITES, Driver, Place, Seat, Tally, narrowed, placed

SET_UP_S = 3.0
"""Time for the set-up and a few readings, s."""
LOSS_S = 3.0
"""Time after which a silent device counts as lost, including retries, s."""
LEAST_BEYOND = 0.01
"""Minimum distance of a value beyond its range, as a share of the range."""


class Cases:
    """Cases of one device, drawn from a source."""

    def __init__(self, place: Place, profile: DeviceProfile, source: random.Random, tally: Tally) -> None:
        """Judge a profile of the place's device."""
        self.place, self.profile, self.source, self.tally = place, profile, source, tally
        self.period_s = max(block.period_s for block in self.profile.blocks)

    def conduct(self, rounds: int) -> None:
        """Try everything; ``rounds``: number of readings, and of writes, that are drawn."""
        for signal in (signal for block in self.profile.blocks for signal in block.signals):
            known = signal.name in self.place.table.shown or signal.name == "status" or signal.guards
            self._judge("read", bool(known), f"{signal.name} is in no maker's table")
        self._read(rounds)
        for _ in range(rounds):
            for name in self.place.table.parameters:
                self._write(name)
        self._refuse()
        self._faults()
        self._silence()
        for _ in range(rounds):
            self._restart()

    def _judge(self, kind: str, right: bool, text: str) -> None:
        self.tally.judge(kind, right, f"{self.profile.name}: {text}")

    # the driver at its slave ------------------------------------------------------------------------------------

    def _driver(self, link: ModbusLink, parameters: Mapping[str, float]) -> Driver:
        return Sensor(self.profile, 1, link, parameters=parameters)

    def _numbers(self, driver: Driver) -> dict[str, float]:
        """Return the numbers that the driver shows, by channel."""
        assert isinstance(driver, Sensor)
        return dict(zip(driver.channels, driver.raw, strict=True))

    def _believed(self, seat: Seat) -> bool:
        """Return whether the rest of the program takes the driver's numbers as valid."""
        assert isinstance(seat.driver, Sensor)
        return seat.driver.fresh(seat.now)

    @contextmanager
    def _seat(self, parameters: Mapping[str, float] = {}, ready: bool = True) -> Iterator[Seat]:
        """Power the device up with drawn numbers, and connect the driver; ``ready``: wait until it reads."""
        self.place.slave.power_up()
        self.place.measure(self.source, self._bounds, inside=True)
        with self.place.seat(lambda link: self._driver(link, parameters)) as seat:
            if ready:
                seat.run(SET_UP_S)
                self._judge("read", self._believed(seat), f"not ready: {seat.driver.refused}")
            yield seat

    def _settle(self, seat: Seat) -> None:
        """Let the driver read every block twice, with its latency."""
        seat.run(2.5 * self.period_s + 0.1)

    def _bounds(self, channel: str) -> tuple[float, float]:
        """Return the bounds within which the profile accepts a channel."""
        signal, share = self.profile.signal(channel), self.profile.saturated
        edge = signal.greatest if share is None else share * signal.greatest - signal.scale
        return max(signal.least, -edge) if share is not None else signal.least, edge

    # cases -------------------------------------------------------------------------------------------------------

    def _compare(self, seat: Seat, kind: str, when: str) -> None:
        """Compare each channel with the device; values within the profile's bounds must be valid, and no others."""
        plausible, beyond = True, False
        for channel, value in self._numbers(seat.driver).items():
            if channel not in self.place.table.shown:
                continue
            true, step = self.place.truth(channel)
            least, greatest = self._bounds(channel)
            signal = self.profile.signal(channel)
            beyond = beyond or not signal.least - step <= true <= signal.greatest + step
            if not least <= true <= greatest:
                plausible = False
            elif not abs(value - true) <= step:
                self._judge(kind, False, f"{when}: {channel} is {true!r} and was read as {value!r}")
        believed = self._believed(seat)
        self._judge(kind, believed or not plausible, f"{when}: good numbers are not believed")
        self._judge(kind, not (believed and beyond), f"{when}: numbers beyond the profile's bounds are believed")
        self.tally.counts["numbers"] += len(self.place.table.shown)

    def _read(self, rounds: int) -> None:
        with self._seat() as seat:
            for name, value in self.place.table.wanted.items():
                held = self.place.slave.get(name)
                self._judge("read", held == value, f"{name} is {held:g}, and the numbers mean {value:g}")
            for _ in range(rounds):
                self.place.measure(self.source, self._bounds)
                self._settle(seat)
                self._compare(seat, "read", "measured")

    def _write(self, name: str) -> None:
        """Write a parameter drawn over the maker's range."""
        register, factor = self.place.table[self.place.table.parameters[name][0]], self.place.table.parameters[name][1]
        value = self.source.choice([register.least, register.greatest, *self._drawn(register.least, register.greatest)])
        refusals = [self._refusal(name, asked * factor) for asked in (register.least, register.greatest, value)]
        for refusal in filter(None, refusals):
            self._judge("write", False, f"a {name} of the maker's is refused: {refusal}")
        if refusals[-1]:
            return
        with self._seat({name: value * factor}) as seat:
            held = self.place.slave.get(register.name)
            rounding = 1e-6 * abs(register.greatest) + (0.0 if register.type == "f32" else 0.5)
            self._judge("write", abs(held - value) <= rounding, f"{name} {value!r} arrived as {held!r}")
            self._compare(seat, "write", f"{name} written")

    def _drawn(self, least: float, greatest: float) -> list[float]:
        return [self.source.uniform(least, greatest) for _ in range(6)]

    def _refuse(self) -> None:
        """Let the device, or the driver, refuse what the table forbids."""
        for name, (register_name, factor) in self.place.table.parameters.items():
            self._refuse_value(name, register_name, factor)
        for code in (*NAMED, *PASSING):
            self._exception(code, READS)
        if self.profile.writes or self.profile.setup:
            for code in {*NAMED, *PASSING, self.place.table.protected}:
                self._exception(code, WRITES)

    def _refuse_value(self, name: str, register_name: str, factor: float) -> None:
        """Write values outside the maker's range, and one that this particular device does not accept."""
        register = self.place.table[register_name]
        width = register.greatest - register.least
        drawn = self.source.uniform(LEAST_BEYOND, 1.0)
        for beyond in (LEAST_BEYOND * width, drawn * width):
            for value in ((register.least - beyond) * factor, (register.greatest + beyond) * factor):
                refusal = self._refusal(name, value)
                self._judge("refuse", name in refusal, f"{name} {value:g}: {refusal or 'accepted'}")
        with placed(narrowed(self.place.table, register_name, register.least + 0.5 * width)) as narrow:
            narrow.slave.power_up()
            value = (register.least + self.source.uniform(0.6, 1.0) * width) * factor
            with narrow.seat(lambda link: self._driver(link, {name: value})) as seat:
                seat.run(SET_UP_S)
                refusal = seat.driver.refused or ""
                right = not self._believed(seat) and (name in refusal or "exception 3" in refusal)
                self._judge("refuse", right, f"{name} {value:g}, which the device does not take: {refusal!r}")

    def _refusal(self, name: str, value: float) -> str:
        """Return why the driver refuses a value, "" if it accepts it."""
        try:
            self._driver(ModbusLink(), {name: value})
        except ValueError as error:
            return str(error)
        return ""

    def _exception(self, code: int, functions: tuple[int, ...]) -> None:
        """Let the device raise an exception on reads, or on writes, from its first answer on, and then answer."""
        what = f"exception {code} on {'reads' if functions is READS else 'writes'}"
        with self._seat(ready=False) as seat:
            self.place.slave.raises = dict.fromkeys(functions, code)
            seat.run(SET_UP_S)
            refusal = seat.driver.refused
            self._judge("refuse", not self._believed(seat), f"{what}: numbers are believed")
            if code not in PASSING:
                self._judge("refuse", f"exception {code}" in (refusal or ""), f"{what}: {refusal!r}")
                return
            self.place.slave.raises = {}
            seat.run(SET_UP_S + LOSS_S)
            self._compare(seat, "refuse", f"{what}, over")

    def _faults(self) -> None:
        """Show each fault of the table, and each lookalike, between good numbers."""
        with self._seat() as seat:
            for state in (*self.place.table.faults, *self.place.table.harmless):
                before = {name: self.place.slave.get(name) for name in state.values}
                self.place.slave.show(state)
                self._settle(seat)
                if state in self.place.table.harmless:
                    self._compare(seat, "fault", state.name)
                else:
                    numbers = self._numbers(seat.driver)
                    self._judge("fault", not self._believed(seat), f"{state.name}: {numbers} are believed")
                for name, value in before.items():
                    self.place.slave.put(name, value)
                self.place.measure(self.source, self._bounds, inside=True)
                self._settle(seat)
                self._compare(seat, "fault", f"{state.name}, over")

    def _silence(self) -> None:
        """Let the device go silent, and return with other numbers."""
        with self._seat() as seat:
            self.place.slave.silent = True
            seat.run(LOSS_S + 4.0 * self.period_s)
            self._judge("fault", not self._believed(seat), "silent, and its numbers are believed")
            self._judge("fault", seat.driver.is_lost, "silent, and not lost")
            self.place.measure(self.source, self._bounds, inside=True)
            self.place.slave.silent = False
            seat.run(SET_UP_S + LOSS_S + 4.0 * self.period_s)
            self._compare(seat, "fault", "silent, and back")



    def _restart(self) -> None:
        """Let the device restart, silent for a drawn time: a driver that missed a reply sets it up again."""
        with self._seat(self._ordinary()) as seat:
            timeouts = seat.driver.station.counters.timeouts
            self.place.slave.silent = True
            seat.run(self.source.uniform(0.02, 1.0))
            self.place.slave.power_up()
            self.place.measure(self.source, self._bounds, inside=True)
            seat.run(SET_UP_S + LOSS_S)
            if seat.driver.station.counters.timeouts == timeouts:
                return
            for name, value in self._holds().items():
                held = self.place.slave.get(name)
                self._judge("fault", abs(held - value) <= 0.5 * self._step(name), f"begun anew: {name} holds {held:g}")
            self._compare(seat, "fault", "begun anew")

    def _ordinary(self) -> dict[str, float]:
        """Return a value within its range for each parameter."""
        table = self.place.table
        return {
            name: (0.25 * table[register].least + 0.75 * table[register].greatest) * factor
            for name, (register, factor) in table.parameters.items()
        }

    def _holds(self) -> dict[str, float]:
        """Return the register values after a set-up with ordinary parameters."""
        table = self.place.table
        return dict(table.wanted) | {
            register: 0.25 * table[register].least + 0.75 * table[register].greatest
            for register, _ in table.parameters.values()
        }

    def _step(self, name: str) -> float:
        return 2e-6 * abs(self.place.table[name].greatest) if self.place.table[name].type == "f32" else 1.0
