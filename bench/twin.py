"""Cost of one transaction of a Modbus line, both ends, and of one tick of the plant on the simulated rig.

Nothing else runs: ``scan`` shows the same inside a whole scan. The load cell's line is ticked at 100 Hz, that of jacket
and thermometer at 20 Hz, with the setpoint asked for in every tick.
"""

from __future__ import annotations

from collections.abc import Callable

from bench.effort import Effort
from bench.figures import Figure
from bench.stopwatch import cpu_us_per
from drivers.modbus import ModbusLink
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from sim.machines.wheel_on_belt.plant import Plant
from sim.machines.wheel_on_belt.rubbing import WheelSetting
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave
from sim.physics.contact import ContactModel
from sim.physics.parameters import SimParameters
from sim.wires.modbus_wire import ModbusWire
from tester.machine.tickers import collector_at_rest

TURNING_RAD_S = 0.8 / 0.045
HEATER_W = 50.0
CELL, THERMOMETER, JACKET = "four_axis_transmitter", "calex_pyrominibus", "simulated_jacket"

PLANT_TICKS: dict[str, tuple[float, float, float, float]] = {
    "plant, sliding at 100 Hz": (0.01, 200.0, 0.5, TURNING_RAD_S),
    "plant, rolling at 20 Hz": (0.05, 50.0, 0.8, TURNING_RAD_S),
    "plant, lifted and turning at 20 Hz": (0.05, 0.0, 0.8, TURNING_RAD_S),
    "plant, standing at 10 Hz": (0.1, 0.0, 0.0, 0.0),
}
"""Tick in s, load in N, speed of the belt in m/s and of the wheel in rad/s."""

Work = Callable[[int], object]


def measure(effort: Effort) -> list[Figure]:
    """Return us of CPU for transactions and ticks, including thermal steps and draws of noise."""
    count = effort.pick(20_000, 2_000)
    figures: list[Figure] = []
    with collector_at_rest():
        figures.append(_timed("load cell: transaction, both ends", _cell_line(), count, effort.runs, 1.0))
        work, transactions = _slow_line()
        share = transactions(count) / count
        figures.append(_timed("jacket and thermometer: transaction, both ends", work, count, effort.runs, share))
        for name, (dt, load_n, belt_m_s, wheel_rad_s) in PLANT_TICKS.items():
            work = _plant_ticks(dt, load_n, belt_m_s, wheel_rad_s)
            figures.append(_timed(name, work, count // 4, effort.runs, 1.0))
    return figures


def _timed(name: str, work: Work, count: int, runs: int, share: float) -> Figure:
    work(count // 10)
    return Figure(name, "us CPU", tuple(cpu_us_per(work, count) / share for _ in range(runs)))


def _plant() -> Plant:
    plant = Plant(SimParameters(), 1)
    plant.install(0, 0, "1#", True)
    plant.begin_repeat(0, 0, 0, WheelSetting(0.1, 200.0, (0.0,), 25.0))
    return plant


def _tick(wire: ModbusWire, link: ModbusLink, now: float) -> None:
    """Serve a line as ``tester.kinds.wheel_on_belt.image.devices`` does."""
    if wire.arrives_s <= now:
        link.feed(wire.read(now), now)
    if now >= link.wants_s:
        link.service(wire, now)


def _cell_line() -> Work:
    wire = ModbusWire(115200, "N", [CellSlave(load_profile(CELL), 1, _plant())])
    link = ModbusLink("rtu", 115200)
    Sensor(load_profile(CELL), 1, link)
    now = 0.0

    def work(count: int) -> None:
        nonlocal now
        for _ in range(count):
            now += 0.01
            _tick(wire, link, now)

    work(10)
    return work


def _slow_line() -> tuple[Work, Callable[[int], int]]:
    """Return a function that does the work of so many ticks, and one that also counts the transactions."""
    plant = _plant()
    jacket, thermometer = ControllerSlave(load_profile(JACKET), 1, plant), IrSlave(load_profile(THERMOMETER), 2, plant)
    wire, link = ModbusWire(38400, "N", [jacket, thermometer]), ModbusLink("rtu", 38400)
    driver = TemperatureController("jacket", load_profile(JACKET), 1, link)
    Sensor(load_profile(THERMOMETER), 2, link)
    now = 0.0

    def work(count: int) -> None:
        nonlocal now
        for _ in range(count):
            now += 0.05
            _tick(wire, link, now)
            driver.enable(True)
            driver.set_setpoint(45.0)

    def counted(count: int) -> int:
        before = wire.requests
        work(count)
        return wire.requests - before

    work(200)
    return work, counted


def _plant_ticks(dt: float, load_n: float, belt_m_s: float, wheel_rad_s: float) -> Work:
    plant = _plant()
    contact = plant.parameters.contact
    press_mm = contact.gap + ContactModel(contact).depth_mm(load_n) if load_n > 0.0 else 0.0

    def work(count: int) -> None:
        for _ in range(count):
            worn_mm = 0.5 * (plant.parameters.wheel.outer_diameter - plant.diameter_mm)
            plant.advance(dt, wheel_rad_s, belt_m_s, press_mm + worn_mm, 0.0, 0.0, HEATER_W)

    return work
