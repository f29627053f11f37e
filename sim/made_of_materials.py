"""Rigs whose friction is made of a rubber and a surface: how they are told where to find both."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

from sim.physics.laws import LawSetting


@runtime_checkable
class MadeOfMaterials(Protocol):
    """A rig whose friction may be made of a rubber and a surface (``sim.physics.materials``)."""

    @property
    def of_materials(self) -> bool:
        """Tell whether it is, on this one."""
        ...

    def take(self, setting: LawSetting) -> None:
        """Take where they are found, before anything is put on."""
        ...
