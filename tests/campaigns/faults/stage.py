"""One run on a rig that can have faults, ticked by hand and copied in the middle."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy
from functools import cache
from math import nan
from typing import Any, Protocol

from sim.faults import FaultScript, Injection
from sim.faults.can import FaultyCanWire
from sim.faults.kinds import FaultKind
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.drive_power import ENERGISED
from tester.analysis.results import Burst, RepeatResult, RepeatStatus
from tester.inputs.recipe.plan import Plan
from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY, KnownRatio
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.kinds.wheel_on_belt.run.past_runs import KIND as HEATING
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import next_tick
from tester.run.fault_injection import RIG_STEP_S, FaultyRun
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tester.store.sql import Judged, Ticket
from tests.campaigns.faults.invariants import Invariants
from tests.campaigns.faults.wheel_harm import HarmObserver, Truth
from tests.tester.inputs.recipe.texts import load_recipe

RUNNING = frozenset({"armed", "run", "hold"})
STANDING = frozenset({"idle", "latched"})
EMERGENCY = "emergency stop mirrored"
AT_REST_S = 0.3
"""After latching, a rig may take this long to be at rest in every axis: a yaw axis stops from 20 deg/s in 0.25 s on the
ramp of its drive, which latching disables."""
EMERGENCY_REST_S = 3.0
"""A mirrored emergency stop begins with the drives at speed: I5 allows them this time."""

Place = tuple[int, str]
"""Where a run is: the number of the plan's step (0 while connecting) and its phase in one word."""


class Exposing(Protocol):
    """Judges from the onset of a fault whether it can be noticed."""

    def now(self) -> bool:
        """Return whether it can be noticed now."""
        ...


class Ledger(NullRecorder):
    """Counts what a run would have recorded."""

    def __init__(self) -> None:
        super().__init__()
        self.committed = 0
        self.trips: list[str] = []
        self.journal: list[str] = []
        self.warned: set[str] = set()
        self.heatings: list[str] = []

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Count a committed repeat."""
        if result.status is not RepeatStatus.VOID:
            self.committed += 1
        return Ticket(done=True)

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = nan, limit: float = nan, unit: str = ""
    ) -> int:
        """Note a trip."""
        self.trips.append(interlock)
        return len(self.trips)

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Record what changes the state."""
        if kind in ("mode", "trip"):
            self.journal.append(text)
        elif kind == "warning":
            self.warned.add(text.partition(":")[0])
        elif kind == HEATING and data:
            self.heatings.append(data)


@cache
def rig_of(overrides: tuple[str, ...]) -> RigConfig:
    """Return the simulated rig with overrides; without its standstill relay, so that only the program is judged."""
    overrides = ("sim.standstill_relay=false", *overrides)
    return load_rig("sim", overrides, accept_risk="what a rig does without one of its watches")


@cache
def plan_of(text: str, overrides: tuple[str, ...]) -> Plan:
    """Return a recipe's plan on that rig."""
    return expand(load_recipe(text, PART, "campaign.yaml").recipe, rig_of(overrides))


