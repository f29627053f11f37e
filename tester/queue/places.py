"""Where the queue of a rig is kept, beside its runs: ``runs/.queue/RIG``, with a folder for each item."""

from __future__ import annotations

import re
from hashlib import sha256
from pathlib import Path
from typing import Final

FOLDER: Final = ".queue"
RECIPE: Final = "recipe.yaml"
RIG_AS_ADDED: Final = "rig as added.yaml"


def queue_folder(runs: Path, rig: str, *, simulated: bool) -> Path:
    """Return the folder of a rig's queue; rigs of other names, and a twin of the same name, have others."""
    words = re.sub(r"[^a-z0-9]+", "-", rig.lower()).strip("-")[:40] or "rig"
    digest = sha256(f"{rig}\n{simulated}".encode()).hexdigest()[:8]
    return runs / FOLDER / f"{words}-{digest}"


def item_folder(queue: Path, number: int) -> Path:
    """Return the folder of an item: its rig as it was when the item was added, and what its run reads."""
    return queue / "items" / str(number)


def run_recipe(item: Path) -> Path:
    """Return the recipe that an item's run reads; its materials are beside it."""
    return item / "run" / RECIPE
