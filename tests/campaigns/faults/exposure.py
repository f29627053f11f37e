"""When a fault can be noticed, judged from the plant, the devices and the plan, never from control's beliefs.

A fault that hides something from control must not thereby switch its own budget off.
"""

from __future__ import annotations

from dataclasses import replace
from math import hypot, inf, isfinite, radians, sin

from drivers.canopen import objects as o
from sim.faults.can import FaultyCanWire
from sim.faults.kinds import Exposure, FaultKind
from sim.faults.sensors import SpoiledForces, SpoiledTemperature
from sim.machines.wheel_on_belt.faults.catalogue import WheelExposure
from sim.nodes.safety_io import SafetyIo
from sim.physics.contact import ContactModel
from tester.kinds.wheel_on_belt.recipe.plan_steps import Heat, Install, PreGrind, WheelCondition
from tests.campaigns.faults.stage import Stage
from tests.campaigns.faults.wheel_harm import Truth

TURNS_M_S = 0.04
FITTED_S = 1.1
"""For a second after a wheel change, two temperature readings are not compared."""
LOADED_N = 20.0
"""Below this the contact counts as unloaded (docs/kinds/wheel-on-belt.md)."""
HELD_SHARE = 0.45
"""A load counts as held from this share of the recipe's greatest on: the interlocks of a held load begin at half of
it."""
LIFTS_MM_S = -5.0
"""A press commanded to retract faster than this is lifting; while holding a load it moves at most 2 mm/s."""
DRIVEN_M_S = 0.06
"""The drives make slip: above the 50 mm/s threshold of "belt torn"."""
ASTRAY_M_S = 0.1
"""Twice the allowed difference between a speed and its command."""
DEPTH_SHARE, DEPTH_MM = 1.3, 0.55
"""The margin of "contact too deep" (1.3 times, 0.2 mm), plus the delay of noticing a touch when the cell reads half."""
MISREAD_K = 9.5
"""Deviation from the truth: the model's 8 K, the bias of a session, and the model's own error."""
OUTPUT_PERCENT, BELOW_K = 82.0, 6.0
"""More output, and colder, than "heater line open" requires (80 %, 5 K)."""
HIDDEN_K, HIDDEN_SHARE = 6.0, 0.6
"""Hotter than shown by more than "heat not shown" allows (5 K, and 1 K of a sound sensor), and by twice its share of
the rise shown above ambient (0.3)."""
ABOVE_K = 8.5
"""More than "jacket runaway" requires (8 K)."""
HOT_C = 115.0
"""45 K hotter than the hub in any recipe of the campaign; harm is 155 degC [A]."""


class Exposed:
    """Judges from the onset of a fault whether it can be noticed."""

    def __init__(self, stage: Stage, kind: FaultKind) -> None:
        """Begin at the onset."""
        self.stage = stage
        self.kind = kind
        self._warm = frozenset(
            place for place, step in enumerate(stage.plan.steps, 1) if isinstance(step, Heat | WheelCondition)
        )
        self._most_n = max(
            (step.setpoint.number("load") if isinstance(step, WheelCondition) else step.load_n)
            for step in stage.plan.steps
            if isinstance(step, WheelCondition | PreGrind)
        )
        step = stage.place[0]
        fitted = step > 0 and not isinstance(stage.plan.steps[step - 1], Install)
        self._settled = stage.running and fitted and stage.next_s - stage.step_since_s > FITTED_S

    def now(self) -> bool:
        """Return whether the fault can be noticed now."""
        stage, exposure = self.stage, self.kind.exposure
        scans = stage.run.engine.scans
        if exposure is Exposure.ALWAYS:
            return scans > 0
        if exposure is Exposure.DRIVES:
            return scans > 0 or stage.run.connector.watches_drives
        if exposure is Exposure.CONNECTING:
            return scans == 0 and stage.ticks < 3
        if not stage.running:
            return False
        if exposure is Exposure.ENABLED:
            return stage.all_on
        if exposure is WheelExposure.RUNNING:
            return self._settled
        assert isinstance(exposure, WheelExposure)
        if exposure in _THERMAL:
            return self._thermal(exposure)
        return self._mechanical(exposure)

    def _mechanical(self, exposure: WheelExposure) -> bool:
        stage = self.stage
        rig, truth = stage.rig, Truth.of(stage.rig)
        if exposure is WheelExposure.TURNING:
            return abs(truth.wheel_m_s) > TURNS_M_S
        if exposure is WheelExposure.ASTRAY:
            return stage.all_on and astray_m_s(stage, self.kind.axis) > ASTRAY_M_S
        if exposure is WheelExposure.LOADED:
            return truth.force_n > LOADED_N
        lifts = rig.axes["press"].axis.target < LIFTS_MM_S
        held = truth.force_n > max(LOADED_N, HELD_SHARE * self._most_n) and not lifts
        if exposure is WheelExposure.PRESSING:
            return held
        if exposure is WheelExposure.MISWEIGHED:
            return held and not excess_mm(stage) <= DEPTH_MM
        slides = driven_slip_m_s(stage) > DRIVEN_M_S
        if exposure is WheelExposure.RUBBING:
            return held and slides
        return truth.force_n > LOADED_N and slides

    def _thermal(self, exposure: WheelExposure) -> bool:
        stage = self.stage
        plant, jacket = stage.rig.plant, stage.rig.jacket
        if exposure is WheelExposure.HEATING:
            return stage.run.engine.ctx.progress.step in self._warm
        if exposure is WheelExposure.MISREAD:
            turning = abs(Truth.of(stage.rig).wheel_m_s) > TURNS_M_S
            return turning and not misread_k(stage) <= MISREAD_K
        if exposure is WheelExposure.STARVED:
            asked = jacket.running and jacket.output >= OUTPUT_PERCENT
            return asked and jacket.pv_c < jacket.setpoint_c - BELOW_K
        if exposure is WheelExposure.HIDDEN:
            shown_k, hidden_k = jacket.pv_c - plant.parameters.ambient, plant.heat.hub_c - jacket.pv_c
            given = jacket.running and jacket.output >= OUTPUT_PERCENT
            return given and hidden_k > HIDDEN_K and hidden_k > HIDDEN_SHARE * shown_k
        if exposure is WheelExposure.OVERHEATED:
            return plant.heat.hub_c > max(stage.hub_most_c, plant.surface_c) + ABOVE_K
        if exposure is WheelExposure.HOT:
            return plant.heat.hub_c > HOT_C
        io = io_of(stage)
        if exposure is WheelExposure.UNASKED:
            return io.contactor_closed and jacket.heater_w > 0.0 and jacket.output <= 0.0
        return io.contactor_closed and not io.requested