class Stage:
    """Run, rig, ledger and observer, with the time of the next tick."""

    def __init__(
        self, text: str, overrides: Iterable[str] = (), seed: int = 0, heat: KnownRatio = NO_HISTORY,
        believed: tuple[str, ...] = (),
    ) -> None:  # fmt: skip
        """Build everything; nothing is sent before the first ``tick``. ``heat``: the rig's history.

        ``believed``: further overrides of the rig file that control has; the machine is without them.
        """
        config = rig_of((*overrides, *believed))
        self.plan = plan_of(text, (*overrides, *believed))
        ports, rig, attendant = simulated_ports(rig_of(tuple(overrides)), seed, None, FaultyCanWire)
        self.ledger = Ledger()
        assert isinstance(rig, WheelRig)
        self.rig: Any = rig
        prompts = Prompts(automatic=True)
        self.run: Run = build_run(RunSetup(config, self.plan, ports, attendant, self.ledger, prompts), heat)
        held = [step.setpoint for step in self.plan.conditions()]
        planned = max((one.number("slip_velocity") * one.number("load") for one in held), default=0.0)
        self.observer: Any = HarmObserver(rig, planned)
        self.invariants: Any = Invariants()
        self.hub_most_c = rig.plant.heat.hub_c
        """The highest setpoint of the jacket's controller so far; initially the hub's temperature, degC."""
        self.begin(config)

    def begin(self, config: object) -> None:
        """Begin with run, rig, plan, ledger, observer and invariants as they are."""
        self.faulty = FaultyRun(self.run, self.rig, FaultScript())
        self.next_s = 0.0
        self.ticks = 0
        self.mode = ""
        self.mode_since_s = 0.0
        self.trip = ""
        """The first cause of a trip; an acknowledgement clears it in control, not here."""
        self._step = 0
        self.step_since_s = 0.0
        """When the plan's present step began."""
        self.all_on = False
        """Every drive was energised since they were last all off: one without power now has dropped out."""
        self._shared: tuple[object, ...] = (config, self.plan)

    def copy(self) -> Stage:
        """Return an independent twin; configuration and plan never change and are shared."""
        return deepcopy(self, {id(one): one for one in self._shared})

    def inject(self, *injections: Injection) -> None:
        """Schedule faults by their times."""
        self.faulty.script.add(injections)

    @property
    def copyable(self) -> bool:
        """No drive is addressed outside the scan: such a conversation is a generator."""
        devices = self.run.engine.devices
        return not any(devices.master.busy(drive) for drive in devices.drives)

    @property
    def place(self) -> Place:
        """Where the run is."""
        engine = self.run.engine
        if not engine.scans:
            return 0, "connect"
        progress = engine.ctx.progress
        return progress.step, progress.phase.partition(" ")[0] or progress.title.partition(" ")[0]

    @property
    def running(self) -> bool:
        """The recipe is running, or held; not yet while connecting."""
        return self.mode in RUNNING

    @property
    def ended(self) -> bool:
        """The recipe will not continue: stopped, tripped, finished or never begun."""
        run = self.run
        return run.finished or run.connector.failed or (run.engine.scans > 0 and self.mode not in RUNNING)

    def tick(self) -> float:
        """Advance the rig to the next tick and do it; return its time, s. A run that has ended does nothing."""
        now = self.next_s
        faulty = self.faulty
        faulty.advance(now)
        if self.run.finished:
            # Frames on the wire are no longer received, however urgent they are.
            self.next_s = next_tick(now, now + RIG_STEP_S, faulty.script.due_s)
        else:
            self.next_s = next_tick(now, faulty.tick(now), faulty.urgent_s)
        self.ticks += 1
        state = self.run.engine.control.state
        if state.trip is not None and not self.trip:
            self.trip = state.trip.name
        mode = state.mode.value
        if mode != self.mode:
            self.mode, self.mode_since_s = mode, now
        self._note(now)
        self.observer.look(self._must_stand(now))
        self.invariants.look(self)
        return now

    def _note(self, now: float) -> None:
        """Record the data of the rig and the plan that exposures need."""
        step = self.run.engine.ctx.progress.step
        if step != self._step:
            self._step, self.step_since_s = step, now
        on = [drive.state in ENERGISED for drive in self.rig.axes.values()]
        self.all_on = all(on) or (self.all_on and any(on))
        self.note_of_kind()

    # -- specific to the kind; here a wheel on a belt ------------------------------------------------------

    def note_of_kind(self) -> None:
        """Record the machine's data that exposures need."""
        jacket = self.rig.jacket
        if jacket.running and jacket.setpoint_c > self.hub_most_c:
            self.hub_most_c = jacket.setpoint_c

    def exposed(self, kind: FaultKind) -> Exposing:
        """Begin to judge whether a fault can be noticed."""
        from tests.campaigns.faults.exposure import Exposed

        return Exposed(self, kind)

    def missing(self, kinds: tuple[FaultKind, ...]) -> list[str]:
        """Return what the safe state lacks under these faults."""
        return Truth.of(self.rig).unsafe(
            creeping=self.mode == "cooldown",
            force_stays=any(kind.force_stays for kind in kinds),
        )

    def _must_stand(self, now: float) -> bool:
        if self.run.engine.scans == 0:
            return False  # axes are homed while connecting
        since_s = now - self.mode_since_s
        if self.mode == EMERGENCY:
            return since_s > EMERGENCY_REST_S
        return self.mode in STANDING and since_s > AT_REST_S
