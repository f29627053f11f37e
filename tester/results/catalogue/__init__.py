"""A catalogue of many runs and their coefficients: an index next to the runs, or one that a laboratory shares."""

from __future__ import annotations

import os
from pathlib import Path

from tester.results.catalogue.entries import Catalogue

SHARED_VARIABLE = "TESTER_CATALOGUE"
"""Environment variable with the URL of a shared catalogue, e.g. postgresql://lab@db/friction."""


def open_catalogue(under: Path, url: str | None = None) -> Catalogue:
    """Return the catalogue: that of ``url`` (default: ``TESTER_CATALOGUE``), else the index next to the runs.

    Raises CatalogueError where it cannot be opened.
    """
    wanted = os.environ.get(SHARED_VARIABLE, "") if url is None else url
    if wanted:
        from tester.results.catalogue.shared import SharedCatalogue

        return SharedCatalogue(wanted)
    from tester.results.catalogue.local import LocalIndex

    return LocalIndex(under)
