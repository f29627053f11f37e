"""What the analysis finds: the statuses and the result of a repeat. Plain values, shared with the store.

Units are in the names. NaN stands for a value that does not exist; the store keeps it as NULL.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

NAN = float("nan")

Flag = Literal["rolling", "extended", "truncated"]


class RepeatStatus(StrEnum):
    """How a repeat ended. Only VALID ones enter a mean; only VOID ones are done again."""

    OPEN = "open"
    """Begun and not committed: under way, or cut off."""
    VALID = "valid"
    NOT_STABILISED = "not stabilised"
    TOO_FEW = "too few revolutions"
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    VOID = "void"
    """Interrupted in contact; a further attempt replaces it."""


class ConditionStatus(StrEnum):
    """Whether a condition has a value that can be trusted, and why not."""

    OK = "ok"
    PENDING = "not measured"
    INSUFFICIENT = "insufficient"
    CANNOT_HOLD = "temperature cannot be held"
    NOT_REACHED = "not reached"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True)
class RepeatResult:
    """One repeat's coefficient and what was measured with it.

    The coefficients are ratios of means (module ``reduce``). Forces in N, moments in N m, speeds in m/s,
    angles in degrees, temperatures in degC; times in rig seconds. ``uncertainty`` is the standard
    uncertainty of ``mu_resultant`` from ``batches`` batch means, ``fluctuation_percent`` the batch means'
    standard deviation in per cent of it. ``drift_percent`` and ``bound_percent`` (90 %) are per window, in
    per cent of the coefficient.
    """

    status: RepeatStatus
    reason: str = ""
    flags: str = ""
    """Words of ``Flag``, separated by a space."""
    mu_resultant: float = NAN
    mu_longitudinal: float = NAN
    mu_lateral: float = NAN
    uncertainty: float = NAN
    fluctuation_percent: float = NAN
    batches: int = 0
    drift_percent: float = NAN
    bound_percent: float = NAN
    revolutions: int = 0
    """Whole accepted revolutions that the coefficient rests on."""
    truncated: int = 0
    """Whole accepted revolutions left out as transient."""
    window_s: float = NAN
    """Accepted seconds that the coefficient rests on."""
    bursts: int = 0
    force_x_n: float = NAN
    force_y_n: float = NAN
    force_z_n: float = NAN
    moment_z_nm: float = NAN
    drive_torque_nm: float = NAN
    wheel_speed_m_s: float = NAN
    belt_speed_m_s: float = NAN
    slip_m_s: float = NAN
    sideslip_deg: float = NAN
    camber_deg: float = NAN
    surface_c: float = NAN
    hub_c: float = NAN
    started_s: float = NAN
    ended_s: float = NAN

    @property
    def valid(self) -> bool:
        """Return whether the coefficient may enter a mean."""
        return self.status is RepeatStatus.VALID


@dataclass(frozen=True, slots=True)
class Burst:
    """One contact within a repeat: accepted whole revolutions, rig seconds, surface temperature in degC."""

    number: int
    revolutions: int
    started_s: float
    ended_s: float
    surface_first_c: float
    surface_last_c: float
