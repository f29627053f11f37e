"""The wheel's load cell with hung weights: the three forces, and the lines for the rig file.

The cell's error enters the budget (``budget.calibrated``).
"""

from __future__ import annotations

from math import hypot
from typing import Final

from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.commission_step import Notes
from tester.machine.commission.hung_channel import HungWay
from tester.machine.commission.hung_weights import CellPlan, HungCell, tell_calibration


def _most_n(rig: Rig) -> float:
    return RigConfig.of(rig).limits.load_n


def _conclude(notes: Notes, hung: HungCell) -> None:
    """Record the error of Fx over Fz, and print the lines for the rig file."""
    gains, standards = hung.gains(), hung.standards()
    ratio = gains["x"] / gains["z"] - 1.0
    sensitivity = hypot(ratio, standards["x"], standards["z"])
    notes.values["cell_sensitivity"] = sensitivity
    tell_calibration(notes, hung.due)
    notes.tell(f"    cell_sensitivity: {100 * sensitivity:.3f} %     # Fx/Fz off by {100 * ratio:+.3f} %, with U")


PLAN: Final = CellPlan(
    ("Fx", "Fy", "Fz"),
    (
        HungWay("z", "Fz", 2, (50.0, 100.0, 200.0, 300.0, 200.0)),
        HungWay("x", "Fx", 0, (50.0, 100.0, 200.0, 100.0)),
        HungWay("y", "Fy", 1, (50.0, 100.0, 200.0)),
    ),
    _most_n,
    _conclude,
)
