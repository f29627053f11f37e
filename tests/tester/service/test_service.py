"""The service with a script instead of its clients."""

from __future__ import annotations

import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.service.alarms import Cause
from tester.service.commands import (
    Acknowledge,
    Answer,
    Arm,
    Hold,
    Jog,
    Release,
    ResumeRun,
    RunRecipe,
    Stop,
    Tare,
)
from tester.service.interrupted import interrupted_runs
from tester.service.service_link import Presence
from tester.service.state_view import StateView
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.inputs.rig.test_key_classes import NONSENSE
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.test_session import Screen
from tests.tester.service.stage import Script, Stage, play

RUN = RunRecipe("short", text=SHORT, seed=1, speed=None, yes=True)
TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")
TWO_COMPOUNDS = SHORT.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n')


@pytest.fixture(autouse=True)
def _every_poll_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)


def running(view: StateView) -> bool:
    return view.mode == "RUN"


def over(view: StateView) -> bool:
    return view.run is not None and view.run.exit is not None


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Stage:
    """A run from beginning to end, its frames watched for a while."""

    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        assert stage.told_frames == []
        yield Presence("client 1", 1, 0, True)
        while len(stage.told_frames) < 3:
            yield None
        yield Presence("client 1", 1, 0, False)
        yield None
        yield None
        count = len(stage.told_frames)
        for _ in range(5):
            yield None
        assert len(stage.told_frames) == count
        yield from stage.until(over)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)
        return play(tmp_path_factory.mktemp("finished"), script, *QUIET)


def test_a_run_that_is_watched_leaves_the_tables_of_tester_run(finished: Stage, tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    screen = Screen()
    options = SessionOptions(str(tmp_path / "short.yaml"), "sim", QUIET, tmp_path / "alone", seed=1)
    assert Session(options, screen).run() == 0
    run = finished.views[-1].run
    assert run is not None and (run.outcome, run.exit) == ("done", 0)
    for table in TABLES:
        assert (Path(run.folder) / table).read_bytes() == (Path(screen.results[0]) / table).read_bytes()


def test_values_stand_beside_setpoint_gate_and_limit(finished: Stage) -> None:
    counting = _counting(finished)
    load, friction = counting.value("load"), counting.value("friction")
    assert load is not None and friction is not None
    assert (load.setpoint, load.band_low, load.high, load.quality) == (200.0, 196.0, 440.0, "good")
    assert load.value == pytest.approx(200.0, abs=5.0)
    assert friction.value is not None and 0.5 < friction.value < 1.2


def test_devices_and_buses_are_shown(finished: Stage) -> None:
    counting = _counting(finished)
    assert {device.name for device in counting.devices} >= {"wheel", "press", "load cell", "jacket", "thermometer"}
    assert all(device.online for device in counting.devices)
    assert counting.buses[0].load_percent is not None and 10.0 < counting.buses[0].load_percent < 40.0


def test_the_time_left_shrinks_and_steps_get_their_measured_durations(finished: Stage) -> None:
    left = [view.progress.left_s for view in finished.views if view.mode == "RUN"]
    assert left[-1] is not None and left[0] is not None and left[-1] < left[0]
    last = [plan for plan in finished.plans if plan is not None][-1]
    assert [step.state for step in last.steps][-1] == "now"
    assert all(step.measured_s is not None for step in last.steps if step.state == "done")
    assert finished.texts("step")[0].startswith("install wheel 1")


def test_a_trip_leaves_no_time_left_and_the_share_as_it_was(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(lambda view: view.mode == "LATCHED")
        tripped = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > tripped + 20.0)
        yield stage.order(Stop())  # a drive whose heartbeat was lost is connected anew by the next run only
        yield from stage.until(over)

    fault = 'sim.faults=["t=20 s: belt drive heartbeat lost for 3 s"]'
    latched = [view for view in play(tmp_path, script, fault).views if view.mode == "LATCHED" and view.progress.steps]
    assert latched[-1].t_s > 40.0 and {view.progress.left_s for view in latched} == {None}
    assert all(view.progress.finish_utc == "" for view in latched)
    share = latched[0].progress.share
    assert latched[-1].progress.share == pytest.approx(share) and 0.0 < share < 0.8


def test_a_hold_stops_the_share_and_the_time_left(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(lambda view: view.mode == "RUN" and view.progress.share > 0.0)
        yield stage.order(Hold())
        yield from stage.until(lambda view: view.mode == "HOLD")
        held = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > held + 10.0)
        yield stage.order(Stop())
        yield from stage.until(over)

    held = [view.progress for view in play(tmp_path, script).views if view.mode == "HOLD"]
    assert len({progress.share for progress in held}) == 1 and len({progress.left_s for progress in held}) == 1


def test_frames_of_every_bus_are_shown_in_both_directions(finished: Stage) -> None:
    frames = [frame for message in finished.told_frames for frame in message.frames]
    assert {frame.bus for frame in frames} >= {"can", "load_cell"}
    assert {frame.sent for frame in frames} == {True, False}


def _counting(stage: Stage) -> StateView:
    return next(view for view in stage.views if view.progress.burst and all(gate.open for gate in view.gates))


def test_a_run_of_two_specimens_shows_the_way_to_the_end_of_both(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("two", text=TWO_COMPOUNDS, speed=None, yes=True))
        yield from stage.until(lambda view: view.run is not None and view.run.compound == "2#")
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script, *QUIET)
    shares = [view.progress.share for view in stage.views if view.mode == "RUN"]
    assert shares == sorted(shares) and shares[-1] > 0.4
    assert {view.run.compound for view in stage.views if view.run is not None} >= {"1#", "2#"}


