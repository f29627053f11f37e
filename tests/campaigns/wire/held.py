"""Replies delayed as by a USB adapter's latency timer, seen from outside: `tester run` and its bus log."""

from __future__ import annotations

import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from tests.campaigns.acceptance.figure import Figure, at_least, holds
from tests.campaigns.seeds.sweeps import COMMAND

HELD_MS: Final = 16
"""The usual latency timer of a USB-RS485 adapter (FTDI's default)."""
REFUSED_MS: Final = 40
LEAST_HZ: Final = 40
SHORT: Final = """\
recipe: short
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 1, min_valid: 1, window: 10 rev, temperature_band: 2 degC}
grids:
  - {name: short, slip_velocity: 300 mm/s, load: 100 N, temperature: 40 degC}
"""


def _run(folder: Path, recipe: str, held_ms: int) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", COMMAND, "run", recipe, "--yes", "--out", str(folder / "runs"),
               "--set", f"sim.latency_timer={held_ms} ms", "--bus-log", str(folder / "log")]  # fmt: skip
    return subprocess.run(command, capture_output=True, text=True, check=False)


def readings_hz(log: Path) -> float:
    """Return the median number of readings in a second, over the seconds with requests at the sliding rate. Slower
    scans request 20 or 10 readings a second: more than 25 come from sliding.
    """
    seconds: Counter[int] = Counter()
    for line in log.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if len(words) > 2 and words[1] == "RX" and words[2:4] == ["01", "03"]:
            seconds[int(float(words[0].strip("()")))] += 1
    quick = sorted(count for count in seconds.values() if count > 25)
    return quick[len(quick) // 2] if quick else 0.0


def run(*, whole: bool) -> Iterator[Figure]:
    """Yield the figures of a run with delayed replies."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        recipe = "quickstart"
        if not whole:
            (folder / "short.yaml").write_text(SHORT, encoding="utf-8")
            recipe = str(folder / "short.yaml")
        done = _run(folder, recipe, HELD_MS)
        yield holds(f"replies held back {HELD_MS} ms: the run completes", done.returncode == 0,
                    f"exit {done.returncode}", "exit 0")  # fmt: skip
        if done.returncode != 0:
            return
        found = readings_hz(folder / "log" / "modbus-load_cell.log")
        yield at_least(f"replies held back {HELD_MS} ms: load cell, median while sliding", found, LEAST_HZ, "1/s")


def refused() -> Iterator[Figure]:
    """Yield whether a line that is too slow is refused, and why."""
    with TemporaryDirectory() as name:
        done = _run(Path(name), "quickstart", REFUSED_MS)
        named = "too slow for interlocks.stale_cell" in done.stderr and "latency_timer" in done.stderr
        what = next((line for line in done.stderr.splitlines() if "too slow" in line), done.stderr[-200:])
        yield holds(f"replies held back {REFUSED_MS} ms: refused by name", done.returncode == 4 and named,
                    f"exit {done.returncode}: {what.strip()}", "exit 4, key and setting named")  # fmt: skip
