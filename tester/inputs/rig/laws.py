"""Friction laws from installed packages, where the simulation knows none of a name."""

from __future__ import annotations

from typing import cast

from sim.physics.laws import LawMaker, OfMaterials
from tester.base.plugins import PluginError, plugins


def extension_law(name: str) -> LawMaker | None:
    """Return the law of an extension of the group ``laws``, None where there is none of this name.

    Raises PluginError for one that is not allowed, cannot be loaded or makes nothing.
    """
    if ":" not in name and name not in plugins().names("laws"):
        return None
    maker = plugins().load("laws", name)
    if not (callable(maker) or isinstance(maker, OfMaterials)):
        raise PluginError(f'extension "{name}" is no friction law: it cannot be called with a compound and its figures')
    return cast("LawMaker", maker)
