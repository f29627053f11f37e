"""What the rows of the hub's sensor (``hub``) and of the thermometer (``surface``) share."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter

JUMP_K: Final = Parameter(
    "jump_k", "K", "5 K", "from one reading to the next, surface or hub",
    hardest="10 K",
    because="full output moves the hub by 0.1 K from reading to reading: more than 10 K is no temperature",
)  # fmt: skip
BLIND_S: Final = Parameter(
    "blind_s", "s", "1 s", "after a change of wheel readings are not compared for this long [A]",
    hardest="5 s", because="25 readings: what was on its way has long come",
)  # fmt: skip
STALE_DELAY_S: Final = Parameter(
    "stale_delay_s", "s", "200 ms", "for both [A]", NOT_NEGATIVE,
    hardest="1 s", because="with an age of 1 s ten readings are missing by then",
)  # fmt: skip
