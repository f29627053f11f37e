"""From the name that a command is given to the folder of a run."""

from __future__ import annotations

from pathlib import Path

import click


def run_folder(name: str) -> Path:
    """Return the folder of a run; a name that is none is a usage error."""
    from tester.store.catalogue import find_run
    from tester.store.schema import StoreError

    try:
        return find_run(name)
    except StoreError as error:
        raise click.UsageError(str(error)) from error
