"""The promises: the limit of each ratio, the parts cut for a quick look, and the parts skipped with a reason."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import ClassVar

import pytest
import yaml

from bench.child import ROOT
from bench.cli import main as bench
from bench.figures import Figure, Verdict, at_most
from bench.ladder import recipes
from bench.promises import (
    ASKED,
    Extent,
    beside_skeleton,
    conditions,
    faster,
    flat,
    grosch_text,
    shorter,
    table2,
    table2_text,
)
from bench.versions import Cost, Tree, fingerprint, spent
from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.recipe.part import PART as TRACK
from tester.kinds.wheel_on_belt.recipe.part import PART as WHEEL


class CostedTree(Tree):
    """A tree whose runs take the times listed for its name; keeps the options of the runs."""

    costs: ClassVar[dict[str, Cost]] = {}
    options: ClassVar[list[tuple[str, ...]]] = []

    def cost(self, recipe: Path, out: Path, *options: str) -> Cost:
        self.options.append(options)
        return self.costs[self.name]


def trees(before: Cost, now: Cost, folder: Path = ROOT) -> tuple[Tree, Tree]:
    CostedTree.costs = {"before": before, "now": now}
    CostedTree.options = []
    return CostedTree("before", folder), CostedTree("now", folder)


def cost(cpu_s: float, wall_s: float = 1.0, memory_mb: float = 100.0, rig_s: float = 1000.0) -> Cost:
    return Cost(cpu_s, cpu_s, wall_s, memory_mb, rig_s)


def extent(tmp_path: Path, *, wall: bool = False, skeleton: Path | None = None) -> Extent:
    return Extent(3, True, wall, skeleton, tmp_path)


def by_name(figures: list[Figure]) -> dict[str, Figure]:
    return {figure.name: figure for figure in figures}


@pytest.mark.parametrize(("now_s", "verdict"), [(4.0, Verdict.HOLDS), (4.1, Verdict.MISSED)])
def test_conditions_have_to_take_two_fifths_of_the_time_in_plain_python(
    tmp_path: Path, now_s: float, verdict: Verdict
) -> None:
    first, *_ = conditions(trees(cost(10.0), cost(now_s)), ASKED["plain"], extent(tmp_path))
    assert (first.verdict, first.median) == (verdict, pytest.approx(10.0 / now_s))
    assert len(first.runs) == 3


def test_where_the_runs_differ_in_length_both_ratios_are_shown_and_the_recipe_is_judged() -> None:
    two = trees(cost(10.0), cost(8.0))
    found = faster("a", two, ([cost(10.0, rig_s=1000.0)], [cost(8.0, rig_s=1600.0)]), 2.0)
    whole, equal, *_ = found
    assert (whole.median, whole.verdict) == (1.25, Verdict.MISSED)
    assert (equal.median, equal.verdict) == (2.0, Verdict.SHOWN)


def test_a_share_is_of_the_earlier_time() -> None:
    two = trees(cost(10.0), cost(4.0))
    first, *_ = shorter("a", two, ([cost(10.0)], [cost(4.0)]), at_most(0.5))
    assert (first.median, first.verdict) == (0.4, Verdict.HOLDS)


@pytest.mark.parametrize("wall", [False, True])
def test_table2_is_judged_by_its_processor_time_or_by_its_wall_time(tmp_path: Path, wall: bool) -> None:
    two = trees(cost(100.0, wall_s=10.0), cost(24.0, wall_s=9.0))
    found = table2(two, ASKED["compiled"], extent(tmp_path, wall=wall))
    judged = {figure.name: figure.verdict for figure in found if figure.limit is not None}
    time = Verdict.MISSED if wall else Verdict.HOLDS
    assert list(judged.values()) == [time, Verdict.HOLDS]
    assert set(CostedTree.options) == {("--jobs", "2")}


def test_more_memory_than_before_is_a_miss(tmp_path: Path) -> None:
    two = trees(cost(100.0), cost(1.0, memory_mb=101.0))
    (missed,) = (figure for figure in table2(two, ASKED["plain"], extent(tmp_path)) if figure.missed)
    assert missed.name.endswith("memory, now / before")


def test_without_a_skeleton_its_line_gives_the_reason(tmp_path: Path) -> None:
    found = flat(trees(cost(2.0), cost(1.0)), ASKED["plain"], extent(tmp_path))
    assert (found[-1].verdict, found[-1].note) == (Verdict.UNAVAILABLE, "no --skeleton FOLDER was given")
    found = flat(trees(cost(2.0), cost(1.0)), ASKED["plain"], extent(tmp_path, skeleton=tmp_path))
    assert "rig.py" in found[-1].note


def test_beside_the_skeleton_all_three_speeds_are_shown(tmp_path: Path) -> None:
    costs = [cost(10.0)], [cost(4.0)]
    found = by_name(beside_skeleton(trees(cost(1.0), cost(1.0)), costs, [50.0], 2.7, tmp_path))
    assert [figure.runs for figure in found.values()] == [(50.0,), (2.0,), (5.0,), (2.5,)]
    assert [figure.verdict for figure in found.values()] == [*[Verdict.SHOWN] * 3, Verdict.MISSED]


def test_the_skeleton_runs_from_its_folder(tmp_path: Path) -> None:
    (tmp_path / "rig.py").write_text(
        "class Supervisor:\n    def __init__(self, slow): pass\n"
        "    def run(self, ticks, dt, loads):\n        sum(range(20 * ticks))\n",
        encoding="utf-8",
    )
    found = by_name(flat(trees(cost(2.0), cost(1.0)), ASKED["plain"], extent(tmp_path, skeleton=tmp_path)))
    assert len(found["skeleton"].runs) == 3 and found["skeleton"].least > 0.0


@pytest.mark.parametrize("quick", [False, True])
def test_the_texts_of_both_tables_are_valid(quick: bool) -> None:
    load_checked(table2_text(ROOT, quick), load_rig("sim"), WHEEL, "table2.yaml")
    load_checked(grosch_text(ROOT, quick), load_rig("grosch"), TRACK, "grosch.yaml")


def test_a_look_takes_two_compounds_at_one_temperature() -> None:
    recipe = yaml.safe_load(table2_text(ROOT, True))
    assert len(recipe["specimens"]) == 2 and {grid["temperature"] for grid in recipe["grids"]} == {"40 degC"}


def test_a_command_that_fails_ends_with_its_name_and_complaint(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="mine: exit code 3\nno rig"):
        spent("mine", [sys.executable, "-c", "import sys; sys.stderr.write('no rig'); sys.exit(3)"], tmp_path, {})


def test_processor_time_and_memory_are_those_of_the_command(tmp_path: Path) -> None:
    work = "block = bytearray(200_000_000); sum(range(3_000_000)); print('done')"
    printed, used = spent("mine", [sys.executable, "-c", work], tmp_path, {})
    assert printed == "done\n" and used.memory_mb > 190.0 and 0.0 < used.user_s <= used.cpu_s


def test_a_compiled_copy_is_recognised_by_its_installed_files(tmp_path: Path) -> None:
    (tmp_path / "tester").mkdir()
    (tmp_path / "tester" / "a.py").write_text("A = 1\n", encoding="utf-8")
    first = fingerprint(tmp_path)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "b.py").write_text("B = 1\n", encoding="utf-8")
    assert fingerprint(tmp_path) == first
    (tmp_path / "tester" / "a.py").write_text("A = 2\n", encoding="utf-8")
    assert fingerprint(tmp_path) != first


def test_an_unknown_figure_ends_with_those_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        bench(["promises", "--against", "HEAD", "speed"])
    assert "conditions, flat, table2, grosch, build" in capsys.readouterr().err


def test_whole_conditions_are_the_ladders_first_recipe() -> None:
    names = [recipe.name for recipe in recipes()]
    assert names[0] == "four conditions" and sum(name.startswith("100 Hz") for name in names) == 2
