"""The steps of this machine's commissioning, in their order, as data."""

from __future__ import annotations

from functools import partial
from typing import Final

from sim.physics.friction import KNOWN
from tester.kinds.wheel_on_belt.commission import (
    first,
    jog,
    readings,
    relay,
    spring,
    thermometer,
    touch,
    watchdogs,
    weights,
)
from tester.kinds.wheel_on_belt.commission.armed import WheelSeat
from tester.kinds.wheel_on_belt.commission.quiet import jog_seat
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.machine.commission.commission_step import CommissionStep
from tester.machine.commission.hung_weights import calibrate
from tester.machine.commission.jog_axis import JoggedAxis, jog_axis
from tester.machine.commission.person import CommissionPart
from tester.machine.commission.step_readings import identify, of_armed, of_axis, of_bus, of_cell

_BUS: Final = ("can", "lines", "devices")
_CELL: Final = ("devices.load_cell", "lines.load_cell")
_HEAT: Final = ("devices.ir_thermometer", "devices.jacket")
_ALL: Final = (*_BUS, "axes", "geometry", "limits", "loops", "gates", "interlocks", "arming", "wear", "observer")
_HOMED: Final = tuple(f"axes.{axis.name}" for axis in POSITIONED)
_QUIET: Final = partial(jog_seat, jog.SPEEDS)
_JOGGED: Final = tuple(f"jog {axis.name}" for axis in jog.AXES)


def _jog(axis: JoggedAxis) -> CommissionStep:
    return CommissionStep(
        f"jog {axis.name}",
        f"direction and scale of the {axis.name} axis",
        (f"axes.{axis.name}", *(("geometry",) if axis.name == "press" else ())),
        ("identify",),
        _QUIET,
        partial(jog_axis, axis),
        readings=of_axis(axis),
        required=True,
    )


STEPS: Final = (
    CommissionStep("identify", "who is on the wires", (*_BUS, "axes"), (), _QUIET, identify,
         readings=of_bus),
    *(_jog(axis) for axis in jog.AXES),
    CommissionStep("cell", "load cell with hung weights", (*_CELL, "limits"), ("identify",), _QUIET,
         partial(calibrate, weights.PLAN),
         readings=of_cell),
    CommissionStep("spring", "lifting spring of the press", ("axes.press", "geometry"), ("jog press",), _QUIET,
         spring.measure_spring, readings=of_axis(jog.AXES[2])),
    CommissionStep("home", "homing, and whether zero is straight", (*_HOMED, "can", "arming"),
         _JOGGED, WheelSeat, touch.home, readings=readings.of_positions),
    CommissionStep("watchdogs", "drives stop by themselves", ("axes", "can", "arming", "devices.jacket"), _JOGGED,
         watchdogs.TrialSeat, watchdogs.watchdogs, readings=readings.of_trial),
    CommissionStep("relay", "standstill relay, provoked",
         ("arming.standstill_relay", "axes.wheel", "axes.belt", "geometry", "arming"), ("watchdogs",),
         watchdogs.TrialSeat, relay.provoke, readings=readings.of_trial, required=True),
    CommissionStep("touch", "first touch and tare", ("axes", "geometry", "loops", *_CELL), ("cell", "spring", "home"),
         WheelSeat, touch.touch, readings=of_armed(readings.PRESS, readings.FORCES, readings.SPEEDS)),
    CommissionStep("rolling", "speed ratio by rolling", ("axes.wheel", "axes.belt", "geometry"), ("touch",), WheelSeat,
         touch.roll, readings=of_armed(readings.SPEEDS, readings.FORCES)),
    CommissionStep("directions", "crosstalk and misalignment by both directions of slip", _ALL, ("rolling",),
         alone=first.directions),
    CommissionStep("thermometer", "thermometer against a hub soak", (*_HEAT, "geometry", "observer"), ("home",),
         WheelSeat, thermometer.soak, readings=of_armed(readings.HEAT, readings.SPEEDS)),
    CommissionStep("first", "a first condition three times", _ALL, ("rolling", "thermometer"), alone=first.coefficient),
)  # fmt: skip
"""In order of dependence; the heating steps come last, so that the rig cools only once."""

COMMISSIONS: Final = CommissionPart(STEPS, tuple(KNOWN), TwinPerson)
