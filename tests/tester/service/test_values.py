"""Values for people: the nominal pressure beside the load, and the height of the arm where a sensor measures it."""

from __future__ import annotations

import pytest

from tester.inputs.rig.further_sensors import quantities_on
from tester.kinds import load_rig
from tester.run.kind_lookup import served_kind
from tester.service.values import ValueView, unknown_values, with_pressure
from tests.tester.kinds.specimen_on_track.bench import GROSCH, TrackBench

STATED = "contact={area: 50 mm2, source: drawing 12}"


def test_without_an_area_the_values_are_those_of_the_channels() -> None:
    rig = load_rig("grosch")
    values = unknown_values(quantities_on(rig), rig)
    assert with_pressure(values, rig.area_metadata) == values


def test_a_rig_at_rest_shows_the_pressure_by_the_area_of_its_file() -> None:
    rig = load_rig("sim", [STATED])
    values = with_pressure(unknown_values(quantities_on(rig), rig), rig.area_metadata)
    at = [value.key for value in values].index("load")
    load, pressure = values[at : at + 2]
    assert (pressure.key, pressure.unit, pressure.value) == ("pressure", "kPa", None)
    assert load.high is not None and pressure.high == 20.0 * load.high and pressure.scale_high == 20.0 * load.scale_high


@pytest.mark.parametrize(("stated", "kpa"), [("", 400.0), ("contact: {area: 100 mm2, source: die}\n", 200.0)])
def test_a_run_shows_the_pressure_of_the_load_that_is_on_the_arm(stated: str, kpa: float) -> None:
    bench = TrackBench(recipe=stated and GROSCH + stated, overrides=[STATED]).phase("slide")
    engine = bench.run.engine
    found = {one.key: one for one in ValueView(engine, served_kind(bench.config).panel(engine)).values()}
    load, pressure = found["load"], found["pressure"]
    assert (load.value, load.setpoint) == (20.0, 20.0)
    assert (pressure.value, pressure.setpoint) == (kpa, kpa) and pressure.quality == load.quality == "good"


def test_the_height_of_the_arm_is_shown_with_its_interlocks_bounds() -> None:
    rig = load_rig("pin-on-disc", ["interlocks.wear=1 mm", "interlocks.thickness=0.25 mm"])
    height = next(value for value in unknown_values(quantities_on(rig), rig) if value.key == "height")
    assert (height.low, height.high) == (-1.25, 0.25)
    assert height.scale_low < -1.25 < 0.25 < height.scale_high


def test_a_rig_without_a_sensor_of_the_height_does_not_show_it() -> None:
    rig = load_rig("grosch")
    assert "height" not in {value.key for value in unknown_values(quantities_on(rig), rig)}
    assert "height_mm" in quantities_on(rig).names
