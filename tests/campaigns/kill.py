"""`python -m tests.campaigns.kill [--sample | --full] [--keep DIR]`: the process dies, the rig must stop.

Each kill: `tester sim` in a process of its own, `tester run` on the rig file that it writes; while the wheel slides
under load with the heat on, the run receives SIGKILL. The rig's own log then shows when the devices alone stopped the
drives and switched the heat off. Then a new run must be able to take the rig over. Once, the run is paused for 300 ms
(SIGSTOP) instead: the drives stop by their watchdog, and the run trips when it continues. Prints a line a figure; exit
code 1 where one misses.
"""

from __future__ import annotations

import argparse
import random
import signal
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.base import clock
from tester.kinds import load_rig
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.realtime.processes import NotReachedError, RunProcess, SimProcess, sliding
from tests.realtime.state import Row, for_good, since

KILLS = 20
SAMPLE = 2
WATCHDOG_S = 0.25
"""Limit: both drives at standstill within this plus their ramp, v/a."""
HEAT_OFF_S = 3.0
"""Limit: no heat after this."""
STANDING_M_S, UNLOADED_N = 0.01, 5.0
"""Standstill and lifted, by the safety figures."""
WATCHED_S = 4.0
STALL_S = 0.3
SEED = 1


@dataclass(frozen=True, slots=True)
class Aftermath:
    """The rig's reaction to the loss of its controller; seconds since the loss."""

    standstill_s: float
    ramp_s: float
    heat_off_s: float
    unloaded_s: float
    heater_w: float

    @property
    def stopped_in_time(self) -> bool:
        return self.standstill_s <= WATCHDOG_S + self.ramp_s

    @property
    def cold_in_time(self) -> bool:
        return self.heat_off_s <= HEAT_OFF_S

    def __str__(self) -> str:
        return (
            f"standstill after {1e3 * self.standstill_s:.0f} ms (asked {1e3 * (WATCHDOG_S + self.ramp_s):.0f}), "
            f"heat off after {1e3 * self.heat_off_s:.0f} ms (was {self.heater_w:.0f} W), "
            f"unloaded after {1e3 * self.unloaded_s:.0f} ms"
        )


def aftermath(rows: list[Row], gone_s: float, quick_stop_m_s2: float) -> Aftermath:
    """Read from the log what happened after ``gone_s``, on the machine's monotonic clock."""
    last = [row for row in rows if row.clock_s < gone_s][-1]
    after = since(rows, gone_s)
    stood = for_good(after, lambda row: max(abs(row.wheel_m_s), abs(row.belt_m_s)) < STANDING_M_S)
    cold = for_good(after, lambda row: row.heater_w == 0.0)
    free = for_good(after, lambda row: row.force_z_n < UNLOADED_N)
    speed = max(abs(last.wheel_m_s), abs(last.belt_m_s))
    return Aftermath(stood - gone_s, speed / quick_stop_m_s2, cold - gone_s, free - gone_s, last.heater_w)


def watch(sim: SimProcess, gone_s: float) -> Aftermath:
    """Let the rig run on for a while and return its reaction."""
    rig = load_rig(sim.rig_file)
    slowest = min(rig.axes.belt.quick_stop_deceleration,
                  rig.axes.wheel.quick_stop_deceleration * 0.5e-3 * rig.geometry.wheel_diameter_mm)  # fmt: skip
    sim.until(lambda row: row.clock_s >= gone_s + WATCHED_S, 2.0 * WATCHED_S + 10.0, "the rig living on")
    return aftermath(sim.state.rows, gone_s, slowest)


def kill(folder: Path, after_s: float, *, again: bool) -> tuple[Aftermath, bool]:
    """Kill a run ``after_s`` into its sliding; ``again``: check whether a new run can take the rig over."""
    with sliding(folder) as (sim, run):
        clock.sleep_until(clock.monotonic() + after_s)
        gone_s = clock.monotonic()
        run.process.kill()
        found = watch(sim, gone_s)
        if not again:
            return found, True
        second = RunProcess(folder, sim.rig_file)
        try:
            sim.until(lambda row: row.controlled > 0.0 and row.wheel_m_s > 0.5, 60.0, "a new run turning", second)
        finally:
            second.process.kill()
            second.process.wait()
        return found, True


def stall(folder: Path) -> list[Figure]:
    """Pause a run for a while, then let it continue."""
    with sliding(folder) as (sim, run):
        gone_s = clock.monotonic()
        run.process.send_signal(signal.SIGSTOP)
        clock.sleep_until(gone_s + STALL_S)
        run.process.send_signal(signal.SIGCONT)
        found = watch(sim, gone_s)
        code = run.process.wait(timeout=30.0)
        output = run.said()
    name = f"stopped for {1e3 * STALL_S:.0f} ms"
    return [
        holds(f"{name}: drives", found.stopped_in_time, str(found), "250 ms + v/a, by their own watchdog"),
        equal(f"{name}: exit code (tripped)", code, 5),
        holds(f"{name}: trip", "trip" in output, output, "a trip with its reason"),
    ]


def measure(folder: Path, kills: int) -> list[Figure]:
    """Kill the requested number of runs and print each result as it comes; return the figures."""
    moments = random.Random(SEED)
    found: list[Aftermath] = []
    lost = 0
    taken_over = False
    for number in range(kills):
        try:
            one, again = kill(folder / f"kill-{number}", moments.uniform(0.0, 2.0), again=number == 0)
        except NotReachedError as error:
            lost += 1
            print(f"kill {number + 1}: {error}", flush=True)
            continue
        taken_over = taken_over or (number == 0 and again)
        found.append(one)
        print(f"kill {number + 1}: {one}", flush=True)
    stopped = sum(one.stopped_in_time for one in found)
    cold = sum(one.cold_in_time for one in found)
    figures = [
        equal("runs that slid until they were killed", kills - lost, kills),
        equal("both drives at standstill within 250 ms + v/a", f"{stopped} of {kills}", f"{kills} of {kills}"),
        equal("heat at zero within 3 s", f"{cold} of {kills}", f"{kills} of {kills}"),
        equal("a new run takes the rig over", taken_over, True),
    ]
    if found:
        worst = max(one.standstill_s - one.ramp_s for one in found)
        figures.append(at_most("slowest standstill, without its ramp", 1e3 * worst, 1e3 * WATCHDOG_S, "ms", 0))
        figures.append(at_most("slowest heat off", max(one.heat_off_s for one in found), HEAT_OFF_S, "s"))
    if hasattr(signal, "SIGSTOP"):
        try:
            figures += stall(folder / "stall")
        except NotReachedError as error:
            figures.append(holds("stopped for a while", False, str(error), "a run that slides"))
    return figures


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.kill", description="Kill the process, watch the rig.")
    extent = parser.add_mutually_exclusive_group()
    extent.add_argument("--sample", action="store_true", help=f"{SAMPLE} kills (default)")
    extent.add_argument("--full", action="store_true", help=f"{KILLS} kills")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="keep logs and runs in this folder")
    read = parser.parse_args(arguments)
    with TemporaryDirectory(prefix="kill-", ignore_cleanup_errors=True) as temporary:
        figures = measure((read.keep or Path(temporary)).resolve(), KILLS if read.full else SAMPLE)
    for figure in figures:
        print(figure, flush=True)
    return 0 if all(figure.ok for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
