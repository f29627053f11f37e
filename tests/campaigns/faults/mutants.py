"""Seeded bugs of the control code: does the campaign detect them?

Each mutant is put into a copy of the source tree, never into the tree itself, and hunted there by a process of its own
(``--probe``): the recipes must still run to their end, the sample campaign and the stateful test must find nothing,
every row of the interlock table must be the first cause of its faults, and a wheel's first contact must detect what
turns wrongly. Any check that detects something kills the mutant. Besides the bugs written by hand, each row is masked.
The unchanged copy is checked first and must pass.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import unittest
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from tests.campaigns.faults.first_up import FIRST
from tests.campaigns.faults.track import FAULTS as TRACK_FAULTS
from tests.campaigns.faults.track import FIRST as TRACK_FIRST
from tests.campaigns.faults.track import GRID as TRACK_GRID
from tests.campaigns.faults.track import fits

ROOT = Path(__file__).resolve().parents[3]
COPIED = ("tester", "drivers", "sim", "recipes", "tests")
ASKED_FOR = 0.9
"""Share of the mutants that must be killed: 18 of 20."""
SHORT_CASES, PROBED = 90, 420
"""Cases of the short recipe, and of the three of the grid."""
FIRST_CONTACT = "tests/tester/kinds/wheel_on_belt/procedures/test_first_contact.py"
AFTER_TRIP, AFTER_TRIP_CASES = "after a trip", 110
"""In place of an interlock: cases of tests.campaigns.aftertrip are tried first."""
BATCH = 70
"""Cases between two looks at the result: each batch runs its recipes anew."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """One bug: a text in a file, replaced by another; ``row`` is the interlock it concerns, looked at first.

    ``kind``: of machine, whose campaign hunts it.
    """

    name: str
    path: str
    old: str
    new: str
    row: str = ""
    kind: str = "wheel_on_belt"


_CONTROL, _STOPS = "tester/machine/control.py", "tester/kinds/wheel_on_belt/control/stop_modes.py"
_SAFE, _MAY = "tester/kinds/wheel_on_belt/control/stop_modes.py", "tester/kinds/wheel_on_belt/control/permissives.py"
_ROWS = "tester/kinds/wheel_on_belt/interlocks"
_TABLE, _WIRES, _MOTION = "tester/machine/interlock_table.py", "tester/machine/wires.py", f"{_ROWS}/motion.py"
_LOAD, _HUB = "tester/kinds/wheel_on_belt/interlocks/load.py", "tester/kinds/wheel_on_belt/interlocks/hub.py"
_CONTACT = "tester/kinds/wheel_on_belt/procedures/first_contact.py"


def _masked(name: str, kind: str = "wheel_on_belt") -> Mutant:
    """Return the mutant in which a row of the table is never evaluated."""
    old = "for row in table.rows if row.when is when)"
    return Mutant(f"row masked: {name}", _TABLE, old, f"{old[:-1]} and row.name != {name!r})", name, kind)


def _powered(kind: str) -> Mutant:
    """Return the mutant in which no drive loses its voltage half a second after a stop."""
    old = "        out.voltage_off = now - state.unwanted_s > VOLTAGE_S\n"
    return Mutant("voltage stays after a stop", _CONTROL, old, "        out.voltage_off = False\n", AFTER_TRIP, kind)


BY_HAND: tuple[Mutant, ...] = (
    Mutant("a comparison inverted: overload", _LOAD,
           'at_most("Fz > {}", _force_n,', 'at_least("Fz > {}", _force_n,'),
    Mutant("a comparison inverted: standing under load", _MOTION,
           "if v.turning is belt_moves:", "if v.turning is not belt_moves:"),
    Mutant("a comparison inverted: overshoot", _LOAD,
           '_force_n, _most_n, "N"', 'lambda v: -_force_n(v), _most_n, "N"'),
    Mutant("a comparison inverted: wheel speed", _MOTION,
           "return wheel.low_m_s - error, v.readings.wheel_speed_m_s, wheel.high_m_s + error",
           "return wheel.high_m_s + error, v.readings.wheel_speed_m_s, wheel.low_m_s - error"),
    Mutant("a delay x 10: stale temperatures", _HUB,
           "applies=lambda v: not v.attended,\n    delay=STALE_DELAY_S,",
           "applies=lambda v: not v.attended,\n    delay=JACKET_DELAY_S,"),
    Mutant("a delay x 10: load overshoot", _LOAD,
           "    delay=OVERLOAD_DELAY_S,\n", "    delay=FROZEN_CELL_S,\n"),
    Mutant("a level made an edge", _CONTROL,
           "        state.held = now_held\n        state.tripped",
           "        now_held, state.held = now_held & ~state.held, now_held\n        state.tripped"),
    Mutant("an early return hides the other levels", _TABLE,
           "        if v.lifting_s >= 0.0 or v.resting or v.unpowered:\n",
           "        if found & 1:\n            return 0\n        if v.lifting_s >= 0.0 or v.resting or v.unpowered:\n"),
    Mutant("stale accepted: drives", _WIRES,
           "return allowed if allowed < most else most", "return 1e9"),
    Mutant("stale accepted: load", _LOAD,
           "        _cell_answered_s,\n", "        lambda v: 1e-9 * (v.readings.now_s - v.readings.cell_at_s),\n"),
    Mutant("not a number passes: hub", _HUB,
           "_hub_answered_s, STALE_JACKET_S", "lambda v: max(0.0, _hub_answered_s(v)), STALE_JACKET_S"),
    Mutant("not a number passes: every limit that is a parameter", _TABLE,
           "not (number(v) <= limit_value)", "number(v) > limit_value"),
    Mutant("acknowledged without the cause gone", _CONTROL,
           "        holding = (state.held | table.still_there(self.view) & state.tripped) & ~table.warnings\n",
           "        holding = 0\n"),
    Mutant("the drives do not watch our heartbeat", "drivers/servo_setup.py",
           "    watched = heartbeat.consumer_entry(pc_node_id, config.consumer_heartbeat_s)\n", "    watched = 0\n"),
    Mutant("a unit factor 1000: late scans", _WIRES,
           "lambda v: v.late_s, LATE_SCAN_S", "lambda v: 1e-3 * v.late_s, LATE_SCAN_S"),
    Mutant("safe outputs without: heat off", _SAFE, "    setpoints.heat = False\n", ""),
    Mutant("safe outputs without: contactor off", _SAFE, "    setpoints.contactor = False\n", ""),
    Mutant("safe outputs without: lift", _SAFE,
           "    setpoints.press_mm_s = -rig.axes.press.max_speed if fast else -rig.loops.load.lift_speed_mm_s\n", ""),
    Mutant("safe outputs without: belt to zero", _SAFE, "    setpoints.belt_m_s = 0.0\n", ""),
    Mutant("safe outputs without: quick stop", _SAFE, "    setpoints.quick_stop = fast\n", ""),
    Mutant("no power off when the lift has failed", _CONTROL, "            state.setpoints.power_off = True\n",
           "            state.setpoints.power_off = False\n"),
    Mutant("heat without the wheel seen turning", _MAY,
           "now - state.turning_since_s >= p[TURNING_CONFIRMED_S]", "now >= 0.0"),
    Mutant("latched before the contact is open", _STOPS,
           "return standing(view) and lifted and unloaded(view)", "return standing(view)"),
    Mutant("first contact: a wheel touched too early is taken", _CONTACT,
           "if early or not place_mm <= expected_mm + self.off_mm:",
           "if not place_mm <= expected_mm + self.off_mm:"),
    Mutant("first contact: a wheel touched too late is taken", _CONTACT,
           "if early or not place_mm <= expected_mm + self.off_mm:", "if early:"),
    Mutant("first contact: friction need not turn round", _CONTACT,
           "if not (faster.sign < 0.0 < slower.sign):", "if not (faster.sign < 0.0 or 0.0 < slower.sign):"),
    Mutant("first contact: friction may turn the wrong way round", _CONTACT,
           "if not (faster.sign < 0.0 < slower.sign):", "if not (faster.sign * slower.sign < 0.0):"),
    Mutant("first contact: only slowly", _CONTACT,
           "SpeedSweep(slow, share * slow + creep), SpeedSweep(fast, share * fast + creep),",
           "SpeedSweep(slow, share * slow + creep),"),
)  # fmt: skip
"""Bugs by hand; in addition, each row of the interlock table that is the first cause of something is masked."""

MASKED = tuple(_masked(name) for name in dict.fromkeys(row.interlock for row in FIRST))
TRACK = "specimen_on_track"
_T_ROWS, _T_CONTROL = "tester/kinds/specimen_on_track/interlocks", "tester/kinds/specimen_on_track/control.py"
TRACK_BY_HAND: tuple[Mutant, ...] = (
    _powered(TRACK),
    Mutant("output without effect is not added up", _T_CONTROL,
           "        view.unanswered_s = max(view.full_s, abs(view.excess_s))\n", "        view.unanswered_s = 0.0\n",
           "air sensor frozen", TRACK),
    Mutant("a runaway chamber passes", f"{_T_ROWS}/chamber.py",
           "abs(v.readings.air_c - v.arrived_c), RUNAWAY_K", "v.readings.air_c - v.arrived_c - 1e3, RUNAWAY_K",
           "chamber runaway", TRACK),
    Mutant("a unit factor 1000: late scans", _WIRES,
           "lambda v: v.late_s, LATE_SCAN_S", "lambda v: 1e-3 * v.late_s, LATE_SCAN_S", "scan late", TRACK),
    Mutant("stale accepted: drives", _WIRES, "return allowed if allowed < most else most", "return 1e9",
           "drive data stale", TRACK),
    Mutant("a deaf cell passes on a film", f"{_T_ROWS}/witness.py", "return max(deaf_n, HALF * least_mu * load_n)",
           "return -1e3", "contact lost", TRACK),
    Mutant("no height is too low", f"{_T_ROWS}/witness.py", "return -(v.parameters[WEAR_MM] + thick_mm), ",
           "return -1e3, ", "arm off its height", TRACK),
    Mutant("the least friction is not lowered", f"{_T_ROWS}/witness.py", "return 0.0 < LOW * least_mu < lost_share",
           "return False", "arm off its height", TRACK),
)  # fmt: skip
"""Bugs of the second kind's control by hand."""
MUTANTS = (*BY_HAND, _powered("wheel_on_belt"), *MASKED)
TRACK_MUTANTS = (
    *TRACK_BY_HAND, *(_masked(name, TRACK) for name in dict.fromkeys(row.interlock for row in TRACK_FIRST))
)  # fmt: skip


