
from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served.left_on_rig import WheelLeft
from tester.kinds.wheel_on_belt.served.manual import WheelHand
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.service.commands import Arm, Hold, Jog, Stop, Tare
from tester.service.preflight import left_on_rig
from tester.service.service_link import Presence
from tester.service.state_view import StateView
from tester.store.records import PieceInfo, RunInfo
from tester.store.run_folders import run_folders
from tester.store.run_reader import RunReader
from tests.tester.service.stage import Script, Stage, play
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer

ARMED = Presence("client 1", 1, 0, False)


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Show every poll, and let simulated time run as fast as it goes."""
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)
    monkeypatch.setattr("tester.service.service.MANUAL_LAPSE", 50.0)


def manual(view: StateView) -> bool:
    return view.mode == "MANUAL"


def off(view: StateView) -> bool:
    return view.mode == "OFFLINE" and view.run is not None


def armed(stage: Stage) -> Script:
    yield ARMED
    yield stage.order(Arm())
    yield from stage.until(manual)
    watch = stage.service.desk.watch if stage.service is not None else None
    assert watch is not None
    while not watch.run.engine.ctx.readings.drives_enabled:
        yield None


def jog(stage: Stage, *steps: Jog) -> Script:
    """Press keys, no faster than is allowed."""
    for step in steps:
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view, due_s=at_s + 0.25: view.t_s >= due_s)
        yield stage.order(step)


def stays_manual(stage: Stage, seconds: float) -> Script:
    """Let time pass; fail if the mode has ended."""
    due_s = stage.views[-1].t_s + seconds
    yield from stage.until(lambda view: view.t_s > due_s or not manual(view))
    assert stage.views[-1].mode == "MANUAL"


def value(view: StateView, key: str) -> float:
    found = view.value(key)
    assert found is not None and found.value is not None
    return found.value


def test_a_step_turns_the_wheel_by_one_step_and_no_further(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, Jog("both", 1), Jog("both", 1))
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > at_s + 5.0)
        assert value(stage.views[-1], "wheel_speed") == pytest.approx(0.1, abs=0.005)
        assert value(stage.views[-1], "belt_speed") == pytest.approx(0.1, abs=0.005)
        yield stage.order(Arm(on=False))
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_keys_that_come_too_fast_are_refused(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield [stage.order(Jog("wheel", 1)), stage.order(Jog("wheel", 1))]
        yield None
        assert "steps a second" in stage.refused["jog"]
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


@pytest.mark.parametrize(
    ("step", "reason"),
    [(Jog("press", 1), "same speed"), (Jog("heat", 1), "wheel turning"), (Jog("heat", -1), "wheel turning")],
    ids=lambda value: value if isinstance(value, str) else f"{value.axis} {value.direction}",
)
def test_harmful_orders_are_refused(tmp_path: Path, step: Jog, reason: str) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(step)
        yield None
        assert reason in stage.refused["jog"]
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


def test_under_load_the_speeds_move_only_together_and_no_tare_is_taken(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, Jog("both", 1), Jog("press", 1), Jog("press", 1))
        yield from stage.until(lambda view: value(view, "load") > 15.0)
        yield from jog(stage, Jog("wheel", 1), Jog("sideslip", 1))
        yield None
        assert "only with the wheel lifted" in stage.refused["jog"]
        yield stage.order(Tare())
        yield None
        assert "in contact" in stage.refused["tare"]
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


def test_both_speeds_go_as_far_as_the_rig_lets_both(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 24)
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > at_s + 3.0)
        assert value(stage.views[-1], "wheel_speed") == pytest.approx(1.1, abs=0.01)
        assert value(stage.views[-1], "belt_speed") == pytest.approx(1.1, abs=0.01)
        yield stage.order(Stop())
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_an_angle_is_reached(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("sideslip", -1)] * 5)
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > at_s + 3.0)
        assert value(stage.views[-1], "sideslip") == pytest.approx(-5.0, abs=0.1)
        yield stage.order(Stop())
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_a_load_above_that_of_a_roll_check_is_reached(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 4, *[Jog("press", 1)] * 9)
        yield from stays_manual(stage, 30.0)
        assert value(stage.views[-1], "load") == pytest.approx(100.0, abs=10.0)
        yield stage.order(Stop())
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_the_first_load_is_one_that_can_be_held(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 4, Jog("press", 1))
        yield from stays_manual(stage, 30.0)
        assert value(stage.views[-1], "load") == pytest.approx(20.0, abs=10.0)
        yield from jog(stage, Jog("press", -1))
        yield from stays_manual(stage, 10.0)
        assert value(stage.views[-1], "load") == pytest.approx(0.0, abs=2.0)
        yield stage.order(Stop())
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_a_temperature_above_that_of_the_air_is_heated_for(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 4, *[Jog("heat", 1)] * 12)
        yield from stays_manual(stage, 20.0)
        hub = stage.views[-1].value("hub")
        assert hub is not None and hub.setpoint is not None and hub.setpoint > 40.0
        yield stage.order(Stop())
        yield from stage.until(off)

    assert play(tmp_path, script).refused == {}


def test_the_wheel_that_the_last_run_left_worn_is_touched_and_loaded(tmp_path: Path) -> None:
    folder = tmp_path / "runs" / "2024-02-21T14-05-09-worn"
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, rig_text=load_rig("sim").text), SPECIMENS, [CONDITION])
    writer.piece_mounted(PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 85.0, 812.0))
    writer.finish("done", "", rig_seconds=80.0)
    writer.close()

    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 2, *[Jog("press", 1)] * 3)
        yield from stage.until(lambda view: value(view, "load") > 25.0 or not manual(view))
        assert stage.views[-1].mode == "MANUAL"
        yield stage.order(Stop())
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert stage.texts("wheel") == [f"the wheel is taken to have 85.00 mm, as {folder.name} left it"]


def test_under_load_wheel_and_belt_keep_turning(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, *[Jog("both", 1)] * 2, *[Jog("press", 1)] * 4)
        yield from stage.until(lambda view: value(view, "load") > 30.0)
        yield from jog(stage, Jog("both", -1))
        assert "jog" not in stage.refused
        yield from jog(stage, Jog("both", -1))
        at_s = stage.views[-1].t_s
        yield from stage.until(lambda view: view.t_s > at_s + 2.0)
        assert "lift the wheel first" in stage.refused["jog"]
        assert stage.views[-1].mode == "MANUAL"
        assert value(stage.views[-1], "wheel_speed") == pytest.approx(0.05, abs=0.01)
        yield from jog(stage, *[Jog("press", -1)] * 4)
        yield from stage.until(lambda view: value(view, "load") < 5.0)
        stage.refused.clear()
        yield from jog(stage, Jog("both", -1))
        yield from stage.until(lambda view: abs(value(view, "wheel_speed")) < 0.01)
        assert stage.refused == {}
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


def test_a_tare_reports_the_new_zero(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(Tare())
        yield from stage.until(lambda view: bool(view.manual.tare))
        assert "Fz" in stage.views[-1].manual.tare
        yield stage.order(Stop())
        yield from stage.until(off)

    assert "tare" in play(tmp_path, script).accepted


def test_a_zero_that_is_refused_changes_nothing(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(Tare())
        yield from stage.until(lambda view: bool(view.manual.tare))
        assert stage.service is not None and stage.service.desk.watch is not None
        ctx, hand = stage.service.desk.watch.run.engine.ctx, stage.service.desk.hand
        assert hand is not None and isinstance(hand.hand, WheelHand)
        before = ctx.cell.tare
        hand.hand.reference_tare[2] -= 45.0
        yield stage.order(Tare())
        yield from stage.until(lambda view: view.manual.tare.startswith("not taken: load cell zero drifted by 4"))
        assert ctx.cell.tare == before
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


def test_it_disarms_a_minute_after_the_last_step(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, Jog("wheel", 1))
        yield from stage.until(off)

    stage = play(tmp_path, script)
    left = [view.manual.left_s for view in stage.views if view.manual.left_s is not None]
    assert min(left) < 2.0
    assert all(value.value is None for value in stage.views[-1].values)


def test_it_disarms_when_its_client_loses_control(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield Presence("", 0, 0, False)
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert stage.texts("control")[-1] == "no client has control"
    # Of 60 s: the time had not run out.
    assert min(view.manual.left_s for view in stage.views if view.manual.left_s is not None) > 20.0


def test_it_ends_at_once_when_control_was_taken_while_it_was_being_armed(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield ARMED
        arm = stage.order(Arm())
        stage.presence = Presence("client 2", 2, 1, False)  # received with it, before the mode begins
        yield arm
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert min(view.manual.left_s for view in stage.views if view.manual.left_s is not None) > 50.0


def held(stage: Stage) -> Script:
    """Hold the rig during manual motion."""
    yield from armed(stage)
    yield from jog(stage, Jog("both", 1))
    yield stage.order(Hold())
    yield from stage.until(lambda view: view.mode == "HOLD" and view.mode_since_s > 5.0)


def test_it_can_be_disarmed_in_a_hold(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from held(stage)
        yield stage.order(Arm(on=False))
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert min(view.manual.left_s for view in stage.views if view.manual.left_s is not None) > 20.0
    assert journal(tmp_path)[0] == "done"


def test_it_disarms_in_a_hold_when_its_client_loses_control(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from held(stage)
        yield Presence("", 0, 0, False)
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert min(view.manual.left_s for view in stage.views if view.manual.left_s is not None) > 20.0


def test_a_hold_does_not_stop_its_minute(tmp_path: Path) -> None:
    began: list[float] = []

    def script(stage: Stage) -> Script:
        yield from held(stage)
        began.append(stage.views[-1].t_s)
        yield from stage.until(off)

    stage = play(tmp_path, script)
    assert stage.views[-1].run is not None and stage.views[-1].run.outcome == "done"
    # Counted from the hold, how long arming took does not matter; arming to the hold takes 13 s of rig time.
    assert max(view.t_s for view in stage.views) - began[0] < 67.0


def journal(home: Path) -> tuple[str, str, list[str]]:
    """Return status, reason and events of the only stay in manual mode."""
    (folder,) = (home / "runs" / ".manual").iterdir()
    with RunReader(folder) as reader:
        stored = reader.run()
        return stored.status, stored.reason, [event.text for event in reader.events()]


def test_a_stop_in_manual_mode_is_written_down(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)
    status, reason, events = journal(tmp_path)
    assert status == "stopped" and reason.startswith("stop by")
    assert any(text.startswith("run -> stopping: stop by") for text in events)


def test_a_trip_in_manual_mode_is_written_down(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        assert stage.service is not None and stage.service.desk.watch is not None
        stage.service.desk.watch.run.engine.devices.axes.wheel.lost = True
        stage.service.desk.watch.run.engine.devices.axes.wheel.news = True
        yield from stage.until(lambda view: view.mode == "LATCHED")

    play(tmp_path, script)
    status, reason, events = journal(tmp_path)
    assert status == "tripped" and reason.startswith("drive fault")
    assert any(text.startswith("drive fault: ") for text in events)


def test_a_journal_of_manual_mode_is_no_run(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)
    assert list(run_folders(tmp_path / "runs")) == []


def test_a_screen_that_gives_no_sign_of_life_for_a_second_ends_the_mode(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield from jog(stage, Jog("both", 1))
        yield from stays_manual(stage, 5.0)
        stage.silent = True
        yield from stage.until(off)

    assert any("no sign of its screen" in text for text in play(tmp_path, script).texts("mode"))


def test_an_axis_that_this_machine_does_not_have_is_refused_with_those_it_has(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from armed(stage)
        yield stage.order(Jog("chamber", 1))
        yield None
        assert stage.refused["jog"] == (
            "no axis 'chamber' for manual mode here: wheel, belt, both, press, sideslip, camber, heat"
        )
        yield stage.order(Stop())
        yield from stage.until(off)

    play(tmp_path, script)


RIG = load_rig("sim")
HERE = replace(RUN, rig_text=RIG.text)
WHEEL = PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 85.0, 812.0)


def mounted_wheel(runs: Path, rig: RigConfig) -> WheelLeft | None:
    left = left_on_rig(runs, rig, SERVED)
    assert left is None or isinstance(left, WheelLeft)
    return left


def a_run(runs: Path, name: str, info: RunInfo, *wheels: PieceInfo) -> None:
    folder = runs / name
    folder.mkdir()
    writer = open_writer(folder)
    writer.begin_run(info, SPECIMENS, [CONDITION])
    for wheel in wheels:
        writer.piece_mounted(wheel)
    writer.finish("stopped", "", rig_seconds=80.0)
    writer.close()


def test_it_is_the_last_wheel_of_the_newest_run(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, replace(WHEEL, diameter_mm=80.0))
    a_run(tmp_path, "2024-02-01-new", HERE, replace(WHEEL, diameter_mm=81.0), replace(WHEEL, piece=2, installed_s=70.0))
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.wheel is not None
    assert (found.run, found.wheel.piece, found.wheel.diameter_mm) == ("2024-02-01-new", 2, 85.0)


def test_a_run_without_a_wheel_and_an_unreadable_run_are_skipped(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", HERE)
    (tmp_path / "2024-03-01-broken").mkdir()
    (tmp_path / "2024-03-01-broken" / "run.db").write_bytes(b"no database")
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.run == "2024-01-01-old"


@pytest.mark.parametrize(
    "info",
    [
        replace(HERE, rig_text=replace(RIG, rig="another").text),
        replace(HERE, simulated=False),
        replace(HERE, rig_text="no: [yaml"),
    ],
    ids=["another rig", "a real one", "unreadable"],
)
def test_a_wheel_of_another_rig_is_not_on_this_one(tmp_path: Path, info: RunInfo) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", info, replace(WHEEL, diameter_mm=88.0))
    found = mounted_wheel(tmp_path, RIG)
    assert found is not None and found.wheel is not None and found.wheel.diameter_mm == 85.0


def test_the_same_rig_with_another_setting_has_the_same_wheel(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    assert mounted_wheel(tmp_path, load_rig("sim", ("sim.noise=0",))) is not None


def test_a_wheel_worn_below_its_least_is_taken_for_changed(tmp_path: Path) -> None:
    a_run(tmp_path, "2024-01-01-old", HERE, WHEEL)
    a_run(tmp_path, "2024-02-01-new", HERE, replace(WHEEL, diameter_mm=77.0))
    assert mounted_wheel(tmp_path, RIG) is None


def test_without_a_run_nothing_is_known(tmp_path: Path) -> None:
    assert mounted_wheel(tmp_path / "nowhere", RIG) is None
