"""Time steps of the heat in the plant: short explicit steps after a disturbance, long implicit steps when calm.

Powers are summed tick by tick, and their mean is applied in the thermal model's own steps. After some seconds without
friction and without a change of contact or rotation, the fast parts of the temperature profile have decayed. Then the
implicit step of ``sim.physics.thermal`` is as good, at a fifth of the work.
"""

from __future__ import annotations

from typing import Final

from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.physics.thermal import CALM_STEP_S, ThermalModel
from sim.sensors import TemperatureSensor

CALM_AFTER_S: Final = 5.0
"""Time without a disturbance after which heat is calm: then both steps agree within 0.02 K, on the hot rig too."""
CALM_FRICTION_W: Final = 1.0
"""Friction power that is no disturbance: rolling at 200 N with 4 mm/s of slip."""
SAME_STEP_S: Final = 1e-9
"""Ticks share step constants if their lengths differ by less: differences of a float clock are never quite equal."""


class HeatFlow:
    """Temperatures of wheel, hub and belt (``state``), and their followers: the hub's sensor and the load cell.

    ``rubber_c`` is the rubber's mean temperature after the last thermal step, degC.
    """

    def __init__(self, model: ThermalModel, ambient_c: float, sensor: TemperatureSensor, cell: LoadCellSensor) -> None:
        """Begin with everything at ambient temperature, without contact and rotation."""
        self._model = model
        self._ambient_c = ambient_c
        self._sensor = sensor
        self._cell = cell
        self._every_gains = [
            model.surface_gains(ambient_c, contact, rotating) for contact in (0.0, 1.0) for rotating in (False, True)
        ]
        self.state = model.state(ambient_c)
        self._calm = False
        self._due_s = 0.0
        self._quiet_s = 0.0
        self.restart()

    def restart(self) -> None:
        """Begin anew with the temperatures as they are, after a change of the wheel."""
        self._key = 0
        self._gains = self._every_gains[0]
        self._pending_s = self._heater_j = self._friction_j = self._touch_s = 0.0
        self.rubber_c = self._model.rubber_mean_c(self.state)
        self._sensor.reset(self.state.hub_c)
        self._stir()

    def advance(self, dt: float, heater_w: float, friction_w: float, touching: bool, rotating: bool) -> float:
        """Advance by ``dt`` s with these powers and return the temperature of the tread's surface, degC."""
        key = (3 if rotating else 2) if touching else (1 if rotating else 0)  # arithmetic of truth values takes longer
        if key != self._key or friction_w > CALM_FRICTION_W:
            self._quiet_s = 0.0
            if self._calm:
                self._disturb()
            if key != self._key:
                self._key = key
                self._gains = self._every_gains[key]
        if touching:
            self._friction_j += friction_w * dt
            self._touch_s += dt
        self._heater_j += heater_w * dt
        self._pending_s = pending_s = self._pending_s + dt
        if pending_s >= self._due_s:
            self._flow()
        per_cell, per_w, per_belt, of_air = self._gains
        state = self.state
        return per_cell * state.cells_c[-1] + per_w * friction_w + per_belt * state.belt_c + of_air

    def _flow(self) -> None:
        """Apply the mean powers since the last thermal step, for the whole steps that are due."""
        pending_s, due_s = self._pending_s, self._due_s
        heater_w, friction_w = self._heater_j / pending_s, self._friction_j / pending_s
        contact = self._touch_s / pending_s
        model, ambient_c, rotating = self._model, self._ambient_c, self._key & 1 != 0
        step_s = CALM_STEP_S if self._calm else model.step_s
        while pending_s >= due_s:
            if self._calm:
                model.calm_step(self.state, heater_w, friction_w, ambient_c, self._key > 1, rotating)
            else:
                model.step(self.state, step_s, heater_w, friction_w, ambient_c, contact, rotating)
            self._sensor.follow(self.state.hub_c)
            self._cell.warm(step_s, self.state.belt_c)
            pending_s -= step_s
            self._quiet_s += step_s
        self.rubber_c = model.rubber_mean_c(self.state)
        self._pending_s = pending_s
        self._heater_j = heater_w * pending_s
        self._friction_j = friction_w * pending_s
        self._touch_s = contact * pending_s
        if not self._calm and self._quiet_s >= CALM_AFTER_S:
            self._calm = True
            self._due_s = CALM_STEP_S - SAME_STEP_S
            self._sensor.retime(CALM_STEP_S)

    def _disturb(self) -> None:
        """End the calm: apply the heat not yet applied, under the conditions until now."""
        pending_s = self._pending_s
        if pending_s > SAME_STEP_S:
            touching, rotating = self._key > 1, self._key & 1 != 0
            heater_w, friction_w = self._heater_j / pending_s, self._friction_j / pending_s
            self._model.step(self.state, pending_s, heater_w, friction_w, self._ambient_c, float(touching), rotating)
            self._sensor.retime(pending_s)
            self._sensor.follow(self.state.hub_c)
            self._cell.warm(pending_s, self.state.belt_c)
            self._pending_s = self._heater_j = self._friction_j = self._touch_s = 0.0
        self._stir()

    def _stir(self) -> None:
        """Switch to short steps."""
        self._calm = False
        self._quiet_s = 0.0
        self._due_s = self._model.step_s - SAME_STEP_S
        self._sensor.retime(self._model.step_s)
