"""Profiles and friction laws by name: packaged, a TOML file beside the rig file, or from an installed package."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final, TypeAlias, cast

from drivers.profiles import DeviceProfile, ProfileError, load_profile, profile_names, read_profile
from sim.physics.laws import LawMaker, OfMaterials
from tester.base.plugins import PluginError, plugins
from tester.base.source import Tree, Value


def profile_of(name: str) -> DeviceProfile:
    """Return a device's profile; raises ProfileError.

    ``name``: of a packaged profile; a path that ends in ``.toml``; or of an extension in the group ``profiles``, whose
    package carries the TOML file. An extension cannot take a packaged name.
    """
    if name.endswith(".toml") or name in profile_names():
        return load_profile(name)
    try:
        text = plugins().text("profiles", name, ".toml")
    except PluginError as error:
        known = ", ".join(profile_names())
        raise ProfileError(f"no device profile {name!r} (there are {known}); {error}") from error
    return read_profile(name, text)


def extension_drive(name: str) -> str:
    """Return the text of a drive's profile, from an extension of the group ``drives``; raises PluginError."""
    return plugins().text("drives", name, ".toml")


def find_beside(tree: Tree, folder: Path) -> None:
    """Resolve paths of profiles and laws relative to a rig file's folder, where they lead to a file there.

    Any other path stays unchanged: it is relative to the working folder.
    """
    if not isinstance(tree.data, dict):
        return  # the reader of the rig file reports it
    for section_key, key in LAW_KEYS:
        section = tree.data.get(section_key)
        law = section.get(key) if isinstance(section, dict) else None
        if isinstance(section, dict) and isinstance(law, str) and is_law_file(law) and (folder / law).is_file():
            section[key] = str((folder / law).resolve())
    for key in ("devices", "axes"):
        section = tree.data.get(key)
        for part in section.values() if isinstance(section, dict) else ():
            if isinstance(part, dict):
                _find_beside(part, folder)


def _find_beside(part: dict[str, Value], folder: Path) -> None:
    name = part.get("profile")
    if isinstance(name, str) and name.endswith(".toml") and (folder / name).is_file():
        # Absolute: a run records it, and resumes from any folder, whatever path its rig file was named by.
        part["profile"] = str((folder / name).resolve())


LAW_KEYS: Final = (("sim", "friction_model"), ("sim", "law"))
"""Keys of a rig file that name a law of friction."""


LawCopies: TypeAlias = Mapping[str, str]
"""Copies of kept laws in a run's folder, by the absolute path of the original."""
NO_COPIES: Final[LawCopies] = MappingProxyType({})


def take_copies(tree: Tree, copies: LawCopies) -> None:
    """Replace the path of a kept law by that of its copy: a run goes by the law that it began with."""
    for section_key, key in LAW_KEYS:
        section = tree.data.get(section_key) if isinstance(tree.data, dict) else None
        law = section.get(key) if isinstance(section, dict) else None
        if isinstance(section, dict) and isinstance(law, str):
            section[key] = copies.get(law, law)


def is_law_file(name: str) -> bool:
    """Return whether the name of a law is that of a kept law's file."""
    return name.endswith((".yaml", ".yml"))


def extension_law(name: str) -> LawMaker | None:
    """Return the law of a kept law's file or of an extension of the group ``laws``, None where there is none.

    Raises PluginError for an extension that is not allowed, cannot be loaded or is no law, InvalidSource for a file.
    """
    if is_law_file(name):
        from tester.inputs.kept_laws.law_value import load_law  # needs pydantic

        kept = load_law(Path(name))
        if kept.model.of_materials:
            return OfMaterials(kept.on, slow=True, version=int(kept.model.hash()[:8], 16))
        return kept.of
    if ":" not in name and name not in plugins().names("laws"):
        return None
    maker = plugins().load("laws", name)
    if not (callable(maker) or isinstance(maker, OfMaterials)):
        raise PluginError(f'extension "{name}" is no friction law: it cannot be called with a compound and its figures')
    return cast("LawMaker", maker)
