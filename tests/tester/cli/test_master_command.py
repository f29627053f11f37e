"""``tester master``."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest

from sim.physics.laws import LawSetting
from sim.physics.track import TWO_BELLS, TrackParameters
from tester.cli.main import invoke
from tests.tester.kinds.specimen_on_track.fit.made import law, made_track_run
from tests.tester.kinds.wheel_on_belt.fit.made import made_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path / "runs"


def said(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> tuple[str, str]:
    found = invoke(["master", *arguments])
    captured = capsys.readouterr()
    assert found == code, captured.err
    return captured.out, captured.err


def data(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> dict[str, Any]:
    return json.loads(said(capsys, *arguments, "--json", code=code)[0])


def test_a_run_of_the_simulated_law_collapses_at_its_ts(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = data(capsys, str(made_track_run(home / "one")))
    assert (found["verdict"], found["reasons"], found["ts_given"]) == ("collapses", [], False)
    assert found["ts_c"] == pytest.approx(-3.0, abs=1.2)
    low, high = found["ts_interval_c"]
    assert low < -3.0 < high and 1.5 < high - low < 4.0
    assert found["scatter_ln"] == pytest.approx(0.02, rel=0.25)
    assert len(found["rows"]) == 99 and len(found["neighbours"]) == 10


def test_the_table_goes_to_stdout_and_messages_to_stderr(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table, summary = said(capsys, str(made_track_run(home / "one")))
    assert len(table.splitlines()) == 100 and table.startswith("log10 aT v  mu as measured")
    assert "SBR, dry, 20 N: 99 conditions of one, 11 temperatures from -40 to 60 degC" in summary
    assert "verdict: collapses" in summary and "0.58 K of the thermometer" in summary
    assert "maximum: mu 2." in summary


def test_the_verdict_comes_first_and_is_there_again_below_the_table(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, error = said(capsys, str(made_track_run(home / "one")))
    lines = error.splitlines()
    assert lines[0] == lines[-1] == "verdict: collapses"


def test_a_maximum_has_its_interval(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (peak,) = data(capsys, str(made_track_run(home / "one")))["peaks"]
    low, high = peak["interval_m_s"]
    assert low < peak["speed_m_s"] < high and low < 0.0755 < high


def test_the_compounds_file_gives_grosch_his_rules_and_ts(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", scatter=0.005))
    found = data(capsys, run, "--ts", "glass")
    assert (found["ts_c"], found["ts_given"], found["glass_c"]) == (-3.0, True, -53.0)
    adhesion, grit = found["rules"]
    assert adhesion["speed_m_s"] == pytest.approx(9.55e-4, rel=0.01)
    assert grit["speed_m_s"] == pytest.approx(0.0755, rel=0.01) and abs(grit["decades"]) < 0.1


def test_the_reference_moves_the_table_by_its_shift(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", scatter=0.0))
    at_20, at_ts = (data(capsys, run, "--ts=-3degC", f"--reference={c}degC")["rows"] for c in (20, -3))
    assert at_20[5]["x"] - at_ts[5]["x"] == pytest.approx(8.86 * 23.0 / 124.5, abs=1e-9)


def test_a_set_that_is_no_curve_exits_1_with_the_reason(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    off = {-40.0 + 10.0 * i: 1.0 + 0.1 * (-1) ** i for i in range(11)}
    run = made_track_run(home / "one", mu=lambda celsius, speed: off[round(celsius, -1)] * law(celsius, speed))
    _, summary = said(capsys, str(run), code=1)
    assert "verdict: does not collapse" in summary and "by factors of their own" in summary


def test_a_power_law_exits_6(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = made_track_run(home / "one", mu=lambda celsius, speed: 3.0 * speed**0.1 * 0.99**celsius)
    _, summary = said(capsys, str(run), code=6)
    assert "verdict: cannot tell" in summary and "a power law in v collapses at any shift" in summary


def test_a_wheels_run_is_refused_with_the_reason(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, error = said(capsys, str(made_run(home / "wheel")), code=1)
    assert "is refused: friction heats the surface of the wheel" in error
    assert "which no shift of time against temperature allows" in said(capsys, "appendix-b", code=1)[1]


def test_a_run_that_heated_itself_is_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, error = said(capsys, str(made_track_run(home / "one", band_k=0.05)), code=1)
    assert "one is refused: friction warms the contact beyond its band" in error.replace(str(home / "one"), "one")


def test_conditions_that_differ_in_more_have_to_be_chosen(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", interfaces=("dry", "talc")))
    _, error = said(capsys, run, code=2)
    assert "conditions of several values of interface: dry, talc; choose with --interface, or --each" in error
    assert data(capsys, run, "--interface", "talc")["held"] == {"interface": "talc", "load": "20 N"}
    assert "no condition of 'wet' (there are dry, talc)" in said(capsys, run, "--interface", "wet", code=2)[1]
    assert "there are 20 N" in said(capsys, run, "--interface", "dry", "--load", "10 N", code=2)[1]


def test_left_out_conditions_are_named(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, summary = said(capsys, str(made_track_run(home / "one", failed=[7])))
    assert "left out (not reached): one/7 (SBR, 20 N, -40 degC, 1 mm/s)" in summary


def test_a_reference_beyond_the_pole_is_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one"))
    assert "no shift: -110 degC" in said(capsys, run, "--reference=-110degC", code=1)[1]


def test_few_conditions_are_refused(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", (0.0, 20.0), (1e-4, 1e-3)))
    assert "4 conditions are too few for a curve" in said(capsys, run, code=1)[1]


def test_the_table_is_written_with_full_precision(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one"))
    said(capsys, run, "-o", "master.csv")
    rows = list(csv.reader(io.StringIO(Path("master.csv").read_text(encoding="utf-8"))))
    told = data(capsys, run)["rows"]
    assert rows[0][:2] == ["log10 aT v", "mu as measured"] and len(rows) == 100
    assert [float(one) for one in rows[1]] == list(told[0].values())


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_the_figure_is_drawn(home: Path, capsys: pytest.CaptureFixture[str], ending: str) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    run = str(made_track_run(home / "one"))
    said(capsys, run, "-o", f"master.{ending}", "--format", ending)
    assert Path(f"master.{ending}").stat().st_size > 5000


@pytest.mark.parametrize(("arguments", "message"), [
    (["--format", "csv"], "which file? (expected -o FILE.csv)"),
    (["-o", "master.doc"], "the ending names no format"),
    (["-o", "master.csv", "--format", "png"], "the ending is csv, --format png"),
    (["--ts", "warm"], "--ts: "),
    (["--load", "2 kg"], "--load: "),
])  # fmt: skip
def test_meaningless_options_are_usage_errors(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert message in said(capsys, str(made_track_run(home / "one")), *arguments, code=2)[1]


def test_a_compound_without_a_file_has_no_glass_transition(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", compounds=("nameless",)))
    assert "no file has the Tg of nameless" in said(capsys, run, "--ts", "glass", code=2)[1]
    assert data(capsys, run)["rules"] == []


TRACKS = {"wavy glass": "dry", "silicon carbide": "dry"}


def surfaces(home: Path) -> list[str]:
    """Return runs of the twin's law on glass and on silicon carbide."""
    made: list[str] = []
    for name in TRACKS:
        law_of = TrackParameters(law=TWO_BELLS).law_of("SBR", LawSetting(surface=name))
        folder = made_track_run(home / name.partition(" ")[0], mu=lambda t, v, law=law_of: law.mu(t, 20.0, v),
                                metadata={"abrasive": name})  # fmt: skip
        made.append(str(folder))
    return made


