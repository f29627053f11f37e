"""Use on a system without POSIX: modules that Windows lacks are blocked.

It shows that nothing needs them without a clear error. It cannot show how Windows itself treats sockets, files and
signals. Untried there: docs/windows.md.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ABSENT = ("termios", "tty", "pty", "fcntl", "resource", "pwd", "grp", "syslog", "readline", "curses", "_posixshmem")
"""Modules of the standard library that Windows does not have."""
WITHOUT = f"""
import os, socket, sys
import filelock  # it has a lock of Windows' own; without fcntl, elsewhere, it has none that is held
for name in {ABSENT!r}:
    sys.modules[name] = None  # every import of it fails
for name in ("AF_UNIX", "SO_REUSEPORT", "AF_CAN", "PF_CAN", "CAN_RAW"):
    if hasattr(socket, name):
        delattr(socket, name)
for name in ("fork", "openpty", "setsid", "killpg", "sched_setscheduler", "sched_getscheduler",
             "sched_param", "SCHED_RR", "sched_setaffinity", "wait4", "mkfifo", "tcgetpgrp"):
    if hasattr(os, name):
        delattr(os, name)
"""
EVERY = """
import importlib, pkgutil
for name in ("drivers", "sim", "tester"):
    package = importlib.import_module(name)
    for found in pkgutil.walk_packages(package.__path__, name + "."):
        try:
            importlib.import_module(found.name)
        except Exception as error:
            if "friction-tester[" not in str(error):  # the library of an extra that is not installed
                raise
"""
INVOKE = """
from tester.cli.main import invoke
sys.exit(invoke({arguments!r}))
"""


def without_posix(code: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run code in an interpreter that has lost what Windows lacks."""
    return subprocess.run(
        [sys.executable, "-c", WITHOUT + code], cwd=folder, capture_output=True, text=True, encoding="utf-8",
        env=os.environ | {"LOGNAME": "somebody"}, check=False,  # Windows says USERNAME
    )


def test_every_module_can_be_imported(tmp_path: Path) -> None:
    done = without_posix(EVERY, tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["check", "quickstart"],
        ["plan", "quickstart"],
        ["rig", "show"],
        ["rig", "init", "rig.yaml"],
        ["sim", "--help"],
    ],
)
def test_commands_that_move_nothing_work(arguments: list[str], tmp_path: Path) -> None:
    done = without_posix(INVOKE.format(arguments=arguments), tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout


SHORT = """\
recipe: short
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 2
  min_valid: 1
  window: 10 rev
  temperature_band: 20 K
  soak: {within: 5 degC, for: 1 s}
grids:
  - name: short
    slip_velocity: 100 mm/s
    load: 100 N
    temperature: 24.2 degC
wheel: {replace_after: 15 mm}
"""


def test_a_run_in_one_process_comes_to_its_end(tmp_path: Path) -> None:
    (tmp_path / "recipe.yaml").write_text(SHORT, encoding="utf-8")
    arguments = ["run", "recipe.yaml", "--yes", "--out", "runs"]
    done = without_posix(INVOKE.format(arguments=arguments), tmp_path)
    assert done.returncode == 0, done.stderr
    assert list((tmp_path / "runs").glob("*/conditions.csv"))

