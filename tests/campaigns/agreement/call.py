"""The command line in this process: what it prints, as text."""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Printed:
    """What a command wrote, and its exit code."""

    code: int
    out: str
    err: str


class CallError(Exception):
    """A command that should print results failed."""


@contextmanager
def _streams() -> Iterator[tuple[io.TextIOWrapper, io.TextIOWrapper]]:
    """Capture the standard streams, bytes included."""
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8", newline="") for _ in range(2))
    program = sys.argv
    sys.argv = ["tester"]
    try:
        with redirect_stdout(out), redirect_stderr(err):
            yield out, err
    finally:
        sys.argv = program


def captured(work: Callable[[], int]) -> Printed:
    """Return what some work writes."""
    with _streams() as (out, err):
        code = work()
        texts: list[str] = []
        for stream in (out, err):
            stream.flush()
            stream.seek(0)
            texts.append(stream.read())
    return Printed(code, texts[0], texts[1])


def called(*arguments: str) -> Printed:
    """Return what `tester ARGUMENTS` prints; raises CallError if it fails."""
    from tester.cli.main import invoke

    found = captured(lambda: invoke([*arguments]))
    if found.code:
        raise CallError(f"tester {' '.join(arguments)}: exit {found.code}: {found.err[-500:]}")
    return found
