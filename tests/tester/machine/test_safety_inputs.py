"""Safety inputs that a rig file names: on Modbus and on a CiA 401 node, in every mode of both kinds of rig."""

from __future__ import annotations

from copy import deepcopy
from itertools import product
from math import nan
from typing import Any, Final

import pytest

from sim.faults.common import SCAN_S, TRIP, further_rows, node_rows
from sim.faults.scene import Scene
from tester.base.source import InvalidSource
from tester.kinds import load_rig, load_rig_text
from tester.machine.motions import Ask
from tester.machine.prompts import Prompts
from tester.machine.safety_inputs import InputStates
from tester.machine.state import Mode
from tester.run.simulated import spec_of
from tests.tester.kinds.specimen_on_track.bench import TrackBench
from tests.tester.kinds.wheel_on_belt.bench import QUIET, Simulation

NODE: Final = (
    "can.nodes.inputs={node_id: 21, period: 50 ms, channels: {limiter_closed: {byte: 0, type: bit, bit: 1, scale: 1,"
    " unit: ''}, air_closed: {byte: 0, type: bit, bit: 6, scale: 1, unit: ''}}}"
)
INPUTS: Final = {
    "light_curtain": "{channel: di_0}",
    "second_door": "{channel: di_1, open_at_rest: true}",
    "limiter": "{channel: limiter_closed}",
    "air": "{channel: air_closed, reaction: controlled}",
    "water": "{channel: di_4, reaction: controlled}",
}
FAST = {Mode.FAST_STOP, Mode.LATCHED}
CONTROLLED = {Mode.STOPPING, Mode.COOLDOWN, Mode.LATCHED}
"""Modes after the scan of a trip: a rig at rest has stopped at once."""
WORKING = (Mode.RUN, Mode.HOLD)
RESTING = (Mode.IDLE, Mode.ARMED, Mode.LATCHED)
CASES = list(product(INPUTS, (0.0, nan, 2.0)))


def overrides(line: str) -> tuple[str, ...]:
    device = "devices.io={profile: moxa_e1214, line: LINE, unit_id: 9}".replace("LINE", line)
    return (device, NODE, *(f"safety_inputs.{name}={text}" for name, text in INPUTS.items()))


def wheel() -> Simulation:
    return Simulation(overrides=(*QUIET, *overrides("heat")))


def track() -> TrackBench:
    return TrackBench("grosch", overrides=overrides("heat"))


@pytest.fixture(scope="module", params=["wheel", "track"])
def running(request: pytest.FixtureRequest) -> Any:
    """A run that has begun, of either kind."""
    bench: Any = wheel() if request.param == "wheel" else track()
    return bench.until(lambda one: one.run.engine.control.state.mode is Mode.RUN, 300.0)


def opened(bench: Any, name: str, value: float, mode: Mode, *, driven: bool = True) -> Any:
    """Return a copy of the control after one scan in ``mode`` in which an input reads ``value``."""
    engine = deepcopy(bench.run.engine)
    control, ctx = engine.control, engine.ctx
    place = {channel: i for i, channel in enumerate(control.view.further_places)}
    channel = INPUTS[name].split()[1].strip(",}")
    ctx.readings.channels[place[channel]] = value
    ctx.demand.enabled = driven
    if mode is Mode.HOLD:
        assert control.request_hold(ctx.demand, ctx.readings.now_s, "test") == ""
    control.state.mode = mode
    control.state.setpoints.enable = driven
    if mode in (Mode.STOPPING, Mode.FAST_STOP, Mode.COOLDOWN, Mode.EMERGENCY):
        control.state.stop.began_s = ctx.readings.now_s
    control.step(ctx.demand, ctx.readings, 0.01)
    return control


def title(name: str) -> str:
    return name.replace("_", " ")


@pytest.mark.parametrize("mode", list(Mode))
def test_an_input_that_is_not_closed_trips_in_every_mode_but_at_rest_by_its_name(running: Any, mode: Mode) -> None:
    for name, value in CASES:
        control = opened(running, name, value, mode)
        held = control.table.names_of(control.state.held)
        assert title(name) in held, (name, value)
        if mode in RESTING:
            continue  # nothing to stop: it only prevents arming
        assert control.state.trip is not None and title(name) in {
            control.state.trip.name, *control.table.names_of(control.state.tripped)
        }  # fmt: skip
        if mode in WORKING:
            assert control.state.mode in (CONTROLLED if "controlled" in INPUTS[name] else FAST), (name, value)


@pytest.mark.parametrize("mode", RESTING)
def test_only_a_door_may_be_open_while_the_drives_have_no_power(running: Any, mode: Mode) -> None:
    for name in INPUTS:
        control = opened(running, name, 0.0, mode, driven=False)
        assert (title(name) in control.table.names_of(control.state.held)) is (name != "second_door")


