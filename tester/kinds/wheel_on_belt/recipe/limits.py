"""Checks of a recipe against the rig's limits; each problem has the position of the value and the source of the limit.

It checks the file's tree, value by value, instead of the validated recipe: even with a misspelt key, a load beyond the
limit is reported, so that all problems come at once. The schema reports unreadable values itself.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import prod
from typing import TYPE_CHECKING, NamedTuple

from sim.physics.friction import FrictionModel
from sim.physics.slip import slip_velocity
from sim.physics.wheel_law import WheelLaw
from tester.base.axes import Axis
from tester.base.source import Location, Problem, Tree, Value
from tester.base.units import show, shown
from tester.inputs.recipe.axis_lists import MAX_CONDITIONS, readable
from tester.kinds.wheel_on_belt.control.loops import hub_needed_c
from tester.kinds.wheel_on_belt.image.axes import AXES, POSITIONED
from tester.kinds.wheel_on_belt.recipe.references import AT
from tester.kinds.wheel_on_belt.recipe.schema import REFERENCE_HELD
from tester.kinds.wheel_on_belt.recipe.twin_law import TwinLaws
from tester.kinds.wheel_on_belt.rig.wheel_rig import RIPPLE_N
from tester.kinds.wheel_on_belt.stopped_contact import POWER_SCATTER, PlannedContact, contact, remedy, unheld

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig import RigConfig

DEFAULT_BAND_K = 2.0
"""Default temperature band of a recipe (``tester.inputs.recipe.recipe_schema.MeasureModel``)."""
TOUCHES = 1.5
"""The least load is this times the touching force [A]: the press moves until it feels that force, and runout and noise
add some 12 N. On the simulated rig 10 N trips "load overshoot", 12 N sometimes does, 15 N does not.
"""
OVERHEAT_K = 3.0
"""Greatest excess of the rubber over its band [A]: a burst ends only once the press has lifted, and the thermometer
lags (gates.ir_lag) and has a bias. On the simulated rig the excess is 1.2 K, and the bias 1 K.
"""


def _power_w(one: PlannedContact) -> float:
    return one.power_w


def least_load_n(rig: RigConfig) -> float:
    """Return the least load that a rig can hold, N."""
    return TOUCHES * rig.loops.load.touch_load_n


class PlacedValue(NamedTuple):
    """A quantity in the file: its value in the requested unit, and its position."""

    value: float
    at: Location


class Motion(NamedTuple):
    """Wheel and belt speeds in m/s at a sideslip angle, with the resultant slip speed."""

    wheel: float
    belt: float
    sideslip_deg: float
    slip: float


class _Case(NamedTuple):
    """A compound at a temperature, that of greatest friction if it is known, at one slip speed."""

    compound: str
    model: WheelLaw
    hottest: float
    slip: float
    cornering: float


def limit_problems(tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return values beyond the rig's limits, for all readable values of the tree."""
    return sorted(set(_Limits(tree, rig).problems()))


