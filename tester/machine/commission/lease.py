"""A temperature controller left alone: its own lease, or the setpoint that it falls back to, must end its run."""

from __future__ import annotations

from collections.abc import Callable, Generator
from math import inf, isfinite
from typing import Final

from drivers.temperature_controller import TemperatureController
from tester.machine.commission.commission_step import Measured, Notes, StepRefused, Waits, press, wait

RUNS_S: Final = 1.5
"""Time for which it runs with its setpoint, s: three writes of the setpoint, and a reading."""
LEASE_MORE_S: Final = 3.0
"""Time for the controller to report the end of its lease, s [A]: a period of its own and of its readings."""
NO_OUTPUT_PERCENT: Final = 0.5


def left_alone(
    name: str, controller: TemperatureController, ends_s: float, asked_c: float, renew: Callable[[bool], None],
    notes: Notes, more_s: float = LEASE_MORE_S,
) -> Generator[Waits, str, str]:
    """Run a controller, then send nothing until its lease, or its own setpoint, ends the run; return what was seen.

    ``ends_s``: its lease, s; ``asked_c``: the setpoint, degC, that needs no heat; ``renew``: sets whether anything else
    may renew its setpoint; ``more_s``: time for the end to show. Raises StepRefused.
    """
    if not isfinite(asked_c):
        raise StepRefused(f"the {name} reports no temperature: sensor, or its wires")
    yield from press("watchdog heat", f"the {name} runs for {ends_s:g} s without heat and new setpoints")
    renew(False)
    after_s = yield from _run_on(name, controller, asked_c, ends_s + more_s)
    failed = controller.lease_expired
    yield from wait(1.0)  # until there is a new reading of its output
    output = controller.output_percent
    renew(True)
    controller.enable(False)
    yield from wait(1.0)
    kind = "lease" if controller.has_lease else "setpoint that it falls back to"
    if not failed:
        raise StepRefused(
            f"watchdogs: the {name}'s {kind} did not end its heat {after_s:.1f} s after our last setpoint"
            f" (expected {ends_s:g} s): it would heat on without the PC"
        )
    if not abs(output) <= NO_OUTPUT_PERCENT:
        raise StepRefused(f"watchdogs: the {name} gives {output:g} % of its heat after its {kind} has ended that")
    report = {"kind": kind, "read_back_s": ends_s, "after_s": round(after_s, 1), "output_percent": output}
    notes.read("heat: ended without our setpoint", report)
    return f"{kind} over after {after_s:.1f} s (set and read back: {ends_s:g} s)"


def _run_on(name: str, controller: TemperatureController, asked_c: float, most_s: float) -> Measured:
    """Run it at a setpoint, degC, then send nothing for at most ``most_s``; return how long it ran on, s."""
    begun_s, sent_s, ended_s = inf, -inf, -inf

    def running(now_s: float) -> bool:
        nonlocal begun_s, sent_s
        begun_s = min(begun_s, now_s)
        controller.set_setpoint(asked_c)
        controller.enable(True)
        sent_s = now_s
        return now_s - begun_s >= RUNS_S

    yield running
    if controller.lease_expired:
        raise StepRefused(f"watchdogs: the {name} reports that our setpoint does not arrive, though it is sent")

    def over(now_s: float) -> bool:
        nonlocal ended_s
        ended_s = now_s
        return controller.lease_expired or now_s - sent_s > most_s

    yield over
    return ended_s - sent_s
