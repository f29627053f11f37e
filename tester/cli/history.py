"""What stored runs say of the repeatability of a compound."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import click

from tester.analysis.uncertainty import Pool


def repeatability(under: Path, compounds: Iterable[str], *, simulated: bool) -> dict[str, Pool]:
    """Return the deviations between repeats pooled over the stored runs, by compound, where there are any.

    Runs of the simulated rig count for it alone, and those of a machine for machines.
    """
    from tester.results.catalogue import open_catalogue
    from tester.results.catalogue.entries import CatalogueError, WantedRuns, refresh

    pools: dict[str, Pool] = {}
    if not under.is_dir():
        return pools
    try:
        catalogue = open_catalogue(under)
        try:
            refresh(catalogue, under)
            for compound in compounds:
                pool = Pool()
                for run in catalogue.runs(WantedRuns(compound)):
                    if run.simulated != simulated:
                        continue
                    for one in catalogue.conditions(run):
                        if one.compound == compound and one.status == "ok" and one.mu and one.s and one.n_valid > 1:
                            df = one.n_valid - 1
                            pool = Pool(pool.squares + df * (one.s / one.mu) ** 2, pool.df + df)
                if pool.df:
                    pools[compound] = pool
        finally:
            catalogue.close()
    except CatalogueError as error:
        raise click.ClickException(str(error)) from error
    return pools
