"""The profile of a device by the name that a rig file gives: packaged, a TOML file, or from an installed package."""

from __future__ import annotations

from drivers.profiles import DeviceProfile, ProfileError, load_profile, profile_names, read_profile
from tester.base.plugins import PluginError, plugins


def profile_of(name: str) -> DeviceProfile:
    """Return a device's profile; raises ProfileError.

    ``name``: of a packaged profile; a path that ends in ``.toml``; or an extension's of the group ``profiles``, whose
    package carries the TOML file. A packaged name cannot be taken by an extension.
    """
    if name.endswith(".toml") or name in profile_names():
        return load_profile(name)
    try:
        text = plugins().text("profiles", name, ".toml")
    except PluginError as error:
        known = ", ".join(profile_names())
        raise ProfileError(f"no device profile {name!r} (there are {known}); {error}") from error
    return read_profile(name, text)
