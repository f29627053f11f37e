"""The thermal observer: the expected reading of the rubber's surface, computed from hub and friction alone.

The infrared thermometer may be wrong (misaligned, dirty, wrong emissivity); a heat loop that trusts it overheats the
rubber. The observer never uses it after the start. Its boundary is the hub's own sensor, its source the measured
friction power; its parameters come from the rig file's section ``observer``. It is deliberately coarser than the
simulated wheel: a few cells and steps of half a second are enough to detect 8 K.
"""

from __future__ import annotations

from itertools import accumulate, pairwise
from math import isfinite, log, nan, pi
from typing import Final

from sim.physics.thermal import cell_thicknesses
from tester.kinds.wheel_on_belt.rig import RigConfig

CELLS: Final = 5
OUTER_CELL_MM: Final = 0.5
"""Mesh over the rubber layer [A]: too coarse for the first second of the surface."""
STEP_S: Final = 0.5
"""Length of a step; the outermost cell is stable up to about one second [A]."""
LONGEST_S: Final = 60.0
"""Longest gap between two scans that is made up, s: later scans have tripped."""


class ThermalObserver:
    """Temperatures of rubber and belt, degC; ``surface_c`` is NaN before hub and surface have been read once.

    ``rub`` collects the friction of a scan. ``step`` is called at ``due_s``; ``given_j`` is then the heat that has
    flowed from hub to rubber in that step, J.
    """

    def __init__(self, rig: RigConfig) -> None:
        """Work out the conductances (W/K) and heat capacities (J/K) from the rig file's ``observer`` section."""
        observer, thermal, wheel = rig.observer, rig.observer.thermal, rig.observer.wheel
        outer_m, width_m = 0.5e-3 * wheel.outer_diameter, 1e-3 * wheel.width
        thick = cell_thicknesses(1e-3 * wheel.rubber_layer, CELLS, 1e-3 * OUTER_CELL_MM)
        faces = list(accumulate(thick, initial=outer_m - 1e-3 * wheel.rubber_layer))
        middles = [0.5 * (a + b) for a, b in pairwise(faces)]
        areas = [pi * (b * b - a * a) for a, b in pairwise(faces)]
        radial = 2.0 * pi * thermal.conductivity * width_m
        tread = 2.0 * pi * outer_m * width_m
        hub = 1.0 / (1.0 / thermal.hub_to_rubber + log(middles[0] / faces[0]) / radial)
        self._links = (hub, *(radial / log(b / a) for a, b in pairwise(middles)))
        self._outer = radial / log(faces[-1] / middles[-1])
        self._cell_j_k = tuple(thermal.density * thermal.heat_capacity * width_m * area for area in areas)
        self._sides = tuple(thermal.film_sides * 2.0 * area for area in areas)
        self._air_rotating = thermal.film_rotating * tread
        self._air_stopped = thermal.film_stopped * tread
        self._rotating_above = thermal.rotating_above
        self._share = observer.friction_heat_fraction
        self._touching = observer.belt_conductance
        self._belt_j_k = thermal.belt_capacity
        self._belt_to_air = thermal.belt_to_air
        self._ambient_c = rig.ambient_c
        self._energy_j = self._contact_s = 0.0
        self._last_s = nan
        self.given_j = 0.0
        self.due_s = float("-inf")
        self.belt_c = rig.ambient_c
        self.cells_c: list[float] = []
        self.surface_c = nan

    def air(self, ambient_c: float) -> None:
        """Take another temperature of the air, degC, before the first step; the belt has it."""
        self._ambient_c = self.belt_c = ambient_c

    def new_wheel(self) -> None:
        """Restart with a wheel at ambient temperature, new from the shelf. The hub keeps its temperature."""
        self.cells_c = [self._ambient_c] * CELLS
        self.surface_c = self._ambient_c

    def rub(self, power_w: float, dt: float) -> None:
        """Add ``dt`` s of contact at a friction power in W; NaN counts as no friction."""
        if power_w >= 0.0:
            self._energy_j += power_w * dt
        self._contact_s += dt

    def step(self, now: float, hub_c: float, wheel_m_s: float, measured_c: float) -> None:
        """Advance to ``now``; ``measured_c`` is used only for the start."""
        self.due_s = now + STEP_S
        self.given_j = 0.0
        if not isfinite(hub_c):
            return
        if not self.cells_c:
            if not isfinite(measured_c):
                return
            # The wheel was mounted before: its rubber is somewhere between hub and surface.
            self.cells_c = [hub_c + (measured_c - hub_c) * (i + 0.5) / CELLS for i in range(CELLS)]
            self._last_s = now
        if not isfinite(self._last_s):
            self._last_s = now
        elapsed = min(now - self._last_s, LONGEST_S)
        self._last_s = now
        if elapsed <= 0.0:
            return
        power_w, contact = self._energy_j / elapsed, min(self._contact_s / elapsed, 1.0)
        self._energy_j = self._contact_s = 0.0
        steps = 1 + int(elapsed / (1.2 * STEP_S))
        air = self._air_rotating if abs(wheel_m_s) > self._rotating_above else self._air_stopped
        for _ in range(steps):
            self._advance(elapsed / steps, hub_c, power_w, air, self._touching * contact)

    def _advance(self, dt: float, hub_c: float, power_w: float, air: float, belt: float) -> None:
        cells, ambient, outer = self.cells_c, self._ambient_c, self._outer
        heat = outer * cells[-1] + self._share * power_w + air * ambient + belt * self.belt_c
        self.surface_c = surface = heat / (outer + air + belt)
        flow_in = self._links[0] * (hub_c - cells[0])
        self.given_j += dt * flow_in
        last = len(cells) - 1
        for i, cell_c in enumerate(cells):
            flow_out = self._links[i + 1] * (cell_c - cells[i + 1]) if i < last else outer * (cell_c - surface)
            cells[i] = cell_c + dt * (flow_in - flow_out - self._sides[i] * (cell_c - ambient)) / self._cell_j_k[i]
            flow_in = flow_out
        gain = (1.0 - self._share) * power_w + belt * (surface - self.belt_c)
        self.belt_c += dt * (gain - self._belt_to_air * (self.belt_c - ambient)) / self._belt_j_k
