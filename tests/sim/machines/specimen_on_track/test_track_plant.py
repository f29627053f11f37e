"""The plant against closed forms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import exp, radians
from pathlib import Path

import pytest

from sim.machines.specimen_on_track.plant import TrackPlant
from sim.physics import tabulated, track
from sim.physics.laws import LawSetting, make, with_parts
from sim.physics.materials import Rubber, Surface
from sim.physics.track import TrackContact, TrackParameters, TrackSensors
from sim.physics.wlf import PoleError, WlfBell, WlfBellParameters
from tests.sim.physics.materials_example import Shelf

CLEAN = TrackParameters(noise=0.0, scatter=0.0)
LAW = WlfBell(WlfBellParameters())
STIFFNESS_N_M = 1e3 * CLEAN.contact.stiffness


def lowered(parameters: TrackParameters = CLEAN, weights_n: float = 20.0, compound: str = "SBR") -> TrackPlant:
    plant = TrackPlant(parameters, 1)
    plant.install(0, compound)
    plant.put_on(weights_n)
    plant.advance(0.01, 0.0, 0.0, 0.0)
    return plant


def slid(plant: TrackPlant, track_m_s: float, seconds: float, dt: float = 0.01) -> TrackPlant:
    for _ in range(round(seconds / dt)):
        plant.advance(dt, track_m_s, 0.0, 0.0)
    return plant


@pytest.mark.parametrize(("lift_mm", "share"), [(10.0, 0.0), (1.0, 0.0), (0.25, 0.75), (0.0, 1.0)])
def test_the_load_comes_on_with_the_last_of_the_lift(lift_mm: float, share: float) -> None:
    plant = lowered()
    plant.advance(0.01, 0.0, lift_mm, 0.0)
    assert plant.load_n == pytest.approx(20.0 * share)


def test_while_it_sticks_the_force_is_the_springs() -> None:
    plant = slid(lowered(), 1e-5, 5.0)
    assert plant.force_n == pytest.approx(STIFFNESS_N_M * 1e-5 * 5.0) and plant.slid_m == 0.0


def test_it_breaks_loose_at_the_static_limit() -> None:
    speed, plant = 1e-4, lowered()
    limit_n = 20.0 * LAW.mu(23.0, 20.0, speed) * (1.0 + CLEAN.contact.static_excess)
    most_n = 0.0
    for _ in range(600):
        plant.advance(0.01, speed, 0.0, 0.0)
        most_n = max(most_n, plant.force_n)
    assert most_n == pytest.approx(limit_n, rel=0.01)


@pytest.mark.parametrize("speed", [1e-5, 1e-4, 1e-3, 1e-2])
def test_sliding_steadily_the_force_is_the_laws(speed: float) -> None:
    plant = slid(lowered(), speed, 2e-3 / speed, 0.1 * 1e-4 / speed)
    assert plant.force_n == pytest.approx(20.0 * LAW.mu(plant.specimen_c, 20.0, speed), rel=1e-6)


def test_the_other_way_the_force_is_the_other_way() -> None:
    plant = slid(slid(lowered(), 1e-3, 2.0), -1e-3, 3.0)
    assert plant.force_n == pytest.approx(-20.0 * LAW.mu(23.0, 20.0, 1e-3), rel=1e-4)


def test_turning_back_it_sticks_until_the_spring_is_drawn_the_other_way() -> None:
    plant = slid(lowered(), 1e-3, 2.0)
    distance_m, force_n = plant.slid_m, plant.force_n
    plant.advance(0.01, -1e-3, 0.0, 0.0)
    assert plant.slid_m == distance_m and plant.force_n == pytest.approx(force_n - STIFFNESS_N_M * 1e-5)


def test_a_standing_track_keeps_the_force_and_the_contact_rests() -> None:
    plant = slid(lowered(), 1e-3, 2.0)
    force_n = plant.force_n
    slid(plant, 0.0, 1.0)
    assert plant.force_n == force_n and plant.slip_m_s == 0.0
    slid(plant, 1e-3, 0.05)
    assert plant.force_n > 1.1 * force_n


def test_raised_nothing_is_left_of_the_force() -> None:
    plant = slid(lowered(), 1e-3, 2.0)
    plant.advance(0.01, 1e-3, 10.0, 0.0)
    assert (plant.force_n, plant.load_n, plant.slip_m_s, plant.power_w) == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize(("interface", "share"), [("dry", 1.0), ("wet", 0.6), ("talc", 0.5)])
def test_the_interface_takes_its_share(interface: str, share: float) -> None:
    plant = lowered()
    plant.prepare(interface)  # type: ignore[arg-type]
    assert slid(plant, 1e-3, 3.0).mu == pytest.approx(share * LAW.mu(plant.specimen_c, 20.0, 1e-3), rel=1e-6)


def on_track(law: str, tables: Path, compound: str = "SBR", **contact: float) -> TrackPlant:
    """Return a plant whose law is made of materials, with a specimen loaded."""
    plant = TrackPlant(replace(CLEAN, law=law, contact=TrackContact(area=50.0, **contact)), 1)
    plant.setting = LawSetting(Shelf(), "track", tables=tables)
    plant.install(0, compound)
    plant.put_on(20.0)
    plant.advance(0.01, 0.0, 0.0, 0.0)
    return plant


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Tables that the tests of this module share: of the speed and the load that they use, with few points."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(track, "TABLE_M_S", (5e-4, 2e-3))
        patch.setattr(track, "TABLE_N", (10.0, 40.0))
        patch.setattr(tabulated, "POINTS", (6, 20, 5))
        patch.setattr(tabulated, "_EVERYWHERE", 100)
        yield tmp_path_factory.mktemp("tables")


@pytest.mark.parametrize("law", ["persson", "greta"])
def test_a_law_of_materials_rubs_with_the_pressure_on_the_nominal_area(law: str, tables: Path) -> None:
    plant = slid(on_track(law, tables), 1e-3, 3.0)
    slow = make(law, "SBR", setting=LawSetting(Shelf(), "track", 50.0))
    assert plant.mu == pytest.approx(slow.mu(plant.specimen_c, 20.0, 1e-3), rel=0.005)


@pytest.mark.parametrize(("interface", "kept"), [("dry", (1.0, 1.0)), ("wet", (0.0, 1.0)), ("talc", (0.1, 0.9))])
def test_of_a_law_that_knows_its_parts_water_takes_the_adhesion_and_talc_most_of_it(
    interface: str, kept: tuple[float, float], tables: Path
) -> None:
    plant = on_track("greta", tables)
    plant.prepare(interface)  # type: ignore[arg-type]
    slid(plant, 1e-3, 3.0)
    slow = with_parts("greta", make("greta", "SBR", setting=LawSetting(Shelf(), "track", 50.0)))
    adhesion, hysteresis = slow.components(plant.specimen_c, 20.0, 1e-3)
    assert adhesion > 0.01 * hysteresis > 0.0
    assert plant.mu == pytest.approx(kept[0] * adhesion + kept[1] * hysteresis, rel=0.01)


def test_water_may_leave_a_share_of_the_adhesion_and_talc_none(tables: Path) -> None:
    made = partial(on_track, "greta", tables, wet_adhesion=0.3, talc_adhesion=0.0, talc_hysteresis=1.0)
    dry, wet, talc = (made() for _ in range(3))
    wet.prepare("wet")
    talc.prepare("talc")
    for plant in (dry, wet, talc):
        slid(plant, 1e-3, 3.0)
    assert wet.mu == pytest.approx(0.3 * dry.mu + 0.7 * talc.mu, rel=1e-3)


@pytest.mark.parametrize("law", ["wlf_bell", "greta"])
def test_friction_falls_with_the_pressure_to_the_power_put_in(law: str, tables: Path) -> None:
    """20 N on 50 mm2 are 400 kPa, four times the pressure at which the law holds; wet, both parts fall alike."""
    for interface in ("dry", "wet"):
        even, falling = (on_track(law, tables, pressure_exponent=power) for power in (0.0, 0.25))
        for plant in (even, falling):
            plant.prepare(interface)  # type: ignore[arg-type]
            slid(plant, 1e-3, 3.0)
        assert falling.mu == pytest.approx(4.0**-0.25 * even.mu, rel=1e-3)


def test_an_interface_stays_when_another_specimen_is_put_in(tables: Path) -> None:
    plant = on_track("greta", tables)
    plant.prepare("talc")
    before = slid(plant, 1e-3, 3.0).mu
    plant.install(0, "SBR")
    plant.advance(0.01, 0.0, 0.0, 0.0)
    assert slid(plant, 1e-3, 3.0).mu == pytest.approx(before, rel=1e-3)


def test_the_tracks_own_surface_goes_before_the_recipes(tables: Path) -> None:
    one, other = (replace(CLEAN, law="persson", surface=name) for name in ("", "grit"))
    setting = LawSetting(Shelf(), "road", tables=tables)
    with pytest.raises(ValueError, match="'road' has no spectrum"):
        one.friction_of("SBR", setting)
    assert other.friction_of("SBR", setting).mu(20.0, 20.0, 1e-3) > 0.0


def test_a_specimen_put_in_reads_its_materials_once(tables: Path) -> None:
    asked: list[str] = []

    class Counted(Shelf):
        def rubber(self, name: str) -> Rubber:
            asked.append(name)
            return super().rubber(name)

        def surface(self, name: str) -> Surface:
            asked.append(name)
            return super().surface(name)

    replace(CLEAN, law="persson").friction_of("SBR", LawSetting(Counted(), "track", tables=tables))
    assert sorted(asked) == ["SBR", "track"]


def test_without_materials_such_a_law_names_its_needs() -> None:
    with pytest.raises(ValueError, match="'persson' is made of materials and needs the modulus of 'SBR'"):
        lowered(replace(CLEAN, law="persson"))


@pytest.mark.parametrize("law", ["power", "arrhenius"])
def test_plain_laws_are_also_found_by_their_names(law: str) -> None:
    plant = slid(lowered(replace(CLEAN, law=law)), 1e-3, 3.0)
    assert plant.mu == pytest.approx(make(law, "SBR").mu(plant.specimen_c, 20.0, 1e-3))


def test_friction_heats_nothing_at_the_slow_tracks_speeds() -> None:
    plant = slid(lowered(), 1e-2, 200.0, 0.1)
    assert plant.power_w < 0.5 and plant.specimen_c - 23.0 < 0.2


def test_friction_warms_the_pin_on_a_disc_and_the_exit_edge_more() -> None:
    plant = slid(lowered(replace(CLEAN, motion="disc", enclosed=False)), 1.0, 2000.0, 0.1)
    heat = CLEAN.heat
    assert plant.specimen_c - 23.0 == pytest.approx(heat.specimen_rise * heat.friction_share * plant.power_w, rel=0.01)
    assert plant.exit_c == pytest.approx(plant.specimen_c + heat.exit_rise * plant.power_w)


def test_the_air_of_the_chamber_follows_its_output_exponentially() -> None:
    plant, heat = TrackPlant(CLEAN, 1), CLEAN.heat
    for _ in range(6000):
        plant.advance(0.1, 0.0, 10.0, -50.0)
    end_k = -0.5 * heat.chamber_rate * heat.chamber_time
    assert plant.air_c - 23.0 == pytest.approx(end_k * (1.0 - exp(-600.0 / heat.chamber_time)), rel=1e-9)


def test_the_specimen_follows_the_air_late() -> None:
    plant = TrackPlant(CLEAN, 1)
    plant.air_c = 60.0
    parameters = replace(CLEAN, enclosed=False)  # the air stays as it is
    plant.parameters = parameters
    for _ in range(3000):
        plant.advance(0.1, 0.0, 10.0, 0.0)
    assert plant.specimen_c == pytest.approx(60.0 - 37.0 * exp(-1.0), rel=1e-9)


def test_a_specimen_colder_than_its_law_is_reported() -> None:
    plant = lowered()
    plant.specimen_c = plant.air_c = -110.0
    with pytest.raises(PoleError):
        plant.advance(0.01, 1e-3, 0.0, 0.0)


def test_without_noise_the_cell_reads_the_force_within_its_range() -> None:
    plant = slid(lowered(), 1e-3, 1.0)
    assert plant.forces_measured(0.0) == (plant.force_n, 0.0, 0.0, 0.0)
    plant.force_n = -900.0
    assert plant.forces_measured(0.0)[0] == -200.0


def test_equal_seeds_make_equal_rigs_and_others_other_ones() -> None:
    noisy = TrackParameters()

    def reading(seed: int) -> tuple[float, ...]:
        plant = TrackPlant(noisy, seed)
        plant.install(3, "NR")
        plant.begin_repeat(1, 2, 0)
        plant.put_on(20.0)
        slid(plant, 1e-3, 1.0)
        cell_n = plant.forces_measured(0.0)[0]
        return plant.force_n, cell_n, plant.surface_measured_c(0.0), plant.controller_measured_c(0.0)

    assert reading(5) == reading(5)
    assert all(one != other for one, other in zip(reading(5), reading(6), strict=True))


def test_a_repeat_does_not_depend_on_earlier_measurements() -> None:
    def reading(before: int) -> float:
        plant = TrackPlant(TrackParameters(), 5)
        plant.install(3, "SBR")
        for _ in range(before):
            plant.forces_measured(0.0)
        plant.begin_repeat(1, 2, 0)
        return plant.forces_measured(0.0)[0]

    assert reading(0) == reading(17)


def test_another_law_is_found_by_its_name() -> None:
    assert slid(lowered(replace(CLEAN, law="paper"), compound="1#"), 1e-2, 1.0).mu > 0.0


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"noise": -1.0}, "noise"), ({"ambient": 90.0}, "ambient"), ({"law": "magic"}, "law"),
        ({"switches": 150.0}, "switches"),
    ],
)  # fmt: skip
def test_parameters_out_of_range_are_refused_by_name(wrong: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        TrackParameters(**wrong)  # type: ignore[arg-type]


def test_a_lift_that_never_leaves_the_track_is_refused() -> None:
    with pytest.raises(ValueError, match="touch must be below lift_travel"):
        TrackContact(touch=10.0)


def test_a_rubber_that_is_not_known_is_refused_with_those_that_are() -> None:
    with pytest.raises(ValueError, match=r"no rubber 'XY'.*known: SBR, NR, NBR, ABR, INR, butyl"):
        lowered(compound="XY")


def test_a_session_has_its_own_weights_within_the_greatest_error() -> None:
    hung = [TrackPlant(TrackParameters(contact=TrackContact(weights=0.01)), seed) for seed in range(20)]
    for plant in hung:
        plant.put_on(10.0)
    off = [plant.weights_n / 10.0 - 1.0 for plant in hung]
    assert max(map(abs, off)) <= 0.01 and min(off) < -0.003 < 0.003 < max(off)


def test_a_cells_curve_is_right_at_zero_and_within_its_greatest_error() -> None:
    off: list[float] = []
    for seed in range(20):
        sensors = TrackSensors(force_rms=0.0, force_zero=0.0, force_drift=0.0, force_linearity=0.2)
        plant = TrackPlant(TrackParameters(sensors=sensors), seed)
        assert plant.forces_measured(0.0)[0] == 0.0
        for force_n in (-150.0, -2.0, 2.0, 20.0, 50.0, 100.0, 150.0, 200.0):
            plant.force_n = force_n
            off_n = plant.forces_measured(0.0)[0] - force_n
            assert abs(off_n) <= min(0.2, 0.0104 * abs(force_n)) + 1e-12
            off.append(off_n)
    assert max(map(abs, off)) > 0.1


def test_a_cell_askew_shows_some_of_the_load() -> None:
    sensors = TrackSensors(force_rms=0.0, force_zero=0.0, force_drift=0.0, misalignment=0.2)
    shown: list[float] = []
    for seed in range(20):
        plant = TrackPlant(TrackParameters(sensors=sensors), seed)
        assert plant.forces_measured(0.0)[0] == 0.0
        plant.load_n = 20.0
        shown.append(plant.forces_measured(0.0)[0])
    assert 0.5 * radians(0.2) * 20.0 < max(map(abs, shown)) <= radians(0.2) * 20.0
