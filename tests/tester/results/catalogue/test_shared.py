"""The shared catalogue: the same answers as the index next to the runs, from SQLite and from a real PostgreSQL."""

from __future__ import annotations

import os
import shutil
import socket
import sqlite3
import subprocess
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tester.results.catalogue import open_catalogue
from tester.results.catalogue.entries import Catalogue, CatalogueError, WantedRuns, origin_of, refresh
from tests.tester.store.build import small_run

sqlalchemy = pytest.importorskip("sqlalchemy", reason="the extra `catalogue` is not installed")


def postgres_tools() -> Path | None:
    """Return the folder of a PostgreSQL server's programs, Debian's included."""
    found = shutil.which("initdb")
    if found:
        return Path(found).parent
    return next((path.parent for path in sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), reverse=True)), None)


@pytest.fixture
def postgres(tmp_path: Path) -> Iterator[str]:
    """A PostgreSQL server for this test, on a socket in its folder; yields its URL."""
    tools = postgres_tools()
    if tools is None:
        pytest.skip("no PostgreSQL server is installed")
    # The server refuses to run as root: as root, run it as the user of Debian's package.
    as_user = ["runuser", "-u", "postgres", "--"] if os.geteuid() == 0 else []
    if as_user and subprocess.run([*as_user, "true"], capture_output=True).returncode:
        pytest.skip("this is root, and there is no user postgres")
    home = tmp_path / "postgres"
    home.mkdir()
    if as_user:
        shutil.chown(home, "postgres")
        for parent in (home, *home.parents):
            if parent.stat().st_uid == os.geteuid() or parent == home:
                parent.chmod(parent.stat().st_mode | 0o011)
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]

    def run(program: str, *arguments: str) -> None:
        command = [*as_user, str(tools / program), *arguments]
        done = subprocess.run(command, cwd=home, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=120)
        assert done.returncode == 0, done.stderr.decode()

    data = str(home / "data")
    run("initdb", "-D", data, "-U", "lab", "--auth=trust", "--no-sync", "-E", "UTF8")
    options = f"-p {port} -c listen_addresses=127.0.0.1 -c unix_socket_directories='' -c fsync=off"
    run("pg_ctl", "-D", data, "-o", options, "-l", str(home / "log"), "-w", "start")
    try:
        yield f"postgresql://lab@127.0.0.1:{port}/postgres"
    finally:
        run("pg_ctl", "-D", data, "-m", "immediate", "-w", "stop")


def check(catalogue: Catalogue, runs: Path) -> None:
    """Compare a catalogue with the index next to the same runs, through changes of them."""
    local = open_catalogue(runs, "")
    small_run(runs / "one")
    small_run(runs / "two", ([0.5, 0.52, 0.51],))
    for _ in range(2):  # nothing is new the second time
        for one in (catalogue, local):
            refresh(one, runs)
    for wanted in (
        WantedRuns(),
        WantedRuns("1#"),
        WantedRuns("#"),
        WantedRuns(since="2024-03"),
        WantedRuns(recipe="TWO l"),
        WantedRuns(recipe="%"),
    ):
        assert catalogue.runs(wanted) == local.runs(wanted)
    for run in local.runs(WantedRuns()):
        assert catalogue.conditions(run) == local.conditions(run) and local.conditions(run)
    shutil.rmtree(runs / "one")
    refresh(catalogue, runs)
    assert list(catalogue.fingerprints(origin_of(runs))) == ["two"]
    assert [run.name for run in catalogue.runs(WantedRuns())] == ["two"]
    local.close()
    catalogue.close()


def test_a_shared_catalogue_answers_as_the_local_index(tmp_path: Path) -> None:
    check(open_catalogue(tmp_path / "runs", f"sqlite:///{tmp_path / 'shared.db'}"), tmp_path / "runs")


@pytest.mark.campaign
def test_postgresql_answers_as_the_local_index(tmp_path: Path, postgres: str) -> None:
    check(open_catalogue(tmp_path / "runs", postgres), tmp_path / "runs")


@pytest.mark.campaign
def test_two_laboratories_share_one_postgresql(tmp_path: Path, postgres: str) -> None:
    for place in ("here", "there"):
        small_run(tmp_path / place / "run")
        catalogue = open_catalogue(tmp_path / place, postgres)
        refresh(catalogue, tmp_path / place)
        catalogue.close()
    catalogue = open_catalogue(tmp_path, postgres)
    assert len({run.origin for run in catalogue.runs(WantedRuns())}) == 2
    catalogue.close()


def test_tables_of_another_version_are_refused_with_the_way_out(tmp_path: Path) -> None:
    with closing(sqlite3.connect(tmp_path / "shared.db")) as database, database:
        database.execute("CREATE TABLE friction_run (origin TEXT, name TEXT, weight TEXT)")
    with pytest.raises(CatalogueError, match=r"another version.*friction_run.*weight.*Drop the tables"):
        open_catalogue(tmp_path / "runs", f"sqlite:///{tmp_path / 'shared.db'}")


def test_a_missing_catalogue_is_reported(tmp_path: Path) -> None:
    with pytest.raises(CatalogueError, match="cannot be used"):
        open_catalogue(tmp_path, f"sqlite:///{tmp_path / 'no' / 'folder' / 'x.db'}")
