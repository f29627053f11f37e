"""Errors of the operating system in words."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest

from tester.base.trouble import in_words


def test_it_names_the_file_why_and_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(OSError) as caught:
        (tmp_path / "none" / "a.csv").open("w")
    expected = f"{tmp_path}/none/a.csv: there is no such file or folder: check the name"
    assert in_words(caught.value).startswith(expected)


def test_a_folder_in_place_of_a_file_is_reported(tmp_path: Path) -> None:
    with pytest.raises(OSError) as caught:
        tmp_path.open("w")
    assert in_words(caught.value) == f"{tmp_path}: it is a folder, and a file is wanted: name a file"


@pytest.mark.parametrize("number", sorted(errno.errorcode))
def test_no_error_shows_its_number(number: int) -> None:
    told = in_words(OSError(number, os.strerror(number), "a file", None, "another"))
    assert "Errno" not in told and str(number) not in told and told.startswith("a file to another: ")


def test_an_error_without_a_number_is_as_it_is() -> None:
    assert in_words(OSError("the line is dead")) == "the line is dead"
    assert in_words(ValueError("no number")) == "no number"
