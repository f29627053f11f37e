"""The build back end (PEP 517): setuptools, which asks for mypy only where the scan is to be compiled."""

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
"""Translates Python to C; pinned to one minor release, as another may translate another way."""

Settings = Mapping[str, object]


def get_requires_for_build_wheel(config_settings: Settings | None = None) -> list[str]:
    """Return what a wheel is built with, beside setuptools: nothing, or mypy where the scan is to be compiled."""
    required = build_meta.get_requires_for_build_wheel(config_settings)
    return [*required, COMPILER] if wanted() else required


def build_editable(
    wheel_directory: str, config_settings: Settings | None = None, metadata_directory: str | None = None
) -> str:
    """Make an editable installation, which is plain Python. Raises SystemExit where a compiled one is asked for."""
    if wanted():
        raise SystemExit(f"{VARIABLE}=1: an editable installation runs the source and cannot be compiled; unset it")
    return build_meta.build_editable(wheel_directory, config_settings, metadata_directory)
