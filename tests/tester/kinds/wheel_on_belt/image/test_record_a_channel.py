"""The how-to page "record a channel", done: its line, put into the table, is recorded, averaged and exported."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import pytest

from tester.base import clock
from tester.base.quantities import LAST, Channel, Figure, Means, Quantities, Screen
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.process_image import Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.machine.sampler import Sampler
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.kinds.wheel_on_belt.bench import make_bench
from tests.tester.results.made import made
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, result

PAGE = Path(__file__).parents[5] / "docs" / "how-to" / "record-a-channel.md"


@pytest.fixture(scope="module")
def table() -> Quantities:
    """Return the wheel's table with the page's line in it."""
    line = PAGE.read_text("utf-8").split("<!-- channel -->\n```python\n")[1].split("```")[0]
    added = eval(line, {"Channel": Channel, "Screen": Screen, "Figure": Figure})  # noqa: S307 - our own page
    at = next(i for i, one in enumerate(QUANTITIES.channels) if one.name in LAST)
    return Quantities((*QUANTITIES.channels[:at], added, *QUANTITIES.channels[at:]), QUANTITIES.roles)


def test_the_scan_records_it(table: Quantities) -> None:
    bench = make_bench()
    bench.ctx.readings.belt_torque_nm = 4.25
    Sampler(bench.notes, table).record(bench.ctx, Setpoints())
    row = dict(zip(table.names, bench.notes.rows[-1], strict=True))
    assert (row["belt_torque_nm"], row["gate"]) == (4.25, 0.0)


def test_a_screen_has_a_bar_for_it(table: Quantities) -> None:
    screen = table["belt_torque_nm"].screen
    assert screen is not None and screen.low.of(load_rig()) == -screen.high.of(load_rig()) < 0.0
    assert table.shown[-1].name == "belt_torque_nm"


def test_it_is_stored_and_exported(table: Quantities, tmp_path: Path) -> None:
    writer = RunWriter(tmp_path / "run.db", table, clock=clock.monotonic, synchronous=True)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    key = writer.begin_repeat(1, 1, 1)
    writer.sample((*(float(i) for i in range(len(table.names) - 1)), float(key)))
    found = result()
    means = Means(table, [*found.means.values(), 4.25])
    writer.commit_repeat(key, replace(found, means=means))
    writer.close()
    with RunReader(tmp_path) as reader:
        (repeat,) = csv.DictReader(made("repeats", reader).decode("utf-8-sig").splitlines())
        (sample,) = csv.DictReader(made("samples", reader).decode("utf-8-sig").splitlines())
        assert reader.repeats()[0].result.means["belt_torque_nm"] == 4.25
    assert [*repeat][-1] == "measured_belt_torque_nm" and repeat["measured_belt_torque_nm"] == "4.25"
    assert sample["belt_torque_nm"] == str(float(table.index("belt_torque_nm")))
