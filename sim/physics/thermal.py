"""Heat in the wheel's rubber, its hub and the belt: radial finite volumes, explicit or (when calm) implicit in time.

A lump of two or three nodes misses the square-root-of-time response of the surface in the first ten
seconds, which decides a friction test. So the rubber is cut into cells that shrink outward, and the
surface is a node without mass. Pure: no noise, no clock, no state except the argument. An observer uses
the module with its own parameters. Temperatures in degC, powers in W, times in s, conductances in W/K.
"""

from __future__ import annotations

import math
from itertools import accumulate, pairwise
from typing import Final

from sim.physics.parameters import ThermalParameters, WheelParameters

MAX_STEP_S: Final = 0.05
"""Longest explicit step, s; the cells may need a shorter one (``ThermalModel.step_s``)."""

CALM_STEP_S: Final = 0.2
"""Length of an implicit step, s (``ThermalModel.calm_step``)."""


class ThermalState:
    """Temperatures in degC of hub, rubber cells (inside first), tread surface and belt."""

    def __init__(self, cells: int, temperature_c: float) -> None:
        """Start with one temperature everywhere."""
        self.hub_c = temperature_c
        self.belt_c = temperature_c
        self.surface_c = temperature_c
        self.cells_c = [temperature_c] * cells

    def set_all(self, temperature_c: float) -> None:
        """Give everything one temperature."""
        self.hub_c = self.belt_c = temperature_c
        self.set_rubber(temperature_c)

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


_Eliminated = tuple[tuple[float, ...], list[float], list[float], tuple[float, ...], list[float]]
"""Coefficients of an implicit step: a node's share of its own excess over ambient, its share of the inner node, its
part of the outer node, its gain in K per W. Order: the hub's; the cells'; surface's and belt's; the parts of the outer
node, outside first."""