class _Limits:
    """Checks one tree against one rig."""

    def __init__(self, tree: Tree, rig: RigConfig) -> None:
        self.tree = tree
        self.rig = rig
        stated = self._entries(("ambient",), "degC")
        self.ambient_c = stated[0].value if stated else rig.ambient_c
        self.ambient_from = "ambient of this recipe" if stated else f'ambient of rig "{rig.name}"'
        places: list[Location] = [("specimens", index, "compound") for index in self._indices(("specimens",))]
        names = [self._node(at) for at in (*places, (*AT, "compound"))]
        self.compounds = list(dict.fromkeys(name for name in names if isinstance(name, str)))
        self.twin = TwinLaws(rig, tree)
        self.models = [(name, law) for name in self.compounds for law in self.twin.laws(name)]

    def problems(self) -> Iterator[Problem]:
        """Yield every problem, unordered, possibly twice."""
        for index in self._indices(("specimens",)):
            yield from self._compound(("specimens", index, "compound"))
        yield from self._pre_grind()
        yield from self._rest()
        yield from self._wheel_speeds(("measure",))
        for index in self._indices(("grids",)):
            yield from self._grid(("grids", index))
        if isinstance(self._node(AT), dict):
            yield from self._grid(AT)
            yield from self._compound((*AT, "compound"))

    # -- reading the tree -------------------------------------------------------------------------------------

    def _node(self, at: Location) -> Value:
        node = self.tree.data
        for piece in at:
            if isinstance(node, dict) and isinstance(piece, str):
                node = node.get(piece)
            elif isinstance(node, list) and isinstance(piece, int):
                node = node[piece]
            else:
                return None
        return node

    def _indices(self, at: Location) -> range:
        node = self._node(at)
        return range(len(node)) if isinstance(node, list) else range(0)

    def _entries(self, at: Location, unit: str) -> list[PlacedValue]:
        """Return the readable quantities of an axis or a single value; an empty list where there is none."""
        node = self._node(at)
        if node is None:
            # The defaults of a reference condition may also be beyond a rig's limits.
            return [PlacedValue(REFERENCE_HELD[at[1]], at)] if at[:1] == AT and at[1] in REFERENCE_HELD else []
        return [PlacedValue(value, place) for value, place in readable(node, at, unit)]

    def _beyond(self, entry: PlacedValue, text: str, key: str, limit: float, unit: str) -> Problem:
        """Return the problem of a value beyond the rig's limit ``key``."""
        return self.tree.problem(entry.at, f'{text} (limit {show(limit, unit)}: {key} of rig "{self.rig.name}")')

    def _above(self, entry: PlacedValue, limit: float, unit: str, key: str) -> Iterator[Problem]:
        """Yield a problem for a value (of either sign) beyond a limit."""
        if abs(entry.value) > limit:
            name = next(piece for piece in reversed(entry.at) if isinstance(piece, str))
            message = f"{name}: {show(entry.value, unit)} is more than the rig allows"
            yield self._beyond(entry, message, key, limit, unit)

    def _too_light(self, entry: PlacedValue) -> Iterator[Problem]:
        """Yield a problem for a load too close to touching to be held; the schema reports a value that is no load."""
        touch_n = self.rig.loops.load.touch_load_n
        least_n = least_load_n(self.rig)
        if 0.0 < entry.value < least_n:
            asked, touching = show(entry.value, "N"), show(touch_n, "N")
            message = f"load: {asked} is too near to touching, which is {touching}, to be held"
            source = f'{TOUCHES:g} x loops.load.touch_load of rig "{self.rig.name}"'
            yield self.tree.problem(entry.at, f"{message} (expected at least {show(least_n, 'N')}: {source})")

    def _too_heavy(self, entry: PlacedValue) -> Iterator[Problem]:
        """Yield a problem for a load beyond its limit, or beyond it at each turn of the wheel."""
        limit_n = self.rig.limits.load_n
        most_n = limit_n - RIPPLE_N  # with the tread's runout the load stays below limits.load
        yield from self._above(entry, limit_n, "N", "limits.load")
        if most_n < entry.value <= limit_n:
            message = f"load: {show(entry.value, 'N')} is too near to limits.load, {show(limit_n, 'N')}, to be held"
            source = f'{show(RIPPLE_N, "N")} of runout below limits.load of rig "{self.rig.name}"'
            yield self.tree.problem(entry.at, f"{message} (expected at most {show(most_n, 'N')}: {source})")

    def _by_hand(self, entry: PlacedValue, axis: Axis, *, driven: bool) -> Iterator[Problem]:
        """Yield a problem for an angle on an axis that a person sets: it would have to move in every burst."""
        if entry.value != 0.0 and not driven:
            asked = show(entry.value, axis.recipe_unit)
            message = f"{axis.name}: {asked} needs a driven axis; this rig's is set by hand"
            yield self.tree.problem(entry.at, f'{message} ({axis.drive} of rig "{self.rig.name}")')

    # -- what may be wrong --------------------------------------------------------------------------------------

    def _compound(self, at: Location) -> Iterator[Problem]:
        name = self._node(at)
        if self.rig.simulated and isinstance(name, str) and (fault := self.twin.fault(name)):
            yield self.tree.problem(at, f"compound: {fault}")

    def _wheel_speeds(self, at: Location) -> Iterator[Problem]:
        for wheel in self._entries((*at, "wheel_speed"), "m/s"):
            yield from self._above(wheel, self.rig.limits.wheel_speed_m_s, "m/s", "limits.wheel_speed")

    def _pre_grind(self) -> Iterator[Problem]:
        at: Location = ("pre_grind",)
        limits = self.rig.limits
        yield from self._wheel_speeds(at)
        for belt in self._entries((*at, "belt_speed"), "m/s"):
            yield from self._above(belt, limits.belt_speed_m_s, "m/s", "limits.belt_speed")
            for wheel, load in product(self._entries((*at, "wheel_speed"), "m/s"), self._entries((*at, "load"), "N")):
                motion = Motion(wheel.value, belt.value, 0.0, abs(wheel.value - belt.value))
                yield from self._powers([load], [motion], [self.ambient_c])
                yield from self._stopped(load, max(wheel.value, belt.value), self.ambient_c)
        for load in self._entries((*at, "load"), "N"):
            yield from self._too_heavy(load)
            yield from self._too_light(load)

    def _rest(self) -> Iterator[Problem]:
        until = self._entries(("rest", "until"), "degC")
        within = self._entries(("rest", "within"), "K")
        for entry in until:
            highest = entry.value + (within[0].value if within else DEFAULT_BAND_K)
            if highest <= self.ambient_c:
                message = f"until: a wheel at rest does not cool to {show(highest, 'degC')}"
                yield self.tree.problem(entry.at, f"{message} ({show(self.ambient_c, 'degC')}: {self.ambient_from})")

    def _grid(self, at: Location) -> Iterator[Problem]:
        if prod(max(1, len(self._entries((*at, axis.name), axis.recipe_unit))) for axis in AXES) > MAX_CONDITIONS:
            return  # reported as too many; every combination would be looked at here
        limits = self.rig.limits
        loads = self._entries((*at, "load"), "N")
        for load in loads:
            yield from self._too_heavy(load)
            yield from self._too_light(load)
        driven, allowed = self.rig.axes.driven(), limits.positions()
        for axis in POSITIONED:
            most = allowed[axis.name]
            for angle in self._entries((*at, axis.name), axis.recipe_unit):
                yield from self._above(angle, most, axis.recipe_unit, axis.limit)
                yield from self._by_hand(angle, axis, driven=axis.name in driven)
        yield from self._wheel_speeds(at)
        yield from self._temperatures(at)
        yield from self._slips(at)
        motions = self._motions(at)
        band_k = self._band_k(at)
        # Within its band rubber may be colder, and friction greater by several per cent per kelvin.
        temperatures = [
            max(entry.value + off_k, self.ambient_c)
            for entry in self._entries((*at, "temperature"), "degC")
            for off_k in (-band_k, 0.0, band_k)
        ]
        yield from self._powers(loads, motions, temperatures)
        both = self._both(at)
        belts = [2.0 * motion.wheel - motion.belt if both else motion.belt for motion in motions]
        fastest = max((*belts, *(motion.wheel for motion in motions)), default=0.0)
        hottest = max(temperatures, default=self.ambient_c)
        for load in loads:
            yield from self._stopped(load, fastest, hottest)

    def _stopped(self, load: PlacedValue, speed_m_s: float, hottest_c: float) -> Iterator[Problem]:
        """Yield a problem for a load that the program alone does not keep below harm once wheel or belt stands."""
        rig = self.rig
        if rig.arming.standstill_relay or load.value <= 0.0 or speed_m_s <= 0.0:
            return
        contacts = [contact(rig, name, load.value, speed_m_s, hottest_c) for name in self.compounds]
        worst = max(contacts, key=_power_w, default=None)
        why = unheld(rig, worst) if worst is not None else ""
        if worst is not None and why:
            yield self.tree.problem(load.at, f"load: {why} (expected {remedy(rig, worst)})")

    def _band_k(self, at: Location) -> float:
        bands = self._entries((*at, "temperature_band"), "K") or self._entries(("measure", "temperature_band"), "K")
        return bands[0].value if bands else DEFAULT_BAND_K

    def _temperatures(self, at: Location) -> Iterator[Problem]:
        surface_c, jacket_c = self.rig.limits.surface_c, self.rig.limits.jacket_c
        band = self._band_k(at)
        for entry in self._entries((*at, "temperature"), "degC"):
            reached = f"temperature: {show(entry.value, 'degC')} with its band of {show(band, 'K')}"
            if entry.value + band > surface_c:
                message = f"{reached} is hotter than the rig allows rubber"
                yield self._beyond(entry, message, "limits.surface", surface_c, "degC")
            elif entry.value + band > surface_c - OVERHEAT_K:
                nearer = f"leaves less than {show(OVERHEAT_K, 'K')}, by which a burst overshoots, to what rubber may be"
                yield self._beyond(entry, f"{reached} {nearer}", "limits.surface", surface_c, "degC")
            elif (hub_c := hub_needed_c(self.rig, entry.value)) > jacket_c:
                message = f"{reached} needs a hub of {show(round(hub_c, 1), 'degC')}, hotter than the jacket may get"
                yield self._beyond(entry, message, "limits.jacket", jacket_c, "degC")
            if entry.value + band < self.ambient_c:
                source = f"({show(self.ambient_c, 'degC')}: {self.ambient_from})"
                yield self.tree.problem(entry.at, f"{reached} is below ambient, and the rig cannot cool {source}")

    def _slips(self, at: Location) -> Iterator[Problem]:
        belt_limit, most = self.rig.limits.belt_speed_m_s, self.rig.interlocks.max_slip_m_s
        for slip, wheel, sign in product(
            self._entries((*at, "slip_velocity"), "m/s"), self._speeds(at), (1.0, -1.0) if self._both(at) else (1.0,)
        ):
            belt = round(wheel - sign * slip.value, 9)
            turned = ", reversed by both_directions," if sign < 0.0 else ""
            asked = f"slip_velocity: {show(slip.value, 'm/s')}{turned} at a wheel speed of {show(wheel, 'm/s')}"
            if belt > belt_limit:
                message = f"{asked} needs {show(belt, 'm/s')} of the belt"
                yield self._beyond(slip, message, "limits.belt_speed", belt_limit, "m/s")
            if abs(slip.value) > most:
                yield self._beyond(slip, f"{asked} is more than is ever loaded", "interlocks.max_slip", most, "m/s")
                continue
            off = 0.01 * self.rig.gates.speed_percent * (wheel + abs(belt))
            if abs(slip.value) + off > most:
                nearer = f"leaves less than {show(off, 'm/s')}, by which the speeds may be off (gates.speed)"
                message = f"{asked} {nearer}, to what is ever loaded"
                yield self._beyond(slip, message, "interlocks.max_slip", most, "m/s")

    def _both(self, at: Location) -> bool:
        """Return whether a grid is measured in both directions of slip."""
        stated = self._node((*at, "both_directions"))
        return (self._node(("measure", "both_directions")) if stated is None else stated) is True

    def _speeds(self, at: Location) -> list[float]:
        speeds = self._entries((*at, "wheel_speed"), "m/s") or self._entries(("measure", "wheel_speed"), "m/s")
        return list(dict.fromkeys(speed.value for speed in speeds))

    def _motions(self, at: Location) -> list[Motion]:
        slips = dict.fromkeys(entry.value for entry in self._entries((*at, "slip_velocity"), "m/s"))
        angles = dict.fromkeys(entry.value for entry in self._entries((*at, "sideslip"), "deg")) or {0.0: None}
        motions: list[Motion] = []
        for wheel, slip, angle in product(self._speeds(at), slips, angles):
            belt = wheel - slip
            motions.append(Motion(wheel, belt, angle, slip_velocity(wheel, belt, angle)[2]))
        return motions

    def _powers(self, loads: list[PlacedValue], motions: list[Motion], temperatures: list[float]) -> Iterator[Problem]:
        """Yield a problem for every load with too much friction heat; it names the worst conditions."""
        pressing = [load for load in loads if load.value > 0.0]
        if not motions or not temperatures or not pressing:
            return
        cases: list[_Case] = []
        for name, model in self.models:
            # Both of the paper's models are a temperature factor times a factor of load and slip: the worst
            # temperature is the same everywhere.
            hottest = max(temperatures, key=lambda at_c: model.mu(at_c, pressing[0].value, motions[0].slip))
            worst = [hottest] if isinstance(model.law, FrictionModel) else temperatures
            cases += [
                _Case(name, model, at_c, motion.slip, model.cornering_factor(motion.sideslip_deg))
                for motion in motions for at_c in worst
            ]  # fmt: skip
        for load in pressing:
            yield from self._power(load, cases)

    def _power(self, load: PlacedValue, cases: list[_Case]) -> Iterator[Problem]:
        limit = self.rig.limits.slip_power_w
        newtons, most, worst = load.value, limit / (1.0 + POWER_SCATTER), None
        for case in cases:
            _, model, hottest, slip, cornering = case
            power = model.mu(hottest, newtons, slip) * cornering * newtons * slip
            if power > most:
                most, worst = power, case
        if worst is not None:
            where = f"{show(worst.slip, 'm/s')} of slip with {shown(worst.compound)} at {show(worst.hottest, 'degC')}"
            message = f"load: {show(newtons, 'N')} makes {most:.0f} W of friction heat at {where}"
            if most <= limit:
                message += f", and with the scatter of friction {100.0 * POWER_SCATTER:.0f} % more"
            yield self._beyond(load, message, "limits.slip_power", limit, "W")
