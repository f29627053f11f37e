"""Figures that the real-time checks read from logs, and, as campaigns, the checks themselves."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns import kill, latency
from tests.campaigns.kill import aftermath
from tests.campaigns.latency import Counting
from tests.realtime.frames import GUARD_S, cell_samples, latencies, scans_of, share
from tests.realtime.state import Row, StateReader, for_good, since

SCAN = "({0:.6f}) can0 201#0F00 T\n({1:.6f}) can0 203#0F00 T\n({2:.6f}) can0 205#0F00 T\n({3:.6f}) can0 080# T\n"
ANSWERS = "({0:.6f}) can0 181#2700 R\n({1:.6f}) can0 185#2700 R\n"


def row(t: float, *, wheel: float = 0.8, belt: float = 0.7, force: float = 100.0, heat: float = 10.0) -> Row:
    return Row(t, t + 1000.0, 1.0, wheel, belt, wheel - belt, force, 11.0, heat, 24.0, 23.0)


def scan(t: float) -> str:
    return SCAN.format(t, t + 0.0003, t + 0.0006, t + 0.001)


@pytest.fixture
def bus_log(tmp_path: Path) -> Path:
    """Return a log of scans at 0, 10 and 20 ms, the first answered late, and of one read of the load cell."""
    text = scan(0.0) + ANSWERS.format(0.002, 0.0095) + scan(0.010) + ANSWERS.format(0.012, 0.013) + scan(0.020)
    (tmp_path / "can.log").write_text("(0.0) can0 701#05 R\n" + text + scan(0.030), encoding="utf-8")
    (tmp_path / "modbus-load_cell.log").write_text(
        "(0.001000) TX 01 03\n(0.006000) RX 01 03\n(0.011000) TX 01 03\n(0.021000) TX 01 03\n", encoding="utf-8"
    )
    return tmp_path


def test_a_scan_that_came_too_soon_after_an_answer_does_not_count_for_it(bus_log: Path) -> None:
    found = latencies(bus_log, lambda t: t < 0.015)
    # from the SYNC at 1 ms to the end of the scan at 20 ms, and from that at 11 ms to the same
    assert found.drives_s == pytest.approx([0.0206 - 0.001, 0.0206 - 0.011])


def test_a_sample_of_the_load_cell_counts_from_its_request_to_the_press(bus_log: Path) -> None:
    assert latencies(bus_log, lambda t: True).cell_s == pytest.approx([0.0103 - 0.001])


def test_requests_without_a_reply_are_no_samples(bus_log: Path) -> None:
    assert cell_samples(bus_log / "modbus-load_cell.log") == [(0.001, 0.006)]


def test_the_last_answer_to_a_sync_counts(bus_log: Path) -> None:
    first, second, *_ = scans_of(bus_log / "can.log")
    assert (first.sync_s, first.answered_s, second.first_s) == (0.001, 0.0095, 0.010)
    assert second.first_s - first.answered_s < GUARD_S


def test_only_samples_taken_while_sliding_under_load_count() -> None:
    rows = [row(0.0), row(0.01, force=0.0), row(0.02, belt=0.8), row(0.03)]
    counts = Counting(rows, 0.0, 0.05)
    assert [counts(t) for t in (-0.01, 0.005, 0.015, 0.025, 0.04, 0.06)] == [False, True, False, False, True, False]


def test_a_share_of_nothing_keeps_no_limit() -> None:
    assert not share([], 0.99) <= 0.02
    assert share([3.0, 1.0, 2.0, 4.0], 0.5) == 2.0


def test_the_aftermath_is_read_from_the_moment_of_the_kill() -> None:
    rows = [row(0.01 * i) for i in range(100)]
    rows += [row(1.0 + 0.01 * i, wheel=0.0, belt=0.005, force=3.0, heat=0.0) for i in range(100)]
    found = aftermath(rows, 1000.75, 5.0)
    assert (found.standstill_s, found.heat_off_s, found.unloaded_s) == pytest.approx((0.25, 0.25, 0.25))
    assert found.ramp_s == pytest.approx(0.8 / 5.0)
    assert found.stopped_in_time and found.cold_in_time


@pytest.mark.parametrize("last", [{"wheel": 0.8, "heat": 0.0}, {"wheel": 0.0, "belt": 0.0, "heat": 5.0}])
def test_a_rig_that_keeps_moving_or_starts_again_is_never_in_time(last: dict[str, float]) -> None:
    rows = [row(0.0), row(0.1, wheel=0.0, belt=0.0, heat=0.0), row(3.5, **last)]
    found = aftermath(rows, 1000.05, 5.0)
    assert not (found.stopped_in_time and found.cold_in_time)


def test_for_good_means_to_the_end_of_the_log() -> None:
    rows = [row(0.0, heat=0.0), row(0.1), row(0.2, heat=0.0), row(0.3, heat=0.0)]
    assert for_good(rows, lambda one: one.heater_w == 0.0) == 1000.2
    assert since(rows, 1000.15) == rows[2:]


def test_a_log_is_read_while_its_last_row_is_being_written(tmp_path: Path) -> None:
    path = tmp_path / "state.csv"
    header = "time_s,clock_s,controlled,wheel_m_s,belt_m_s,slip_m_s,force_z_n,press_mm,heater_w,hub_c,surface_c\n"
    path.write_text(header + "0,1,0,0,0,0,0,0,0,23,23\n0.01,1.01,1,0", encoding="utf-8")
    reader = StateReader(path)
    assert [one.time_s for one in reader.fresh()] == [0.0]
    with path.open("a", encoding="utf-8") as file:
        file.write(",0,0,0,0,0,23,23\n")
    assert [one.controlled for one in reader.fresh()] == [1.0]
    assert len(reader.rows) == 2


@pytest.mark.campaign
def test_a_rig_whose_controller_is_killed_stops() -> None:
    assert kill.main(["--sample"]) == 0


@pytest.mark.campaign
def test_a_sample_becomes_a_command_in_time() -> None:
    assert latency.main(["--seconds", "20", "--idle"]) == 0
