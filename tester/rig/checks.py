"""What must hold between the sections of a rig file; each section alone is checked by its types."""

from __future__ import annotations

import difflib
from collections.abc import Iterator

from drivers.profiles import ProfileError, load_profile
from tester.rig.config import DeviceConfig, IrThermometerConfig, RigConfig
from tester.rig.press import torque_problem
from tester.source import Location, Problem, Tree

EQUAL_DECELERATIONS = 0.05
"""Wheel and belt slow down alike, in m/s2, within this share [A]: unequal, one stands while the other still turns."""
MAX_BUS_LOAD = 0.5
"""Above this share of the bus the scan rate is refused: bursts of SDO and EMCY need the rest (fieldbus, wire sums)."""
SYNC_BITS, RPDO_BITS, TPDO_BITS = 55, 115, 135
"""Bits of a frame of 0, 6 and 8 bytes with worst-case stuffing and the space between frames."""


def problems_of(rig: RigConfig, tree: Tree) -> list[Problem]:
    """Return what does not fit together, with positions."""
    found = [*_nodes(rig), *_bus_load(rig), *_speeds(rig), *_decelerations(rig), *_lines(rig), *_units(rig)]
    found += [*_profiles(rig), *_press(rig), *_temperatures(rig), *_simulation(rig)]
    return [tree.problem(location, message) for location, message in found]


_Found = Iterator[tuple[Location, str]]


def _nodes(rig: RigConfig) -> _Found:
    taken = {rig.can.node: "the PC"}
    for name, axis in rig.axes.driven().items():
        if axis.node_id in taken:
            yield ("axes", name, "node_id"), f"node {axis.node_id} is {taken[axis.node_id]} already"
        taken.setdefault(axis.node_id, name)
    if not 1 <= rig.can.node <= 127:
        yield ("can", "node"), f"node {rig.can.node} is not a CANopen node (expected 1 to 127)"


def bus_load(rig: RigConfig, scan_hz: float) -> float:
    """Return the share of the CAN bus that cyclic traffic takes at a scan rate, with worst-case stuffing."""
    cycle = SYNC_BITS + len(rig.axes.driven()) * (RPDO_BITS + TPDO_BITS)
    return cycle * scan_hz / rig.can.bitrate


def _bus_load(rig: RigConfig) -> _Found:
    load = bus_load(rig, rig.scan.sliding_hz)
    if load > MAX_BUS_LOAD:
        rate = f"{rig.scan.sliding_hz:g} Hz"
        message = f"{rate} loads the CAN bus with {100 * load:.0f} %, more than {100 * MAX_BUS_LOAD:.0f} %"
        yield ("scan", "sliding"), f"{message}: raise can.bitrate or lower the rate"


def _speeds(rig: RigConfig) -> _Found:
    """A drive that clamps below the rig's limit would run slower than it is asked, silently."""
    wheel = rig.axes.wheel.max_speed * 0.5e-3 * rig.geometry.wheel_diameter_mm
    if wheel < rig.limits.wheel_speed_m_s:
        yield ("axes", "wheel", "max_speed"), f"gives {wheel:.3f} m/s, less than limits.wheel_speed"
    if rig.axes.belt.max_speed < rig.limits.belt_speed_m_s:
        yield ("axes", "belt", "max_speed"), f"{rig.axes.belt.max_speed:g} m/s is less than limits.belt_speed"
    if rig.loops.load.lift_speed_mm_s > rig.axes.press.max_speed:
        yield ("loops", "load", "lift_speed"), "is above axes.press.max_speed"
    if rig.loops.load.acceleration_mm_s2 > min(rig.axes.press.acceleration, rig.axes.press.deceleration):
        yield ("loops", "load", "acceleration"), "is above what axes.press can follow"


def _decelerations(rig: RigConfig) -> _Found:
    radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
    for key in ("deceleration", "quick_stop_deceleration"):
        wheel = float(getattr(rig.axes.wheel, key)) * radius_m
        belt = float(getattr(rig.axes.belt, key))
        if abs(wheel - belt) > EQUAL_DECELERATIONS * belt:
            message = f"wheel {wheel:.3g} m/s2 at the rim, belt {belt:.3g} m/s2: they must be equal within 5 %"
            yield ("axes", "wheel", key), message


def _lines(rig: RigConfig) -> _Found:
    used: dict[tuple[str, int], str] = {}
    for name, device in _devices(rig).items():
        line, unit_id = device.line, device.unit_id
        if line not in rig.lines:
            near = difflib.get_close_matches(line, rig.lines, n=1)
            meant = f", did you mean {near[0]}?" if near else ""
            yield ("devices", name, "line"), f"no such line{meant} (lines has {', '.join(rig.lines)})"
        if not 1 <= unit_id <= 247:
            yield ("devices", name, "unit_id"), f"{unit_id} is not a Modbus address (expected 1 to 247)"
        if (line, unit_id) in used:
            yield ("devices", name, "unit_id"), f"{unit_id} on line {line} is {used[line, unit_id]} already"
        used.setdefault((line, unit_id), name)
    for name, line in rig.lines.items():
        if line.baud <= 0:
            yield ("lines", name, "baud"), "expected a baud rate above 0"


def _devices(rig: RigConfig) -> dict[str, DeviceConfig | IrThermometerConfig]:
    devices = rig.devices
    return {"load_cell": devices.load_cell, "jacket": devices.jacket, "ir_thermometer": devices.ir_thermometer}


def _profiles(rig: RigConfig) -> _Found:
    for name, device in _devices(rig).items():
        try:
            kind = load_profile(device.profile).kind
        except ProfileError as error:
            yield ("devices", name, "profile"), str(error)
            continue
        if kind != name:
            yield ("devices", name, "profile"), f"{device.profile} is a profile of kind {kind} (expected {name})"


def _units(rig: RigConfig) -> _Found:
    due = {"wheel": "rad/s", "belt": "m/s", "press": "mm/s", "sideslip": "deg", "camber": "deg"}
    for name, axis in rig.axes.driven().items():
        if axis.unit != due[name]:
            yield ("axes", name, "unit"), f"the {name} axis is in {due[name]}, not {axis.unit}"
    if not rig.axes.press.digital_io:
        yield ("axes", "press", "digital_io"), "the press drive carries the safety chain's inputs (expected true)"
    if rig.interlocks.stale_inputs_s < 2.0 * rig.axes.press.inputs_period_s:
        message = "is less than two of axes.press.inputs_period: a single lost frame would stop the rig"
        yield ("interlocks", "stale_inputs"), message


def _press(rig: RigConfig) -> _Found:
    problem = torque_problem(rig)
    if problem:
        yield ("axes", "press", "screw"), problem


def _temperatures(rig: RigConfig) -> _Found:
    heat = rig.loops.heat
    if heat.hub_max_c > rig.limits.jacket_c:
        yield ("loops", "heat", "hub_max"), f"{heat.hub_max_c:g} degC is above limits.jacket"
    if heat.hub_min_c >= heat.hub_max_c:
        yield ("loops", "heat", "hub_min"), "is not below hub_max"


def _simulation(rig: RigConfig) -> _Found:
    """A simulated rig has no real wire and a real one no simulated wire: half of each is a mistake."""
    wires = [(("can", "interface"), rig.can.interface)]
    wires += [(("lines", name, "port"), line.port) for name, line in rig.lines.items()]
    for location, wire in wires:
        if (wire == "sim") != rig.simulated:
            message = 'a simulated rig has "sim" here' if rig.simulated else '"sim" is for a simulated rig'
            yield location, f"{message}, and simulated is {'true' if rig.simulated else 'false'}"
