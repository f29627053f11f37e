"""`python -m tests.campaigns.compounds [--sample] [--seeds N] [--jobs N]`: compounds drawn by seed.

Each seed draws a rubber (a Prony series, a WLF shift of its own, a sweep of a few frequencies) and the spectrum of a
surface. A laboratory's way through the commands follows: import the sweep, write surface and recipe, check, run on the
simulated track, which rubs by Persson's theory on those two files, fit a law and keep it, predict with it, draw it. No
command may fail. A second run of the same specimen, at speeds and temperatures between those of the first, is compared
with the kept law's prediction: 95 % of its conditions must be inside the interval.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
import tempfile
from functools import partial
from math import pi, sqrt
from multiprocessing import get_context
from pathlib import Path
from random import Random
from statistics import median
from typing import NamedTuple

from tester.cli.main import invoke
from tester.inputs.kept_laws.law_materials import read_law
from tester.inputs.kept_laws.law_value import KeptLaw
from tester.results.run_results import results_of
from tester.store.run_reader import RunReader

SEEDS, SAMPLE_SEEDS = 20, 1
INSIDE = 0.93, 0.97
"""Required share of held-out conditions inside the 95 % interval, over all seeds together."""
SPREAD = 2.6
"""Tolerance of a sample's share, in standard deviations of a share of so few conditions [A]: 1 sample in 100 by
chance."""
C1, C2_K = 17.44, 51.6
"""WLF's constants at the glass transition, about which those of a rubber are drawn."""
FREQUENCIES_HZ = 0.3, 1.0, 3.0, 10.0, 30.0, 100.0
OWN_LAW = "persson"
"""Law for data about which the other law says nothing: that of the rubber's and the surface's own files."""
LOAD_N, AREA_MM2 = 20, 100
FITTED = ([0, 10, 20, 30, 40, 50], ["1e-5", "1e-4", "1e-3", "1e-2"])
HELD_OUT = ([5, 25, 45], ["3.162e-5", "3.162e-4", "3.162e-3"])
"""Temperatures in degC and speeds in m/s."""


class Stranger(NamedTuple):
    """A rubber and a surface, drawn."""

    sweep: str
    """CSV of an instrument: temperature, frequency, moduli."""
    glass_c: float
    spectrum: str


class CompoundResult(NamedTuple):
    """The result of a seed. ``errors``: commands that failed, with their last words."""

    seed: int
    errors: tuple[str, ...]
    inside: int = 0
    held_out: int = 0
    greatest_percent: float = 0.0
    half_width_percent: float = 0.0
    doubts: int = 0
    law: str = ""