_THERMAL = frozenset({
    WheelExposure.HEATING, WheelExposure.MISREAD, WheelExposure.STARVED, WheelExposure.HIDDEN,
    WheelExposure.OVERHEATED, WheelExposure.HOT, WheelExposure.UNASKED, WheelExposure.WELDED,
})  # fmt: skip


def io_of(stage: Stage) -> SafetyIo:
    """Return the inputs and outputs at the press drive. Raises LookupError if there are none."""
    for drive in stage.rig.axes.values():
        if drive.io is not None:
            return drive.io
    raise LookupError("no drive of this rig has digital inputs")


def driven_slip_m_s(stage: Stage) -> float:
    """Return the slip that the drives make, whether or not wheel and belt follow them, m/s."""
    axes = stage.rig.axes
    rim_m_s, belt_m_s = axes["wheel"].axis.value * _radius_m(stage), axes["belt"].axis.value
    yaw = axes["sideslip"].axis.position if "sideslip" in axes else 0.0
    return hypot(rim_m_s - belt_m_s, belt_m_s * sin(radians(yaw)))


def astray_m_s(stage: Stage, axis: str) -> float:
    """Return the difference between the speed that a drive shows and its last command on the wire, m/s."""
    rig, drive = stage.rig, stage.rig.axes[axis]
    per = drive.config.velocity_increments
    shown = drive.axis.value
    frozen = rig.can.frozen.get(o.TPDO1_BASE + drive.node_id) if isinstance(rig.can, FaultyCanWire) else None
    if frozen:  # statusword and speed
        shown = int.from_bytes(frozen[2:6], "little", signed=True) / per
    off = abs(shown - drive.store.values[(o.TARGET_VELOCITY, 0)] / per)
    return off * _radius_m(stage) if axis == "wheel" else off


def excess_mm(stage: Stage) -> float:
    """Return how much deeper the press is than DEPTH_SHARE of the depth that the shown load needs by the rig file,
    mm."""
    source, plant = stage.rig.cell.source, stage.rig.plant
    shown_n = true_n = plant.force_z_n
    if isinstance(source, SpoiledForces):
        shown_n = source.shown_n(true_n, stage.rig.now_s)
    true, believed_n_mm = plant.parameters.contact, stage.run.engine.ctx.rig.loops.load.stiffness_n_per_mm
    believed = ContactModel(replace(true, reference_stiffness=believed_n_mm))
    return ContactModel(true).depth_mm(true_n) - DEPTH_SHARE * believed.depth_mm(max(0.0, shown_n))


def misread_k(stage: Stage) -> float:
    """Return the thermometer's error against the true surface, K; infinite if it shows nothing."""
    source = stage.rig.ir.source
    if not isinstance(source, SpoiledTemperature):
        return 0.0
    off = abs(source.off_k(stage.rig.plant.surface_c, stage.rig.now_s))
    return off if isfinite(off) else inf


def _radius_m(stage: Stage) -> float:
    return 0.0005 * stage.rig.plant.diameter_mm
