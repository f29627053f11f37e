"""What is known to stand, to be open or to be unloaded: old and unknown is none of these. Several rows ask for it."""

from __future__ import annotations

from math import isfinite
from typing import Final

from tester.inputs.rig.parameter import Direction, Parameter
from tester.kinds.wheel_on_belt.interlocks.contact import UNLOADED_N
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs
from tester.machine.wires import STALE_INPUTS_S

STANDING_M_S: Final = Parameter(
    "standing_m_s", "m/s", "20 mm/s", "a drive slower than this stands [A]: forty times the noise of its speed",
    hardest="50 mm/s", because="0.05 m/s is the creep that the arming proof calls moving",
)  # fmt: skip
SPEEDS_OLD_S: Final = Parameter(
    "speeds_old_s", "s", "500 ms", "a stop does not end on speeds, force or position older than this [A]",
    hardest="1 s",
    because="the next step of a stop that does not work begins a second after it: by then it must be known to fail",
)  # fmt: skip
CLEAR_MM: Final = Parameter(
    "clear_mm", "mm", "0.5 mm", "this far off the known contact the press is clear, whatever the cell shows [A]",
    direction=Direction.HIGHER, hardest="0.2 mm",
    because="four times the runout of the tread, which is 0.05 mm peak to peak",
)  # fmt: skip


def standing(v: Inputs) -> bool:
    """Tell whether wheel and belt are known to stand; what is old or unknown is not standing."""
    r, p = v.readings, v.parameters
    since, slow = r.now_s - p[SPEEDS_OLD_S], p[STANDING_M_S]
    return (
        r.wheel_at_s >= since
        and r.belt_at_s >= since
        and -slow < r.wheel_speed_m_s < slow
        and -slow < r.belt_speed_m_s < slow
    )


def contactor_open(v: Inputs) -> bool:
    """Tell whether the heater's contactor is known to be open."""
    r = v.readings
    return not r.contactor_closed and r.now_s - r.inputs_at_s <= v.parameters[STALE_INPUTS_S]


def unloaded(v: Inputs) -> bool:
    """Tell whether the contact is known to be open: by a fresh force, or by the press standing clear of it.

    The position only counts where the cell says nothing: it is stale, invalid, or repeats itself.
    """
    r, old_s = v.readings, v.parameters[SPEEDS_OLD_S]
    if r.cell_valid and r.now_s - r.cell_at_s <= old_s:
        if r.force_z_n < UNLOADED_N:
            return True
        if r.now_s - r.cell_changed_s <= old_s:
            return False
    touched_mm = v.contact.contact_mm
    known = isfinite(touched_mm) and r.now_s - r.press_at_s <= old_s
    return known and r.press_mm <= touched_mm - v.parameters[CLEAR_MM]