def drawn(seed: int) -> Stranger:
    """Draw a rubber whose relaxation times span 14 decades, and a self-affine surface."""
    draw = Random(f"stranger {seed}")
    glass_c = draw.uniform(-75.0, -35.0)
    c1, c2_k = C1 * draw.uniform(0.92, 1.08), C2_K * draw.uniform(0.92, 1.08)
    rubbery_mpa, glassy_mpa = 10.0 ** draw.uniform(0.3, 1.0), 10.0 ** draw.uniform(2.9, 3.4)
    middle, width = draw.uniform(-1.0, 2.0), draw.uniform(1.5, 3.0)  # log10 of seconds at Tg, and its spread
    times = [middle - 7.0 + 0.5 * i for i in range(41)]
    weights = [draw.uniform(0.6, 1.4) * 10.0 ** (-(((t - middle) / width) ** 2) / 2.0) for t in times]
    scale = (glassy_mpa - rubbery_mpa) / sum(weights)
    # Filled rubber also loses energy on its plateau: slow modes of nearly equal weight.
    slow = rubbery_mpa * draw.uniform(0.1, 0.25)
    moduli = [scale * w + (slow if t > middle else 0.0) for w, t in zip(weights, times, strict=True)]
    lines = ["Temperature [degC],Frequency [Hz],E' [MPa],E'' [MPa]"]
    for step in range(24):
        temperature_c = glass_c + 5.0 + 6.0 * step
        shift = -c1 * (temperature_c - glass_c) / (c2_k + temperature_c - glass_c)
        for frequency_hz in FREQUENCIES_HZ:
            storage, loss = rubbery_mpa, 0.0
            for modulus, time in zip(moduli, times, strict=True):
                x = 2.0 * pi * frequency_hz * 10.0 ** (time + shift)
                storage += modulus * x * x / (1.0 + x * x)
                loss += modulus * x / (1.0 + x * x)
            lines.append(f"{temperature_c:.2f},{frequency_hz:g},{storage:.6g},{max(loss, 1e-3 * storage):.6g}")
    hurst, q0 = draw.uniform(0.7, 0.95), 10.0 ** draw.uniform(3.3, 4.3)
    q1 = q0 * 10.0 ** draw.uniform(1.0, 1.8)
    # rms, of which <slope^2> = 2 pi int q^3 C dq: rough enough that dry friction shows the contact (5 % of the load).
    slope = draw.uniform(0.9, 1.5)
    span = (q1 / q0) ** (2.0 - 2.0 * hurst) - 1.0
    c0 = slope**2 * (2.0 - 2.0 * hurst) / (2.0 * pi * q0**4 * span)
    spectrum = f"{{C0: {c0:.6g} m4, q0: {q0:.6g} 1/m, q1: {q1:.6g} 1/m, H: {hurst:.4g}}}"
    return Stranger("\n".join(lines) + "\n", glass_c, spectrum)


def recipe_of(temperatures_c: list[int], speeds: list[str]) -> str:
    """Return the text of a recipe over these settings."""
    return f"""\
recipe: stranger
kind: specimen_on_track
specimens: [{{compound: stranger}}]
abrasive: {{name: strange track}}
measure:
  repeats: 3
  distance: 0.25 mm
  at_least: 5 s
  temperature_band: 1 K
  soak: {{within: 0.5 K, for: 30 min, at_most: 3 h}}
grids:
  - name: all
    load: {LOAD_N} N
    temperature: [{", ".join(f"{value} degC" for value in temperatures_c)}]
    track_speed: [{", ".join(f"{value} m/s" for value in speeds)}]
"""


class CommandError(Exception):
    """A command ended with an error."""


def call(*words: str, allowed: tuple[int, ...] = (0,)) -> str:
    """Call a command as a user does; return its output. Raises CommandError."""
    out, error_output = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error_output):
        code = invoke(list(words))
    if code not in allowed:
        last = (out.getvalue() + error_output.getvalue())[-400:]
        raise CommandError(f"tester {' '.join(words[:2])}: exit code {code}: {last}")
    return out.getvalue()


def measure(seed: int, folder: Path, law: str) -> CompoundResult:
    """Go through a laboratory's work with the compound of a seed. Raises CommandError."""
    stranger = drawn(seed)
    (folder / "sweep.csv").write_text(stranger.sweep, encoding="utf-8")
    (folder / "compounds").mkdir()
    (folder / "surfaces").mkdir()
    compound = folder / "compounds" / "stranger.yaml"
    call("materials", "import", "dma", str(folder / "sweep.csv"), "--name", "stranger", "--strain", "0.1 %",
         "-o", str(compound))  # fmt: skip
    text = compound.read_text(encoding="utf-8")
    assert text.count("moduli:\n") == 1
    text = text.replace("moduli:\n", "moduli:\n  beyond: hold\n")  # a track begins to slide from standstill
    compound.write_text(f"{text}Tg: {stranger.glass_c:.1f} degC\n", encoding="utf-8")
    (folder / "surfaces" / "strange-track.yaml").write_text(
        f"name: strange track\nspectrum: {stranger.spectrum}\n", encoding="utf-8"
    )
    call("materials", "check", str(compound))
    rig = ("--rig", "grosch", "--set", "sim.law=persson", "--set", f"sim.contact.area={AREA_MM2}")
    for name, grid in (("fitted", FITTED), ("held", HELD_OUT)):
        recipe = folder / f"{name}.yaml"
        recipe.write_text(recipe_of(*grid), encoding="utf-8")
        call("check", str(recipe), *rig)
        call("run", str(recipe), *rig, "--yes", "--seed", f"{seed}", "--out", str(folder / name))
    fitted = str(next((folder / "fitted").iterdir()))
    kept = folder / "law.yaml"
    call("fit", fitted, "--law", law, "--area", f"{AREA_MM2} mm2", "-o", str(kept), allowed=(0, 1))
    if not kept.exists():  # the conditions do not determine a parameter
        law = OWN_LAW
        call("fit", fitted, "--law", law, "--given", f"area={AREA_MM2}", "-o", str(kept), allowed=(0, 1))
    call("predict", "--law", str(kept), "--slip", "1 mm/s", "--load", f"{LOAD_N} N", "--temperature", "25 degC")
    call("figure", fitted, "--law", str(kept), "--format", "svg", "--out", str(folder / "figures"))
    return held_against(seed, read_law(kept), next((folder / "held").iterdir()))._replace(law=law)


