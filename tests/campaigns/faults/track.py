"""A specimen on a track under faults: its stage, when a fault can be noticed, its invariants, and its rows' faults."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from math import isfinite

from sim.faults.can import FaultyCanWire
from sim.faults.kinds import Exposure, FaultKind
from sim.machines.specimen_on_track.faults import TrackExposure
from sim.machines.specimen_on_track.rig import TrackRig
from tester.inputs.recipe.plan import Plan
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.interlocks.table import TABLE
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.recipe.plan_steps import Temper
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.runs import RUNS
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.run.simulated import simulated_ports
from tests.campaigns.faults.campaign import pairs
from tests.campaigns.faults.first_up import First
from tests.campaigns.faults.hardware import MustHold
from tests.campaigns.faults.moments import Moment
from tests.campaigns.faults.recipes import TRACKS, has, language_of
from tests.campaigns.faults.stage import Ledger, Stage
from tests.campaigns.faults.track_harm import TrackHarmObserver, TrackTruth
from tests.tester.inputs.recipe.texts import load_recipe

WORKING = frozenset({"run", "hold"})
AT_REST = frozenset({"idle", "latched"})
MOVES_SHARE = 2e-5
"""A track faster than this share of its drive's greatest speed moves intentionally: 0.2 um/s, 0.04 mm/s."""
ASTRAY_SHARE = 0.3
"""Off its command by more than this share, a track does not follow it: ``interlocks.speed_share``."""
SLID_MM = 1.2
"""After this distance under load rubber slides: the arm's spring is drawn."""
TOUCHED_N = 0.1
"""Rubber under load has more friction: 10 N at 0.02."""
NEAR_MM = 20.0
"""To the end of the travel."""


class TrackLedger(Ledger):
    """Also records when the cell was tared: only then the track may move with the arm down."""

    def __init__(self) -> None:
        super().__init__()
        self.tared = False

    def tare(self, t_s: float, kind: str, values: tuple[float, float, float, float], repeat_key: int = 0) -> None:
        """Record a tare."""
        self.tared = True


@cache
def track_rig_of(name: str, overrides: tuple[str, ...]) -> TrackConfig:
    """Return a packaged rig with overrides."""
    return TrackConfig.of(load_rig(name, overrides, accept_risk="what a rig does without one of its watches"))


@cache
def track_plan_of(name: str, text: str, overrides: tuple[str, ...]) -> Plan:
    """Return a recipe's plan on that rig."""
    return PART.expand(load_recipe(text, PART, "campaign.yaml").recipe, track_rig_of(name, overrides))


class TrackStage(Stage):
    """Run, rig, ledger and observer of a specimen on a track."""

    def __init__(
        self, rig: str, text: str, overrides: Iterable[str] = (), seed: int = 0, believed: tuple[str, ...] = ()
    ) -> None:
        """Build everything on a packaged rig; nothing is sent before the first ``tick``. ``believed``: as Stage's."""
        config = track_rig_of(rig, (*overrides, *believed))
        self.plan = track_plan_of(rig, text, (*overrides, *believed))
        machine = track_rig_of(rig, tuple(overrides))
        ports, world, attendant = simulated_ports(machine, seed, None, FaultyCanWire)
        self.ledger = self.tares = TrackLedger()
        assert isinstance(world, TrackRig)
        self.rig = world
        self.run: Run = RUNS.build(
            RunSetup(config, self.plan, ports, attendant, self.ledger, Prompts(automatic=True))
        )
        self.observer = TrackHarmObserver(world)
        self.invariants = TrackInvariants()
        self.begin(config)

    def note_of_kind(self) -> None:
        """Record that the cell was tared."""
        self.observer.tared = self.tares.tared

    def exposed(self, kind: FaultKind) -> TrackExposed:
        """Begin to judge whether a fault can be noticed."""
        return TrackExposed(self, kind)

    def missing(self, kinds: tuple[FaultKind, ...]) -> list[str]:
        """Return what the safe state lacks."""
        return TrackTruth.of(self.rig).unsafe(self.observer.still_m_s)


