"""A laboratory's axis: a kind that adds one axis, set by a person, to the wheel's."""

from __future__ import annotations

import json
import pickle
import re
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.kinds import find, load_rig, packaged_text
from tester.kinds.wheel_on_belt.image.axes import AXES, held_by
from tester.store.run_reader import RunReader
from tests.extension.counts import ROOT
from tests.extension.installing import installed
from tests.tester.inputs.recipe.texts import load_recipe

PAGE = (ROOT / "docs" / "how-to" / "add-an-axis.md").read_text(encoding="utf-8")
RECIPE = re.compile(r"<!-- wet.yaml -->\n```yaml\n(.*?)```", re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A laboratory's folder: its module is installed, its rig file names the kind, the page's recipe is run."""
    own = packaged_text().replace("\nkind: wheel_on_belt", "\nkind: lab_water:KIND", 1)
    folder = tmp_path_factory.mktemp("lab")
    (folder / "my-rig.yaml").write_text(own, encoding="utf-8")
    (folder / "wet.yaml").write_text(RECIPE.findall(PAGE)[0], encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        with installed("axis", folder / "site", patch):
            assert invoke(["run", "wet.yaml", "--rig", "my-rig.yaml", "--yes"]) == 0
            yield folder


def run_of(folder: Path) -> Path:
    (found,) = (path for path in (folder / "runs").iterdir() if (path / "run.db").exists())
    return found


def test_it_is_a_column_of_the_table(folder: Path) -> None:
    header, dry, wet = (run_of(folder) / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()
    assert header.split(",")[:3] == ["Formula", "Interface", "Slip Velocity /mm·s⁻¹"]
    assert (dry.split(",")[1], wet.split(",")[1]) == ("dry", "wet")
    conditions = (run_of(folder) / "conditions.csv").read_text(encoding="utf-8-sig").splitlines()
    assert any("interface" in line.split(",") for line in conditions)


def test_a_person_was_asked_for_it_once_and_the_wheel_was_warmed_again(folder: Path) -> None:
    with closing(RunReader(run_of(folder))) as reader:
        asked = [prompt.text for prompt in reader.prompts() if "belt" in prompt.text]
        heated = [event.text for event in reader.events() if event.text.startswith("heat to")]
    assert asked == ["the belt is to be wet"] and len(heated) == 2


def test_the_record_states_the_axis_without_the_kind_and_is_verified(folder: Path) -> None:
    assert invoke(["verify", str(run_of(folder))]) == 0
    with closing(RunReader(run_of(folder))) as reader:
        assert [str(one.info.setpoint.value("interface")) for one in reader.conditions()] == ["dry", "wet"]
        assert reader.axes()["interface"].choices == ("dry", "wet")


def test_a_plan_shows_the_axis_in_words_and_as_json(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["plan", "wet.yaml", "--rig", "my-rig.yaml"]) == 0
    assert "wet, 300 mm/s, 200 N" in capsys.readouterr().out
    assert invoke(["plan", "wet.yaml", "--rig", "my-rig.yaml", "--json"]) == 0
    steps = json.loads(capsys.readouterr().out)["steps"]
    found = [
        (step["interface"], step["load_n"], step["temperature_c"]) for step in steps if step["kind"] == "condition"
    ]
    assert found == [("dry", 200, 40), ("wet", 200, 40)]


def test_a_further_axis_leaves_the_hold_of_the_wheel_unchanged(folder: Path) -> None:
    recipe = find("lab_water:KIND").recipe
    assert recipe is not None
    values = {"slip_velocity": 0.3, "load": 200.0, "sideslip": 7.0, "temperature": 40.0}
    plain, wet = AXES.setpoint("1#", **values), recipe().axes.setpoint("1#", interface="wet", **values)
    assert held_by(wet) == held_by(plain) and plain.values != wet.values


def test_a_plan_goes_to_other_processes(folder: Path) -> None:
    rig = load_rig("my-rig.yaml")
    recipe = find(rig.kind).recipe
    assert recipe is not None
    plan = recipe().expand(load_recipe(Path("wet.yaml"), recipe()).recipe, rig)
    assert pickle.loads(pickle.dumps(plan)) == plan  # noqa: S301 - our own


def test_screens_have_it(folder: Path) -> None:
    served = find("lab_water:KIND").served
    assert served is not None
    assert [one.name for one in served().machine.axes] == ["interface", *(axis.name for axis in AXES)]


def test_the_kind_it_was_made_from_has_it_not(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "interface" not in [axis.name for axis in AXES]
    assert invoke(["check", "wet.yaml"]) == 3
    assert "interface" in capsys.readouterr().err
