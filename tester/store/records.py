"""What goes into a run's database and comes out of it, as plain values. Units in the names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isnan

from tester.analysis.kelvin import KnownSlope
from tester.analysis.results import NOT_JUDGED, ConditionStatus, Judgement, RepeatResult
from tester.analysis.schemes import Scheme, scheme_of
from tester.analysis.terms import Term
from tester.base.axes import Axes, Setpoint

NAN = float("nan")


@dataclass(frozen=True, slots=True)
class Calibration:
    """One figure that turns what a device says into a quantity, e.g. load cell, scale fz, 0.1, N."""

    device: str
    quantity: str
    value: str
    unit: str


@dataclass(frozen=True, slots=True)
class SessionInfo:
    """One process's stretch of a run, counted from 1. ``origin_s``: rig seconds of the run at its beginning."""

    session: int
    origin_s: float
    started_utc: str
    host: str
    pid: int
    operator: str
    software_version: str
    git_revision: str
    versions: str
    """Of libraries, as JSON."""


@dataclass(frozen=True, slots=True)
class Change:
    """What differed when a run was resumed (``subject``: recipe, rig or calibration), and why it went on.

    ``before`` is the earlier text; the run itself holds the present one.
    """

    session: int
    utc: str
    subject: str
    before_sha256: str
    after_sha256: str
    before: str
    reason: str


@dataclass(frozen=True, slots=True)
class StoredMaterial:
    """A file of a compound or a surface that the recipe names, or (``role``: data) one that such a file refers to."""

    role: str
    name: str
    """As the recipe says it; of data the file's own."""
    file: str
    """Where its copy lies in the run's folder."""
    source: str
    sha256: str
    """Of its bytes, hexadecimal."""
    text: str | None
    """None of what is no short text: the copy alone holds it."""
    doubts: str = ""
    """What was doubtful in it, a line each."""


@dataclass(frozen=True, slots=True)
class StoredTare:
    """A zero of the load cell. ``kind``: reference, repeat or check; ``zeros``: of each channel, by its name."""

    t_s: float
    kind: str
    repeat_id: int
    zeros: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class StoredPrompt:
    """A question to a person, and its answer (empty: none)."""

    asked_s: float
    asked_utc: str
    text: str
    answered_s: float
    answered_utc: str
    answer: str
    answered_by: str


@dataclass(frozen=True, slots=True)
class StoredTrip:
    """A trip: the interlock, the value that caused it and its limit, who acknowledged it and when.

    Value and limit are NaN where what is watched is no number, ``acknowledged_s`` where the run was over by then.
    """

    id: int
    t_s: float
    utc: str
    interlock: str
    text: str
    value: float
    limit_value: float
    unit: str
    acknowledged_s: float
    acknowledged_utc: str
    acknowledged_by: str

    @property
    def compared(self) -> str:
        """Value and limit in words, "" where there are none."""
        if isnan(self.value) and isnan(self.limit_value):
            return ""
        unit = "" if self.unit in ("", "1") else f" {self.unit}"
        value, limit = ("unknown" if isnan(one) else f"{one:.4g}" for one in (self.value, self.limit_value))
        return f"{value}{unit}, limit {limit}{unit}"

    @property
    def acknowledged(self) -> str:
        """Who acknowledged it and when, in words."""
        if not self.acknowledged_utc:
            return "not acknowledged"
        by = f" by {self.acknowledged_by}" if self.acknowledged_by else ""
        return f"acknowledged {self.acknowledged_utc}{by}"


@dataclass(frozen=True, slots=True)
class StoredParameter:
    """What was read back from a device."""

    t_s: float
    device: str
    parameter: str
    name: str
    value: str


ACCEPTED_RISK, LOOSE_KEYS = "accepted_risk", "loose_safety_keys"
"""Metadata of a run on a rig whose safety keys are looser than they should be: why that is so, and which they are."""


EXTENSION = "extension "
"""Begins the component, in a run's versions, that is an extension which the run had loaded: ``extension laws/NAME``."""


def risk_text(metadata: Mapping[str, str]) -> str:
    """Return the risks in a run's metadata as one line; "" where none was accepted."""
    keys = metadata.get(LOOSE_KEYS, "")
    return f"{keys} (accepted: {metadata.get(ACCEPTED_RISK, '')})" if keys else ""


