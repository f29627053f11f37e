"""Heat in the wheel's rubber, its hub and the belt: radial finite volumes, explicit in time.

A lump of two or three nodes misses the square-root-of-time response of the surface in the first ten
seconds, which is what decides a friction test; so the rubber is cut into cells that shrink outward and the
surface is a node without mass. Pure: no noise, no clock, no state but the one passed in. An observer uses
it with its own parameters. Temperatures in degC, powers in W, times in s, conductances in W/K.
"""

from __future__ import annotations

import math
from itertools import accumulate, pairwise

from sim.parameters import ThermalParameters, WheelParameters

MAX_STEP_S = 0.05
"""Longest internal step; shorter where the cells need it (``ThermalModel.step_s``)."""


class ThermalState:
    """Temperatures in degC of hub, rubber cells (inside first), tread surface and belt."""

    __slots__ = ("belt_c", "cells_c", "hub_c", "surface_c")

    def __init__(self, cells: int, temperature_c: float) -> None:
        """Start with one temperature everywhere."""
        self.hub_c = temperature_c
        self.belt_c = temperature_c
        self.surface_c = temperature_c
        self.cells_c = [temperature_c] * cells

    def set_rubber(self, temperature_c: float) -> None:
        """Give the whole rubber one temperature (a new wheel from the shelf); hub and belt keep theirs."""
        self.surface_c = temperature_c
        self.cells_c = [temperature_c] * len(self.cells_c)


def cell_thicknesses(layer: float, cells: int, outer: float) -> list[float]:
    """Return the thickness of each cell, inside first: geometric, ``outer`` the last, together ``layer``.

    Any one unit of length. Equal cells where ``outer`` times ``cells`` already fills the layer.
    """
    if outer * cells >= layer:
        return [layer / cells] * cells
    low, high = 1.0, layer / outer
    for _ in range(200):
        ratio = 0.5 * (low + high)
        if sum(ratio**i for i in range(cells)) * outer > layer:
            high = ratio
        else:
            low = ratio
    thick = [outer * low**i for i in reversed(range(cells))]
    scale = layer / sum(thick)
    return [t * scale for t in thick]


