"""Extensions of a laboratory's own, from installed packages: profiles of devices, export formats, laws, kinds.

An extension is asked for by name and found in one of two ways. A package declares an entry point of that name in the
group ``friction_tester.profiles``, ``.drives``, ``.formats``, ``.laws`` or ``.kinds``; or the name is dotted,
``package.module:object``. A path is refused. Nothing is imported before it is asked for, and what was loaded is kept
for the run's record.

A command that a person starts loads what that person's rig file names. A service is handed names by its clients, so it
loads those only that its own start allowed (``tester serve --allow NAME``, or ``TESTER_ALLOW=NAME,NAME``). The
variable is inherited: what counts for a process counts for those it starts.
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

Group = Literal["profiles", "drives", "formats", "laws", "kinds"]

ALLOW_VARIABLE = "TESTER_ALLOW"
"""Environment variable: names, separated by commas, of the extensions that may be loaded; empty for none. Where it is
not set, all that is asked for."""

_DOTTED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")
_NAME = re.compile(r"\w[\w.-]*")


class PluginError(ValueError):
    """An extension that is not there, not allowed, or not what it should be; the message is for people."""


@dataclass(frozen=True, slots=True)
class Extension:
    """What was loaded, and where it came from."""

    group: Group
    name: str
    """As it was asked for."""
    target: str
    """Where it was found: ``module:object``."""
    distribution: str
    """Name of the installed package, "" for a module that belongs to none."""
    version: str
    sha256: str
    """Of the file that was read (a profile's TOML, else the module's), "" where there is none."""

    def describe(self) -> str:
        """Return a line for people and for the record."""
        package = f"{self.distribution} {self.version}" if self.distribution else "of no installed package"
        return f"{package}, {self.target}, sha256 {self.sha256 or 'unknown'}"


class Plugins:
    """Finds and loads extensions, and keeps what it loaded."""

    def __init__(self, allowed: Collection[str] | None = None) -> None:
        """``allowed``: names that may be loaded; None = all that is asked for."""
        self.allowed = None if allowed is None else frozenset(allowed)
        self._loaded: dict[tuple[Group, str], tuple[Extension, object]] = {}

    @property
    def loaded(self) -> tuple[Extension, ...]:
        """Return what was loaded, in that order."""
        return tuple(extension for extension, _ in self._loaded.values())

    def names(self, group: Group) -> tuple[str, ...]:
        """Return the names that installed packages declare in a group and that may be loaded; imports nothing."""
        declared = {point.name for point in entry_points(group=f"friction_tester.{group}")}
        return tuple(sorted(declared if self.allowed is None else declared & self.allowed))

    def load(self, group: Group, name: str) -> object:
        """Return the object of an extension. Raises PluginError; what its module raises on import passes."""
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
                    found: object = content.decode()
                else:
                    place = import_module(module)
                    found = attrgetter(attribute)(place) if attribute else place
                    content = Path(place.__file__).read_bytes() if place.__file__ else b""
            except (ImportError, SyntaxError, AttributeError, OSError, TypeError, ValueError) as error:
                raise PluginError(f'extension "{name}" ({target}) cannot be loaded: {error}') from error
            known = version(distribution) if distribution else ""
            digest = sha256(content).hexdigest() if content else ""
            self._loaded[group, name] = Extension(group, name, target, distribution, known, digest), found
        return self._loaded[group, name][1]

    def _check(self, name: str) -> None:
        """Refuse a name that is none, or not allowed. Nothing has been imported."""
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
                f'extension "{name}" is not allowed here (allowed: {may}): whoever starts the service allows it, with'
                f" tester serve --allow {name}, or {ALLOW_VARIABLE}"
            )


def _declared(group: Group, name: str) -> tuple[str, str, str]:
    """Return module, object ("" for the module itself) and distribution of an entry point; raises PluginError."""
    points = entry_points(group=f"friction_tester.{group}")
    found = {point.value: point for point in points if point.name == name}
    if len(found) == 1:
        (point,) = found.values()
        return point.module, point.attr, _package(point)
    if found:
        packages = " and ".join(sorted(map(_package, found.values())))
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
    """Let this process, and those it starts, load only these extensions, and what ``TESTER_ALLOW`` names already."""
    os.environ[ALLOW_VARIABLE] = ",".join([*filter(None, [os.environ.get(ALLOW_VARIABLE)]), *names])
    plugins.cache_clear()


@cache
def plugins() -> Plugins:
    """Return the extensions of this process, with what its environment allows."""
    said = os.environ.get(ALLOW_VARIABLE)
    return Plugins(None if said is None else [name.strip() for name in said.split(",") if name.strip()])


class MissingExtraError(Exception):
    """A library that comes with an extra is not installed; the message gives the command that installs it."""


def needs(what: str, library: str, extra: str) -> str:
    """Return the message: ``what`` needs ``library``, and the command that installs it."""
    return f'{what} needs {library}: pip install "friction-tester[{extra}]" (in a clone: pip install ".[{extra}]")'
