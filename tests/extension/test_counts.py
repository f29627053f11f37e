"""The count of files that name an axis or a channel: its rules, and its upper bounds."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.extension.counts import AT_MOST, COUNTS, EXAMPLES, Count, files_naming, files_of, main, words_in

NOW = {"camber": 3, "moment_z_nm": 4}
"""Files at present: ask before you add another."""


@pytest.mark.parametrize("count", COUNTS, ids=[count.name for count in COUNTS])
def test_no_further_file_names_an_axis_or_a_channel(count: Count) -> None:
    found = files_naming(count.name)
    assert len(found) <= NOW[count.name], found


def test_the_count_prints_the_files_and_its_exit_code_is_the_verdict(capsys: pytest.CaptureFixture[str]) -> None:
    code = main()
    told = capsys.readouterr().out
    inside = all(len(files_naming(count.name)) <= count.at_most for count in COUNTS)
    beside = all(0 < len(files_of(example)) <= at_most for example, at_most in AT_MOST.items())
    assert code == int(not (inside and beside))
    assert "axis camber: " in told and "  tester/kinds/wheel_on_belt/image/axes.py\n" in told


@pytest.mark.parametrize("example", sorted(path.name for path in EXAMPLES.iterdir() if path.is_dir()))
def test_an_example_has_no_more_files_than_a_stranger_is_to_write(example: str) -> None:
    assert 0 < len(files_of(example)) <= AT_MOST[example], files_of(example)


def test_identifiers_and_texts_count_and_prose_does_not(tmp_path: Path) -> None:
    source = '"""camber"""\n# camber\n\ndef f(a):\n    """camber"""\n    return a.camber_deg, "camber of it"\n'
    assert sorted(words_in(source)) == ["a", "a", "camber of it", "camber_deg", "f"]
    (tmp_path / "sim").mkdir()
    (tmp_path / "sim" / "one.py").write_text('"""camber"""\n', encoding="utf-8")
    (tmp_path / "sim" / "two.py").write_text("camber_deg = 1\n", encoding="utf-8")
    (tmp_path / "sim" / "three.py").write_text("cambering = 1\n", encoding="utf-8")
    assert files_naming("camber", tmp_path) == [Path("sim/two.py")]
