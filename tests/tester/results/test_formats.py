"""A format is defined once: commands, screens, run folders and verification read the table. Packages add their own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner

from tester.base.plugins import ALLOW_VARIABLE, PluginError, plugins
from tester.cli.result_commands import export as export_command
from tester.results.formats import FORMATS, format_names, format_of
from tester.results.run_files import write_all
from tests.tester.base.test_plugins import install
from tests.tester.store.build import small_run

MODULE = """
from tester.results.formats import Format

def write(record, file):
    for row in record.results.rows:
        file.write(f"{row.info.compound} {row.result.mu_resultant:.2f}\\n".encode())

PLAIN = Format("plain", "plain.txt", "a line a condition", write)
"""


@pytest.fixture
def laboratory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a run below runs, where a package with a format of its own is installed."""
    points = "plain = lab_formats:PLAIN\nnothing = lab_formats:write\nwear = lab_formats:PLAIN\n"
    declared = f"[friction_tester.formats]\n{points}"
    install(tmp_path / "site", "lab_formats", declared, **{"__init__.py": MODULE})
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    monkeypatch.delenv(ALLOW_VARIABLE, raising=False)
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one")
    plugins.cache_clear()
    yield tmp_path
    plugins.cache_clear()


def test_a_runs_folder_keeps_the_formats_of_the_table(tmp_path: Path) -> None:
    write_all(small_run(tmp_path))
    made = {path.name for path in tmp_path.iterdir()}
    tables = {"appendix.csv", "budget.csv", "conditions.csv", "repeats.csv", "wheel.csv"}
    assert made == {"run.db", "manifest.json", *tables}


def test_no_two_formats_write_the_same_file() -> None:
    assert len({one.file for one in FORMATS.values()}) == len(FORMATS)


def test_a_format_of_an_installed_package_is_listed_without_loading_it(laboratory: Path) -> None:
    assert format_names() == (*FORMATS, "nothing", "plain") and plugins().loaded == ()


@pytest.mark.parametrize("name", ["plain", "lab_formats:PLAIN"])
def test_a_format_of_an_installed_package_is_exported(laboratory: Path, name: str) -> None:
    done = CliRunner().invoke(export_command, ["one", "--format", name])
    assert (done.exit_code, done.stdout) == (0, "1# 0.90\n1# 0.73\n")


def test_a_format_that_is_shipped_cannot_be_replaced(laboratory: Path) -> None:
    assert format_of("wear") is FORMATS["wear"] and plugins().loaded == ()


def test_an_unknown_format_is_a_usage_error_that_names_those_there_are(laboratory: Path) -> None:
    done = CliRunner().invoke(export_command, ["one", "--format", "pain"])
    assert done.exit_code == 2
    assert "appendix, conditions" in done.stderr and "declared: nothing, plain" in " ".join(done.stderr.split())


def test_a_path_is_no_format(laboratory: Path) -> None:
    done = CliRunner().invoke(export_command, ["one", "--format", "./lab_formats.py"])
    assert done.exit_code == 2 and "is a path" in done.stderr


def test_an_extension_that_is_no_format_is_refused(laboratory: Path) -> None:
    with pytest.raises(PluginError, match="is no format"):
        format_of("nothing")
