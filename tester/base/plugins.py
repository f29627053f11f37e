"""A laboratory's extensions from installed packages: profiles of devices, export formats, laws, kinds.

An extension is requested by name and found in one of two ways. A package declares an entry point of that name in the
group ``friction_tester.profiles``, ``.drives``, ``.formats``, ``.laws`` or ``.kinds``; or the name is dotted,
``package.module:object``. A path is refused. Nothing is imported before it is requested, and every loaded extension is
kept for the run's record.

A command that a person starts loads the extensions that the rig file names. A service receives names from its clients,
so it loads only those that its own start allowed (``tester serve --allow NAME``, or ``TESTER_ALLOW=NAME,NAME``). Child
processes inherit the variable and its restriction.
"""

from __future__ import annotations

import os
import re
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points, packages_distributions, version
from importlib.resources import files
from operator import attrgetter
from pathlib import Path
from typing import Literal

from tester.base.trouble import MisuseError

Group = Literal["profiles", "drives", "formats", "laws", "kinds"]

ALLOW_VARIABLE = "TESTER_ALLOW"
"""Environment variable: names, separated by commas, of the extensions that may be loaded; empty for none. Without it,
any may be loaded."""

_DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")
_NAME = re.compile(r"\w[\w.-]*")


class PluginError(ValueError):
    """An extension that is missing, not allowed, or of the wrong type; the message is for people."""


@dataclass(frozen=True, slots=True)
class Extension:
    """A loaded extension, and its origin."""

    group: Group
    name: str
    """The requested name."""
    target: str
    """Location: ``module:object``."""
    distribution: str
    """Name of the installed package, "" for a module outside packages."""
    version: str
    sha256: str
    """Hash of the file that was read (a profile's TOML, else the module's), "" where there is none."""

    def describe(self) -> str:
        """Return a line for people and for the record."""
        package = f"{self.distribution} {self.version}" if self.distribution else "of no installed package"
        return f"{package}, {self.target}, sha256 {self.sha256 or 'unknown'}"


class Plugins:
    """Finds and loads extensions, and keeps the loaded ones."""

    def __init__(self, allowed: Collection[str] | None = None) -> None:
        """``allowed``: names that may be loaded; None = any."""
        self.allowed = None if allowed is None else frozenset(allowed)
        self._loaded: dict[tuple[Group, str], tuple[Extension, object]] = {}

    @property
    def loaded(self) -> tuple[Extension, ...]:
        """Return the loaded extensions, in order of loading."""
        return tuple(extension for extension, _ in self._loaded.values())

    def names(self, group: Group) -> tuple[str, ...]:
        """Return the names that installed packages declare in a group and that may be loaded; imports nothing."""
        declared = {point.name for point in entry_points(group=f"friction_tester.{group}")}
        return tuple(sorted(declared if self.allowed is None else declared & self.allowed))

    def load(self, group: Group, name: str) -> object:
        """Return the object of an extension. Raises PluginError; errors of its module's import pass through."""
        return self._kept(group, name, ending="")

    def text(self, group: Group, name: str, ending: str) -> str:
        """Return the text of a file that an extension's package carries. Raises PluginError.

        The file is named after the object, or after the entry point where that names a package only: ``module:cell``
        with ``ending`` ".toml" is ``cell.toml`` in the package ``module``.
        """
        return str(self._kept(group, name, ending))

    def _kept(self, group: Group, name: str, ending: str) -> object:
        self._check(name)
        if (group, name) not in self._loaded:
            module, attribute, distribution = _dotted(name) if ":" in name else _declared(group, name)
            target = f"{module}:{attribute}" if attribute else module
            try:
                if ending:
                    file = files(module) / f"{attribute or name}{ending}"
                    content = file.read_bytes()
                    extension: object = content.decode()
                else:
                    place = import_module(module)
                    extension = attrgetter(attribute)(place) if attribute else place
                    content = Path(place.__file__).read_bytes() if place.__file__ else b""
            except (ImportError, SyntaxError, AttributeError, OSError, TypeError, ValueError) as error:
                raise PluginError(f'extension "{name}" ({target}) cannot be loaded: {error}') from error
            known = version(distribution) if distribution else ""
            digest = sha256(content).hexdigest() if content else ""
            self._loaded[group, name] = Extension(group, name, target, distribution, known, digest), extension
        return self._loaded[group, name][1]

    def _check(self, name: str) -> None:
        """Refuse an invalid name, or one that is not allowed. Nothing has been imported."""
        if "/" in name or "\\" in name or name.endswith(".py"):
            raise PluginError(
                f'"{name}" is a path: an extension is the name of an entry point, or package.module:object of an'
                " installed package, never a file"
            )
        if not (_DOTTED if ":" in name else _NAME).fullmatch(name):
            raise PluginError(f'"{name}" is no name of an extension (expected a name, or package.module:object)')
        if self.allowed is not None and name not in self.allowed:
            may = ", ".join(sorted(self.allowed)) or "none"
            raise PluginError(
                f'extension "{name}" is not allowed here (allowed: {may}): allow it when the service starts, with'
                f" tester serve --allow {name}, or {ALLOW_VARIABLE}"
            )


def _declared(group: Group, name: str) -> tuple[str, str, str]:
    """Return module, object ("" for the module itself) and distribution of an entry point; raises PluginError."""
    points = entry_points(group=f"friction_tester.{group}")
    declaring = {point.value: point for point in points if point.name == name}
    if len(declaring) == 1:
        (point,) = declaring.values()
        return point.module, point.attr, _package(point)
    if declaring:
        packages = " and ".join(sorted(map(_package, declaring.values())))
        raise PluginError(f'extension "{name}": {packages} both declare it: name it package.module:object')
    known = ", ".join(sorted(points.names)) or "none"
    raise PluginError(
        f'there is no extension "{name}": no installed package declares it in friction_tester.{group}'
        f" (declared: {known})"
    )


def _dotted(name: str) -> tuple[str, str, str]:
    module, _, attribute = name.partition(":")
    return module, attribute, next(iter(packages_distributions().get(module.partition(".")[0], [])), "")


def _package(point: EntryPoint) -> str:
    return point.dist.name if point.dist is not None else ""


def allow_only(names: Collection[str]) -> None:
    """Restrict this process, and its children, to these extensions and those already in ``TESTER_ALLOW``."""
    os.environ[ALLOW_VARIABLE] = ",".join([*filter(None, [os.environ.get(ALLOW_VARIABLE)]), *names])
    plugins.cache_clear()


@cache
def plugins() -> Plugins:
    """Return the extensions of this process, as allowed by its environment."""
    allowed = os.environ.get(ALLOW_VARIABLE)
    return Plugins(None if allowed is None else [name.strip() for name in allowed.split(",") if name.strip()])


class MissingExtraError(MisuseError):
    """A library that comes with an extra is not installed; the message gives the command that installs it."""


def needs(what: str, library: str, extra: str) -> str:
    """Return the message: ``what`` needs ``library``, and the command that installs it."""
    return f'{what} needs {library}: pip install "friction-tester[{extra}]" (in a clone: pip install ".[{extra}]")'