def test_stop_ends_a_run_with_exit_code_5_and_names_who(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield stage.order(Stop(), client=9)
        yield from stage.until(over)

    stage = play(tmp_path, script)
    run = stage.views[-1].run
    assert run is not None and (run.outcome, run.exit, run.reason) == ("stopped", 5, "stop by client 9")
    assert "stop" in stage.accepted


def test_stop_is_taken_when_nothing_runs(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(Stop(fast=True))
        yield None

    assert "stop" in play(tmp_path, script).accepted


def test_a_stop_leaves_the_second_specimen_undone(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("two", text=TWO_COMPOUNDS, speed=None, yes=True))
        yield from stage.until(running)
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    assert {view.run.compound for view in stage.views if view.run is not None} <= {"", "1#"}


def test_stop_from_its_own_lane_stops_a_run_before_any_other_order_is_read(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        stage.lane._take("s 7 stop somebody")  # pyright: ignore[reportPrivateUsage]  # what the door's process says
        yield None
        yield stage.order(Hold())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    run = stage.views[-1].run
    assert run is not None and (run.outcome, run.reason) == ("stopped", "stop by somebody")
    assert "stopping" in stage.refused["hold"]


@pytest.mark.parametrize("begin", [RUN, Arm()])
def test_stop_does_not_wait_for_a_record_that_is_closed(
    begin: RunRecipe | Arm, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No poll happens while a record is closed, which waits for the disk: the lane's own thread answers."""
    monkeypatch.setattr("tester.service.service.MANUAL_LAPSE", 50.0)
    ticking: list[bool] = []
    finish = RunWriter.finish

    def script(stage: Stage) -> Script:
        def noted(self: RunWriter, status: str, reason: str, ended_s: float) -> None:
            ticking.append(stage.lane.ticking)
            finish(self, status, reason, ended_s)

        monkeypatch.setattr(RunWriter, "finish", noted)
        yield Presence("client 1", 1, 0, False)
        yield stage.order(begin)
        yield from stage.until(lambda view: view.mode in ("CONNECTING", "MANUAL", "RUN"))
        ticking.append(stage.lane.ticking)
        yield stage.order(Stop(fast=True))
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    play(tmp_path, script)
    assert ticking == [True, False]


def test_a_stop_while_the_recipe_is_planned_keeps_the_run_from_beginning(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        stage.lane._take("s 7 fast somebody")  # pyright: ignore[reportPrivateUsage]
        yield None
        yield None

    stage = play(tmp_path, script)
    assert stage.refused["run"] == "fast stop by somebody" and "run" not in stage.accepted
    assert not list(tmp_path.glob("runs/2*"))


@pytest.mark.parametrize("second", [Stop(), Stop(fast=True)])
def test_two_stops_do_not_unlatch_a_fast_stop(tmp_path: Path, second: Stop) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield stage.order(Stop(fast=True))
        yield from stage.until(lambda view: view.mode == "LATCHED")
        yield stage.order(second)
        yield from stage.until(over)
        yield stage.order(RUN)
        yield None
        assert stage.views[-1].mode == "LATCHED"
        yield stage.order(Acknowledge())
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    stage = play(tmp_path, script)
    assert "acknowledge first" in stage.refused["run"]
    run = stage.views[-1].run
    assert run is not None and run.outcome == "stopped"


def test_a_fast_stop_is_not_softened_by_another_stop(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield [stage.order(Stop(fast=True)), stage.order(Stop())]
        yield from stage.until(lambda view: view.mode == "LATCHED")
        assert not any(view.mode in ("STOPPING", "COOLDOWN") for view in stage.views)
        yield stage.order(Acknowledge())
        yield from stage.until(over)

    play(tmp_path, script)


def test_a_second_run_is_refused_while_one_is_under_way(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        stage.accepted.clear()
        yield stage.order(RUN)
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    assert "a run is under way" in stage.refused["run"]
    assert "run" not in stage.accepted


@pytest.mark.parametrize(
    ("action", "reason"),
    [
        (Hold(), "nothing runs"),
        (Release(), "nothing runs"),
        (Acknowledge(), "nothing to acknowledge"),
        (Answer(1), "prompt 1 does not wait"),
        (Jog("wheel", 1), "manual mode is not armed"),
        (Tare(), "manual mode is not armed"),
        (Arm(on=False), "manual mode is not armed"),
        (ResumeRun("none"), "no run none"),
        (RunRecipe("no-such-recipe"), "no recipe"),
        (RunRecipe("bad", text="recipe: [", speed=None), ".yaml:2:1: not YAML"),
        (RunRecipe("quickstart", rig="no-such-rig.yaml"), "no-such-rig.yaml"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.command,
)
def test_orders_without_sense_in_this_state_are_refused_with_a_reason(
    tmp_path: Path,
    action: Hold | Release | Acknowledge | Answer | Jog | Tare | Arm | ResumeRun | RunRecipe,
    reason: str,
) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(action)
        yield None
        yield None

    stage = play(tmp_path, script)
    assert reason in stage.refused[action.command]
    assert not list(tmp_path.glob("runs/2*"))


def test_a_prompt_waits_for_its_answer_and_a_no_leaves_it_waiting(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("short", text=SHORT, speed=None))
        yield from stage.until(lambda view: view.prompt is not None)
        yield stage.order(Answer(7))
        assert "answer" in stage.refused
        yield stage.order(Answer(1, "no"))
        yield None
        assert stage.views[-1].prompt is not None
        stage.refused.pop("answer")
        yield stage.order(Answer(1, "89.6 mm"))
        yield None
        assert "expected one of: yes" in stage.refused["answer"] and stage.views[-1].prompt is not None
        yield stage.order(Answer(1))
        yield from stage.until(lambda view: view.prompt is None)
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    assert any(name == "prompt" and "install wheel 1" in text for name, text in stage.notes)
    assert "answer yes by client 1" in stage.texts("command")


def test_a_hardness_is_typed_at_a_screen_and_stored_with_its_name(tmp_path: Path) -> None:
    asked = SHORT.replace('compound: "1#"', 'compound: "1#"\n    measured: {hardness: prompt}')

    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("short", text=asked, speed=None))
        yield from stage.until(lambda view: view.prompt is not None and view.prompt.unit == "Shore A")
        yield stage.order(Answer(1, "645"))
        yield None
        assert "expected 0 to 100 Shore A" in stage.refused["answer"]
        yield stage.order(Answer(1, "64.5 Shore A"))
        yield from stage.until(lambda view: view.prompt is None)
        yield from stage.until(lambda view: "hardness" in {event.kind for event in stage.events})
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    run = stage.views[-1].run
    assert run is not None
    with RunReader(Path(run.folder)) as reader:
        (piece,) = reader.pieces()
        (prompt,) = reader.prompts()
    assert (piece.hardness_shore_a, piece.hardness_by) == (64.5, "client 1") and piece.hardness_utc
    assert (prompt.answer, prompt.answered_by) == ("64.5 Shore A", "client 1")


def test_a_trip_latches_until_it_is_acknowledged(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        assert stage.service is not None and stage.service.desk.watch is not None
        rig = stage.service.desk.watch.run.engine.ctx.attendant
        assert isinstance(rig, WheelRig)
        rig.axes["belt"].fault(0x2310)
        yield from stage.until(lambda view: view.mode == "LATCHED")
        stage.accepted.clear()
        yield stage.order(RUN)
        yield None
        yield stage.order(Acknowledge())
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    stage = play(tmp_path, script)
    assert "run" in stage.refused and "run" not in stage.accepted
    trips = [alarm for view in stage.views for alarm in view.alarms if alarm.priority == 1]
    assert trips and all(trip.name == "drive fault" and trip.first_up for trip in trips)
    assert stage.views[-1].alarms == ()
    assert any(name == "trip" for name, _ in stage.notes)
    run = stage.views[-1].run
    assert run is not None and run.outcome == "tripped"


def test_another_alarm_s_acknowledgement_leaves_the_rig_latched(tmp_path: Path) -> None:
    other = Cause("cabinet warm", 2, "48 degC")

    def alarm(stage: Stage, name: str) -> int:
        return next(alarm.number for alarm in stage.views[-1].alarms if alarm.name == name)

    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        assert stage.service is not None and stage.service.desk.watch is not None
        watch = stage.service.desk.watch
        rig = watch.run.engine.ctx.attendant
        assert isinstance(rig, WheelRig)
        rig.axes["belt"].fault(0x2310)
        yield from stage.until(lambda view: view.mode == "LATCHED")
        stage.service.desk.alarms.raise_(other, 1.0)
        yield None
        yield stage.order(Acknowledge(alarm(stage, other.name)))
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > at_s + 3.0 or view.mode == "OFFLINE")
        assert stage.views[-1].mode == "LATCHED" and not watch.acknowledged
        assert {one.name: one.state for one in stage.views[-1].alarms} == {
            "drive fault": "active",
            other.name: "acknowledged",
        }
        yield stage.order(Acknowledge(alarm(stage, "drive fault")))
        yield from stage.until(lambda view: view.mode == "OFFLINE")
        assert watch.acknowledged

    assert set(play(tmp_path, script).accepted) >= {"ack"}


def test_stop_ends_a_tripped_run_whose_cause_stays_and_the_rig_stays_latched(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        assert stage.service is not None and stage.service.desk.watch is not None
        rig = stage.service.desk.watch.run.engine.ctx.attendant
        assert isinstance(rig, WheelRig)
        rig.axes["belt"].fault(0x2310)
        yield from stage.until(lambda view: view.mode == "LATCHED")
        yield stage.order(Stop())
        yield from stage.until(lambda view: view.run is not None and view.run.outcome == "tripped")
        yield stage.order(RUN)
        yield None
        yield stage.order(Acknowledge())
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    stage = play(tmp_path, script)
    assert "acknowledge first" in stage.refused["run"]
    assert stage.views[-1].alarms == ()


def test_a_held_run_continues_when_it_is_released(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(lambda view: view.mode == "RUN" and view.progress.repeat == 1)
        yield stage.order(Hold())
        yield from stage.until(lambda view: view.mode == "HOLD" and view.mode_since_s > 5.0)
        yield stage.order(Release())
        yield from stage.until(running)
        yield stage.order(Release())
        yield None
        assert "nothing to release" in stage.refused["release"]
        yield stage.order(Stop())
        yield from stage.until(over)

    stage = play(tmp_path, script)
    assert set(stage.accepted) >= {"hold", "release"}
    assert any(name == "hold" for name, _ in stage.notes)
    held = [view for view in stage.views if view.mode == "HOLD"][-1]
    load = held.value("load")
    assert load is not None and load.value is not None and load.value < 5.0


def test_term_stops_the_run_and_ends_the_service(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        os.kill(os.getpid(), signal.SIGTERM)
        yield from stage.until(lambda view: False)

    stage = play(tmp_path, script)
    run = stage.views[-1].run
    assert run is not None and (run.outcome, run.reason) == ("stopped", "terminated")


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="this system has no SIGHUP")
def test_a_hang_up_is_ignored(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        os.kill(os.getpid(), signal.SIGHUP)
        yield None
        yield stage.order(Stop())

    assert "stop" in play(tmp_path, script).accepted


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="this system has no SIGHUP")
def test_a_hang_up_during_a_run_is_ignored(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        os.kill(os.getpid(), signal.SIGHUP)
        for _ in range(20):
            yield None
        assert running(stage.views[-1])
        yield stage.order(Stop())
        yield from stage.until(over)

    run = play(tmp_path, script).views[-1].run
    assert run is not None and run.reason.startswith("stop by")


def test_an_open_run_is_shown_as_interrupted_until_acknowledged(tmp_path: Path) -> None:
    def cut_off(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield stage.order(Stop())
        yield from stage.until(over)

    run = play(tmp_path, cut_off).views[-1].run
    assert run is not None
    import sqlite3

    with sqlite3.connect(Path(run.folder) / "run.db") as database:
        database.execute("UPDATE run SET status = 'running'")

    def script(stage: Stage) -> Script:
        yield from stage.until(lambda view: view.mode == "INTERRUPTED")
        yield stage.order(Acknowledge())
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    stage = play(tmp_path, script)
    assert any(run.name in view.interrupted for view in stage.views)
    assert stage.views[-1].interrupted == ()


def test_a_run_that_was_resumed_to_its_end_is_interrupted_no_longer(tmp_path: Path) -> None:
    def cut_off(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield stage.order(Stop())
        yield from stage.until(over)

    run = play(tmp_path, cut_off, *QUIET).views[-1].run
    assert run is not None
    import sqlite3

    with sqlite3.connect(Path(run.folder) / "run.db") as database:
        database.execute("UPDATE run SET status = 'running'")

    def script(stage: Stage) -> Script:
        yield from stage.until(lambda view: view.mode == "INTERRUPTED")
        yield stage.order(ResumeRun(run.name, speed=None, yes=True))
        yield from stage.until(running)
        yield from stage.until(lambda view: view.run is not None and view.run.outcome != "running")
        yield from stage.until(lambda view: view.mode == "OFFLINE")

    last = play(tmp_path, script, *QUIET).views[-1]
    assert last.run is not None and (last.run.outcome, last.interrupted) == ("done", ())


def test_a_run_in_use_by_another_process_is_not_marked_interrupted(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        assert list(interrupted_runs(tmp_path / "runs")) == []
        yield stage.order(Stop())
        yield from stage.until(over)

    play(tmp_path, script)


def test_notes_and_operator_are_kept(tmp_path: Path) -> None:
    action = RunRecipe("short", text=SHORT, speed=None, yes=True, operator="A. Person", notes="new belt")

    def script(stage: Stage) -> Script:
        yield stage.order(action)
        yield from stage.until(running)
        yield stage.order(Stop())
        yield from stage.until(over)

    run = play(tmp_path, script).views[-1].run
    assert run is not None
    with RunReader(Path(run.folder)) as reader:
        assert reader.run().info.operator == "A. Person"
        assert any(event.kind == "note" and event.text == "new belt" for event in reader.events())


def test_locks_of_the_run_are_let_go_of(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(RUN)
        yield from stage.until(running)
        yield stage.order(Stop())
        yield from stage.until(over)

    run = play(tmp_path, script).views[-1].run
    assert run is not None
    with ExclusiveUse() as use:
        use.lock_file("run", Path(run.folder) / RUN_LOCK, "", lasting=False)


def test_commands_are_recorded_with_the_system_user_who_gave_them(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield replace(stage.order(RUN), peer="user id 1000")
        yield from stage.until(running)
        yield replace(stage.order(Hold(), 2), peer="address 192.0.2.7:40000")
        yield replace(stage.order(Stop()), peer="user id 1000")
        yield from stage.until(over)

    stage = play(tmp_path, script, *QUIET)
    run = stage.views[-1].run
    assert run is not None
    with RunReader(Path(run.folder)) as reader:
        said = [event.text for event in reader.commands()]
    assert said == [
        "run by client 1 (user id 1000)",
        "hold by client 2 (address 192.0.2.7:40000)",
        "stop by client 1 (user id 1000)",
    ]


def test_nonsense_in_a_client_s_overrides_begins_nothing(tmp_path: Path) -> None:
    reasons: dict[str, str] = {}

    def script(stage: Stage) -> Script:
        for override in NONSENSE:
            stage.refused.clear()
            yield stage.order(replace(RUN, overrides=(override,)))
            while "run" not in stage.refused:
                yield None
            reasons[override] = stage.refused["run"]

    stage = play(tmp_path, script)
    assert len(reasons) == len(NONSENSE) == 20 and stage.accepted == {}
    assert all(override.partition("=")[0] in reason for override, reason in reasons.items())


def test_an_override_of_a_client_that_is_looser_than_it_may_be_begins_nothing(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield stage.order(replace(RUN, overrides=("interlocks.hold_at_most=3 h",)))
        while "run" not in stage.refused:
            yield None

    stage = play(tmp_path, script, *QUIET)
    assert "interlocks.hold_at_most: 10800 s is looser than 7200 s" in stage.refused["run"]
    assert not list(tmp_path.glob("runs/2*")) and stage.accepted == {}
