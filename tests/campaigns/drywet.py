"""`python -m tests.campaigns.drywet [--sample] [--seeds N]`: is the true share of hysteresis found?

The recipe `pin-on-disc` on its simulated rig, over seeds, with all noise and scatter. Wet, the twin keeps a share of
the dry friction (`sim.contact.wet`): as shipped in every other seed, others between. `tester components` must find it,
dry less wet, within its stated interval, for both compounds, in 16 of 20 seeds; and the interval must be narrow.
tests.campaigns.greta judges the recipe `greta`, whose law separates its parts.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from statistics import median
from typing import NamedTuple

import recipes
from tester.cli.main import invoke
from tester.results.components_table import FilmPair, SharesMean, film_pairs, means_of
from tester.results.run_results import results_of
from tester.store.run_reader import RunReader

SEEDS, SAMPLE_SEEDS = 20, 3
SHARES = (0.6, 0.35, 0.6, 0.8)
"""True shares, in turn; the first is the packaged rig's."""
HELD = 0.8
"""Required share of seeds: 16 of 20."""
WIDEST = 0.07
"""Maximum median of the mean shares' expanded uncertainties [A]: a wide interval would contain anything."""
SPEEDS = ("0.05 m/s, 0.1 m/s, 0.2 m/s, 0.3 m/s, 0.5 m/s, 1 m/s", "0.05 m/s, 0.1 m/s, 0.2 m/s")


class Found(NamedTuple):
    """A seed's result for a compound; ``rows``: how many of its conditions contain the truth, and all."""

    seed: int
    compound: str
    truth: float
    share: float
    expanded: float
    rows: tuple[int, int]

    @property
    def held(self) -> bool:
        """Return whether the interval of the mean contains the true share."""
        return abs(self.share - self.truth) <= self.expanded


def measure(seed: int, *, sample: bool) -> list[Found]:
    """Run the recipe with a seed and split it."""
    truth = SHARES[seed % len(SHARES)]
    pairs = pairs_of("pin-on-disc", seed, ("--set", f"sim.contact.wet={truth:g}"), SPEEDS if sample else ("", ""))
    return [found_of(seed, pairs, mean, truth) for mean in means_of(pairs)]


def pairs_of(name: str, seed: int, options: tuple[str, ...], *changes: tuple[str, str]) -> list[FilmPair]:
    """Run the recipe with some changes of its text; return the dry and wet results."""
    text = Path(recipes.find(name)).read_text(encoding="utf-8")
    for change in changes:
        text = text.replace(*change)
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()) as errors:
        recipe, runs = Path(folder) / "recipe.yaml", Path(folder) / "runs"
        recipe.write_text(text, encoding="utf-8")
        with contextlib.redirect_stdout(io.StringIO()):
            code = invoke(["run", str(recipe), "--rig", "pin-on-disc", "--yes", "--seed", f"{seed}", "--out", str(runs),
                           *options])  # fmt: skip
        if code:
            raise RuntimeError(f"seed {seed}: exit code {code}: {errors.getvalue()[-500:]}")
        with RunReader(next(runs.iterdir())) as reader:
            return [*film_pairs(results_of(reader))]


def found_of(seed: int, pairs: list[FilmPair], mean: SharesMean, truth: float) -> Found:
    """Return the results of a compound's conditions and their mean."""
    own = [one.parts.share for one in pairs if one.dry.info.compound == mean.compound]
    held = sum(abs(one.value - truth) <= one.expanded for one in own)
    return Found(seed, mean.compound, truth, mean.share.value, mean.share.expanded, (held, len(own)))


def figures(found: list[Found], seeds: int) -> Iterator[tuple[str, bool]]:
    """Yield every figure in words, and whether it passes."""
    by_seed = {seed: [one for one in found if one.seed == seed] for seed in range(seeds)}
    held = sum(len(own) == 2 and all(one.held for one in own) for own in by_seed.values())
    least = -int(-HELD * seeds // 1)
    yield f"seeds whose intervals hold the share, both compounds: {held} of {seeds} (asked: {least})", held >= least
    widest = median(one.expanded for one in found)
    yield f"expanded uncertainty of a mean share, median: {widest:.4f} (asked: <= {WIDEST:g})", widest <= WIDEST
    off = [one.share - one.truth for one in found]
    yield f"off the share: mean {sum(off) / len(off):+.4f}, largest {max(map(abs, off)):.4f} (said)", True
    rows, all_rows = (sum(one.rows[i] for one in found) for i in range(2))
    yield f"single conditions that hold it: {rows} of {all_rows} (asked: 90 %)", rows >= 0.9 * all_rows


def main(arguments: list[str] | None = None) -> int:
    """Measure; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.drywet", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_SEEDS} seeds, the three slowest speeds")
    parser.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"seeds ({SEEDS})")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="processes (2)")
    read = parser.parse_args(arguments)
    seeds = SAMPLE_SEEDS if read.sample else read.seeds
    with get_context("spawn").Pool(read.jobs) as pool:
        found = [one for own in pool.map(partial(measure, sample=read.sample), range(seeds), 1) for one in own]
    for one in found:
        text = f"share {one.share:.4f} ± {one.expanded:.4f}, put in {one.truth:.3g}"
        print(f"     seed {one.seed}, {one.compound}: {text}; conditions {one.rows[0]} of {one.rows[1]}")
    missed = 0
    for text, met in figures(found, seeds):
        missed += not met
        print(f"{'ok  ' if met else 'MISS'} {text}", flush=True)
    print("every figure met" if not missed else f"{missed} missed")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
