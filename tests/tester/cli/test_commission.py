"""`tester commission`: at a terminal with real keys, by the simulated person, and its list."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from tester.cli.commission_command import TerminalPerson
from tester.cli.main import invoke
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.record import CommissionRecord, record_path
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Question
from tester.run.commissioning import CommissionOptions, commission
from tester.run.kind_lookup import load_rig
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, named

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are POSIX")


class AtKeys(TerminalPerson):
    """A terminal at whose keyboard the simulated person types: keys go through a real pseudo-terminal."""

    def __init__(self, twin: TwinPerson, master: int, slave: int) -> None:
        from tester.cli.command_keys import keys_of

        self.stream = os.fdopen(slave, "r")
        super().__init__(time_stands=True)
        self._keys = keys_of(self.stream)
        self.twin = twin
        self.master = master
        self.to_type = b""
        self.said: list[str] = []

    def at(self, hands: object) -> None:
        self.twin.at(hands)  # type: ignore[arg-type]

    def message(self, text: str) -> None:
        self.said.append(text)

    def put(self, question: Question) -> None:
        super().put(question)
        self.twin.asked.append(question)
        self.twin.prepare(question)
        self.to_type = (self.twin.answer(question) + "\r").encode()

    def commands(self) -> list[str]:
        typed, self.to_type = self.to_type, b""
        if typed:
            os.write(self.master, typed)
        return super().commands()


def at_keys(tmp_path: Path, *steps: str) -> tuple[Bench, AtKeys]:
    import pty

    master, slave = pty.openpty()
    bench = Bench(tmp_path / "r.jsonl", steps=named(*steps))
    person = AtKeys(bench.person, master, slave)
    bench.person = person  # type: ignore[assignment]
    person.begin()
    return bench, person


def test_a_person_commissions_with_real_keys_from_the_start_to_the_coefficient(tmp_path: Path) -> None:
    _, person = at_keys(tmp_path)
    try:
        outcome = commission(load_rig("sim", ()), CommissionOptions(out=tmp_path), person)
    finally:
        person.end()
    assert outcome.ended is Ended.DONE, outcome
    assert [name for name, _ in outcome.took_s] == [step.name for step in STEPS]
    assert outcome.rig_s == pytest.approx(sum(seconds for _, seconds in outcome.took_s))
    assert any("direction right" in text for text in person.said)
    assert any(text.startswith("passed: coefficient of 1#") for text in person.said)


def test_a_word_that_is_no_answer_is_asked_for_again(tmp_path: Path) -> None:
    bench, person = at_keys(tmp_path, "identify")
    wrong = [b"perhaps\r", b"Yes\r"]
    put = person.put

    def once_wrong(question: Question) -> None:
        put(question)
        if wrong:
            person.to_type = wrong.pop()

    person.put = once_wrong  # type: ignore[method-assign]
    try:
        assert bench.run().ended is Ended.DONE
    finally:
        person.end()
    assert person.said.count("expected one of: yes, no") == 2


@pytest.mark.parametrize("key", [b"\x18", b"\x1b[24~", b"\x06"])
def test_a_stop_key_stops_while_a_question_is_open(tmp_path: Path, key: bytes) -> None:
    bench, person = at_keys(tmp_path, "jog belt")
    put = person.put

    def stopping(question: Question) -> None:
        put(question)
        if question.key == "jog belt whole read":
            person.to_type = key

    person.put = stopping  # type: ignore[method-assign]
    try:
        outcome = bench.run()
    finally:
        person.end()
    assert outcome.ended is Ended.STOPPED
    assert bench.world is not None and not any(drive.energised for drive in bench.world.axes.values())


def test_a_missing_terminal_is_reported(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["commission", "sim", "--out", str(tmp_path)]) == 2
    assert "no interactive terminal" in capfd.readouterr().err


def test_a_compound_without_a_model_on_the_twin_is_reported(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["commission", "sim", "--yes", "--compound", "mine", "--out", str(tmp_path)]) == 2
    assert "expected 1#, 2#, 3#" in capfd.readouterr().err


def test_the_list_names_the_tasks(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["commission", "sim", "--list", "--out", str(tmp_path)]) == 0
    assert "jog wheel        to be done" in capfd.readouterr().out


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(10))
def test_the_whole_way_takes_less_than_half_an_hour_of_rig_time(
    tmp_path: Path, seed: int, capfd: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["commission", "sim", "--yes", "--seed", str(seed), "--out", str(tmp_path)]) == 0
    said = capfd.readouterr().err
    assert "passed: coefficient" in said
    minutes = float(said.rsplit(";", 1)[1].split()[0])
    assert minutes < 30
    steps = [float(text.split(" s of rig time")[0].split()[-1]) for text in said.splitlines() if "s of rig" in text]
    assert len(steps) == len(STEPS)
    assert sum(steps) / 60 == pytest.approx(minutes, abs=0.1)
    record = CommissionRecord(record_path(tmp_path, load_rig("sim", ()).name), str, "")
    soak, last = record.last("thermometer"), record.last("first")
    assert soak is not None and soak.values["hub_c"] <= 45.0
    assert last is not None and last.values["conditions"][0]["n"] >= 3
    with RunReader(tmp_path / last.values["run"]) as reader:
        assert max(row.result.means["hub_c"] for row in reader.repeats()) <= 45.0


@pytest.mark.parametrize(
    ("more", "said"), [([], "needs a terminal"), (["--yes"], "either a simulated person answers, or the one")]
)
def test_a_screen_needs_a_terminal_and_a_person(
    more: list[str], said: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["commission", "sim", "--tui", "--out", str(tmp_path), *more]) == 2
    assert said in capfd.readouterr().err
