"""Make an example importable like an installed package: its folder on sys.path, and pip's metadata beside it."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tester.base.plugins import plugins

EXAMPLES = Path(__file__).parent / "examples"


def describe(project: Path, site: Path) -> None:
    """Write the .dist-info of a project, from its pyproject.toml, into a folder of sys.path."""
    said = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    name, version = said["name"].replace("-", "_"), said["version"]
    about = site / f"{name}-{version}.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {said['name']}\nVersion: {version}\n")
    (about / "top_level.txt").write_text(name)
    points = ""
    for group, declared in said.get("entry-points", {}).items():
        points += f"[{group}]\n" + "".join(f"{key} = {target}\n" for key, target in declared.items())
    (about / "entry_points.txt").write_text(points)


@contextmanager
def installed(example: str, site: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Install an example within the block; its modules are unloaded afterwards. ``site``: an empty folder."""
    folder = EXAMPLES / example
    if (folder / "pyproject.toml").exists():
        describe(folder / "pyproject.toml", site)
        monkeypatch.syspath_prepend(str(site))
    monkeypatch.syspath_prepend(str(folder))
    before = set(sys.modules)
    plugins.cache_clear()
    yield folder
    plugins.cache_clear()
    for name in set(sys.modules) - before:
        if str(getattr(sys.modules[name], "__file__", None) or "").startswith(str(folder)):
            del sys.modules[name]
