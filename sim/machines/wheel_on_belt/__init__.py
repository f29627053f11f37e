"""A rubber wheel pressed on an abrasive belt: plant, rig and faults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.hands import COUNT, FLAG, REPEAT, TEXT, VALUES, Argument, Verb
from sim.machines import SimulatedMachine
from sim.machines.wheel_on_belt.rig import WheelRig

if TYPE_CHECKING:
    from sim.faults.language import FaultLanguage
    from sim.rig import RigSpec

LOG_COLUMNS = (
    "wheel_m_s", "belt_m_s", "slip_m_s", "force_z_n", "press_mm", "heater_w", "hub_c", "surface_c",
)  # fmt: skip
"""The plant's true values (``heater_w`` behind the contactor)."""
LOG_DECIMALS = (5, 5, 5, 3, 4, 3, 3, 3)


def log_row(rig: WheelRig) -> tuple[float, ...]:
    """Return a value for each of LOG_COLUMNS."""
    plant, axes = rig.plant, rig.axes
    wheel_m_s = axes["wheel"].axis.value * 0.5e-3 * plant.diameter_mm
    return (
        wheel_m_s, axes["belt"].axis.value, plant.slip_m_s, plant.force_z_n, axes["press"].axis.position,
        rig.heat_flowing_w, plant.heat.hub_c, plant.surface_c,
    )  # fmt: skip


def _language(spec: RigSpec) -> FaultLanguage:
    from sim.faults.common import with_sensors
    from sim.machines.wheel_on_belt.faults import LANGUAGE

    return with_sensors(LANGUAGE, spec)


_WHEEL = (Argument("specimen", COUNT), Argument("wheel", COUNT), Argument("compound", TEXT))
_WORN = (*_WHEEL, Argument("diameter_mm", "mm"), Argument("sliding_m", "m"))
VERBS = (
    Verb(
        "wheel", "install", "mount a new wheel; yes: of a new specimen, after the rig has cooled down",
        (*_WHEEL, Argument("new_specimen", FLAG)),
    ),
    Verb("again", "mount_again", "mount an earlier wheel again: cold diameter, sliding distance", _WORN),
    Verb("same", "keep", "the same, unless that wheel is on already", _WORN),
    Verb("cover", "cover", "put a belt of this name on, clean", (Argument("surface", TEXT),)),
    Verb("belt", "belt_travelled", "wear a fresh belt by its travel under load", (Argument("travel_m", "m"),)),
    Verb(
        "weight", "hang", "hang a weight on the load cell; zeros remove it",
        (Argument("fx", "N"), Argument("fy", "N"), Argument("fz", "N")),
    ),
    Verb(REPEAT.word, REPEAT.method, REPEAT.about, (*REPEAT.arguments, Argument("held", VALUES))),
)  # fmt: skip

MACHINE = SimulatedMachine(WheelRig, _language, LOG_COLUMNS, log_row, LOG_DECIMALS, VERBS)
