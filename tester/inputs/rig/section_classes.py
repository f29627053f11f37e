"""The classes of the keys that every kind's axes and nodes have: their sections are declared in ``drivers``.

A kind adds those that depend on the axis: ``Inside({**AXIS, "quick_stop_deceleration": Bounded(...)})``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from tester.inputs.rig.key_classes import HIGHER, LOWER, TRUE, Bounded, Classes, Free, Held

DRIVE_HEARTBEAT: Final = Bounded(LOWER, "100 ms", "three are missed before a drive is lost: 0.3 s")
CONSUMER_HEARTBEAT: Final = Bounded(
    LOWER, "250 ms", "a drive keeps its last command: 50 ms more at 400 W are 20 J"
)
WATCHDOG_PROOF: Final = Bounded(HIGHER, TRUE, "else nothing proves that the drives stop without this program")
_ANSWER: Final = Held("the drive that answers at this node with this identity (0x1018): nothing moves before it does")
_SCALE: Final = Held("the jog of the commissioning, without which no run starts, and the axes among themselves")
_KIND: Final = Held("the kind of the machine: the mode and the unit of each axis, and which one carries the inputs")
_HOMED: Final = Held("the zero that a person reads in the commissioning; an axis homes unloaded")
_RAMP: Final = Held("what the drive reads back; a stop that takes longer than its ramp loses its power")
_FORCE: Final = Held("the load cell: the press's torque is compared with it in every contact")
_SPRING: Final = Held("torque and balance in the commissioning; the torque in free travel before every contact")

AXIS: Final[Mapping[str, Classes]] = {
    "name": _ANSWER, "node_id": _ANSWER, "vendor_id": _ANSWER, "product_code": _ANSWER, "serial_number": _ANSWER,
    "profile": _ANSWER, "parameters": _ANSWER,
    "mode": _KIND, "unit": _KIND, "feedback": _KIND,
    "velocity_increments": _SCALE, "position_increments": _SCALE, "acceleration_increments": _SCALE,
    "max_speed_increments": _SCALE, "gear": _SCALE,
    "rated_torque": Held("0x6076 of the drive, within 2 %"),
    "max_speed": _RAMP, "acceleration": _RAMP, "deceleration": _RAMP, "quick_stop_deceleration": _RAMP,
    "max_torque_per_mille": Bounded(LOWER, "4000", "no servo gives more, even for a second [A]", own=True),
    "screw": {
        **dict.fromkeys(
            ("lead", "efficiency_least", "efficiency_most", "drag_least", "drag_most"), _FORCE
        ),
        "spring": _SPRING, "spring_rate": _SPRING,
    },
    "software_limits": Held("the limits and the geometry of the machine"),
    "home_offset": _HOMED, "homing_method": _HOMED, "homing_speed": _HOMED, "homing_zero_speed": _HOMED,
    "home_timeout": Free("an axis that homes for longer is unloaded, and ends at its limits"),
    "position_window": Held("the setpoint: an axis that does not report it as reached is never used"),
    "speed_zero": Held("what the drive reads back (0x606F)"),
    "digital_io": _KIND,
    "inputs_period": Bounded(LOWER, "250 ms", "interlocks.stale_inputs is 500 ms at most: two words", own=True),
    "wiring": Held("the contactor, which must follow its request, and the chain and guard that a person opens"),
    "heartbeat": DRIVE_HEARTBEAT,
    "consumer_heartbeat": CONSUMER_HEARTBEAT,
    "rpdo_deadline": Held("the heartbeat, whose absence stops the drive (consumer_heartbeat)"),
    "proves_watchdog": WATCHDOG_PROOF,
}  # fmt: skip
"""Classes of the keys of an axis (drivers.axis.AxisConfig)."""

_NODE: Final = Held("the node that answers with this identity (0x1018); it measures, and commands nothing")
NODE: Final[Mapping[str, Classes]] = {
    **dict.fromkeys(("name", "node_id", "period", "vendor_id", "product_code", "heartbeat"), _NODE),
    "channels": {
        **dict.fromkeys(("byte", "type", "bit", "scale", "unit"), _NODE),
        "simulated": Free("a real node measures"),
    },
}
"""Classes of the keys of a further node (drivers.canopen.node_config.NodeConfig)."""
