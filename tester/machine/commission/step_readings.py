"""Readings of the rig for the person's screen during commissioning, and who is on its wires."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import nan
from typing import Any, Final

from drivers.cia402 import State
from tester.machine.commission.commission_step import Dialogue, Notes, StepReading, StepRefused, choose
from tester.machine.commission.jog_axis import JoggedAxis
from tester.machine.commission.quiet_seat import JogSeat, QuietSeat
from tester.machine.commission.stages import in_stages

STATES: Final = {
    State.OPERATION_ENABLED: "has power", State.QUICK_STOP_ACTIVE: "quick stop", State.FAULT_REACTION: "fault",
    State.FAULT: "fault",
}  # fmt: skip
Table = tuple[tuple[str, str, str, int], ...]
"""Label, attribute of the readings, unit, decimals."""


def of_bus(seat: QuietSeat) -> Sequence[StepReading]:
    """Return whether each drive and device answers."""
    drives = [(drive.config.name, drive.online) for drive in seat.devices.drives]
    devices = [*drives, *((device.title, device.driver.ready) for device in seat.devices.modbus)]
    return tuple(StepReading(name, nan, "", 0, "heard" if online else "not heard") for name, online in devices)


def of_axis(axis: JoggedAxis) -> Callable[[JogSeat], Sequence[StepReading]]:
    """Return the readings of one axis: its position, its way in all since the mark, whether it has power."""

    def readings(seat: JogSeat) -> Sequence[StepReading]:
        if axis.name not in seat.believed.drives():
            return ()
        drive, jog = seat.jogging.drive(axis.name), seat.jogging.jog
        config = drive.config
        by_position = config.feedback == "position"
        moved = axis.shown(seat.jogging.moved) if jog is not None and jog.axis == axis.name else nan
        guard = "closed" if seat.guarded() else "open"
        return (
            StepReading(f"{axis.name} {'at' if by_position else 'speed'}", axis.shown(drive.actual),
                        axis.way_unit if by_position else f"{axis.way_unit}/s", 2,
                        STATES.get(drive.state, "no power")),
            StepReading("moved in all", moved, axis.way_unit, 2),
            StepReading("guard, safety chain", nan, "", 0, guard),
            *of_cell(seat),
        )  # fmt: skip

    return readings


def of_cell(seat: QuietSeat) -> Sequence[StepReading]:
    """Return the load cell's readings, without tare."""
    cell = seat.cell
    words = "" if cell.valid else "not valid"
    return tuple(
        StepReading(f"F{name}, raw", value, "N", 2, words) for name, value in zip("xyz", cell.raw, strict=False)
    )


def of_armed(*tables: Table) -> Callable[[Any], Sequence[StepReading]]:
    """Return part of the process image."""

    def readings(seat: Any) -> Sequence[StepReading]:
        image = seat.ctx.readings
        return tuple(
            StepReading(label, float(getattr(image, name)), unit, decimals)
            for table in tables
            for label, name, unit, decimals in table
        )

    return readings


def identify(seat: QuietSeat, notes: Notes) -> Dialogue:
    """List the connected devices; raises StepRefused if the person does not recognise them."""
    identities: dict[str, Any] = {}
    for drive in seat.devices.drives:
        name, identity = drive.config.name, drive.identity
        text = f"node {drive.config.node_id}"
        if identity is not None:
            text += (
                f", vendor 0x{identity.vendor_id:08X}, product 0x{identity.product_code:08X},"
                f" revision 0x{identity.revision:08X}, serial number {identity.serial_number}"
            )
        identities[f"{name} drive"] = text
    for device in seat.devices.modbus:
        config = seat.rig.devices[device.name]
        identities[device.title] = f"line {config.line}, unit {config.unit_id}, profile {config.profile}"
    for name, text in identities.items():
        notes.tell(f"  {name}: {text}")
    unnumbered = [drive.config.name for drive in seat.devices.drives if not drive.config.serial_number]
    if unnumbered:
        notes.tell(
            f"  serial numbers that the rig file does not state (axes.*.serial_number): {', '.join(unnumbered)};"
            " with them, two drives of one make that are swapped are found at every connect"
        )
    notes.values = identities
    notes.text = f"{len(identities)} devices found and recognised"
    yield from in_stages(notes, _recognised)


def _recognised() -> Dialogue:
    answer = yield from choose("identify", "are these the devices of this rig?", "yes", "no")
    if answer != "yes":
        raise StepRefused("the person at the rig does not recognise these devices: check adapters, node and unit ids")
