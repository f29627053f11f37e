"""What a person says of a file of moduli, on a command line or in a compound's file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class DmaOptions:
    """What a person says of a file beside what is in it. ``columns``: heading by quantity; ``units``: by heading."""

    columns: Mapping[str, str] = field(default_factory=dict[str, str])
    units: Mapping[str, str] = field(default_factory=dict[str, str])
    frequency_hz: float | None = None
    temperature_c: float | None = None
    poisson: float = 0.5
    ask_column: str = '--columns "{quantity}=HEADING"'
    ask_unit: str = '--unit "{heading}={unit}"'
    ask_value: str = '--{quantity} "{example}"'
    """How it is said, for messages."""
