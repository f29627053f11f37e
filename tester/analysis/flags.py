"""The flags of a repeat or a condition: word, meaning, remedy, and whether a flag is a doubt.

Records store the words; the end of a run, ``tester show``, the tables, the report, the screens and the glossary take
meaning and remedy from this list. A new flag is an entry here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Flag:
    """A flag: the ``word`` in records and tables, its meaning and remedy in words, and its weight."""

    word: str
    meaning: str
    """Meaning for the value, a sentence."""
    remedy: str = ""
    """What to do about it, an instruction without a full stop; "" where no action is needed."""
    doubt: bool = False
    """Whether the value needs care. The others are notes."""


NOT_SHOWN: Final = "drift not shown"
THERMOMETER: Final = "thermometer off"
CHANGED: Final = "friction changed"
SLIP_UNSURE: Final = "slip not sure"
STICK_SLIP: Final = "stick-slip"
STICK_SLIP_UNKNOWN: Final = "stick-slip not known"
SHORT: Final = "short"
CARRY_OVER: Final = "carry-over"
DISAGREES: Final = "setting disagrees"
IMPRECISE: Final = "precision not reached"
OUT_OF_LIMITS: Final = "reference out of limits"
REFERENCE: Final = "reference"
ROLLING: Final = "rolling"
EXTENDED: Final = "extended"
TRUNCATED: Final = "truncated"
OUTLIER: Final = "outlier"
EXCLUDED: Final = "excluded"
CLOSEST_TWO: Final = "closest two of three"

FLAGS: Final[Mapping[str, Flag]] = {
    flag.word: flag
    for flag in (
        # In order of remedies: the remedy of the first of several doubts is shown.
        Flag(
            CARRY_OVER,
            "The coefficient was still settling from repeat to repeat: the rubber was running in.",
            "grind the rubber longer before (pre_grind), then measure the condition again",
            doubt=True,
        ),
        Flag(
            CHANGED,
            "Friction changed by more than 5 % at once, within a repeat or from one repeat to the next.",
            "see which repeat changed (repeats.csv: change_percent), clean or change the counterface, then measure the"
            " condition again",
            doubt=True,
        ),
        Flag(
            THERMOMETER,
            "After the soak the surface's thermometer and the hub's sensor part by more than both are believed to.",
            "compare them at a soak (tester commission), clean the thermometer's window, look at its emissivity and at"
            " observer in the rig file",
            doubt=True,
        ),
        Flag(
            SLIP_UNSURE,
            "The wheel's diameter leaves the slip velocity uncertain by more than 3 mm/s and 2 %.",
            "check the diameter (wear_check: each_condition), then measure the condition again",
            doubt=True,
        ),
        Flag(
            STICK_SLIP,
            "Friction swings by more than 5 % to either side within a revolution: the contact sticks and slips, or the"
            " machine vibrates.",
            "look at the samples (tester export --format samples), then try another speed or load, or a stiffer rig",
            doubt=True,
        ),
        Flag(
            NOT_SHOWN,
            "The repeats do not show that the coefficient is steady.",
            "allow more repeats (repeats: at_most), or look for what drifts",
            doubt=True,
        ),
        Flag(
            SHORT,
            "Fewer repeats count than the recipe asks for, make-up repeats included.",
            "allow more repeats (repeats: at_most)",
            doubt=True,
        ),
        Flag(
            OUT_OF_LIMITS,
            "A reference condition before or after it lies outside the limits of its control chart.",
            "change or clean the counterface, then measure the condition again",
            doubt=True,
        ),
        Flag(
            DISAGREES,
            "The run measures this setting several times, and the values differ by more than their uncertainties.",
            "look for what changed in between (counterface, rubber, temperature), then measure the setting again",
            doubt=True,
        ),
        Flag(
            IMPRECISE,
            "The repeatability that the recipe asks for (until) was not reached within the most repeats.",
            "allow more repeats (repeats: at_most), or ask for less (until)",
            doubt=True,
        ),
        Flag(REFERENCE, "A reference condition: it watches the counterface and is none of the recipe's conditions."),
        Flag(ROLLING, "Measured without slip: the coefficient is the rolling resistance."),
        Flag(
            STICK_SLIP_UNKNOWN,
            "Whether the contact sticks and slips is unknown: contacts are too short, or friction swings with the"
            " wheel's turning, or faster than samples come.",
        ),
        Flag(EXTENDED, "A repeat collected more revolutions than its window before its drift was known."),
        Flag(TRUNCATED, "The first revolutions of a repeat are left out of its mean as a transient."),
        Flag(OUTLIER, "A repeat lies more than 3.5 standard deviations from the median. It stays in the mean."),
        Flag(EXCLUDED, "A person left a repeat out of the mean; who, when and why are on record."),
        Flag(CLOSEST_TWO, "The mean is that of the closest two of three repeats, as the recipe asks (combine: paper)."),
    )
}
"""Every flag by its word."""

DOUBTS: Final = tuple(flag.word for flag in FLAGS.values() if flag.doubt)
"""The words of the flags that are doubts."""


def joined(flags: Iterable[str]) -> str:
    """Return flags as one text, sorted."""
    return "; ".join(sorted(set(flags)))


def flags_in(text: str) -> list[str]:
    """Return the flags in a text that ``joined`` made."""
    return [flag.strip() for flag in text.split(";") if flag.strip()]


def remedy_of(flags: Iterable[str]) -> str:
    """Return what to do about the first doubt among ``flags``; "" where there is none."""
    present = set(flags)
    return next((flag.remedy for flag in FLAGS.values() if flag.doubt and flag.word in present), "")
