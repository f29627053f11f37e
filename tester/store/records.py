"""What goes into a run's database and comes out of it, as plain values. Units in the names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from tester.analysis.results import ConditionStatus, RepeatResult

NAN = float("nan")


@dataclass(frozen=True, slots=True)
class RunInfo:
    """A run as it begins. Texts of recipe and rig file as they were used; times as ISO 8601 UTC text.

    ``metadata`` is the recipe's (abrasive, humidity, experiment fields); ``versions`` those of libraries.
    """

    name: str
    recipe_name: str
    recipe_text: str
    rig_text: str
    started_utc: str
    simulated: bool
    seed: int | None = None
    software_version: str = ""
    git_revision: str = ""
    operator: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict[str, str])
    versions: Mapping[str, str] = field(default_factory=dict[str, str])


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run as it stands: ``status`` is ``running`` until the run said otherwise, also after a crash."""

    info: RunInfo
    recipe_sha256: str
    rig_sha256: str
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
class WheelInfo:
    """A wheel that was installed, and its wear state as of ``updated_s`` (rig seconds) for a resumed run."""

    wheel: int
    specimen: int
    replicate: int
    compound: str
    installed_s: float
    installed_diameter_mm: float
    diameter_mm: float
    sliding_m: float = 0.0
    updated_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ConditionInfo:
    """One condition of the plan. ``row`` is its row of the table, shared by its replicates, in recipe order."""

    condition: int
    row: int
    specimen: int
    replicate: int
    grid: str
    compound: str
    note: str
    slip_velocity_m_s: float
    load_n: float
    sideslip_deg: float
    camber_deg: float
    temperature_c: float
    wheel_speed_m_s: float
    temperature_band_k: float
    repeats: int
    min_valid: int
    window_revolutions: float | None = None
    window_s: float | None = None


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


@dataclass(frozen=True, slots=True)
class StoredRepeat:
    """One attempt at a repeat. ``key`` is its id, as in the samples' ``repeat_key``."""

    key: int
    condition: int
    repeat: int
    attempt: int
    wheel: int
    begun_s: float
    result: RepeatResult


@dataclass(frozen=True, slots=True)
class Event:
    """One line of the journal: sequence number from 1, rig seconds, wall clock, kind, severity, text, data."""

    sequence: int
    t_s: float
    utc: str
    kind: str
    severity: str
    text: str
    data: str
