"""Fresh copies of the checkout, and commands in them: their output with times, and their CPU time."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from time import monotonic  # noqa: TID251 - measures how long a person waits

ROOT = Path(__file__).parents[3]
PASS_S = 0.015
"""CPU time of `python3 -c pass` on the reference machine of the limits (s)."""
_LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "runs", "build", "dist", "__pycache__", "*.egg-info", ".*_cache")
_NOT_HANDED_ON = frozenset(
    {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "VIRTUAL_ENV", "FRICTION_TESTER_COMPILE", "PIP_CACHE_DIR"}
)


@dataclass(frozen=True, slots=True)
class CommandResult:
    """A command's output on both streams, its exit code (None: it was terminated), and times in s."""

    code: int | None
    text: str
    wall_s: float
    cpu_s: float
    """Of the command and all its children; 0 if it was terminated."""
    first_s: float
    """Until the first output."""
    silence_s: float
    """The longest time without output."""


def fresh_copy(to: Path) -> Path:
    """Copy the repository's files (and those not ignored, for a check before a commit) to a new folder."""
    listed = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if listed.returncode:
        shutil.copytree(ROOT, to, ignore=_LEFT_OUT)
        return to
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file():
            (to / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, to / name)
    return to


def readme_command(ends: str) -> str:
    """Return the README's POSIX command that ends with these words; raises LookupError unless there is one."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = [line for line in text.splitlines() if line.startswith("python3 -m venv ") and line.endswith(ends)]
    if len(found) != 1:
        raise LookupError(f"README.md has {len(found)} commands that end with {ends}, not 1")
    return found[0]


def carry_out(
    command: str,
    folder: Path,
    *,
    until: Callable[[str], bool] | None = None,
    on_output: Callable[[str, float], None] | None = None,
    cores: set[int] | None = None,
    **env: str,
) -> CommandResult:
    """Run a shell command without a package cache; terminate it once ``until`` is true of its output so far.

    ``on_output``: called with each new piece of output, and the time since the start (s). ``cores``: cores it may run
    on.
    """
    environment = {key: value for key, value in os.environ.items() if key not in _NOT_HANDED_ON}
    environment |= {"PIP_NO_CACHE_DIR": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", **env}
    begun = last = monotonic()
    process = subprocess.Popen(
        ["bash", "-c", command], cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, start_new_session=True,
        preexec_fn=(lambda: os.sched_setaffinity(0, cores)) if cores else None,
    )  # fmt: skip
    assert process.stdout is not None
    text, first_s, silence_s = "", 0.0, 0.0
    while chunk := os.read(process.stdout.fileno(), 1 << 16):
        now = monotonic()
        first_s = first_s or now - begun
        silence_s, last = max(silence_s, now - last), now
        piece = chunk.decode(errors="replace")
        text += piece
        if on_output is not None:
            on_output(piece, now - begun)
        if until is not None and until(text):
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return CommandResult(None, text, monotonic() - begun, 0.0, first_s, silence_s)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stdout.close()
    cpu_s = usage.ru_utime + usage.ru_stime
    return CommandResult(process.returncode, text, monotonic() - begun, cpu_s, first_s, silence_s)


def pass_s(interpreter: Path) -> float:
    """Return the CPU time of `python -c pass` (s), the median of eleven.

    Uses a fresh environment's interpreter: another may start through a launcher, or load what its site-packages
    require, which would make the scaled limits too wide.
    """

    def once() -> float:
        process = subprocess.Popen([str(interpreter), "-c", "pass"])
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        return usage.ru_utime + usage.ru_stime

    return median(once() for _ in range(11))


def megabytes(folder: Path) -> float:
    """Return a folder's size on the disk (10^6 bytes), links not followed."""
    return sum(path.lstat().st_blocks for path in folder.rglob("*")) * 512 / 1e6


def without_warnings(text: str, lines: int = 15) -> str:
    """Return the last lines of an output, for a message."""
    return "\n".join([line for line in text.splitlines() if not re.match(r"\s*WARNING", line)][-lines:])
