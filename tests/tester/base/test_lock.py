"""Exclusive use: refusals, their text, and when the lock is free again."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tester.base.lock import ExclusiveUse, RigInUseError, user_of
from tester.run.preconditions import buses_of
from tests.tester.inputs.recipe.texts import rig

HOLD = """
import sys
from pathlib import Path
from tester.base.lock import ExclusiveUse
use = ExclusiveUse(Path(sys.argv[1]))
use.lock(["can socketcan:can0"], "table 2")
print("held", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def other(tmp_path: Path) -> subprocess.Popen[str]:
    """Another process that holds can0."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    yield process  # type: ignore[misc]
    process.kill()
    process.communicate()


def test_a_second_process_is_refused_with_the_holder_of_the_rig(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    with pytest.raises(RigInUseError) as refused:
        ExclusiveUse(tmp_path).lock(["can socketcan:can0"], "another")
    text = str(refused.value)
    assert text.startswith("can socketcan:can0 is in use: process ")
    assert f"process {other.pid} of user " in text and " since 20" in text and text.endswith("for table 2")


def test_a_refused_process_leaves_the_holders_text_unchanged(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    for _ in range(2):
        with pytest.raises(RigInUseError, match=f"process {other.pid} of user .* for table 2"):
            ExclusiveUse(tmp_path).lock(["can socketcan:can0"], "another")
    (path,) = tmp_path.iterdir()
    holder = user_of(path)
    assert holder is not None and (holder.pid, holder.run) == (other.pid, "table 2")


@pytest.mark.skipif(os.name != "posix", reason="kills by POSIX signals")
def test_a_killed_process_frees_the_rig(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    other.send_signal(signal.SIGKILL)
    other.wait()
    with ExclusiveUse(tmp_path) as use:
        use.lock(["can socketcan:can0"], "another")
        assert taken(tmp_path, "can socketcan:can0")


def taken(folder: Path, resource: str) -> bool:
    """Return whether another process holds a bus."""
    try:
        with ExclusiveUse(folder) as use:
            use.lock([resource], "a third")
    except RigInUseError:
        return True
    return False


@pytest.mark.skipif(os.name != "posix", reason="modes are POSIX's")
def test_everybody_may_lock_a_bus_and_only_its_user_a_run_whatever_the_umask_is(tmp_path: Path) -> None:
    def mode(path: Path) -> int:
        return path.stat().st_mode & 0o777

    before = os.umask(0o077)
    try:
        with ExclusiveUse(tmp_path) as use:
            use.lock(["can socketcan:can0"], "x")
            (bus,) = tmp_path.iterdir()
            use.lock_file("run", tmp_path / ".lock", "x", lasting=False)
            assert (mode(bus), mode(tmp_path / ".lock")) == (0o666, 0o644)
    finally:
        os.umask(before)


def test_another_rig_is_free(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    with ExclusiveUse(tmp_path) as use:
        use.lock(["can socketcan:can1"], "another")
        assert taken(tmp_path, "can socketcan:can1")


def test_no_lock_is_kept_of_a_rig_with_a_taken_bus(tmp_path: Path, other: subprocess.Popen[str]) -> None:
    use = ExclusiveUse(tmp_path)
    with pytest.raises(RigInUseError), use:
        use.lock(["a line", "can socketcan:can0"], "another")
    with ExclusiveUse(tmp_path) as again:
        again.lock(["a line"], "another")


def test_a_lock_file_that_does_not_last_goes_with_its_holder(tmp_path: Path) -> None:
    with ExclusiveUse() as use:
        use.lock_file("run", tmp_path / ".lock", "x", lasting=False)
        holder = user_of(tmp_path / ".lock")
        assert holder is not None and holder.pid == os.getpid()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("text", ["", "[]", '{"pid": "x"}', "\x00\x01", '{"pid": 12'])
def test_a_lock_file_without_a_holder_still_locks(tmp_path: Path, text: str) -> None:
    (tmp_path / ".lock").write_text(text)
    assert user_of(tmp_path / ".lock") is None
    with ExclusiveUse() as use:
        use.lock_file("run", tmp_path / ".lock", "x")
        with pytest.raises(RigInUseError):
            ExclusiveUse().lock_file("run", tmp_path / ".lock", "y")


def test_a_simulated_rig_needs_no_lock() -> None:
    assert buses_of(rig()) == []


def test_every_bus_of_a_real_rig_is_locked() -> None:
    real = replace(rig(), can=replace(rig().can, interface="socketcan", channel="can0"))
    assert buses_of(real) == ["can socketcan:can0", *(f"line {line.port}" for line in real.lines.values())]