def test_all_closed_holds_no_row_and_every_input_is_on_the_list(running: Any) -> None:
    engine = running.run.engine
    assert engine.control.state.trip is None
    states = InputStates(engine.ctx.rig).closed(engine.ctx.readings.channels)
    assert states == {title(name): True for name in INPUTS}
    assert InputStates(engine.ctx.rig).closed([]) == {title(name): False for name in INPUTS}


@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("kind", ["wheel", "track"])
def test_the_rig_is_not_armed_while_one_is_open(kind: str, name: str) -> None:
    channel = INPUTS[name].split()[1].strip(",}")
    bench: Any = wheel() if kind == "wheel" else track()
    if channel.startswith("di_"):
        bench.world.sensors["io"].show(channel, 0.0)
    else:
        bench.world.nodes[0].show({"limiter_closed": 1.0, "air_closed": 1.0, channel: 0.0})
    while not bench.run.finished and bench.now < 300.0:
        bench.tick()
    assert f"not armed: {title(name)}" in bench.run.reason + bench.run.connector.failure


def test_an_answer_with_a_door_open_does_not_count_and_is_asked_again(running: Any) -> None:
    ctx = deepcopy(running.run.engine).ctx
    ctx.prompts = Prompts(automatic=False)
    ask, door = Ask("change the specimen"), list(running.run.engine.control.view.further_places).index("di_1")
    ctx.readings.channels[door] = 0.0
    assert not ask.step(ctx)
    ctx.prompts.asked[-1].answer = "yes"
    assert not ask.step(ctx) and "door open" in ctx.progress.phase
    ctx.readings.channels[door] = 1.0
    assert not ask.step(ctx) and ask.number == 2
    ctx.prompts.asked[-1].answer = "yes"
    assert ask.step(ctx)


def test_a_module_that_falls_silent_trips_by_the_name_of_its_inputs() -> None:
    bench = track().until(lambda one: one.run.engine.control.state.mode is Mode.RUN, 300.0)
    bench.world.nodes[0].power(False)
    at = bench.now
    bench.until(lambda one: one.run.engine.control.state.trip is not None, at + 1.0)
    assert bench.run.engine.control.state.trip.name == "limiter" and bench.now - at < 0.5


TRIPPED: Final = {
    "io shows di_0": "light curtain",
    "io shows di_4": "water",
    "io silent": "light curtain",
    "io without supply": "light curtain",
    "inputs shows limiter_closed": "limiter",
    "inputs shows air_closed": "air",
    "inputs without supply": "limiter",
}
"""Faults of the catalogue, and the first input named."""


class Unattended:
    """A computer without faults."""

    def stall(self, seconds: float) -> None: ...

    def kill(self) -> None: ...

    def jump(self, seconds: float) -> None: ...

    def operate(self, action: str) -> None: ...


@pytest.mark.parametrize("kind", ["wheel", "track"])
@pytest.mark.parametrize("phrase", TRIPPED)
def test_each_of_the_catalogue_s_faults_trips_in_its_time(kind: str, phrase: str) -> None:
    bench: Any = wheel() if kind == "wheel" else track()
    bench.until(lambda one: one.run.engine.control.state.mode is Mode.RUN, 300.0)
    spec = spec_of(bench.run.engine.ctx.rig)
    rows = {row.phrase: row for row in (*further_rows("io", spec.devices["io"], spec.inputs),
                                        *node_rows(spec.nodes[0], spec.inputs))}  # fmt: skip
    at = bench.now
    rows[phrase].effect().begin(Scene(bench.world, Unattended()), at)
    bench.until(lambda one: one.run.engine.control.state.trip is not None, at + 2.0)
    assert bench.run.engine.control.state.trip.name == TRIPPED[phrase]
    assert rows[phrase].reaction is TRIP and bench.now - at <= rows[phrase].budget_s + SCAN_S


def test_the_file_reads_back_as_the_same() -> None:
    rig = load_rig("sim", overrides("heat"))
    assert load_rig_text(rig.text) == rig
    assert "safety_inputs" not in load_rig("sim").text


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("safety_inputs.water={channel: nowhere}", "no such channel (expected a channel of type bit: di_0, di_1"),
        ("safety_inputs.water={channel: rh}", "rh is no contact (expected type bit)"),
        ("safety_inputs.water={channel: di_0, reaction: warn}", "fast"),
        ("safety_inputs.Water={channel: di_0}", "expected small letters, digits and _"),
    ],
)
def test_a_mistake_is_refused(override: str, message: str) -> None:
    rh = "can.nodes.climate={node_id: 20, channels: {rh: {byte: 0, type: u16, scale: 1, unit: ''}}}"
    with pytest.raises(InvalidSource) as refused:
        load_rig("sim", (*overrides("heat"), rh, override))
    assert message in str(refused.value)