def held_against(seed: int, law: KeptLaw, run: Path) -> CompoundResult:
    """Compare the measured coefficients of a run with a kept law's intervals."""
    with RunReader(run) as reader:
        found = results_of(reader)
    inside, off, wide = 0, [], []
    for condition in found.conditions():
        setpoint = condition.info.setpoint
        temperature_c = condition.result.measured["contact_c"]
        predicted = law.predict(temperature_c, setpoint.number("load"), setpoint.number("track_speed"))
        mu = condition.result.mu
        inside += predicted.low <= mu <= predicted.high
        off.append(100.0 * abs(mu / predicted.mu - 1.0))
        wide.append(50.0 * (predicted.high - predicted.low) / predicted.mu)
    half_percent = median(wide) if wide else 0.0
    return CompoundResult(seed, (), inside, len(off), max(off, default=0.0), half_percent, len(law.doubts))


def one(seed: int, law: str) -> CompoundResult:
    """Return the result of a seed."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return measure(seed, Path(folder), law)
        except CommandError as error:
            return CompoundResult(seed, (str(error),))


def main(arguments: list[str] | None = None) -> int:
    """Print a line a seed and the figures; 1 where one misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.compounds", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="one seed")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"seeds ({SEEDS})")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (2)")
    parser.add_argument("--law", default="wlf_bell", help="law to fit and keep (wlf_bell)")
    read = parser.parse_args(arguments)
    seeds = SAMPLE_SEEDS if read.sample else read.seeds
    met = True
    results: list[CompoundResult] = []
    with get_context("spawn").Pool(read.jobs) as pool:
        for result in pool.imap(partial(one, law=read.law), range(seeds)):
            results.append(result)
            for error in result.errors:
                print(f"MISS seed {result.seed}: {error}", flush=True)
            if not result.errors:
                print(f"     seed {result.seed}, {result.law}: {result.inside} of {result.held_out} inside, half-width"
                      f" {result.half_width_percent:.1f} %, off by {result.greatest_percent:.1f} % at most", flush=True)
    failed = sum(bool(result.errors) for result in results)
    held_out, inside = sum(result.held_out for result in results), sum(result.inside for result in results)
    share = inside / held_out if held_out else 0.0
    low, high = INSIDE
    if read.sample:
        slack = SPREAD * sqrt(0.05 * 0.95 / max(held_out, 1))
        low, high = low - slack, high + slack
    for text, held in (
        (f"seeds in which a command failed, of {seeds}: {failed} (asked: 0)", not failed),
        (f"held-out conditions inside the interval: {100.0 * share:.1f} % of {held_out}"
         f" (asked: {100.0 * low:.0f} to {100.0 * min(high, 1.0):.0f} %)", low <= share <= high),
    ):  # fmt: skip
        print(f"{'ok  ' if held else 'MISS'} {text}", flush=True)
        met = met and held
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
