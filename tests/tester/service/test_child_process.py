"""How the service starts the processes of its doors."""

from __future__ import annotations

import os

import pytest

from tester.service.child_process import spawn

pytestmark = pytest.mark.skipif(os.name != "posix", reason="sessions and process groups of POSIX")


def test_a_child_has_its_own_process_group_in_our_session() -> None:
    process, link = spawn("tester.service.stop_door", ())
    try:
        assert os.getpgid(process.pid) == process.pid
        assert os.getsid(process.pid) == os.getsid(0)
    finally:
        link.close()
        process.kill()
        process.wait()
