"""`tester check`: every mistake with its place, hostile files quickly."""

from __future__ import annotations

import re
from collections.abc import Iterator

from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.acceptance.topic import Topic

EXIT_INVALID = 3
TIMES_AT_MOST = 2.0
"""CPU time limit of a hostile file, in multiples of a small recipe's: machines differ, and drift."""

MISTAKES = """\
recipe: Five mistakes
specimens:
  - compound: "1#"
pre_grind: {wheel_speed: 0.8, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
measure:
  wheel_speed: 0.8 m/s
  repeats: many
grids:
  - name: load
    slip_velocity: 300 mm
    load: [100 N, 2000 N]
    temprature: 40 degC
    temperature: 40 degC
"""
WHERE = {
    "a number without a unit": (4, 26),
    "a word for a number": (7, 12),
    "a unit of something else": (10, 20),
    "a load above the rig's limit": (11, 19),
    "a misspelt key": (12, 5),
}
"""Line and column of each mistake, counted from 1."""

DUPLICATE = MISTAKES.replace("0.8,", "0.8 m/s,").replace("many", "3").replace("300 mm\n", "300 mm/s\n")
DUPLICATE = DUPLICATE.replace("2000 N", "200 N").replace("temprature: 40", "temperature: 25")
"""A recipe whose only mistake is a duplicate key: line 13, column 5."""


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    path = bench.write("five.yaml", MISTAKES)
    done = bench.tester("check", str(path))
    yield equal("five mistakes: exit code", done.code, EXIT_INVALID)
    found = _places(done.stderr, str(path))
    yield equal("five mistakes: problems", len(found), len(WHERE))
    for name, place in WHERE.items():
        message = found.get(place, "nothing there")
        yield holds(f"{name}: line {place[0]}, column {place[1]}", place in found, message, "is named")
    yield from _refused(bench, "60 kB of [", "[" * 60_000, "", done.cpu_s)
    yield from _refused(bench, "a key twice", DUPLICATE, ":13:5: duplicate key", done.cpu_s)


def _refused(bench: Bench, name: str, text: str, says: str, small_s: float) -> Iterator[Figure]:
    done = bench.tester("check", str(bench.write("refused.yaml", text)))
    yield equal(f"{name}: exit code", done.code, EXIT_INVALID)
    lines = done.stderr.splitlines()
    yield equal(f"{name}: problems", len(lines), 1)
    shown = lines[0].rpartition("refused.yaml")[2][:100] if lines else ""
    yield holds(f"{name}: message", bool(shown) and says in shown, shown, f"has {says}" if says else "has a place")
    times = done.cpu_s / small_s
    yield at_most(f"{name}: CPU time, times that of a small recipe ({small_s:.2f} s)", times, TIMES_AT_MOST, digits=2)


def _places(text: str, path: str) -> dict[tuple[int, int], str]:
    """Return the messages by line and column."""
    found = re.findall(rf"^{re.escape(path)}:(\d+):(\d+): (.*)$", text, re.MULTILINE)
    return {(int(line), int(column)): message[:60] for line, column, message in found}


TOPIC = Topic("check", "five mistakes at their places; hostile files refused quickly", figures)