class ThermalModel:
    """Heat capacities and conductances of one wheel, hub and belt; ``step`` moves a state on.

    ``friction_heat_fraction`` is the rubber's share of the friction heat; ``belt_conductance_w_k`` connects
    tread and belt during contact. The model holds no temperature: it serves any number of states.
    """

    def __init__(
        self,
        wheel: WheelParameters,
        thermal: ThermalParameters,
        friction_heat_fraction: float,
        belt_conductance_w_k: float,
    ) -> None:
        """Calculate the network of conductances and the longest stable step."""
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
        self._parts = [a / sum(areas) for a in areas]
        self._hub_to_cell = 1.0 / (1.0 / thermal.hub_to_rubber + math.log(middles[0] / faces[0]) / radial)
        self._outer_to_surface = radial / math.log(faces[-1] / middles[-1])
        inner = [radial / math.log(b / a) for a, b in pairwise(middles)]
        self._links = [self._hub_to_cell, *inner, self._outer_to_surface]
        self._sides = [thermal.film_sides * 2.0 * a for a in areas]
        tread = 2.0 * math.pi * outer_m * width_m
        self._tread_stopped = thermal.film_stopped * tread
        self._tread_rotating = thermal.film_rotating * tread
        self.step_s = min(MAX_STEP_S, self._longest_stable_step())
        self._weigh(self.step_s, 0.0)
        self._calm = [self._eliminate(touching, rotating) for touching in (False, True) for rotating in (False, True)]

    def _longest_stable_step(self) -> float:
        """Return the greatest step in s in which no node of an explicit step overshoots its neighbours."""
        tread = max(self._tread_rotating, self._tread_stopped) + self._touching
        outward = 1.0 / (1.0 / self._outer_to_surface + 1.0 / tread) if tread > 0.0 else 0.0
        links = [*self._links[:-1], outward]
        limits = [c / (a + b + s) for c, (a, b), s in zip(self._cell_j_k, pairwise(links), self._sides, strict=True)]
        limits.append(self._hub_j_k / (self._hub_to_cell + self._hub_to_shaft))
        limits.append(self._belt_j_k / max(self._belt_to_air + self._touching, 1e-9))
        return min(limits)

    def _weigh(self, dt_s: float, ambient_c: float) -> None:
        """Prepare the weights of each cell, of its inner and outer neighbours, and of the air."""
        self._weighed = (dt_s, ambient_c)
        inside = [a * dt_s / c for c, a in zip(self._cell_j_k, self._links, strict=False)]
        outside = [b * dt_s / c for c, b in zip(self._cell_j_k, self._links[1:], strict=True)]
        air = [s * dt_s / c for c, s in zip(self._cell_j_k, self._sides, strict=True)]
        own = [1.0 - a - b - s for a, b, s in zip(inside, outside, air, strict=True)]
        self._weights = (own, inside, outside, [s * ambient_c for s in air])

    def _eliminate(self, touching: bool, rotating: bool) -> _Eliminated:
        """Solve the equations of an implicit step from the hub outward, for the part that is the same in every step."""
        tread = self._tread_rotating if rotating else self._tread_stopped
        links = [*self._links, self._touching if touching else 0.0, 0.0]
        losses = [self._hub_to_shaft, *self._sides, tread, self._belt_to_air]
        stores = [c / CALM_STEP_S for c in (self._hub_j_k, *self._cell_j_k, 0.0, self._belt_j_k)]
        keep: list[float] = []
        take: list[float] = []
        hand: list[float] = []
        gain: list[float] = []
        inside = passed = 0.0
        for store, loss, outside in zip(stores, losses, links, strict=True):
            pivot = store + loss + inside + outside - inside * passed
            passed = outside / pivot
            keep.append(store / pivot)
            take.append(inside / pivot)
            hand.append(passed)
            gain.append(1.0 / pivot)
            inside = outside
        hub = (keep[0], gain[0])
        surface_and_belt = (take[-2], gain[-2], hand[-2], keep[-1], take[-1], gain[-1])
        return hub, keep[1:-2], take[1:-2], surface_and_belt, hand[-3::-1]

    def state(self, temperature_c: float) -> ThermalState:
        """Return a state with one temperature everywhere."""
        return ThermalState(self.cells, temperature_c)

    def rubber_mean_c(self, state: ThermalState) -> float:
        """Return the mean temperature of the rubber by volume, degC."""
        mean_c = 0.0
        for part, cell_c in zip(self._parts, state.cells_c):  # noqa: B905 - compiles to a plain loop
            mean_c += part * cell_c
        return mean_c

    def surface_gains(self, ambient_c: float, contact: float, rotating: bool) -> tuple[float, float, float, float]:
        """Return the tread's K per K of the outermost cell, per W of friction, per K of the belt, and degC of the air.

        ``contact`` is the share of the time, 0 to 1, in which tread and belt touch.
        """
        air = self._tread_rotating if rotating else self._tread_stopped
        belt = self._touching * contact
        total = self._outer_to_surface + air + belt
        return self._outer_to_surface / total, self._share / total, belt / total, air * ambient_c / total

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
        """Advance a state by ``dt_s`` (any length; cut into equal steps of at most ``step_s``).

        ``heater_w`` goes into the hub, ``friction_w`` into the contact (mean over the time). ``contact`` is the share
        of the time, 0 to 1, in which tread and belt touch; ``rotating``: the wheel turns. Heat put in
        equals heat stored plus lost, to rounding.
        """
        steps = 1 if dt_s <= self.step_s else math.ceil(dt_s / self.step_s - 1e-6)
        dt = dt_s / steps
        if self._weighed != (dt, ambient_c):
            self._weigh(dt, ambient_c)
        own, inside, outside, air = self._weights
        per_cell, per_w, per_belt, of_air = self.surface_gains(ambient_c, contact, rotating)
        of_friction = per_w * friction_w + of_air
        to_belt_w = (1.0 - self._share) * friction_w
        for _ in range(steps):
            hub, belt, cells = state.hub_c, state.belt_c, state.cells_c
            surface = per_cell * cells[-1] + per_belt * belt + of_friction
            loss = self._hub_to_cell * (hub - cells[0]) + self._hub_to_shaft * (hub - ambient_c)
            gain = to_belt_w + self._touching * contact * (surface - belt)
            inner, outer = [hub, *cells], cells[1:]
            outer.append(surface)
            state.cells_c = [
                a * t + b * u + c * v + d
                for a, t, b, u, c, v, d in zip(own, cells, inside, inner, outside, outer, air)  # noqa: B905
            ]
            state.surface_c = surface
            state.hub_c = hub + dt * (heater_w - loss) / self._hub_j_k
            state.belt_c = belt + dt * (gain - self._belt_to_air * (belt - ambient_c)) / self._belt_j_k

    def calm_step(
        self,
        state: ThermalState,
        heater_w: float,
        friction_w: float,
        ambient_c: float,
        touching: bool,
        rotating: bool,
    ) -> None:
        """Advance a state by CALM_STEP_S at once: implicit, first order, for slow changes only.

        Arguments as for ``step``. Here also, heat put in equals heat stored plus lost, to rounding. A sudden change
        shows late and less sharp (two seconds after it, 0.02 K from the explicit steps).
        """
        hub, keep, take, surface_and_belt, hand = self._calm[2 * touching + rotating]
        hub_keep, hub_gain = hub
        excess = hub_keep * (state.hub_c - ambient_c) + hub_gain * heater_w
        solved = [excess]
        for t, own, inside in zip(state.cells_c, keep, take):  # noqa: B905 - compiles to a plain loop
            excess = own * (t - ambient_c) + inside * excess
            solved.append(excess)
        surface_take, surface_gain, surface_hand, belt_keep, belt_take, belt_gain = surface_and_belt
        share_w = self._share * friction_w
        surface = surface_take * excess + surface_gain * share_w
        belt = belt_keep * (state.belt_c - ambient_c) + belt_take * surface + belt_gain * (friction_w - share_w)
        excess = surface + surface_hand * belt
        state.belt_c = ambient_c + belt
        state.surface_c = ambient_c + excess
        solved.reverse()
        found: list[float] = []
        for own, outside in zip(solved, hand):  # noqa: B905
            excess = own + outside * excess
            found.append(ambient_c + excess)
        state.hub_c = found.pop()
        found.reverse()
        state.cells_c = found
