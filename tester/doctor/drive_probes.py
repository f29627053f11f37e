"""Probes of the drives: identity, state, objects and scale of each, compared with its axis in the rig file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import pi
from typing import Final

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.dictionary import describe
from drivers.canopen.messages import state_name
from drivers.cia402 import State
from drivers.drive_settings import RATED_TORQUE_SHARE, plan
from drivers.drives.reader import makers_profiles
from drivers.gearing import gear_ratio
from tester.doctor.can_probes import NODE_WIRING
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, note, ok, warning
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN
from tester.run.set_up import mapped, written


def axes(e: Examination) -> Iterator[Finding]:
    """Compare every drive with its axis in the rig file."""
    if not e.can.present:
        return
    configs = e.rig.drives()
    serials = {config.serial_number: name for name, config in configs.items() if config.serial_number}
    for name, config in configs.items():
        if config.node_id not in e.can.present:
            yield _not_there(e, name, config)
            continue
        yield from _identity(e, name, config, serials)
        if config.node_id in e.can.surplus:
            times = e.can.surplus[config.node_id]
            yield fault(
                name, f"node {config.node_id} answered {times} question more than once: two nodes have one node number",
                "unplug one drive after the other and see which still answers; give one drive another number",
            )  # fmt: skip
        yield from _drive_state(e, name, config)
        yield from _objects(e, name, config)


def _not_there(e: Examination, name: str, config: AxisConfig) -> Finding:
    known = {other.node_id for other in (*e.rig.drives().values(), *e.rig.can.nodes.values())}
    for node in sorted({*e.can.present} - known):
        serial = e.can.number(node, (o.IDENTITY, 4))
        same = serial == config.serial_number if config.serial_number else _same_type(e, node, config)
        if same:
            return fault(
                name, f"nothing answers at node {config.node_id}; node {node}, not in the rig file, is such a drive",
                f"set the drive's node number to {config.node_id}, or axes.{name}.node_id to {node}",
            )  # fmt: skip
    state = e.can.traffic.states.get(config.node_id)
    if state is not None:
        return fault(
            name, f"node {config.node_id} sends heartbeats ({state_name(state)}) and answers no SDO request",
            "switch the drive off and on",
        )  # fmt: skip
    return fault(name, f"nothing answers at node {config.node_id}", NODE_WIRING)


def _same_type(e: Examination, node: int, config: AxisConfig) -> bool:
    """Return whether a node is a drive of the axis' manufacturer and product, as far as the rig file states them."""
    if (e.can.number(node, (o.DEVICE_TYPE, 0)) or 0) & 0xFFFF != o.DEVICE_PROFILE:
        return False
    identity = ((1, config.vendor_id), (2, config.product_code))
    return all(not expected or e.can.number(node, (o.IDENTITY, sub)) == expected for sub, expected in identity)


def _identity(e: Examination, name: str, config: AxisConfig, serials: Mapping[int, str]) -> Iterator[Finding]:
    node, can = config.node_id, e.can
    vendor, product, revision, serial = (can.number(node, (o.IDENTITY, sub)) or 0 for sub in (1, 2, 3, 4))
    who = " ".join(
        text for text in (can.text(node, (o.DEVICE_NAME, 0)), can.text(node, (o.HARDWARE_VERSION, 0)),
                          can.text(node, (o.SOFTWARE_VERSION, 0))) if text
    )  # fmt: skip
    seen = f"node {node}: {who or 'no name'}, vendor 0x{vendor:08X}, product 0x{product:08X}, revision 0x{revision:08X}"
    device_type = can.number(node, (o.DEVICE_TYPE, 0)) or 0
    if device_type & 0xFFFF != o.DEVICE_PROFILE:
        yield fault(name, f"{seen}: device type 0x{device_type:08X} is no CiA 402 drive", "look at axes' node numbers")
        return
    profiles = makers_profiles(vendor)
    if profiles and config.profile not in profiles:
        yield warning(
            name, f"{seen}: the maker's profile is {' or '.join(profiles)}, the rig file has {config.profile}",
            f"set axes.{name}.profile: {' or '.join(profiles)}; its units and objects differ from other drives'",
        )  # fmt: skip
    other = serials.get(serial)
    if other is not None and other != name:
        yield fault(
            name, f"node {node} has the serial number {serial}, which the rig file gives to {other}: swapped drives",
            f"exchange the node numbers of the drives of {name} and {other}, or their places in the rig file",
        )  # fmt: skip
        return
    wrong = [
        f"{describe(o.IDENTITY, sub)} is 0x{actual:08X}, the rig file has 0x{expected:08X}"
        for sub, actual, expected in ((1, vendor, config.vendor_id), (2, product, config.product_code),
                                     (4, serial, config.serial_number)) if expected and actual != expected
    ]  # fmt: skip
    if wrong:
        yield fault(
            name, f"{seen}: {'; '.join(wrong)}: another drive than the rig file's",
            "the right drive at this node number, or its own identity and profile in the rig file",
        )  # fmt: skip
    else:
        yield ok(name, f"{seen}, serial number {serial}")


