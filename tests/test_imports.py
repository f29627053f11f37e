"""Modules that each part loads: start-up stays quick, and the scan never loads a plotting or screen library."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

LOADED = "import json, sys; print(json.dumps(sorted({name.partition('.')[0] for name in sys.modules})))"
EVERY_MODULE = """
import importlib, pkgutil
for name in {names!r}:
    package = importlib.import_module(name)
    for found in pkgutil.walk_packages(package.__path__, name + "."):
        importlib.import_module(found.name)
"""
HELP = """
import contextlib, io
from tester.cli.main import invoke
with contextlib.redirect_stdout(io.StringIO()):
    assert invoke(["--help"]) == 0
"""


def output_of(code: str) -> str:
    """Return what a fresh interpreter prints."""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def loaded_by(code: str) -> set[str]:
    """Return the top-level modules that are loaded after running code in a fresh interpreter."""
    return set(json.loads(output_of(code + LOADED).splitlines()[-1]))


@pytest.mark.parametrize("package", ["tester.machine", "tester.kinds", "tester.inputs.recipe", "sim"])
def test_no_module_of_a_package_loads_a_screen_plotting_or_fitting_library(package: str) -> None:
    assert not loaded_by(EVERY_MODULE.format(names=[package])) & {"textual", "matplotlib", "scipy", "pandas"}


def test_no_driver_loads_numpy_or_file_readers() -> None:
    assert not loaded_by(EVERY_MODULE.format(names=["drivers"])) & {"numpy", "yaml", "pydantic", "rich", "click"}


def test_drivers_load_neither_simulator_nor_application() -> None:
    assert not loaded_by(EVERY_MODULE.format(names=["drivers"])) & {"sim", "tester"}


def test_simulator_does_not_load_the_application() -> None:
    assert "tester" not in loaded_by(EVERY_MODULE.format(names=["sim"]))


def test_stop_loads_only_its_sender() -> None:
    code = """
from tester.cli.main import invoke
from tester.service.stop_call import StopCall
StopCall.stop = lambda self, *, fast=False: None
assert invoke(["stop"]) == 0
"""
    assert not loaded_by(code) & {"pydantic", "asyncio", "numpy", "yaml", "websockets"}


@pytest.mark.parametrize("arguments", ['["--help"]', "[]"], ids=["help", "next steps"])
def test_help_and_next_steps_load_nothing_heavy(
    arguments: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    loaded = loaded_by(HELP.replace('["--help"]', arguments))
    assert not loaded & {"pydantic", "numpy", "yaml", "rich", "can", "pymodbus", "pyarrow", "sqlite3", "drivers", "sim"}


def test_a_plan_loads_no_wire_and_no_numbers_library() -> None:
    plan = HELP.replace('["--help"]', '["plan", "quickstart"]')
    assert not loaded_by(plan) & {"numpy", "can", "pymodbus", "pyarrow", "serial"}


def test_help_takes_less_than_150_ms_of_cpu() -> None:
    measured = f"import time\n{HELP}\nprint(time.process_time())"
    assert min(float(output_of(measured)) for _ in range(3)) < 0.15
