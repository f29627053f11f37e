"""Rows of a run's database as plain values. Units in the names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from tester.analysis.kelvin import KnownSlope
from tester.analysis.results import NOT_JUDGED, ConditionStatus, Judgement, RepeatResult
from tester.analysis.schemes import Scheme, scheme_of
from tester.analysis.terms import Term
from tester.base.axes import Axes, Setpoint

NAN = float("nan")


@dataclass(frozen=True, slots=True)
class Calibration:
    """One figure that converts a device's reading into a quantity, e.g. load cell, scale fz, 0.1, N."""

    device: str
    quantity: str
    value: str
    unit: str


@dataclass(frozen=True, slots=True)
class SessionInfo:
    """A process's session of work on a run, counted from 1. ``origin_s``: rig seconds of the run at its beginning."""

    session: int
    origin_s: float
    started_utc: str
    host: str
    pid: int
    operator: str
    software_version: str
    git_revision: str
    versions: str
    """Versions of libraries, as JSON."""


@dataclass(frozen=True, slots=True)
class Change:
    """A difference found when a run resumes (``subject``: recipe, rig or calibration), and the reason to continue.

    ``before`` is the earlier text; the run itself has the present text.
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
    """A file of a compound or surface that the recipe names, or a data file (``role``: data) to which one of these
    refers.
    """

    role: str
    name: str
    """Name in the recipe; for data the file's own name."""
    file: str
    """Path of the file's copy in the run's folder."""
    source: str
    sha256: str
    """Hash of the file's bytes, hexadecimal."""
    text: str | None
    """Content of a short text; None for any other file, whose content is only in the copy."""
    doubts: str = ""
    """Doubtful points in the file, a line each."""


ACCEPTED_RISK, LOOSE_KEYS = "accepted_risk", "loose_safety_keys"
"""Metadata of a run on a rig whose safety keys are looser than allowed: the reason, and the keys."""


EXTENSION = "extension "
"""Prefix, in a run's versions, of the components that are loaded extensions: ``extension laws/NAME``."""


def risk_text(metadata: Mapping[str, str]) -> str:
    """Return the risks in a run's metadata as one line; "" if none was accepted."""
    keys = metadata.get(LOOSE_KEYS, "")
    return f"{keys} (accepted: {metadata.get(ACCEPTED_RISK, '')})" if keys else ""


@dataclass(frozen=True, slots=True)
class RunInfo:
    """A run at its beginning. Texts of recipe and rig file as used; times as ISO 8601 UTC text.

    ``metadata`` is the recipe's (abrasive, humidity, experiment fields), and the accepted risks (``risk``);
    ``versions`` those of libraries and extensions.
    """

    name: str
    recipe_name: str
    recipe_text: str
    rig_text: str
    started_utc: str
    simulated: bool
    kind: str
    """Kind of the rig: the name of its package."""
    axes: Axes
    """Axes of the conditions."""
    worn: str = ""
    """The kind's word for the part of the machine that wears and that is measured."""
    seed: int | None = None
    software_version: str = ""
    git_revision: str = ""
    operator: str = ""
    recipe_source: str = ""
    rig_source: str = ""
    """Origin of recipe and rig file: a path, the name of a packaged file, or empty."""
    calibration: tuple[Calibration, ...] = ()
    metadata: Mapping[str, str] = field(default_factory=dict[str, str])
    versions: Mapping[str, str] = field(default_factory=dict[str, str])
    terms: tuple[Term, ...] = ()
    """Possible errors of the machine's measuring chain."""
    known: tuple[KnownSlope, ...] = ()
    """Known sensitivity of the compounds to temperature."""
    materials: tuple[StoredMaterial, ...] = ()
    """Files of the compounds and the surface that the recipe names, as far as they exist."""

    @property
    def extensions(self) -> Mapping[str, str]:
        """Return the extensions from other packages, by ``group/name``: package, version, hash of the file."""
        return {
            component.removeprefix(EXTENSION): described
            for component, described in self.versions.items()
            if component.startswith(EXTENSION)
        }

    @property
    def risk(self) -> str:
        """Return the safety keys that are looser than allowed, and why that was accepted; "" if there are none."""
        return risk_text(self.metadata)


@dataclass(frozen=True, slots=True)
class StoredRun:
    """A run as stored. ``status`` is ``running`` until the run stores another status, even after a crash."""

    info: RunInfo
    recipe_sha256: str
    rig_sha256: str
    calibration_sha256: str
    status: str
    reason: str
    ended_utc: str
    rig_seconds: float
    """Rig time at the end, or of the last entry while the run is open."""
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
    """A mounted piece (a specimen may have several, for example wheels, one after another), and its wear at
    ``updated_s`` (rig seconds) for a resumed run. ``diameter_mm``: diameter of the part that wears.
    """

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
    """Time at which grinding in was complete; NaN before that."""
    hardness_shore_a: float = NAN
    """As a person read it at mounting; NaN if not."""
    hardness_by: str = ""
    hardness_utc: str = ""
    """Who typed it, "automatic" without a person, "" if not known; and when."""


@dataclass(frozen=True, slots=True)
class ConditionInfo:
    """One condition of the plan. ``row``: number, in recipe order, of its row of the table, which its replicates
    share.
    """

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
    """Whether repeats alternate between the requested direction and its reverse; the counts above are then of pairs."""

    @property
    def scheme(self) -> Scheme:
        """Return how the condition's repeats give values."""
        return scheme_of(both_directions=self.both_directions)

    @property
    def repeats_planned(self) -> int:
        """Return the planned number of repeats, without make-ups."""
        return self.repeats * self.scheme.repeats_each

    @property
    def compound(self) -> str:
        """Return the name of the rubber."""
        return self.setpoint.compound


@dataclass(frozen=True, slots=True)
class StoredCondition:
    """A condition and its final state; ``status`` is None before its end."""

    info: ConditionInfo
    status: ConditionStatus | None
    reason: str
    started_s: float
    ended_s: float
    warming_k_s: float
    """If the temperature could not be held: the measured rate, K/s, and a sufficient band, K."""
    holdable_band_k: float
    judged: Judgement = NOT_JUDGED
    """Judgement of the drift of the condition's repeats."""


@dataclass(frozen=True, slots=True)
class StoredRepeat:
    """One attempt at a repeat. ``key`` is its id, which its samples have as ``repeat_key``."""

    key: int
    condition: int
    repeat: int
    attempt: int
    piece: int
    """Number of the measured piece."""
    begun_s: float
    result: RepeatResult

    @property
    def target(self) -> tuple[int, int, int]:
        """Return condition, repeat and attempt. They identify it permanently, while keys change when parts are
        merged.
        """
        return self.condition, self.repeat, self.attempt


SURFACE_EVENT: Final = "surface"
"""Kind of the events that record a change of the surface."""


@dataclass(frozen=True, slots=True)
class Travel:
    """The travel under load, since the run began, of the counterface that is on, and a piece's sliding, in m."""

    counterface_m: float
    piece_m: float
