"""A load cell of several transmitters: when a reading is complete, and which transmitter is named where it is not."""

from __future__ import annotations

from math import isnan

import pytest

from drivers.joined_cell import JoinedCell, Transmitter
from drivers.profiles import load_profile
from tests.drivers.modbus_bench import Bench, reply

CHANNELS = ("fx", "fy", "fz", "mz")
LAUMAS = load_profile("laumas_tlb")
KG_N = 9.80665
ORIGIN_S = 1.0
"""Time at which a test begins: every transmitter is set up and was read once."""


class Build:
    """Three Laumas on one line; ``answer`` plays the transmitter that was asked."""

    def __init__(self, most_skew_s: float = 0.03, baud: int = 115200) -> None:
        self.bench = Bench(baud=baud)
        self.parts = [
            Transmitter(f"cell {force}", LAUMAS, unit, self.bench.link, {"force": force}, {})
            for unit, force in enumerate(("fx", "fy", "fz"), 1)
        ]
        self.cell = JoinedCell(self.parts, CHANNELS, most_skew_s)
        self.bench.serve(ORIGIN_S - 0.036)
        for number in range(6):  # the set-up, and its first round
            self.answer(0.006 * (number - 5), 0.0)

    def answer(self, at_s: float, kg: float, status: int = 0) -> int:
        """Answer the last request with a weight, at ``at_s`` after ORIGIN_S; return which was asked."""
        unit_id = self.bench.frames[-1][0]
        data = reply(status, 0, round(100.0 * kg), unit_id=unit_id)
        self.bench.serve(ORIGIN_S + at_s + 0.003, (ORIGIN_S + at_s, data), scan=False)
        return unit_id

    def round(self, at_s: float, step_s: float = 0.006) -> None:
        """Answer each once, ``step_s`` apart: x 10 kg, y 1 kg, z 20 kg."""
        for place in range(3):
            unit_id = self.bench.frames[-1][0]
            self.answer(at_s + place * step_s, {1: 10.0, 2: 1.0, 3: 20.0}[unit_id])


def test_the_transmitters_are_also_read_in_turn_between_scans() -> None:
    build = Build()
    asked = [build.answer(0.006 * number, 1.0) for number in range(1, 8)]
    assert asked == [1, 2, 3, 1, 2, 3, 1]


def test_a_reading_is_whole_with_the_last_part_and_as_old_as_the_first() -> None:
    build = Build()
    build.answer(0.006, 10.0)
    build.answer(0.012, 1.0)
    assert build.cell.stamp_s <= ORIGIN_S
    build.answer(0.018, 20.0)
    cell = build.cell
    assert cell.values[:3] == pytest.approx([10 * KG_N, KG_N, 20 * KG_N])
    assert isnan(cell.values[3])
    assert (cell.valid, cell.stamp_s, cell.skew_s) == (True, ORIGIN_S + 0.006, pytest.approx(0.012))
    assert cell.greatest_skew_s >= cell.skew_s


def test_parts_that_lie_farther_apart_than_the_limit_make_no_reading() -> None:
    build = Build(most_skew_s=0.010)
    build.round(0.006)
    assert build.cell.stamp_s == float("-inf")
    assert build.cell.greatest_skew_s == 0.0
    assert build.cell.apart > 3
    assert build.cell.blame(ORIGIN_S + 0.020, 0.05) == "cell fx and cell fz are read 12 ms apart, at most 10 ms"


def test_a_transmitter_that_falls_silent_is_named_and_the_reading_gets_old() -> None:
    build = Build()
    build.round(0.006)
    now = 0.021
    while now < 0.2:  # the second stops answering: its requests time out
        now += 0.003
        if build.bench.frames[-1][0] == 2:
            build.bench.serve(ORIGIN_S + now, scan=False)
        else:
            build.answer(now, 10.0)
    assert build.cell.stamp_s <= ORIGIN_S + 0.04
    assert build.cell.blame(ORIGIN_S + now, 0.05).startswith("cell fy: no reading for 1")


def test_a_transmitter_that_reports_a_fault_makes_the_cell_invalid() -> None:
    build = Build()
    build.round(0.006)
    build.answer(0.024, 10.0)
    build.answer(0.030, 1.0, status=1)
    assert not build.cell.valid
    assert build.cell.blame(ORIGIN_S + 0.031, 0.05) == "cell fy: reading not valid (status 0x1)"


def test_the_zero_is_taken_off_every_channel() -> None:
    build = Build()
    build.round(0.006)
    build.cell.set_tare((1.0, 2.0, 3.0, 0.0))
    assert build.cell.values[:3] == pytest.approx([10 * KG_N - 1, KG_N - 2, 20 * KG_N - 3])
    build.round(0.024)
    assert build.cell.values[:3] == pytest.approx([10 * KG_N - 1, KG_N - 2, 20 * KG_N - 3])
    assert build.cell.raw[:3] == pytest.approx([10 * KG_N, KG_N, 20 * KG_N])


def test_the_repeated_reading_of_a_loaded_channel_dates_the_last_change() -> None:
    build = Build()
    for number in range(4):
        for _ in range(3):
            unit_id = build.bench.frames[-1][0]
            at_s = 0.006 + 0.018 * number + 0.006 * (unit_id - 1)
            build.answer(at_s, {1: 10.0, 2: 0.1, 3: 20.0 + number}[unit_id])
    assert build.cell.changed_s == pytest.approx(ORIGIN_S + 0.006)  # fx, not the small fy


@pytest.mark.parametrize(("baud", "skew_ms"), [(115200, 10.8), (38400, 17.4), (9600, 51.0)])
def test_the_usual_skew_is_the_time_that_the_other_readings_take(baud: int, skew_ms: float) -> None:
    assert 1e3 * Build(baud=baud).cell.usual_skew_s == pytest.approx(skew_ms, abs=1.0)


def test_two_transmitters_of_one_channel_are_refused() -> None:
    bench = Bench()
    parts = [Transmitter(str(unit), LAUMAS, unit, bench.link, {"force": "fx"}, {}) for unit in (1, 2)]
    with pytest.raises(ValueError, match="two transmitters measure fx"):
        JoinedCell(parts, CHANNELS, 0.03)
