"""Twenty forgeries of a finished run: each is reported with the head kept, and without it where the chain is broken."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.results.verify import verify
from tests.campaigns.forgery.forge import FORGERIES, Forgery, detected, remake_all
from tests.campaigns.forgery.run import finished_run


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    home = tmp_path_factory.mktemp("forgery")
    return finished_run(home / "one", 1), finished_run(home / "two", 2)


def test_the_run_itself_is_as_it_was_left(runs: tuple[Path, Path]) -> None:
    found = verify(runs[0])
    assert verify(runs[0], found.head).problems == () and found.coefficients == 3


def test_there_are_twenty_kinds() -> None:
    assert len({forgery.name for forgery in FORGERIES}) == 20


BY_ITS_COEFFICIENTS = (
    "samples changed",
    "chain dropped, this schema claimed",
    "chain dropped, an earlier schema claimed",
    "every sample deleted",
)
"""Forgeries that contradict the samples, so that making everything anew does not hide them."""


@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda forgery: forgery.name)
def test_a_forgery_is_reported(runs: tuple[Path, Path], forgery: Forgery, tmp_path: Path) -> None:
    kept, without, kept_all_anew, _ = detected(*runs, forgery, tmp_path)
    assert (kept, without, kept_all_anew) == (True, True, True)


@pytest.mark.parametrize("name", BY_ITS_COEFFICIENTS)
def test_the_coefficients_report_it_even_with_all_made_anew(
    runs: tuple[Path, Path], name: str, tmp_path: Path
) -> None:
    (forgery,) = (one for one in FORGERIES if one.name == name)
    assert detected(*runs, forgery, tmp_path)[3]


def test_an_earlier_head_is_reported_with_the_later_changes(
    runs: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    from tester.store.run_reader import RunReader

    with RunReader(runs[0]) as reader:
        chain = reader.chain()
    assert invoke(["verify", str(runs[0]), "--head", chain.heads[-2].hex()]) == 1
    assert f"by 1 rows: {chain.names[-1]}" in capsys.readouterr().err
    assert invoke(["verify", str(runs[0]), "--head", chain.head.upper()]) == 0


def test_a_head_that_is_no_hash_is_refused(runs: tuple[Path, Path]) -> None:
    assert invoke(["verify", str(runs[0]), "--head", "abc"]) == 2


def test_rebuilding_everything_over_correct_data_gives_another_head(runs: tuple[Path, Path], tmp_path: Path) -> None:
    import shutil

    folder = tmp_path / runs[1].name
    shutil.copytree(runs[1], folder)
    head = verify(folder).head
    remake_all(folder)
    assert verify(folder).problems == ()
    assert any("another record than the one of the head" in line for line in verify(folder, head).problems)
