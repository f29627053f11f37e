"""A sweep on a real Dask cluster of this machine: scheduler and workers in processes of their own, reached by address.

A campaign: it needs the extra ``cluster``, which neither the default installation nor the default test run has.
"""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tests.tester.kinds.wheel_on_belt.bench import SHORT

pytestmark = pytest.mark.campaign
FILES = ("runs.csv", "conditions.csv", "summary.csv", "totals.csv")
ARGUMENTS = ["--seeds", "3", "--set", "sim.running_in=0", "--set", "sim.noise=0,1"]


def swept(home: Path, name: str, capsys: pytest.CaptureFixture[str], *where: str) -> dict[str, bytes]:
    """Return the tables of a sweep carried out somewhere."""
    assert invoke(["sweep", str(home / "short.yaml"), *ARGUMENTS, "--out", str(home / name), *where]) in (0, 6)
    folder = Path(capsys.readouterr().out.splitlines()[-1])
    return {file: (folder / file).read_bytes() for file in FILES}


def test_a_cluster_gives_the_tables_that_this_machine_gives(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    distributed = import_module("distributed")
    (tmp_path / "short.yaml").write_text(SHORT.replace("14 rev", "7 rev"), encoding="utf-8")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, local_directory=str(tmp_path)
    ) as cluster:
        there = swept(tmp_path, "there", capsys, "--dask", cluster.scheduler_address)
    assert there == swept(tmp_path, "here", capsys, "--jobs", "2")
    assert b"done" in there["runs.csv"] and b"not run" not in there["runs.csv"]


def test_a_missing_scheduler_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    import_module("distributed")
    dask = import_module("dask")
    with dask.config.set({"distributed.comm.timeouts.connect": "1s"}):
        assert invoke(["sweep", "quickstart", "--dask", "tcp://127.0.0.1:1", "--out", str(tmp_path)]) == 2
    assert "no scheduler answers there" in capsys.readouterr().err and not list(tmp_path.iterdir())
