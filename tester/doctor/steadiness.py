"""Probes of what the sensors show over the watch: repeated, noisy or drifting readings, and heat without a run."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import inf, sqrt
from statistics import fmean

from drivers.profiles.model import Signal
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, note, warning
from tester.doctor.line_probes import decoded
from tester.doctor.line_survey import UnitSurvey
from tester.inputs.rig.further_sensors import title_of

LEAST_READINGS = 12
"""Fewest readings that are judged [A]."""
NOISE_SHARE = 0.004
"""Greatest noise of a sound sensor, standard deviation as a share of its range [A]: 2 N of 600 N, 1 K of 300 K."""
DRIFT_SHARE = 0.01
"""Greatest drift of a load cell at rest, share of its range in a minute [A]."""
NOISES = 5.0
"""A drift stands out from the noise of its means by this factor [A]."""
MINUTE_S = 60.0


def steadiness(e: Examination) -> Iterator[Finding]:
    """Report sensors that repeat themselves, are noisy or drift; nothing moves while they are watched."""
    for line in e.lines.values():
        for key, unit in line.units.items():
            watch = e.watch.units.get(key)
            if watch is None or len(watch.values) < LEAST_READINGS:
                continue
            times = [t for t, _ in watch.values]
            rows = [decoded(unit.profile.blocks[0], data) for _, data in watch.values]
            if unit.profile.kind == "load_cell" and len({data for _, data in watch.values}) == 1:
                yield warning(
                    title_of(e.rig, key), f"repeats its reading: {len(rows)} times the same, without any noise",
                    "its amplifier hangs, or filters too much: press on the cell and look whether it follows",
                )  # fmt: skip
            for place, (signal, _) in enumerate(rows[0]):
                if signal.name not in ("status", "output", "setpoint"):
                    values = [row[place][1] for row in rows]
                    yield from _signal(title_of(e.rig, key), unit, signal, times, values)


def _signal(
    name: str, unit: UnitSurvey, signal: Signal, times: list[float], values: list[float]
) -> Iterator[Finding]:
    span = signal.greatest - signal.least
    if not 0.0 < span < inf:
        return
    # Of successive readings: a drift is slower.
    noise = sqrt(0.5 * fmean((after - before) ** 2 for before, after in pairwise(values)))
    if noise > NOISE_SHARE * span:
        yield warning(
            name, f"{signal.name} is noisy: {noise:.3g} {signal.unit} (standard deviation at rest)",
            "its cable, shield and ground; a contact that chatters",
        )  # fmt: skip
    half = len(values) // 2
    moved = fmean(values[-half:]) - fmean(values[:half])
    rate = moved / (fmean(times[-half:]) - fmean(times[:half])) * MINUTE_S
    stands_out = abs(moved) > NOISES * noise / sqrt(half)
    if unit.profile.kind == "load_cell" and stands_out and abs(rate) > DRIFT_SHARE * span:
        yield warning(
            name, f"{signal.name} drifts by {rate:.3g} {signal.unit} a minute at rest",
            "let it warm up; its supply, its bridge, something that leans on it",
        )  # fmt: skip


def heat(e: Examination) -> Iterator[Finding]:
    """Report controllers that control, or give output, while no run is under way."""
    for line in e.lines.values():
        for key, unit in line.units.items():
            shown = {signal.name: value for block, answer in zip(unit.profile.blocks, unit.blocks, strict=False)
                     if answer.ok for signal, value in decoded(block, answer.data)}  # fmt: skip
            name, output = title_of(e.rig, key), shown.get("output", 0.0)
            if unit.switched_on:
                yield warning(
                    name, f"is switched on, set to {shown.get('setpoint', 0.0):g} degC, and gives {output:g} % of its"
                    " output; no run is under way", "switch it to standby; a run does so before it begins",
                )  # fmt: skip
            elif output:
                yield note(name, f"gives {output:g} % of its output in standby", "its relay or its manual mode")
