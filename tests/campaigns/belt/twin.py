"""Runs on the simulated rig whose belt loses 10 % of its grip over 2 km, with wheels that wear three times as fast as
believed.

Conditions and references are short and at 30 degC; wheels need no running in. Warming and soaking in rolling contact
makes up most of the belt's travel: more than a kilometre. The belt's true loss over an interval's metres is known.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.analysis.reference import CounterfaceDrift
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.belt.sets import LOSS, OVER_M
from tests.campaigns.compiled.worker import Silent

WRONG_BELIEFS = ("sim.wear=3", "sim.running_in=0", f"sim.counterface.loss={LOSS}",
                 f"sim.counterface.loss_travel={OVER_M} m")  # fmt: skip
RECIPE = """recipe: does the belt go blunt
specimens: [{{compound: "1#"}}]
replicates: {replicates}
measure:
  wheel_speed: 0.8 m/s
  repeats: 3
  window: 6 rev
  temperature_band: 3 degC
  soak: {{within: 1.5 degC, for: 10 s}}
reference: {{every: 1, temperature: 30 degC{wheel}}}
grids:
  - {{name: one, slip_velocity: 300 mm/s, load: [{loads}], temperature: 30 degC}}
"""
WAYS = {
    "six wheel changes": {"replicates": 7, "wheel": "", "loads": "150 N"},
    "a reserved wheel": {"replicates": 1, "wheel": ", wheel: ref-1", "loads": "120 N, 160 N, 200 N"},
    "one wheel": {"replicates": 1, "wheel": "", "loads": "120 N, 160 N, 200 N"},
}
"""Recipe settings, by name."""


@dataclass(frozen=True, slots=True)
class TwinCase:
    """One run to make."""

    way: str
    seed: int


@dataclass(frozen=True, slots=True)
class TwinFound:
    """The result of a run, and whether its interval contains the belt's true loss over as many metres."""

    case: TwinCase
    stated: bool
    sentence: str
    covered: bool
    over_m: float


def carry_out(case: TwinCase) -> TwinFound:
    """Run a recipe on the simulated rig."""
    with TemporaryDirectory(prefix="belt-") as name:
        recipe = Path(name) / "recipe.yaml"
        recipe.write_text(RECIPE.format(**WAYS[case.way]), encoding="utf-8")
        screen = Silent()
        runs = Path(name) / "runs"
        options = SessionOptions(str(recipe), overrides=WRONG_BELIEFS, out=runs, seed=case.seed, samples=False)
        session = Session(options, screen)
        session.run()
        if session.folder is None:
            raise RuntimeError(" ".join(screen.messages))
        with RunReader(session.folder) as reader:
            results = results_of(reader)
    drift = next(iter(results.watch.drifts.values())) if results.watch is not None else None
    if drift is None:
        return TwinFound(case, False, "no references have a value", False, 0.0)
    return TwinFound(case, drift.apart, drift.sentence("wheel"), holds_truth(drift), drift.over_m)


def holds_truth(drift: CounterfaceDrift) -> bool:
    """Return whether an interval contains the belt's loss over the interval's metres."""
    _, low, high = drift.changed_percent(drift.over_m)
    return low <= 100.0 * ((1.0 - LOSS) ** (drift.over_m / OVER_M) - 1.0) <= high
