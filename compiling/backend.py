"""The build back end (PEP 517): setuptools, which requires mypy only to compile the scan."""

from __future__ import annotations

from collections.abc import Mapping

from setuptools import build_meta
from setuptools.build_meta import (
    build_sdist,
    build_wheel,
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

from compiling.wanted import VARIABLE, wanted

__all__ = [
    "build_editable",
    "build_sdist",
    "build_wheel",
    "get_requires_for_build_editable",
    "get_requires_for_build_sdist",
    "get_requires_for_build_wheel",
    "prepare_metadata_for_build_editable",
    "prepare_metadata_for_build_wheel",
]

COMPILER = "mypy[mypyc]>=2.4,<2.5"
"""Translates Python to C; pinned to one minor release, as another may translate differently."""

Settings = Mapping[str, object]


def get_requires_for_build_wheel(config_settings: Settings | None = None) -> list[str]:
    """Return the build requirements besides setuptools: none, or mypy to compile the scan."""
    required = build_meta.get_requires_for_build_wheel(config_settings)
    return [*required, COMPILER] if wanted() else required


def build_editable(
    wheel_directory: str, config_settings: Settings | None = None, metadata_directory: str | None = None
) -> str:
    """Make an editable installation, which is plain Python. Raises SystemExit if a compiled one is requested."""
    if wanted():
        raise SystemExit(f"{VARIABLE}=1: an editable installation runs the source and cannot be compiled; unset it")
    return build_meta.build_editable(wheel_directory, config_settings, metadata_directory)
