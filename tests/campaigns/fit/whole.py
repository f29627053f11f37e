"""Whole runs of grosch on the simulated rig, with the fitted law and with wrong ones: do their fits end like those of
drawn records?

The rig is ticked at 10 Hz instead of 20 while drives are enabled, which halves the time of a run.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

import recipes
from tester.analysis.fit.fit_law import FitError, by_group
from tester.analysis.fit.joint import fit_group
from tester.kinds.specimen_on_track.fit.fits import FITS
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.sweep.case import Unseen
from tests.campaigns.fit.silence import RESAMPLES, Figure
from tests.tester.kinds.specimen_on_track.bench import one_track

LAWS: Final[Mapping[str, str]] = {
    "the right law": "wlf_bell",
    "a steeper shift": "tests.campaigns.fit.twins:steeper_shift",
    "two merged bells": "tests.campaigns.fit.twins:two_bells",
    "an amplitude that falls by 0.3 %/K": "tests.campaigns.fit.twins:falling",
    "a power law": "tests.campaigns.fit.twins:power_of_speed",
}


class Whole(NamedTuple):
    """A run: its law, its number of conditions, why its fit has no intervals, and its residual standard deviation."""

    name: str
    conditions: int
    silent: str
    residual: float


def ended(which: tuple[str, int]) -> Whole:
    """Return how the fit of a whole run ends; ``which``: the name of its law, and its seed."""
    name, seed = which
    with TemporaryDirectory() as folder:
        screen = Unseen()
        overrides = ("scan.enabled=10 Hz", f"sim.law={LAWS[name]}")
        recipe = Path(folder) / "recipe.yaml"
        recipe.write_text(one_track(recipes.find("grosch").read_text(encoding="utf-8")), encoding="utf-8")
        options = SessionOptions(str(recipe), "grosch", out=Path(folder), seed=seed, overrides=overrides, samples=False)
        session = screen.session = Session(options, screen)
        session.run()
        if session.folder is None:
            raise RuntimeError(f"the run did not begin: {' '.join(screen.messages)}")
        points = FITS.run_points(session.folder).points
    (group, own), *_ = by_group(points).items()
    law = FITS.bound(FITS.laws["wlf_bell"], group, "", {})
    try:
        found = fit_group(law, group, own, FITS.cells, count=RESAMPLES)
    except FitError as error:
        return Whole(name, len(own), str(error), float("nan"))
    return Whole(name, len(own), found.silent, found.lack.residual)


def figures(seeds: int, jobs: int) -> Iterator[Figure]:
    """Yield how the fits of whole runs end."""
    wanted = [(name, seed) for seed in range(3000, 3000 + seeds) for name in LAWS]
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for one in pool.map(ended, wanted):
            right = one.name == "the right law"
            verdict = f"silent: {one.silent}" if one.silent else "intervals are printed"
            asked = "intervals" if right else "silent"
            text = f"whole run of grosch, {one.name}: {one.conditions} conditions, {verdict}"
            met = bool(one.silent) is not right
            yield f"{text}, residual {100.0 * one.residual:.1f} % (asked: {asked})", met
