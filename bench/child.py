"""CPU time and memory of fresh interpreters."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from bench.effort import TopicFailedError
from bench.machine import measures_installed

ROOT = Path(__file__).resolve().parent.parent
"""Import path of ``bench``, and of ``tester`` and ``sim`` if they are not installed."""


def command(arguments: Sequence[str]) -> list[str]:
    """Return the command line of an interpreter whose ``-c`` code imports the measured ``tester``."""
    # Without -P the current folder, this checkout, precedes the installed packages.
    safe = ["-P"] if arguments[0] == "-c" and measures_installed() else []
    return [sys.executable, *safe, *arguments]


def run(arguments: Sequence[str], expected: int = 0) -> str:
    """Run the interpreter with arguments and return its output; raises TopicFailedError for another exit code."""
    done = subprocess.run(command(arguments), capture_output=True, text=True, check=False, cwd=ROOT)
    if done.returncode != expected:
        raise TopicFailedError(f"python {' '.join(arguments)[:60]}: exit code {done.returncode}: {done.stderr[-300:]}")
    return done.stdout


def cpu_accounting() -> bool:
    """Return whether this system accounts for the CPU time of children."""
    return sys.platform != "win32"


def cpu_seconds_of_child(arguments: Sequence[str]) -> float:
    """Return the CPU seconds of a fresh interpreter, including its start and end (POSIX)."""
    before = _children_s()
    run(arguments)
    return _children_s() - before


def peak_memory_mb() -> float | None:
    """Return the greatest memory this process ever occupied, MB (10^6 bytes); None if the system does not report it."""
    status = Path("/proc/self/status")
    if status.exists():
        for line in status.read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM"):
                return int(line.split()[1]) * 1.024e-3
    if sys.platform == "darwin":
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1e-6
    return None


def _children_s() -> float:
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
