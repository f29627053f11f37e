"""Bounds of the section ``interlocks`` that belong to no row: holds, acknowledgements, the cell's zero."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import Parameter
from tester.machine.drive_rows import ACK_WAIT_S

HOLD_AT_MOST_S: Final = Parameter(
    "hold_at_most_s", "s", "60 min", "a hold ends in a controlled stop after this [A]",
    hardest="120 min", because="nobody is expected to attend to a rig with its drives on for longer than that",
)  # fmt: skip
ZERO_STOP_N: Final = Parameter(
    "zero_stop_n", "N", "10 N", "a zero of the cell further off than this is not taken: the run ends [A]",
    hardest="20 N", because="20 N that a tare takes off are a contact as firm as any of these rigs has",
)  # fmt: skip

PARAMETERS: Final[tuple[Parameter, ...]] = (HOLD_AT_MOST_S, ACK_WAIT_S, ZERO_STOP_N)
ABOUT: Final = "holds, acknowledgements, the cell's zero"
"""What these parameters are for."""
