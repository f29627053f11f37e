"""What an extra brings is asked for by the command that installs it, and a run's record says that it is not there."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tester.base.extras import needs
from tester.cli.main import invoke
from tester.results.catalogue import open_catalogue
from tester.results.catalogue.entries import CatalogueError
from tester.run import provenance


def test_the_command_that_installs_an_extra_is_named() -> None:
    text = needs("the format parquet", "pyarrow", "parquet")
    assert text.startswith('the format parquet needs pyarrow: pip install "friction-tester[parquet]"')


@pytest.mark.parametrize(
    ("command", "library", "extra"),
    [
        (["sweep", "quickstart", "--dask", "tcp://127.0.0.1:1", "--out", "sweeps"], "distributed", "cluster"),
        (["tui", "--web"], "textual_serve.server", "web"),
    ],
)
def test_a_command_that_needs_an_extra_is_a_usage_error(
    command: list[str], library: str, extra: str, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, library, None)
    assert invoke(command) == 2
    assert f'pip install "friction-tester[{extra}]"' in capsys.readouterr().err


def test_a_shared_catalogue_names_its_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sqlalchemy", None)
    monkeypatch.delitem(sys.modules, "tester.results.catalogue.shared", raising=False)
    with pytest.raises(CatalogueError, match=r"SQLAlchemy: pip install .friction-tester\[catalogue\]"):
        open_catalogue(tmp_path, "sqlite://")


def test_a_shared_catalogue_without_its_driver_names_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("sqlalchemy", reason="the extra `catalogue` is not installed")
    monkeypatch.setitem(sys.modules, "psycopg", None)
    with pytest.raises(CatalogueError, match=r"a driver: pip install .friction-tester\[catalogue\]"):
        open_catalogue(tmp_path, "postgresql://nobody@127.0.0.1:1/none")


def test_a_record_says_which_library_was_not_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(provenance, "LIBRARIES", ("click", "no-such-distribution"))
    versions = provenance.library_versions()
    assert versions["no-such-distribution"] == "not installed" and versions["click"][0].isdigit()
