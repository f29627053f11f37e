"""The twin of a plain machine, and machines that are found by a dotted name."""

from __future__ import annotations

import pytest

from sim import machines
from sim.nodes.sensor_slave import UnknownQuantityError
from sim.plain_twin import PlainTwin
from tester.run.simulated import spec_of
from tests.tester.machine.plain.bench import BenchPlant, BenchRuns, bench_rig


class CountingPlant(BenchPlant):
    """Adds up its commands."""

    def __init__(self) -> None:
        super().__init__()
        self.seconds = 0.0
        self.speeds: dict[str, float] = {}

    def advance(self, dt: float, speeds: object) -> None:
        self.seconds += dt
        assert isinstance(speeds, dict)
        self.speeds = speeds


def test_its_plant_lives_as_long_as_its_wires_with_every_drives_speed() -> None:
    plant = CountingPlant()
    twin = PlainTwin(spec_of(bench_rig()), plant, {"cell": {"fx": "force_n"}})
    for i in range(1, 101):
        twin.advance(0.01 * i)
    assert plant.seconds == pytest.approx(1.0) and plant.speeds == {"left": 0.0, "right": 0.0}
    assert list(twin.devices) == ["cell"] and twin.ambient_c == 21.0


def test_the_hands_at_it_are_its_plants() -> None:
    plant = CountingPlant()
    twin = PlainTwin(spec_of(bench_rig()), plant, {"cell": {"fx": "force_n"}})
    twin.install(3, "NR")
    twin.begin_repeat(1, 2, 3)
    assert (plant.installed, plant.repeats) == ([(3, "NR")], [(1, 2, 3)])


def test_a_sensor_of_a_quantity_that_the_plant_lacks_is_refused() -> None:
    with pytest.raises(UnknownQuantityError, match="warmth"):
        PlainTwin(spec_of(bench_rig()), CountingPlant(), {"cell": {"fx": "warmth"}})


def test_a_machine_is_found_by_a_dotted_name() -> None:
    assert machines.find(BenchRuns.plant).log_columns == ("force_n",)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("sledge", "no simulated machine 'sledge'; known: specimen_on_track, wheel_on_belt"),
        ("nowhere.twin:MACHINE", "no simulated machine 'nowhere.twin:MACHINE': No module named 'nowhere'"),
        ("sim.machines:NOTHING", "no simulated machine 'sim.machines:NOTHING'"),
        ("sim.machines:names", "sim.machines:names is no simulated machine"),
    ],
)
def test_a_name_that_leads_to_no_machine_is_refused_with_the_reason(name: str, message: str) -> None:
    with pytest.raises(machines.UnknownMachineError, match=message):
        machines.find(name)
