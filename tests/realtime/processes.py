"""Starts the simulated rig and a run on it as users do, and waits by what the rig's state log shows."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from tester.base import clock
from tests.campaigns.acceptance.bench import COMMAND, ROOT
from tests.realtime.state import Row, StateReader

SLIDING_RECIPE = """\
recipe: sliding
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 50
  min_valid: 1
  window: 2000 rev
  temperature_band: 20 K
  soak: {within: 5 degC, for: 1 s}
  max_bursts: 1000
grids:
  - name: sliding
    slip_velocity: 100 mm/s
    load: 100 N
    temperature: 24.2 degC
wheel: {replace_after: 15 mm}
"""
"""Slides some 20 s after its start, for minutes, with the heat on: no pre-grind, no rest, near ambient temperature."""
OVERRIDES = ("sim.noise=0", "sim.thermal.hub_to_shaft=20")
"""No bias of the thermometer, which would decide when sliding begins, and a shaft that takes heat away all the time."""

SLIDING_M_S, LOADED_N = 0.05, 50.0
_LOOK_S = 0.02


class NotReachedError(Exception):
    """Timed out: the awaited state did not come; the message names it and quotes the processes' output."""


class SimProcess:
    """`tester sim` in a folder of its own."""

    def __init__(
        self, folder: Path, overrides: Sequence[str] = OVERRIDES, *, bus_log: bool = False, options: Sequence[str] = ()
    ) -> None:
        """Start it, with further options, and wait until it is ready; raises NotReachedError."""
        self.rig_file, self.bus_log = folder / "rig.yaml", folder / "bus"
        arguments = ["sim", "--write-rig", str(self.rig_file), "--log", str(folder / "state.csv"), *options]
        arguments += [word for override in overrides for word in ("--set", override)]
        arguments += ["--bus-log", str(self.bus_log)] if bus_log else []
        self.errors = folder / "sim.err"
        with self.errors.open("w", encoding="utf-8") as stream:
            self.process = start(arguments, stderr=stream)
        assert self.process.stdout is not None
        self.ready = self.process.stdout.readline()
        if not self.ready.startswith("ready: "):
            raise NotReachedError(f"tester sim: {self.errors.read_text(encoding='utf-8')}")
        self.state = StateReader(folder / "state.csv")

    def until(self, reached: Callable[[Row], bool], at_most_s: float, what: str, run: RunProcess | None = None) -> Row:
        """Wait for a row of the state log; raises NotReachedError after ``at_most_s`` or where the run has ended."""
        give_up = clock.monotonic() + at_most_s
        while clock.monotonic() < give_up:
            for row in self.state.fresh():
                if reached(row):
                    return row
            if run is not None and run.process.poll() is not None:
                raise NotReachedError(f"{what}: the run ended before: {run.said()}")
            clock.sleep_until(clock.monotonic() + _LOOK_S)
        raise NotReachedError(f"{what}: not within {at_most_s:g} s")

    def stop(self) -> int:
        """End it in order and return its exit code."""
        self.process.terminate()
        return self.process.wait(timeout=10.0)


class RunProcess:
    """`tester run` on a rig file."""

    def __init__(self, folder: Path, rig_file: Path, recipe: str = SLIDING_RECIPE) -> None:
        """Start it."""
        (folder / "recipe.yaml").write_text(recipe, encoding="utf-8")
        arguments = ["run", str(folder / "recipe.yaml"), "--rig", str(rig_file), "--yes", "--out", str(folder / "runs")]
        self.errors = folder / "run.err"
        with self.errors.open("w", encoding="utf-8") as stream:
            self.process = start(arguments, stderr=stream)

    def said(self) -> str:
        """Return its standard error, on one line."""
        return " | ".join(self.errors.read_text(encoding="utf-8").splitlines()[-3:])


def start(arguments: Sequence[str], stderr: IO[str]) -> subprocess.Popen[str]:
    """Start `tester` with arguments; its standard output is a pipe."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join((str(ROOT), os.environ.get("PYTHONPATH", "")))}
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, *arguments], stdout=subprocess.PIPE, stderr=stderr, text=True, env=environment
    )


@contextmanager
def sliding(folder: Path, *, bus_log: bool = False) -> Iterator[tuple[SimProcess, RunProcess]]:
    """Give a rig and the run on it, sliding under load with the heat on; both are gone afterwards."""
    folder.mkdir(parents=True, exist_ok=True)
    sim = SimProcess(folder, bus_log=bus_log)
    try:
        run = RunProcess(folder, sim.rig_file)
        try:
            sim.until(slides, 180.0, "sliding under load with the heat on", run)
            yield sim, run
        finally:
            run.process.kill()
            run.process.wait()
    finally:
        sim.process.kill()
        sim.process.wait()


def slides(row: Row) -> bool:
    """Tell whether the wheel slides under load with the heat on."""
    return row.slip_m_s > SLIDING_M_S and row.force_z_n > LOADED_N and row.heater_w > 0.0
