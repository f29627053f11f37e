"""Rows shared by machines with drives: old data, a drive that leaves operation, stops that fail.

A kind supplies its test for standstill, the deadline, its bounds with the harm they prevent, and the texts for the
operator.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

from tester.inputs.rig.parameter import Parameter
from tester.machine.row import ACK, ENDING, POWER_OFF, SELDOM, Compared, Interlock
from tester.machine.watches import at_most, condition
from tester.machine.wires import STALE_CAN_S, STALE_CAN_SCANS, drive_data_allowed_s, drive_data_old

Predicate = Callable[[Any], bool]
"""Predicate over a kind's inputs."""
Seconds = Callable[[Any], float]

ACK_WAIT_S: Final = Parameter(
    "ack_wait_s", "s", "1 s", "an acknowledged drive has reset its fault by then, or it is refused [A]",
    because="a drive with a fault has no power meanwhile",
)  # fmt: skip


def _stops(v: Any) -> bool:
    return v.stopped_s >= 0.0 and not v.stop.creeps


def keeps_power(v: Any) -> bool:
    """Return whether a drive reports power although the last scan disabled the voltage of every drive.

    It repeats old data, or does not obey: only its own watchdog takes the power then.
    """
    return v.voltage_off and not v.readings.drives_disabled


DRIVE_DATA_STALE: Final[Interlock[Any]] = Interlock(
    name="drive data stale",
    cause="no fresh drive data",
    watch=condition(
        "age > stale_can_scans periods, or > stale_can",
        drive_data_old,
        lambda v: Compared(v.readings.now_s - min(v.readings.drive_stamps_s()), drive_data_allowed_s(v), "s"),
    ),
    # A drive that is to come into operation answers every scan from the first, so its data are soon fresh.
    applies=lambda v: v.demand.enabled and (
        v.readings.drives_enabled or v.readings.now_s - v.wanted_since_s > v.parameters[STALE_CAN_S]
    ),
    parameters=(STALE_CAN_SCANS, STALE_CAN_S),
    reset=ACK,
)


def drive_dropped_out(delay: Parameter) -> Interlock[Any]:
    """Return the row for a drive that has left operation although the demand needs it."""
    return Interlock(
        name="drive dropped out",
        cause="a drive left operation by itself (local control, torque off)",
        watch=condition("not OPERATION_ENABLED although wanted", lambda v: not v.readings.drives_enabled),
        applies=lambda v: v.confirmed and v.demand.enabled,
        delay=delay,
        when=SELDOM,
        reset=ACK,
    )


def not_stopping(
    due_s: Seconds, standing: Predicate, cause: str, level: str, parameters: tuple[Parameter, ...]
) -> Interlock[Any]:
    """Return the row for a controlled stop that does not bring the drives to rest ``due_s`` after its begin."""
    return Interlock(
        name="not stopping",
        cause=cause,
        watch=at_most(level, lambda v: v.stopped_s, due_s, "s"),
        applies=lambda v: _stops(v) and not standing(v),
        parameters=parameters,
        when=ENDING,
    )


def quick_stop_failed(due_s: Seconds, standing: Predicate, cause: str, level: str, margin: Parameter) -> Interlock[Any]:
    """Return the row for a quick stop that does not bring the drives to rest ``due_s`` after its begin."""
    return Interlock(
        name="quick stop failed",
        cause=cause,
        watch=at_most(level, lambda v: v.readings.now_s - v.stop.fast_s, due_s, "s"),
        applies=lambda v: _stops(v) and not standing(v),
        parameters=(margin,),
        when=ENDING,
        reaction=POWER_OFF,
    )


def stop_not_ended(cause: str, level: str, timeout: Parameter, *others: Parameter) -> Interlock[Any]:
    """Return the row for a stop that does not end; ``others``: bounds that define the end."""
    return Interlock(
        name="stop not ended",
        cause=cause,
        watch=at_most(level, lambda v: v.readings.now_s - v.mode_since_s, timeout),
        parameters=others,
        applies=_stops,
        when=ENDING,
        reaction=POWER_OFF,
    )
