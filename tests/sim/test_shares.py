"""Faults of shared parts: all members together, each in its own unit, all right again afterwards."""

from __future__ import annotations

from copy import deepcopy

import pytest

from sim.faults import FaultScript, Scene
from sim.faults.shares import OF_READINGS
from tester.kinds import load_rig
from tester.run.simulated import spec_of
from tests.campaigns.faults.recipes import GRID, language_of
from tests.sim.machines.wheel_on_belt.test_parametric_faults import FaultlessComputer, forces, play, sliding

SPEC = spec_of(load_rig("sim"))


def test_a_share_of_the_rig_file_is_in_the_catalogue_without_further_lists() -> None:
    found = language_of(GRID[0]).catalogue
    for name, share in SPEC.shares.items():
        kinds = ("gain", "offset", "drift", "noise") if share.shared in OF_READINGS else ("silent",)
        assert {f"common {name.replace('_', ' ')} {kind}" for kind in (*kinds, "frozen")} <= found.keys()


@pytest.mark.parametrize(
    ("fault", "force", "torque"),
    [("gain 80 %", 0.8, 0.8), ("offset -10 %", -50.0, -0.6), ("drift -60 %/min", -5.0, -0.06)],
)
def test_cell_and_press_torque_go_wrong_alike(fault: str, force: float, torque: float) -> None:
    """The drive's limit is 6 N m until one is written."""
    rig = deepcopy(sliding())
    true_nm = rig.axes["press"].torque_nm
    play(rig, f"common force supply {fault}", 1.0)
    true_n = rig.plant.force_z_n
    shown_n, shown_nm = forces(rig)[2], rig.axes["press"].torque_nm
    gain = fault.startswith("gain")
    assert shown_n == pytest.approx(true_n * force if gain else true_n + force, abs=1.0)
    assert shown_nm == pytest.approx(true_nm * torque if gain else true_nm + torque, abs=1e-3)


def test_a_drive_that_measures_too_little_limits_its_torque_as_much_too_late() -> None:
    rig = deepcopy(sliding())
    limit_nm = rig.axes["press"].torque_limit_nm
    play(rig, "common force supply gain 80 %", 0.1)
    assert rig.axes["press"].torque_limit_nm == pytest.approx(limit_nm / 0.8)


@pytest.mark.parametrize("fault", ["gain 80 %", "offset -10 %", "drift -60 %/min", "noise 5 %"])
def test_every_member_is_right_again_when_the_fault_ends(fault: str) -> None:
    rig = deepcopy(sliding())
    script, scene = FaultScript(), Scene(rig, FaultlessComputer())
    script.add([language_of(GRID[0]).parse(f"t={rig.now_s:.6f} s: common cabinet air {fault} for 1 s")])
    limit_nm = rig.axes["press"].torque_limit_nm
    for _ in range(150):
        script.act(scene, rig.now_s + 1e-6)
        script.renew(scene, rig.now_s)
        rig.advance(rig.now_s + 0.01)
    plant, t = rig.plant, rig.now_s
    assert forces(rig)[2] == plant.force_z_n and rig.axes["press"].torque_limit_nm == limit_nm
    assert rig.ir.source.surface_measured_c(t) == plant.surface_measured_c(t)
    assert rig.jacket.source.controller_measured_c(t) == plant.controller_measured_c(t)


def test_a_common_adapter_repeats_every_reading() -> None:
    rig = deepcopy(sliding())
    play(rig, "common serial adapter frozen", 0.1)
    assert rig.cell.frozen and rig.ir.frozen
    shown = rig.jacket.source.controller_measured_c(rig.now_s)
    rig.plant.heat.set_all(90.0)
    assert rig.jacket.source.controller_measured_c(rig.now_s) == shown