def _drive_state(e: Examination, name: str, config: AxisConfig) -> Iterator[Finding]:
    can, node = e.can, config.node_id
    statusword = can.number(node, (o.STATUSWORD, 0))
    if statusword is not None:
        state = cia402.decode(statusword)
        code = can.number(node, (o.ERROR_CODE, 0)) or 0
        if state in (State.FAULT, State.FAULT_REACTION):
            yield fault(name, f"the drive is in fault: {o.emergency_text(code)}", "look this code up in its manual")
        elif state is State.OPERATION_ENABLED:
            yield fault(name, "the drive is enabled, and no run is under way", "end whatever enabled it")
        if not statusword & cia402.VOLTAGE:
            yield from _no_voltage(e, name, statusword)
        if config.drive.remote and not statusword & cia402.REMOTE:
            yield fault(
                name, f"in local mode: it does not obey the bus (statusword 0x{statusword:04X}, bit 9 = 0)",
                "its key switch, its panel, or the maker's set-up tool",
            )  # fmt: skip
    inputs = can.number(node, (o.DIGITAL_INPUTS, 0)) if config.digital_io else None
    if inputs is not None:
        io, shown = config.io, config.io.from_drive(inputs)
        word = f"0x60FD = 0x{inputs & 0xFFFFFFFF:08X}"
        for mask, what, closed, bit in (
            (INPUT_SAFETY_CHAIN, "safety chain", "healthy", io.safety_chain), (INPUT_GUARD, "guard", "closed", io.guard)
        ):  # fmt: skip
            if shown & mask:
                yield ok(name, f"{what} {closed} (bit {bit}, {word}): look whether it is")
                continue
            yield warning(
                name, f"{what} open (bit {bit} = 0, {word})",
                f"if the {what} is {closed} as you read this, the input's polarity or its wire is wrong: 1 is {closed}",
            )  # fmt: skip


def _no_voltage(e: Examination, name: str, statusword: int) -> Iterator[Finding]:
    """Report a power stage without voltage: a fault where other drives have theirs, since some makes show it late."""
    words = [e.can.number(config.node_id, (o.STATUSWORD, 0)) for config in e.rig.drives().values()]
    text = f"no voltage at its power stage (statusword 0x{statusword:04X}, bit 4 = 0)"
    remedy = "its safe torque off, its main supply, its fuse"
    if any(word is not None and word & cia402.VOLTAGE for word in words):
        yield fault(name, f"{text}, and others have it: it cannot be enabled", remedy)
    else:
        yield note(name, f"{text}, as at every drive: some show it only once enabled", remedy)