class ThermalModel:
    """Heat capacities and conductances of one wheel, hub and belt; ``step`` moves a state on.

    ``friction_heat_fraction`` is the rubber's share of the friction heat, ``belt_conductance_w_k`` links
    tread and belt while they touch. Holds no temperature: one model serves any number of states.
    """

    __slots__ = (
        "_belt_j_k",
        "_belt_to_air",
        "_cell_j_k",
        "_hub_j_k",
        "_hub_to_cell",
        "_hub_to_shaft",
        "_links",
        "_outer_to_surface",
        "_share",
        "_sides",
        "_touching",
        "_tread_rotating",
        "_tread_stopped",
        "_weights",
        "_weights_dt_s",
        "cells",
        "step_s",
    )

    def __init__(
        self,
        wheel: WheelParameters,
        thermal: ThermalParameters,
        friction_heat_fraction: float,
        belt_conductance_w_k: float,
    ) -> None:
        """Work out the network of conductances and the longest stable step."""
        outer_m = 0.5e-3 * wheel.outer_diameter
        width_m = 1e-3 * wheel.width
        thick = cell_thicknesses(1e-3 * wheel.rubber_layer, thermal.cells, 1e-3 * thermal.outer_cell)
        faces = list(accumulate(thick, initial=outer_m - 1e-3 * wheel.rubber_layer))
        middles = [0.5 * (a + b) for a, b in pairwise(faces)]
        areas = [math.pi * (b * b - a * a) for a, b in pairwise(faces)]
        radial = 2.0 * math.pi * thermal.conductivity * width_m

        self.cells = thermal.cells
        self._share = friction_heat_fraction
        self._touching = belt_conductance_w_k
        self._hub_j_k = thermal.hub_capacity
        self._belt_j_k = thermal.belt_capacity
        self._hub_to_shaft = thermal.hub_to_shaft
        self._belt_to_air = thermal.belt_to_air
        self._cell_j_k = [thermal.density * thermal.heat_capacity * width_m * a for a in areas]
        self._hub_to_cell = 1.0 / (1.0 / thermal.hub_to_rubber + math.log(middles[0] / faces[0]) / radial)
        self._outer_to_surface = radial / math.log(faces[-1] / middles[-1])
        inner = [radial / math.log(b / a) for a, b in pairwise(middles)]
        self._links = [self._hub_to_cell, *inner, self._outer_to_surface]
        self._sides = [thermal.film_sides * 2.0 * a for a in areas]
        tread = 2.0 * math.pi * outer_m * width_m
        self._tread_stopped = thermal.film_stopped * tread
        self._tread_rotating = thermal.film_rotating * tread
        self.step_s = min(MAX_STEP_S, self._longest_stable_step())
        self._weigh(self.step_s)

    def _longest_stable_step(self) -> float:
        """Return the step in s up to which no node overshoots its neighbours in an explicit step."""
        tread = max(self._tread_rotating, self._tread_stopped) + self._touching
        outward = 1.0 / (1.0 / self._outer_to_surface + 1.0 / tread) if tread > 0.0 else 0.0
        links = [*self._links[:-1], outward]
        limits = [c / (a + b + s) for c, (a, b), s in zip(self._cell_j_k, pairwise(links), self._sides, strict=True)]
        limits.append(self._hub_j_k / (self._hub_to_cell + self._hub_to_shaft))
        limits.append(self._belt_j_k / max(self._belt_to_air + self._touching, 1e-9))
        return min(limits)

    def _weigh(self, dt_s: float) -> None:
        """Prepare each cell's weights of itself, its inner and outer neighbour and the air for a step."""
        self._weights_dt_s = dt_s
        self._weights: list[tuple[float, float, float, float]] = []
        for c, (a, b), s in zip(self._cell_j_k, pairwise(self._links), self._sides, strict=True):
            inside, outside, air = a * dt_s / c, b * dt_s / c, s * dt_s / c
            self._weights.append((1.0 - inside - outside - air, inside, outside, air))

    def state(self, temperature_c: float) -> ThermalState:
        """Return a state with one temperature everywhere."""
        return ThermalState(self.cells, temperature_c)

    def surface_temperature(
        self, state: ThermalState, friction_w: float, ambient_c: float, contact: float, rotating: bool
    ) -> float:
        """Return the tread's temperature in balance with the outermost cell, friction, air and belt.

        ``contact`` is the share of the time, 0 to 1, that tread and belt touch.
        """
        air = self._tread_rotating if rotating else self._tread_stopped
        belt = self._touching * contact
        inside = self._outer_to_surface
        heat = inside * state.cells_c[-1] + self._share * friction_w + air * ambient_c + belt * state.belt_c
        return heat / (inside + air + belt)

    def step(
        self,
        state: ThermalState,
        dt_s: float,
        heater_w: float,
        friction_w: float,
        ambient_c: float,
        contact: float,
        rotating: bool,
    ) -> None:
        """Move a state on by ``dt_s`` (any length; cut into equal steps of at most ``step_s``).

        ``heater_w`` into the hub, ``friction_w`` in the contact (mean over the time), ``contact`` the share
        of the time, 0 to 1, that tread and belt touch, ``rotating`` whether the wheel turns. What goes in
        equals what is stored plus lost, to rounding.
        """
        steps = 1 if dt_s <= self.step_s else math.ceil(dt_s / self.step_s - 1e-6)
        dt = dt_s / steps
        if dt != self._weights_dt_s:
            self._weigh(dt)
        for _ in range(steps):
            surface = self.surface_temperature(state, friction_w, ambient_c, contact, rotating)
            hub, belt = state.hub_c, state.belt_c
            loss = self._hub_to_cell * (hub - state.cells_c[0]) + self._hub_to_shaft * (hub - ambient_c)
            gain = (1.0 - self._share) * friction_w + self._touching * contact * (surface - belt)
            self._conduct(state.cells_c, hub, surface, ambient_c)
            state.surface_c = surface
            state.hub_c = hub + dt * (heater_w - loss) / self._hub_j_k
            state.belt_c = belt + dt * (gain - self._belt_to_air * (belt - ambient_c)) / self._belt_j_k

    def _conduct(self, cells_c: list[float], hub_c: float, surface_c: float, ambient_c: float) -> None:
        """Move the rubber's cells on by the prepared step, in place."""
        inner_c = [hub_c, *cells_c[:-1]]
        outer_c = [*cells_c[1:], surface_c]
        cells_c[:] = [
            own * here_c + inside * in_c + outside * out_c + air * ambient_c
            for (own, inside, outside, air), here_c, in_c, out_c in zip(
                self._weights, cells_c, inner_c, outer_c, strict=True
            )
        ]