class TrackExposed:
    """Judges from the onset of a fault whether it can be noticed: from the plant, the devices and the plan."""

    def __init__(self, stage: TrackStage, kind: FaultKind) -> None:
        """Begin at the onset."""
        self.stage = stage
        self.kind = kind
        steps = stage.plan.steps
        self._tempered = next((place for place, step in enumerate(steps, 1) if isinstance(step, Temper)), len(steps))
        self._from_m = stage.rig.plant.slid_m

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
        return self._in_run(exposure)

    def _in_run(self, exposure: object) -> bool:
        stage = self.stage
        rig, state = stage.rig, stage.run.engine.control.state
        track = rig.axes["track"]
        told_m_s = abs(track.axis.target) * rig.metres
        moves = stage.all_on and told_m_s > MOVES_SHARE * track.config.max_speed * rig.metres
        if exposure is Exposure.ENABLED:
            return stage.all_on
        if exposure is TrackExposure.ASTRAY:
            wanted_m_s = state.setpoints.track_m_s
            off_m_s = abs(track.axis.value * rig.metres - wanted_m_s)
            return stage.all_on and off_m_s > ASTRAY_SHARE * abs(wanted_m_s)
        if exposure is TrackExposure.MOVING:
            return moves
        if exposure is TrackExposure.SLIDING:
            return moves and rig.plant.load_n > 0.0 and abs(rig.plant.force_n) > TOUCHED_N
        if exposure is TrackExposure.SLID:
            slid_mm = 1e3 * stage.run.engine.ctx.demand.sliding_m
            return moves and rig.plant.load_n > 0.0 and slid_mm > SLID_MM
        if exposure is TrackExposure.LIFTING:
            return stage.all_on and abs(rig.lift_mm - state.setpoints.lift_mm) > 0.5
        if exposure is TrackExposure.TEMPERED:
            return stage.run.engine.ctx.progress.step > self._tempered and state.setpoints.chamber
        place_mm = 1e3 * track.axis.position * rig.metres
        return moves and not NEAR_MM < place_mm < rig.plant.parameters.travel - NEAR_MM


class TrackInvariants:
    """Watches the commands of one stage, scan by scan; ``broken`` names each invariant once."""

    def __init__(self) -> None:
        """Nothing seen yet."""
        self.broken: dict[str, str] = {}
        self._scans = 0
        self._mode = ""
        self._notes = 0

    def look(self, stage: Stage) -> None:
        """Look at the commands of the last scan, if there was a new one."""
        engine = stage.run.engine
        if engine.scans == self._scans or engine.control.state.events:
            return  # pending events: requested after the scan, the next scan acts on them
        self._scans = engine.scans
        state = engine.control.state
        mode, out, r, demand = state.mode.value, state.setpoints, engine.ctx.readings, engine.ctx.demand
        limits = engine.ctx.rig.limits
        placed = r.raised or (r.lowered and demand.tared)
        if out.track_m_s and not (mode in WORKING and placed and r.cell_valid | (not demand.lowered)):
            self._break(stage, "T1", f"the track is commanded in {mode}, arm {r.lift_mm} mm, tared {demand.tared}")
        if out.chamber and mode not in WORKING:
            self._break(stage, "T2", f"the chamber is commanded in {mode}")
        if state.trip is not None and mode in WORKING:
            self._break(stage, "T3", f"tripped ({state.trip.name}) and still in {mode}")
        if mode == "fast stop" and not out.quick_stop:
            self._break(stage, "T3", "fast stop without a quick stop")
        if mode in AT_REST and out.enable:
            self._break(stage, "T4", f"{mode} wants power")
        values = (out.track_m_s, out.lift_mm, out.chamber_c)
        if not all(map(isfinite, values)):
            self._break(stage, "T5", f"not a number is commanded: {values}")
        if abs(out.track_m_s) > 1.001 * limits.track_speed_m_s:
            self._break(stage, "T5", f"{out.track_m_s} m/s is commanded")
        if not limits.air_low_c <= out.chamber_c <= limits.air_high_c:
            self._break(stage, "T5", f"{out.chamber_c} degC is commanded")
        self._changes(stage, mode)

    def _changes(self, stage: Stage, mode: str) -> None:
        ledger, r = stage.ledger, stage.run.engine.ctx.readings
        if mode == self._mode:
            return
        before, self._mode = self._mode, mode
        if before and len(ledger.journal) == self._notes:
            self._break(stage, "T6", f"{before} -> {mode} is not in the journal")
        self._notes = len(ledger.journal)
        if before == "latched" and mode == "idle" and (r.drive_fault or r.bus_fault or not r.safety_chain):
            self._break(stage, "T4", "acknowledged with the cause still there")

    def _break(self, stage: Stage, name: str, text: str) -> None:
        self.broken.setdefault(name, f"{text} at {stage.run.engine.ctx.now:.2f} s")


