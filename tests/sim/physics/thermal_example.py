"""The tread's temperature, written down a second time: the plant has it spread over its steps."""

from __future__ import annotations

from sim.physics.thermal import ThermalModel, ThermalState


def surface_temperature(
    model: ThermalModel, state: ThermalState, friction_w: float, ambient_c: float, contact: float, rotating: bool
) -> float:
    """Return the tread's temperature in balance with the outermost cell, friction, air and belt."""
    per_cell, per_w, per_belt, of_air = model.surface_gains(ambient_c, contact, rotating)
    return per_cell * state.cells_c[-1] + per_w * friction_w + per_belt * state.belt_c + of_air
