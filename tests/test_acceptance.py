"""The acceptance checks as tests: those without a run by default, whole campaigns with `-m campaign`."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from tests.campaigns import wear
from tests.campaigns.acceptance.__main__ import main
from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal, near
from tests.campaigns.acceptance.topic import Topic
from tests.campaigns.acceptance.topics import TOPICS

QUICK = {name: TOPICS[name] for name in ("predict", "plan", "check", "startup")}
"""Topics that need no run; the others in their short form: ``python -m tests.campaigns.acceptance``."""

NAN = float("nan")


def all_kept(figures: Iterable[Figure]) -> bool:
    """Show every figure and say whether none misses."""
    measured = list(figures)
    print(*measured, sep="\n")
    return bool(measured) and all(figure.ok for figure in measured)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """A bench whose runs all quick topics share."""
    one = Bench(tmp_path_factory.mktemp("acceptance"))
    yield one
    one.close()


@pytest.fixture(scope="module")
def full_bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    """A bench for the long form of each topic."""
    one = Bench(tmp_path_factory.mktemp("campaign"), full=True, jobs=os.cpu_count() or 1)
    yield one
    one.close()


@pytest.mark.parametrize("topic", QUICK.values(), ids=QUICK)
def test_every_figure_is_kept(topic: Topic, bench: Bench) -> None:
    assert all_kept(topic.measured(bench))


@pytest.mark.campaign
@pytest.mark.parametrize("topic", TOPICS.values(), ids=TOPICS)
def test_every_figure_of_the_long_form_is_kept(topic: Topic, full_bench: Bench) -> None:
    full_bench.start(topic.runs(full_bench))
    assert all_kept(topic.measured(full_bench))


@pytest.mark.parametrize(
    "figure",
    [near("a", 1.2, 1.0, 0.1), near("a", NAN, 1.0, 0.1), at_most("a", 2.0, 1.0), at_most("a", NAN, 1.0),
     at_least("a", 1.0, 2.0), at_least("a", NAN, 2.0), equal("a", [1, 2], [1])],
)  # fmt: skip
def test_figure_outside_its_limit_misses(figure: Figure) -> None:
    assert not figure.ok and str(figure).startswith("MISS a: ")


def test_command_names_every_topic(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(TOPICS)


@pytest.mark.parametrize(("expected", "code", "mark"), [(0.72977, 0, "ok"), (0.8, 1, "MISS")])
def test_command_prints_its_figures_either_way_and_exits_1_on_a_miss(
    expected: float, code: int, mark: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def one(_: Bench) -> Iterator[Figure]:
        yield near("mu", 0.72977, expected, 1e-4)

    monkeypatch.setitem(TOPICS, "predict", replace(TOPICS["predict"], figures=one))
    assert main(["predict"]) == code
    assert any(line.startswith(mark) and "0.72977" in line for line in capsys.readouterr().out.splitlines())


def test_unmeasurable_figures_miss_and_come_after_the_measured_ones(tmp_path: Path) -> None:
    def broken(_: Bench) -> Iterator[Figure]:
        yield equal("first", 1, 1)
        raise ValueError("no such thing")

    first, second = Topic("broken", "", broken).measured(Bench(tmp_path))
    assert first.ok and not second.ok and "no such thing" in second.value


@pytest.mark.campaign
def test_wear_sample() -> None:
    assert wear.main(["--sample"]) == 0