GRID = ("slow track", "disc", "wet road")
"""The recipes of the campaign, by name."""
FAULTS = tuple(dict.fromkeys(fault for recipe in GRID for fault in language_of(recipe).catalogue))


def fits(recipe: str, fault: str) -> bool:
    """Return whether the rig of a recipe has the part that a fault affects."""
    if not has(recipe, fault):
        return False
    rig = track_rig_of(TRACKS[recipe].rig, TRACKS[recipe].overrides)
    parts = {"lift": rig.axes.lift is not None, "end switch": rig.linear}
    parts |= dict.fromkeys(("holder grinds", "height sensor"), "height_sensor" in rig.devices)
    parts |= {name: name in rig.devices for name in ("chamber", "pyrometer", "thermometer")}
    return all(there for name, there in parts.items() if fault.startswith(name))


ROWS = tuple(row.name for row in TABLE.rows)
SLIDE, TARE, LIFT = ("slow track", "slide"), ("slow track", "tare"), ("slow track", "lift")
TEMPER = ("slow track", "temper")
DISC, WET = ("disc", "slide"), ("wet road", "slide")
"""(recipe, phase)."""
UNWATCHED = "interlocks.speed_share=1"
DULL = "interlocks.speed_floor=0.9"
"""The track's travel is not monitored."""
PATIENT = ("can.consumer_heartbeat=600 ms", "axes.track.rpdo_deadline=600 ms", "axes.lift.rpdo_deadline=600 ms",
           "arming.watchdog_proof=false")  # fmt: skip
"""The drives wait long enough that a late scan does not trip them first."""

