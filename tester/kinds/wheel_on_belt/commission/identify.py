"""Lists every drive and device that answers, with its identity, for a person to confirm."""

from __future__ import annotations

from typing import Any

from tester.kinds.wheel_on_belt.commission.quiet import QuietSeat
from tester.machine.commission.person import Dialogue, StepRefused, choose
from tester.machine.commission.step import Notes


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
    answer = yield from choose("identify", "are these the devices of this rig?", "yes", "no")
    if answer != "yes":
        raise StepRefused("the person at the rig does not know these devices again: check adapters, node and unit ids")
    notes.values = identities
    notes.text = f"{len(identities)} devices found and recognised"
