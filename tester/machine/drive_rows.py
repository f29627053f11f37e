"""Rows that machines with drives have alike: old data, a drive that drops out, stops that do not work.

What is a kind's own it hands in: how it knows that its drives stand, by when they must, its bounds with the harm that
they keep away, and what an operator reads.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from tester.inputs.rig.parameter import Parameter
from tester.machine.row import ACK, ENDING, FAST, POWER_OFF, REPAIR, Compared, Interlock
from tester.machine.wires import STALE_CAN_S, STALE_CAN_SCANS, drive_data_allowed_s

Tells = Callable[[Any], bool]
"""Over a kind's inputs."""
Seconds = Callable[[Any], float]

ACK_WAIT_S: Final = Parameter(
    "ack_wait_s", "s", "1 s", "an acknowledged drive has reset its fault by then, or it is refused [A]",
)  # fmt: skip


def drive_data_stale(heard_s: Callable[[Any], tuple[float, ...]]) -> Interlock:
    """Return the row of data that are too old while drives are on; ``heard_s``: when each came, of the readings."""

    def data_old(v: Any) -> bool:
        r = v.readings
        if not (v.demand.enabled and r.drives_enabled):
            return False
        since = r.now_s - drive_data_allowed_s(v)
        return not all(at_s >= since for at_s in heard_s(r))

    return Interlock(
        name="drive data stale",
        cause="no fresh drive data",
        level="age > stale_can_scans periods, or > stale_can",
        condition=data_old,
        compared=lambda v: Compared(v.readings.now_s - min(heard_s(v.readings)), drive_data_allowed_s(v), "s"),
        parameters=(STALE_CAN_SCANS, STALE_CAN_S),
        reaction=FAST,
        reset=ACK,
    )


def drive_dropped_out(delay: Parameter) -> Interlock:
    """Return the row of a drive that was in operation, is wanted there, and is not."""

    def dropped_out(v: Any) -> bool:
        return v.confirmed and v.demand.enabled and not v.readings.drives_enabled

    return Interlock(
        name="drive dropped out",
        cause="a drive left operation by itself (local control, torque off)",
        level="not OPERATION_ENABLED although wanted",
        condition=dropped_out,
        delay=delay,
        reaction=FAST,
        reset=ACK,
    )


def not_stopping(
    due_s: Seconds, standing: Tells, cause: str, level: str, parameters: tuple[Parameter, ...]
) -> Interlock:
    """Return the row of a controlled stop that does not bring the drives to a stand ``due_s`` after it began."""

    def ramp_over(v: Any) -> bool:
        if v.stop.creeps or not v.stopped_s >= 0.0 or standing(v):
            return False
        return not (v.stopped_s <= due_s(v))

    return Interlock(
        name="not stopping",
        cause=cause,
        level=level,
        condition=ramp_over,
        compared=lambda v: Compared(v.stopped_s, due_s(v), "s"),
        parameters=parameters,
        when=ENDING,
        reaction=FAST,
        reset=REPAIR,
    )


def quick_stop_failed(due_s: Seconds, standing: Tells, cause: str, level: str, margin: Parameter) -> Interlock:
    """Return the row of a quick stop that does not bring the drives to a stand ``due_s`` after it began."""

    def quick_stop_over(v: Any) -> bool:
        if v.stop.creeps or not v.stopped_s >= 0.0 or standing(v):
            return False
        return not (v.readings.now_s - v.stop.fast_s <= due_s(v))

    return Interlock(
        name="quick stop failed",
        cause=cause,
        level=level,
        condition=quick_stop_over,
        compared=lambda v: Compared(v.readings.now_s - v.stop.fast_s, due_s(v), "s"),
        parameters=(margin,),
        when=ENDING,
        reaction=POWER_OFF,
        reset=REPAIR,
    )


def stop_not_ended(cause: str, level: str, timeout: Parameter, *others: Parameter) -> Interlock:
    """Return the row of a stop that has not come to its end; ``others``: bounds by which the end is known."""

    def endless(v: Any) -> bool:
        if v.stop.creeps or not v.stopped_s >= 0.0:
            return False
        return not (v.readings.now_s - v.mode_since_s <= v.parameters[timeout])

    return Interlock(
        name="stop not ended",
        cause=cause,
        level=level,
        condition=endless,
        compared=lambda v: Compared(v.readings.now_s - v.mode_since_s, v.parameters[timeout], "s"),
        parameters=(timeout, *others),
        when=ENDING,
        reaction=POWER_OFF,
        reset=REPAIR,
    )