FIRST: tuple[First, ...] = (
    First("safety chain", ("t=0 s: safety chain opened",), SLIDE),
    First("CAN silent", ("t=0 s: CAN bus off",), SLIDE),
    First("drive fault", ("t=0 s: track drive fault",), SLIDE),
    First("bus lost", ("t=0 s: CAN adapter gone",), SLIDE),
    First("guard open", ("t=0 s: guard opened",), SLIDE),
    First("drive data stale", ("t=0 s: track drive data lost",), SLIDE),
    First("drive dropped out", ("t=0 s: lift drive torque off",), SLIDE),
    First("arm not in place", ("t=0 s: track overspeeds 3 mm/s",), ("slow track", "lower")),
    First("overspeed", ("t=0 s: track overspeeds 14 mm/s",), TARE, 20.0, (UNWATCHED, DULL)),
    First("end of travel", ("t=0 s: track overspeeds 9 mm/s",), TARE, 40.0, (UNWATCHED, DULL)),
    First("track speed", ("t=0 s: track stalls",), SLIDE),
    First("arm stuck", ("t=0 s: lift stuck",), LIFT),
    First("load cell silent", ("t=0 s: load cell silent",), SLIDE),
    First("load cell saturated", ("t=0 s: load cell open",), SLIDE),
    First("load cell frozen", ("t=0 s: load cell frozen",), SLIDE),
    First("overload", ("t=0 s: load cell offset 182 N",), SLIDE),
    First("friction beyond load", ("t=0 s: load cell offset 60 N",), SLIDE),
    First("contact lost", ("t=0 s: load cell gain -99 %",), DISC),
    First("contact lost", ("t=0 s: load cell deaf",), WET),
    First("arm off its height", ("t=0 s: holder grinds",), DISC),
    First("arm off its height", ("t=0 s: holder grinds 0.02",), WET),
    First("arm off its height", ("t=0 s: specimen lost",), WET),
    First("arm off its height", ("t=0 s: height sensor offset -2 mm",), WET),
    First("height sensor silent", ("t=0 s: height sensor silent",), DISC),
    First("height sensor frozen", ("t=0 s: height sensor frozen",), DISC),
    First("force with the arm raised", ("t=0 s: load cell offset 8 N",), LIFT),
    First("chamber beyond its range", ("t=0 s: chamber runs away",), TEMPER, 200.0,
          ("limits.air_high=26.2 degC", "interlocks.range=0.5 K")),
    First("air sensor frozen", ("t=0 s: chamber sensor offset -8 K", "t=5 s: chamber sensor frozen"), TEMPER, 300.0),
    First("chamber runaway", ("t=0 s: chamber sensor offset 15 K",), SLIDE, 60.0),
    First("air silent", ("t=0 s: chamber silent",), SLIDE),
    First("air sensor broken", ("t=0 s: chamber sensor open",), SLIDE),
    First("pyrometer silent", ("t=0 s: pyrometer silent",), DISC),
    First("not stopping", ("t=0 s: operator stop", "t=0.02 s: track overspeeds 5 mm/s"), SLIDE),
    First("quick stop failed", ("t=0 s: operator fast stop", "t=0.02 s: track overspeeds 5 mm/s"), SLIDE),
    First("chamber not off", ("t=0 s: chamber runs away", "t=0.1 s: operator stop"), SLIDE, 30.0),
    First("scan late", ("t=0 s: scan stalled 185 ms",), TARE, 20.0, PATIENT),
)  # fmt: skip
"""For each row a fault of the catalogue that trips it first."""
NEVER_FIRST: dict[str, str] = {
    "second master": "the catalogue has no second master: shown on the wheel, whose wires are the same",
    "clock jump": "a scan waits for its time on the same clock: one that goes back delays it, and that shows first",
    "inputs stale": "the catalogue loses no single frame of inputs: shown on the wheel, whose row is the same",
    "chamber alarm": "its limiter and its lease are behind what the chamber's other rows see",
    "device refused": "no device of the catalogue refuses: shown on the wheel, whose row is the same",
    "line noisy": "what the catalogue spoils it spoils wholly: the value's own age comes before the share of errors",
    "not switched off": "only within the moment in which the drives switch off for a person: the grid comes upon it",
    "stop not ended": "an unseen track loses its power before: a stop is never that long",
    "moving at rest": "the catalogue's drives that obey nothing turn only with power, and at rest none has any",
    "scan delayed": "a warning; shown on the wheel, whose row is the same",
}
"""Rows without a fault that trips them first; their levels and delays are shown in tests/tester/kinds."""


HARDWARE_MUST_HOLD: tuple[MustHold, ...] = (
    MustHold("track overspeeds",
             ("track drive off the bus", "track drive in local mode", "track drive fault", "CAN adapter gone",
              "CAN bus off", "process killed", "common drives clock silent"),
             "emergency stop circuit with safe torque off", "the order to lose its power does not reach its drive"),
    MustHold("track overspeeds", ("track drive feedback frozen", "track drive reading frozen", "track drive data lost"),
             "end switches of the travel, in the emergency stop circuit",
             "it moves until its voltage is disabled, half a second after a stop that its data call ended"),
)  # fmt: skip
"""Pairs that can do harm in spite of any software."""
PAIRS = 1200


def some_pairs(moments: Sequence[Moment], count: int) -> list[tuple[Moment, tuple[str, ...]]]:
    """Return ``count`` pairs of faults that the rig can have at that moment."""
    drawn = pairs(moments, FAULTS, 3 * count)
    return [one for one in drawn if all(fits(one[0].recipe, fault) for fault in one[1])][:count]


def left_out() -> list[str]:
    """Return the rows that are in neither list."""
    known = {row.interlock for row in FIRST} | NEVER_FIRST.keys()
    return [name for name in ROWS if name not in known]