def test_each_has_a_row_for_each_curve_and_the_rules_over_all(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table, error = said(capsys, *surfaces(home), "--each")
    rows = table.splitlines()
    assert len(rows) == 3 and rows[1].startswith("SBR, wavy glass, dry, 20 N") and "collapses" in rows[2]
    assert (rows[1].count(" to "), rows[2].count(" to ")) == (2, 3)  # Ts, and one maximum on glass, two on the cloth
    assert "rule of adhesion, 6 nm x omega of the loss modulus' maximum / 2 pi: holds" in error
    assert "rule of deformation, 150 um x omega of the loss factor's maximum / 2 pi: holds" in error
    assert error.count(": holds") == 5 and error.count("WLF is likelier") == 2


def test_each_as_data_and_as_a_figure(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runs = surfaces(home)
    curves = data(capsys, *runs, "--each")["curves"]
    assert [len(one["peaks"]) for one in curves] == [1, 2]
    assert [[rule["verdict"] for rule in one["rules"]] for one in curves] == [["holds", "cannot tell"], ["holds"] * 2]
    assert {one["shift"]["likelier"] for one in curves} == {"WLF"}
    assert "a table has one curve" in said(capsys, *runs, "--each", "-o", "all.csv", code=2)[1]
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    said(capsys, *runs, "--each", "-o", "all.svg")
    drawn = Path("all.svg").read_text(encoding="utf-8")
    assert drawn.count("<use") > 2 * 99  # a mark for each condition of both curves


def test_each_exits_as_the_worst_curve_and_compares_compounds(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one", compounds=("SBR", "NR"), mu=lambda t, v: 0.5 * v**0.2))
    table, _ = said(capsys, run, "--each", code=6)
    assert table.count("cannot tell") == 2
    made = made_track_run(home / "few", (0.0, 20.0), (1e-4, 1e-3))
    assert "SBR, dry, 20 N: 4 conditions are too few" in said(capsys, str(made), "--each", code=1)[1]


def test_a_run_named_twice_is_a_usage_error(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = str(made_track_run(home / "one"))
    assert "named twice" in said(capsys, run, run, code=2)[1]
