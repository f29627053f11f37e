"""The README is true: its recipe checks, its commands exist, its two commands are complete."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tester.cli.command_table import COMMANDS
from tester.cli.main import invoke

README = (Path(__file__).parent.parent / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    """Return the README's code blocks in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE)


def test_recipe_block_has_ten_lines() -> None:
    (recipe,) = blocks("yaml")
    assert len(recipe.splitlines()) == 10


def test_recipe_block_passes_check(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(blocks("yaml")[0], encoding="utf-8")
    assert invoke(["check", str(path)]) == 0, capsys.readouterr().err


def test_every_command_that_is_named_exists() -> None:
    named = set(re.findall(r"(?:`|/|\\|, `)tester ([a-z-]+)", README))
    assert named and named <= set(COMMANDS)


def test_it_is_one_page() -> None:
    assert len(README.split()) <= 900


def test_every_recipe_that_is_named_is_shipped() -> None:
    paragraph = README[README.index("Packaged recipes need no path") :].partition("`--rig")[0]
    named = re.findall(r"`([a-z0-9-]+)`", paragraph)
    shipped = {path.stem for path in (Path(__file__).parent.parent / "recipes").glob("*.yaml")}
    assert set(named) == shipped


def test_predict_example_gives_the_published_value(capsys: pytest.CaptureFixture[str]) -> None:
    (options,) = re.findall(r"`tester predict ([^`]*)`", README)
    words = [quoted or plain for quoted, plain in re.findall(r'"([^"]*)"|(\S+)', options)]
    assert invoke(["predict", *words]) == 0
    assert capsys.readouterr().out == "0.72977\n"


def test_table_agrees_with_the_model(capsys: pytest.CaptureFixture[str]) -> None:
    rows = blocks("csv")[0].splitlines()[1:]
    for row in rows:
        compound, slip, load, _, temperature, mu = row.split(",")
        quantities = ["--slip", f"{slip} mm/s", "--load", f"{load} N", "--temperature", f"{temperature} degC"]
        assert invoke(["predict", "--compound", compound, *quantities]) == 0
        assert float(capsys.readouterr().out) == pytest.approx(float(mu), abs=0.005)


@pytest.mark.parametrize("command", [*blocks("sh"), *blocks("bat")])
def test_install_command_is_one_line_that_makes_its_own_environment(command: str) -> None:
    assert re.fullmatch(r"(python3|py) -m venv \.venv && \S+pip install \S+ && .*\n", command)


def test_windows_forms_stand_beside_the_others() -> None:
    posix = [re.sub(r"^python3", "py", command).replace("/bin/", "\\Scripts\\") for command in blocks("sh")]
    assert posix == blocks("bat")


def test_links_lead_somewhere() -> None:
    links = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert links and all((Path(__file__).parent.parent / link.partition("#")[0]).exists() for link in links)


@pytest.mark.parametrize("word", ["safety-rated", "fail-safe", "fail safe", "E-stop", " SIL", " PL "])
def test_safety_note_promises_nothing_that_software_cannot_keep(word: str) -> None:
    assert word not in README