def _objects(e: Examination, name: str, config: AxisConfig) -> Iterator[Finding]:
    """Check every object that the set-up needs, and compare ratings and process data with the rig file."""
    answers = e.can.objects.get(config.node_id, {})
    needed = {**written(config), **mapped(config)}
    missing = [describe(*key) for key in needed if key in answers and answers[key].missing
               and key not in config.drive.optional]  # fmt: skip
    if missing:
        yield fault(
            name, f"the drive does not have {len(missing)} of the objects that a set-up writes: {'; '.join(missing)}",
            "its profile has to name them as missing or optional; compare with the maker's EDS",
        )  # fmt: skip
    absent = [key for key in config.drive.optional if key in answers and answers[key].missing]
    for refused in plan(config, absent).refused:
        yield fault(name, refused, "another drive, another profile, or another axis for it in the rig file")
    rated = answers[o.RATED_TORQUE, 0].number if (o.RATED_TORQUE, 0) in answers else None
    expected = config.rated_torque_counts
    actual_nm = (rated or 0) * config.drive.units.rated_torque_nm * config.gear
    foreign = _foreign_units(e, config)
    if rated and foreign and abs(rated - expected) > max(RATED_TORQUE_SHARE * expected, 1.0):
        yield fault(
            name, f"0x6076 holds {rated} in the unit of its maker, the rig file expects {expected:g}",
            f"first axes.{name}.profile: {foreign}",
        )  # fmt: skip
    elif rated and abs(rated - expected) > max(RATED_TORQUE_SHARE * expected, 1.0):
        yield fault(
            name, f"0x6076 rated torque is {actual_nm:.4g} N m, the rig file has {config.rated_torque_nm:g} N m",
            f"every torque would be shown and limited by a factor of {rated / expected:.3g} wrong: correct"
            f" axes.{name}.rated_torque, or the drive's motor data",
        )  # fmt: skip
    if not foreign:
        yield from _scale(e, name, config)
    other = [key for key, value in mapped(config).items() if key in answers and answers[key].number != value]
    if other:
        yield note(name, f"{len(other)} objects of process data differ from the rig file; every connect writes them")


def _foreign_units(e: Examination, config: AxisConfig) -> str:
    """Return the profiles of a drive's maker where the rig file has another: its counts are then in other units."""
    profiles = makers_profiles(e.can.number(config.node_id, (o.IDENTITY, 1)) or 0)
    return "" if config.profile in profiles else " or ".join(profiles)


COUNTED: Final = 1e-3
"""Relative difference within which counts follow from a ratio [A]: they are entered with four digits or more."""
_TURN: Final = {"rad/s": 2.0 * pi, "deg": 360.0}
"""A turn of the shaft in the unit of positions of an axis that turns."""


def _scale(e: Examination, name: str, config: AxisConfig) -> Iterator[Finding]:
    """Compare what a drive holds about speed, encoder and gear with the scale in the rig file."""
    held = written(config)

    def number(index: int, sub: int) -> int:
        return 0 if (index, sub) in held else e.can.number(config.node_id, (index, sub)) or 0

    most, needed = number(o.MAX_PROFILE_VELOCITY, 0), config.max_speed * config.max_speed_counts
    if 0 < most < needed:
        reached = most / config.max_speed_counts
        yield warning(
            name, f"0x607F max profile velocity is {most} counts, {reached:.4g} of max_speed {config.max_speed:g}"
            f" {config.unit}: the drive goes no faster", "raise it in the drive; no run writes it",
        )  # fmt: skip
    turn = _TURN.get(config.unit, 0.0) * config.position_increments
    encoder, turns = number(0x608F, 1), number(0x608F, 2)
    motor, shaft = number(0x6091, 1) or 1, number(0x6091, 2) or 1
    if not turn or encoder <= 1 or not turns:
        return
    counts = encoder / turns * (motor / shaft if motor != shaft else config.gear)
    if gear_ratio(turn / counts, COUNTED) is None:
        yield warning(
            name, f"0x608F and 0x6091 make {counts:.6g} counts a turn of the shaft, position_increments {turn:.6g}:"
            f" no gear explains a factor of {turn / counts:.4g}", f"axes.{name}.position_increments, or the drive's",
        )  # fmt: skip
