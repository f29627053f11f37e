"""Signs of contact on a wet track at a coefficient of 0.02: the height of the arm, and friction that a dead cell does
not show."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import pytest

from sim.faults import FaultScript, Scene
from sim.machines.specimen_on_track.faults import LANGUAGE
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs
from tester.kinds.specimen_on_track.interlocks.table import TABLE
from tester.kinds.specimen_on_track.interlocks.witness import least_stated
from tester.machine.interlock_table import RigTable
from tests.sim.machines.specimen_on_track.test_track_faults import FaultlessComputer
from tests.tester.kinds.specimen_on_track.bench import DISC, TrackBench

WET = DISC.replace("[dry, wet]", "wet").replace("5 K, soak", "5 K, least_friction: 0.02, soak")
FILM = ("sim.contact.wet=0.0094",)
"""Of the dry coefficient of SBR at 0.2 m/s, 2.19: 0.0206."""
SEEDS = 12


def slides(bench: TrackBench) -> bool:
    return bench.run.engine.ctx.readings.lowered and bench.run.engine.ctx.demand.sliding_m > 0.05


@pytest.fixture
def wet() -> TrackBench:
    """A pin that slides on a film with 0.02."""
    return TrackBench("pin-on-disc", WET, FILM).until(slides, 200.0)


def held(bench: TrackBench) -> list[str]:
    """Return the names of the rows that hold now."""
    view = bench.run.engine.control.view
    return TABLE.names_of(RigTable(TABLE, view.parameters).held(view))


@pytest.mark.parametrize("seed", range(SEEDS))
def test_a_coefficient_of_a_fiftieth_is_measured_without_a_false_trip(seed: int) -> None:
    bench = TrackBench("pin-on-disc", WET, FILM, seed).to_the_end()
    assert bench.kept.trips == [] and bench.run.outcome.value == "done"
    ((_, result),) = bench.kept.results
    assert result.valid and result.mu_resultant == pytest.approx(0.0206, abs=0.004)


def test_no_row_holds_while_it_slides_on_a_film(wet: TrackBench) -> None:
    assert held(wet) == []


def without_witness(v: TrackInputs) -> None:
    v.limits.height = False


def reading(name: str, value: object) -> Callable[[TrackInputs], None]:
    """Return a function that sets a reading."""
    return lambda v: setattr(v.readings, name, value)


@pytest.mark.parametrize(
    "spoil",
    [
        without_witness,
        reading("height_at_s", -inf),
        reading("height_silent", value=True),
        reading("height_mm", nan),
        reading("height_mm", -1.31),
        reading("height_mm", 0.51),
        lambda v: setattr(v.demand, "least_mu", 0.0),
    ],
)
def test_friction_on_a_film_is_a_lost_contact_where_no_height_shows_it(
    wet: TrackBench, spoil: Callable[[TrackInputs], None]
) -> None:
    spoil(wet.run.engine.control.view)
    assert "contact lost" in held(wet)


@pytest.mark.parametrize(("friction_n", "lost"), [(0.11, False), (0.09, True), (0.0, True), (-0.2, True), (nan, True)])
def test_friction_that_a_deaf_cell_may_show_is_a_lost_contact_at_any_height(
    wet: TrackBench, friction_n: float, *, lost: bool
) -> None:
    wet.run.engine.control.view.readings.friction_n = friction_n
    assert ("contact lost" in held(wet)) is lost


@pytest.mark.parametrize(
    ("row", "spoil"),
    [
        ("arm off its height", reading("height_mm", nan)),
        ("arm off its height", reading("height_mm", -1.31)),
        ("arm off its height", reading("height_mm", 0.51)),
        ("height sensor silent", reading("height_at_s", -inf)),
        ("height sensor silent", reading("height_at_s", nan)),
        ("height sensor silent", reading("height_silent", value=True)),
        ("height sensor frozen", reading("height_changed_s", -inf)),
    ],
)
def test_a_row_holds_where_the_height_is_not_known_or_not_that_of_a_specimen(
    wet: TrackBench, row: str, spoil: Callable[[TrackInputs], None]
) -> None:
    spoil(wet.run.engine.control.view)
    assert row in held(wet)


@pytest.mark.parametrize("worn_mm", [0.0, 0.7])
def test_a_worn_specimen_holds_no_row(wet: TrackBench, worn_mm: float) -> None:
    wet.world.plant.worn_mm = worn_mm
    now = wet.now
    wet.until(lambda one: one.now > now + 0.5, now + 1.0)
    assert wet.kept.trips == [] and held(wet) == []


@pytest.mark.parametrize("least_mu", [0.4, 1.0])
def test_a_stated_friction_tightens_the_share(wet: TrackBench, least_mu: float) -> None:
    view = wet.run.engine.control.view
    view.demand.least_mu = least_mu
    view.readings.friction_n = 0.49 * least_mu * view.readings.load_n
    assert "contact lost" in held(wet)
    view.readings.friction_n = 0.51 * least_mu * view.readings.load_n
    assert held(wet) == []


@pytest.mark.parametrize(
    ("stated", "interface", "least_mu"),
    [(0.02, "wet", 0.02), (0.02, "talc", 0.02), (0.02, "dry", 0.0), (0.3, "dry", 0.3)],
)
def test_a_dry_contact_is_never_expected_below_the_share(stated: float, interface: str, least_mu: float) -> None:
    assert least_stated(stated, interface, 0.05) == least_mu


def test_after_a_repeat_nothing_low_is_expected(wet: TrackBench) -> None:
    wet.phase("lift")
    assert wet.run.engine.ctx.demand.least_mu == 0.0


@pytest.mark.parametrize(
    ("fault", "row", "within_s"),
    [
        ("specimen lost", "arm off its height", 0.3),
        ("holder grinds 0.02", "arm off its height", 0.3),
        ("holder grinds 0.4", "arm off its height", 0.3),
        ("load cell deaf", "contact lost", 0.4),
        ("load cell frozen", "load cell frozen", 1.2),
        ("height sensor frozen", "height sensor frozen", 1.2),
        ("height sensor offset 0.7 mm", "arm off its height", 0.3),
        ("height sensor offset -2 mm", "arm off its height", 0.3),
        ("height sensor drift 0.5 mm/s", "arm off its height", 1.6),
        ("height sensor silent", "height sensor silent", 0.35),
        ("height sensor open", "arm off its height", 0.3),
    ],
)
def test_a_fault_on_a_film_is_stopped_in_time(wet: TrackBench, fault: str, row: str, within_s: float) -> None:
    script = FaultScript().add([LANGUAGE.parse(f"t={wet.now:.6f} s: {fault}")])
    scene, due_s = Scene(wet.world, FaultlessComputer()), wet.now + within_s
    while not wet.kept.trips:
        assert wet.now < due_s
        script.act(scene, wet.now + 1e-6)
        script.renew(scene, wet.now)
        wet.tick()
    assert wet.kept.trips[0] == row
    wet.to_the_end(wet.now + 20.0)
    assert wet.world.track_m_s == 0.0 and wet.world.plant.ground_m < 0.3