@dataclass(frozen=True, slots=True)
class RunInfo:
    """A run as it begins. Texts of recipe and rig file as they were used; times as ISO 8601 UTC text.

    ``metadata`` is the recipe's (abrasive, humidity, experiment fields), and the risks that were accepted (``risk``);
    ``versions`` those of libraries and extensions.
    """

    name: str
    recipe_name: str
    recipe_text: str
    rig_text: str
    started_utc: str
    simulated: bool
    kind: str
    """Of the rig: the name under which its package is found."""
    axes: Axes
    """Of the conditions."""
    worn: str = ""
    """What people call the part of the machine that wears and is measured on."""
    seed: int | None = None
    software_version: str = ""
    git_revision: str = ""
    operator: str = ""
    recipe_source: str = ""
    rig_source: str = ""
    """Where recipe and rig file were read from: a path, the name of a packaged file, or empty."""
    calibration: tuple[Calibration, ...] = ()
    metadata: Mapping[str, str] = field(default_factory=dict[str, str])
    versions: Mapping[str, str] = field(default_factory=dict[str, str])
    terms: tuple[Term, ...] = ()
    """What the machine's measuring chain may be off by."""
    known: tuple[KnownSlope, ...] = ()
    """What is known of the compounds' sensitivity to temperature."""
    materials: tuple[StoredMaterial, ...] = ()
    """Files of the compounds and the surface that the recipe names, as far as there are any."""

    @property
    def extensions(self) -> Mapping[str, str]:
        """What was loaded from other packages, by ``group/name``: package, version, hash of the file."""
        return {
            component.removeprefix(EXTENSION): described
            for component, described in self.versions.items()
            if component.startswith(EXTENSION)
        }

    @property
    def risk(self) -> str:
        """Which safety keys are looser than they should be, and why that was accepted; "" where none is."""
        return risk_text(self.metadata)


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run as it stands: ``status`` is ``running`` until the run said otherwise, also after a crash."""

    info: RunInfo
    recipe_sha256: str
    rig_sha256: str
    calibration_sha256: str
    status: str
    reason: str
    ended_utc: str
    rig_seconds: float
    """Rig time at the end, or of the last thing recorded while the run is open."""
    overruns: int
    """Samples that the recorder had to drop."""


@dataclass(frozen=True, slots=True)
class SpecimenInfo:
    """One specimen of the recipe, counted from 1."""

    specimen: int
    compound: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class PieceInfo:
    """What was mounted to be measured (of a specimen, several in turn: a wheel), and how worn it was at ``updated_s``
    (rig seconds) for a resumed run. ``diameter_mm``: what wears of it."""

    piece: int
    specimen: int
    replicate: int
    compound: str
    installed_s: float
    installed_diameter_mm: float
    diameter_mm: float
    sliding_m: float = 0.0
    updated_s: float = 0.0
    ground_s: float = NAN
    """When pre-grinding was complete; NaN before."""


@dataclass(frozen=True, slots=True)
class ConditionInfo:
    """One condition of the plan. ``row`` is its row of the table, shared by its replicates, in recipe order."""

    condition: int
    row: int
    specimen: int
    replicate: int
    grid: str
    note: str
    setpoint: Setpoint
    temperature_band_k: float
    repeats: int
    min_valid: int
    window_revolutions: float | None = None
    window_s: float | None = None
    at_most: int = 0
    until_percent: float | None = None
    both_directions: bool = False
    """Repeats alternate between sliding as asked for and reversed; counts above are of pairs."""

    @property
    def scheme(self) -> Scheme:
        """Return how its repeats make values."""
        return scheme_of(both_directions=self.both_directions)

    @property
    def repeats_planned(self) -> int:
        """Return how many repeats are to be made, if none is made up for."""
        return self.repeats * self.scheme.repeats_each

    @property
    def compound(self) -> str:
        """Return the name of the rubber."""
        return self.setpoint.compound


@dataclass(frozen=True, slots=True)
class StoredCondition:
    """A condition and how the run left it; ``status`` None while it has not."""

    info: ConditionInfo
    status: ConditionStatus | None
    reason: str
    started_s: float
    ended_s: float
    warming_k_s: float
    """Where the temperature could not be held: the rate measured, K/s, and the band that would do, K."""
    holdable_band_k: float
    judged: Judgement = NOT_JUDGED
    """What its repeats say of its drift."""


@dataclass(frozen=True, slots=True)
class StoredRepeat:
    """One attempt at a repeat. ``key`` is its id, as in the samples' ``repeat_key``."""

    key: int
    condition: int
    repeat: int
    attempt: int
    piece: int
    """What it was measured on."""
    begun_s: float
    result: RepeatResult

    @property
    def target(self) -> tuple[int, int, int]:
        """Return condition, repeat and attempt, by which it is known for good: keys change when parts are merged."""
        return self.condition, self.repeat, self.attempt


@dataclass(frozen=True, slots=True)
class Travel:
    """How far the counterface had travelled under load since the run began, and a piece had slid, in m."""

    counterface_m: float
    piece_m: float


@dataclass(frozen=True, slots=True)
class StoredExclusion:
    """A person's word on a repeat: out of the mean (``excluded`` 1), or in again (0); ``id`` counts from 1.

    ``manifest_before`` is the text of the folder's manifest before it, "" where there was none.
    """

    id: int
    condition: int
    repeat: int
    attempt: int
    excluded: int
    reason: str
    operator: str
    utc: str
    software_version: str
    manifest_before: str

    @property
    def target(self) -> tuple[int, int, int]:
        """Return condition, repeat and attempt."""
        return self.condition, self.repeat, self.attempt


@dataclass(frozen=True, slots=True)
class StoredEvent:
    """One line of the journal: sequence number from 1, rig seconds, wall clock, kind, severity, text, data."""

    sequence: int
    t_s: float
    utc: str
    kind: str
    severity: str
    text: str
    data: str
