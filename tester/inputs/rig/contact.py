"""The nominal area that the load presses on, of every specimen that a rig takes: a section of the rig file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Final

from tester.base.config_reader import Range
from tester.inputs.rig.key_classes import Free

LONGEST: Final = 500
"""Most characters of a source."""
_SHOWN: Final = Free("it makes a pressure of a load in tables, figures and screens; nothing moves by it")


@dataclass(frozen=True, slots=True)
class ContactConfig:
    """Area of a specimen or of a footprint, and where the number comes from: a drawing, an ink print."""

    area: Annotated[float, "mm2", Range(gt=0.0, le=1e5), _SHOWN]
    source: Annotated[str, _SHOWN]

    def __post_init__(self) -> None:
        """Raise ValueError for an area without a source."""
        if not 0 < len(self.source.strip()) <= LONGEST:
            raise ValueError(
                f"source: expected where the area comes from, in 1 to {LONGEST} characters, such as 'die of 10 mm x 10"
                f" mm', got {len(self.source)}"
            )
