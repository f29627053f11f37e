"""The state view: everything a screen shows, as plain values. The service sends one object four times a second.

A name contains the unit, or the value has a field ``unit``. An unknown value is None, never NaN and never an old value.
``age_s`` and ``quality`` show how far to trust a value. Texts come from recipes, people and devices: show them as they
are, never as markup.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from tester.base.screen import Check, Gate, SoakView, Value

MODES = (
    "OFFLINE",
    "INTERRUPTED",
    "CONNECTING",
    "IDLE",
    "ARMED",
    "RUN",
    "HOLD",
    "STOPPING",
    "COOLDOWN",
    "FAST STOP",
    "LATCHED",
    "E-STOP",
    "MANUAL",
)
"""Values of ``StateView.mode``; a client shows an unknown mode as it is. OFFLINE: no rig is connected; a run connects
it. INTERRUPTED: as OFFLINE, and the store holds an interrupted run; shown until this is acknowledged.
"""


@dataclass(frozen=True, slots=True)
class ProgressView:
    """Where the run is. ``share``: completed share of the whole rig time, 0..1, corrected by the durations measured so
    far.

    ``step`` counts through ``PlanView.steps``. ``over`` of the run's ``conditions`` are finished, with a value or
    without, including those of earlier stretches of a resumed run. ``left_s``: whole rig seconds of work to the end;
    None once a trip or a stop has ended the run early. It is the sum of ``step_left_s``, for the present step, and of
    the later steps in the plan's list. In a hold neither it nor the share changes. ``finish_utc``: the wall-clock time
    of the end at the run's speed, "" at full speed.
    """

    step: int = 0
    steps: int = 0
    title: str = ""
    phase: str = ""
    over: int = 0
    conditions: int = 0
    repeat: int = 0
    repeats: int = 0
    revolutions: float = 0.0
    revolutions_wanted: float = 0.0
    burst: int = 0
    share: float = 0.0
    elapsed_s: float = 0.0
    left_s: float | None = None
    step_left_s: float = 0.0
    finish_utc: str = ""


AlarmState = Literal["active", "acknowledged", "returned"]
"""Cause present, not acknowledged; cause present, acknowledged; cause gone, not acknowledged (ISA-18.2)."""


@dataclass(frozen=True, slots=True)
class Alarm:
    """One alarm. ``priority`` 1 (trip) to 3. ``first_up``: whether it is the first of those that stopped the run.

    ``value``, ``limit``: the measured and the permitted value, None if not a number. ``consequence``: what happens
    next; ``command``: the command that answers the alarm ("ack", "release", "").
    """

    number: int
    name: str
    priority: Literal[1, 2, 3]
    state: AlarmState
    text: str
    value: float | None
    limit: float | None
    unit: str
    consequence: str
    command: str
    first_up: bool
    t_s: float
    utc: str


@dataclass(frozen=True, slots=True)
class PromptView:
    """A question that waits for a person; the command ``answer`` answers it."""

    number: int
    text: str
    t_s: float
    utc: str
    unit: str = ""
    """Of a quantity that may be the answer in place of "yes"; "" for none."""


@dataclass(frozen=True, slots=True)
class DeviceView:
    """One device on a bus. ``kind``: drive, or the type of a device on a line. ``state``: the drive's CiA 402 state.

    ``age_s``: of the device's newest data. Errors are counted since the run began: time-outs, CRC, exceptions,
    emergencies.
    """

    name: str
    kind: str
    bus: str
    address: int
    state: str
    online: bool
    age_s: float | None
    requests: int
    errors: int
    errors_per_hour: float
    detail: str


@dataclass(frozen=True, slots=True)
class BusView:
    """One bus. ``load_percent`` is None where it cannot be measured (a serial line of a real rig)."""

    name: str
    kind: Literal["can", "modbus"]
    load_percent: float | None
    errors: int
    detail: str


@dataclass(frozen=True, slots=True)
class DiskView:
    """Space where runs are stored, in bytes. ``needed``: the estimate for the run under way, 0 if there is none.

    ``free`` is None when the disk does not report it.
    """

    free: int | None
    needed: int
    low: bool


@dataclass(frozen=True, slots=True)
class RunView:
    """The run under way, or the last one. ``outcome``: running, done, incomplete, stopped, tripped, failed, rig
    unreachable. ``exit``: the exit code that `tester run` would give, None while the run is under way.

    ``speed``: rig seconds per second, None = as fast as possible. ``missing``: conditions without a value, in words.
    """

    name: str
    folder: str
    recipe: str
    compound: str
    note: str
    operator: str
    seed: int | None
    simulated: bool
    speed: float | None
    started_utc: str
    outcome: str
    reason: str
    exit: int | None
    missing: tuple[str, ...]

    @property
    def pace(self) -> float | None:
        """Rig seconds per second, None = as fast as possible; on wires 1 where no speed is stated."""
        return self.speed if self.simulated else self.speed or 1.0


@dataclass(frozen=True, slots=True)
class ManualView:
    """Manual mode: armed for ``left_s`` more seconds, or not (None). ``tare``: the newest tare in words."""

    left_s: float | None
    tare: str


@dataclass(frozen=True, slots=True)
class TickView:
    """How punctual the scan is, in real time only: worst lateness and number of overruns since the run began.

    ``late_s``: the worst of the last one to two seconds.
    """

    rate_hz: float
    late_max_s: float
    overruns: int
    late_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ClientsView:
    """The connected clients. ``controller``: name of the client in control, "" if none; ``controller_id``: its
    number.
    """

    controller: str
    controller_id: int
    viewers: int


@dataclass(frozen=True, slots=True)
class StateView:
    """The complete state. ``t_s``: rig seconds of the run; ``wall_s``: seconds since the service started.

    ``mode_text`` is the reason for the mode. ``interrupted``: names of the stored runs that can be resumed.
    ``preflight``: the list to check before starting. ``risk``: the rig's safety keys that are looser than they should
    be, in words; "" if there are none.
    """

    mode: str
    mode_text: str
    mode_since_s: float
    t_s: float
    wall_s: float
    utc: str
    rig: str
    simulated: bool
    run: RunView | None
    progress: ProgressView
    values: tuple[Value, ...]
    gates: tuple[Gate, ...]
    soak: SoakView | None
    alarms: tuple[Alarm, ...]
    prompt: PromptView | None
    manual: ManualView
    devices: tuple[DeviceView, ...]
    buses: tuple[BusView, ...]
    disk: DiskView
    tick: TickView
    clients: ClientsView
    interrupted: tuple[str, ...]
    preflight: tuple[Check, ...]
    alone: str = ""
    """What the rig's devices do by themselves once the service is gone."""
    risk: str = ""

    def value(self, key: str) -> Value | None:
        """Return the value with this key; None if the rig has none."""
        return next((value for value in self.values if value.key == key), None)


StepState = Literal["done", "now", "later"]


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One step: its number from 1, its estimated seconds from before the run, and the measured seconds once it is done.

    ``expected_s``: its duration as now expected from the run so far, whole seconds. The kind ``standstill`` is not a
    step of the plan: it is the way to standstill after each part. ``condition``: number of the condition that it
    measures, 0 for another step.
    """

    number: int
    kind: str
    title: str
    state: StepState
    estimated_s: float
    measured_s: float | None
    expected_s: float
    condition: int = 0


@dataclass(frozen=True, slots=True)
class PlanView:
    """The steps near the present one. ``first``: number of the first listed step; ``total``: number of all steps.

    ``beyond_s``: expected duration of the steps after the last listed one, whole seconds.
    """

    name: str
    total: int
    first: int
    steps: tuple[PlanStep, ...]
    estimated_s: float
    beyond_s: float = 0.0