def copy_tree(to: Path) -> None:
    """Copy the source tree."""
    for name in COPIED:
        shutil.copytree(ROOT / name, to / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", to / "pyproject.toml")


def apply(mutant: Mutant, tree: Path) -> None:
    """Put a mutant into a copy. Raises ValueError unless its text is there exactly once."""
    path = tree / mutant.path
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise ValueError(f"mutant {mutant.name!r}: its text stands {text.count(mutant.old)} times in {mutant.path}")
    path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")


def hunt(mutant: Mutant | None, kind: str = "wheel_on_belt") -> tuple[str, str]:
    """Hunt a mutant, or the unchanged tree with a kind's campaign, in a copy.

    Return its name and what detected it ("" if nothing).
    """
    with TemporaryDirectory() as folder:
        tree = Path(folder)
        copy_tree(tree)
        if mutant is not None:
            apply(mutant, tree)
        environment = {**os.environ, "PYTHONPATH": folder, "PYTHONDONTWRITEBYTECODE": "1"}
        row, kind = (mutant.row, mutant.kind) if mutant is not None else ("", kind)
        done = subprocess.run(
            [sys.executable, "-m", "tests.campaigns.faults.mutants", "--probe", "--row", row, "--kind", kind],
            cwd=tree, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
    lines = (done.stdout.strip() or done.stderr.strip()).splitlines()
    return mutant.name if mutant is not None else "unchanged", (lines[-1] if lines else "?") if done.returncode else ""


def probe(row: str = "", kind: str = "wheel_on_belt") -> str:
    """Return what is wrong with the tree this runs in, "" if nothing is found.

    If an interlock is given its faults are tried first, otherwise the quick checks.
    """
    from tests.campaigns.faults.recipes import GRID

    found = _after_trip(kind) if row == AFTER_TRIP else _rows(row, kind) if row else ""
    if kind == TRACK:
        return found or _rows(kind=kind) or _recipes(TRACK_GRID, SHORT_CASES, TRACK_FAULTS) or _after_trip(kind)
    return (
        found
        or _recipes(("short",), SHORT_CASES)
        or _first_contact()
        or _late()
        or _stateful()
        or _rows()
        or _recipes(GRID, PROBED)
    )


def _after_trip(kind: str) -> str:
    """Check that every axis loses its power after trips."""
    from tests.campaigns.aftertrip import SAMPLE, judged

    with redirect_stdout(StringIO()) as output:
        met = judged(kind, SAMPLE[kind], AFTER_TRIP_CASES, 29)
    return "" if met else output.getvalue().strip().splitlines()[-1].strip()


def _rows(only: str = "", kind: str = "wheel_on_belt") -> str:
    """Check that rows of the interlock table are the first cause of their faults."""
    from tests.campaigns.faults.first_up import conduct

    rows = [row for row in (TRACK_FIRST if kind == TRACK else FIRST) if only in ("", row.interlock)]
    for row, cause in conduct(rows).items():
        if cause != row.interlock:
            return f"{row.faults[0]}: tripped by {cause or 'nothing'}, not by {row.interlock}"
    return ""


def _recipes(names: Iterable[str], count: int, faults: Sequence[str] = ()) -> str:
    """Run recipes to their end, and a sample of ``count`` cases of them; ``faults``: () is all of the wheel's."""
    from tests.campaigns.faults.campaign import all_cases, conduct, faults_of_campaign, sample
    from tests.campaigns.faults.moments import Moment, rehearse

    moments: list[Moment] = []
    for recipe in names:
        found, stage = rehearse(recipe)
        if stage.run.outcome.value != "done":
            return f"{recipe} ends {stage.run.outcome.value}: {stage.run.reason}"
        if stage.observer.found or stage.invariants.broken:
            return f"{recipe}: {stage.observer.found or stage.invariants.broken}"
        moments += found
    tried = all_cases(moments, faults or faults_of_campaign(everything=True))
    cases = sample([one for one in tried if not faults or fits(one[0].recipe, one[1][0])], count)
    for start in range(0, len(cases), BATCH):
        tally = conduct("probe", cases[start : start + BATCH])
        if tally.failed:
            verdict = tally.failed[0]
            return f"{verdict.case}: {verdict.failures[0]}"
    return ""


def _late() -> str:
    from tests.campaigns.faults.late_scans import conduct

    failed = conduct().failed
    return f"late scans: {failed[0].case}: {failed[0].failures[0]}" if failed else ""


def _first_contact() -> str:
    """Check that a wrong rotation ends the run at a wheel's first contact, and at a load that a hand can hold."""
    with redirect_stdout(StringIO()) as output:
        code = pytest.main(["-q", "-x", "-n", "0", "-p", "no:cacheprovider", "--no-header", FIRST_CONTACT])
    failed = [line for line in output.getvalue().splitlines() if line.startswith(("FAILED", "ERROR"))]
    return (failed or ["the tests of the first contact could not run"])[0] if code else ""


def _stateful() -> str:
    from tests.campaigns.faults.test_stateful import AnythingHappens

    outcome = unittest.TestResult()
    unittest.defaultTestLoader.loadTestsFromTestCase(AnythingHappens.TestCase).run(outcome)
    problems = [text for _, text in (*outcome.failures, *outcome.errors)]
    return f"stateful test: {problems[0].strip().splitlines()[-1]}" if problems else ""


def main(jobs: int = 1, mutants: Iterable[Mutant] = MUTANTS, kind: str = "wheel_on_belt") -> int:
    """Hunt every mutant; print each and the figure; return 1 when too few are killed."""
    chosen = list(mutants)
    _, wrong = hunt(None, kind)
    if wrong:
        print(f"MISS the unchanged tree: {wrong}", flush=True)
        return 1
    killed = 0
    with ThreadPoolExecutor(jobs) as pool:
        for name, noticed in pool.map(hunt, chosen):
            killed += bool(noticed)
            print(f"     {'killed' if noticed else 'ALIVE '} {name}{': ' + noticed if noticed else ''}", flush=True)
    met = killed >= ASKED_FOR * len(chosen)
    print(f"{'ok  ' if met else 'MISS'} mutants killed: {killed} of {len(chosen)} (asked: >= {ASKED_FOR:.0%})")
    return 0 if met else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--probe", action="store_true", help="look for anything wrong with the tree this runs in")
    parser.add_argument("--row", default="", metavar="NAME", help="the interlock to look at first")
    parser.add_argument("--only", default="", metavar="TEXT", help="mutants whose name has this text")
    parser.add_argument("--kind", choices=("wheel_on_belt", TRACK), default="wheel_on_belt")
    options = parser.parse_args()
    if options.probe:
        found = probe(options.row, options.kind)
        print(found)
        sys.exit(1 if found else 0)
    hunted = TRACK_MUTANTS if options.kind == TRACK else MUTANTS
    sys.exit(main(1, [mutant for mutant in hunted if options.only in mutant.name], options.kind))
