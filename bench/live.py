"""A run on the simulated rig with everything on, ticked by the measurement: to a phase, then through it."""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.effort import TopicFailedError
from tester.base import clock
from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import next_tick
from tester.run.folder import Job, beginning_of, work_of
from tester.run.simulated import simulated_ports
from tester.store.writer import RunWriter

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
  soak: {within: 2 degC, for: 2 s}
  max_bursts: 1000
grids:
  - name: sliding
    slip_velocity: 100 mm/s
    load: 100 N
    temperature: 30 degC
wheel: {replace_after: 15 mm}
"""
"""Slip pulses of minutes: little friction heat, a wide temperature band, a long window."""

_POLL_S = 0.1
_CONTACT_N = 20.0
_SLIDING_M_S = 0.02
_PATIENCE_S = 7200.0
_PULSE_S = 300.0
"""A slip pulse of the recipe lasts a little longer, 1000 turns."""


class LiveRun:
    """Rig, drivers, control, executor and store as ``tester run`` builds them; ``now`` is its time in s."""

    def __init__(self, text: str, folder: Path, seed: int = 1) -> None:
        """Build everything; nothing is ticked yet."""
        rig = load_rig("sim")
        loaded = load_checked(text, rig, PART, "bench.yaml")
        work = work_of(loaded.recipe, rig)
        plan = work.plan
        self.writer = RunWriter(folder / "run.db", QUANTITIES, clock=clock.monotonic, utc=clock.utc_now, lossless=True)
        beginning_of(work.parts[0], Job(folder, seed), work)(self.writer)
        ports, self.world, attendant = simulated_ports(rig, seed, None)
        self.run = build_run(RunSetup(rig, plan, ports, attendant, self.writer, Prompts(automatic=True)))
        self.engine = self.run.engine
        self.now = 0.0
        self.ticks = 0
        self._poll_due = -inf
        self._pulse = (0, 0)
        self._pulse_ends = 0.0

    @property
    def sliding(self) -> bool:
        """Whether the wheel slides under load, at the rate of that state."""
        ctx = self.engine.ctx
        readings = ctx.readings
        return ctx.moving and readings.force_z_n > _CONTACT_N and readings.slip_m_s > _SLIDING_M_S

    def tick(self) -> None:
        """Do one turn of the simulated ticker (``tester.machine.tickers.run_simulated``)."""
        now = self.now
        self.ticks += 1
        self.world.advance(now)
        later = next_tick(now, self.run.tick(now), self.world.urgent_s)
        wall = clock.monotonic()
        if wall >= self._poll_due:
            self._poll_due = wall + _POLL_S
        self.now = later

    def until(self, reached: Callable[[], bool]) -> None:
        """Tick until a condition is true; raises TopicFailedError if the run ends first."""
        give_up = self.now + _PATIENCE_S
        while not reached():
            if self.run.finished or self.now > give_up:
                raise TopicFailedError(f"the run did not get there: {self.run.outcome.value} {self.run.reason}")
            self.tick()

    def slide(self, seconds: float) -> None:
        """Tick to a slip pulse that lasts another ``seconds`` (at most 300)."""
        self.until(lambda: self.sliding)
        ctx = self.engine.ctx
        pulse = (ctx.repeat_key, ctx.burst)
        if pulse == self._pulse and self.now + seconds > self._pulse_ends:
            self.until(lambda: not self.sliding)
            self.until(lambda: self.sliding)
            pulse = (ctx.repeat_key, ctx.burst)
        if pulse != self._pulse:
            self._pulse, self._pulse_ends = pulse, self.now + _PULSE_S

    def advance(self, seconds: float) -> None:
        """Tick through ``seconds`` of rig time."""
        end = self.now + seconds
        tick = self.tick
        run = self.run
        while self.now < end:
            tick()
        if run.finished:
            raise TopicFailedError(f"the run ended while it was measured: {run.outcome.value} {run.reason}")

    def close(self) -> None:
        """Release the store."""
        self.writer.close()


@contextmanager
def live_run(text: str, seed: int = 1) -> Generator[LiveRun, None, None]:
    """Yield a run in a folder that is removed at the end."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        live = LiveRun(text, Path(folder), seed)
        try:
            yield live
        finally:
            live.close()
