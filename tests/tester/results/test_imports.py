"""Imports of a run stay light."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize(
    "module",
    [
        "tester.store.writer",
        "tester.store.run_reader",
        "tester.analysis.blocks",
        "tester.analysis.reduce",
        "tester.analysis.repeats",
        "tester.results",
        "tester.cli.result_commands",
    ],
)
def test_store_analysis_and_export_load_no_heavy_library(module: str) -> None:
    heavy = "{'numpy', 'scipy', 'pyarrow', 'matplotlib', 'textual', 'pydantic'}"
    code = f"import {module}, sys; print(*sorted({heavy} & set(sys.modules)))"
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parents[3], capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == ""
