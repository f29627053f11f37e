"""Whether a condition's value is trusted, and the mark that stands beside its number wherever it is shown."""

from __future__ import annotations

from typing import Final

from tester.analysis.flags import DOUBTS, flags_in
from tester.analysis.results import ConditionStatus

NOT_TRUSTED: Final = "!"
"""Mark of a number that is no value to be trusted."""
WITH_CARE: Final = "?"
"""Mark of a value that carries a flag of DOUBTS."""


def mark_of(status: ConditionStatus | str, flags: str) -> str:
    """Return the mark of a condition's number: ``!`` not to be trusted, ``?`` with care, "" trusted.

    ``flags`` as a condition's result holds them, one text.
    """
    if status != ConditionStatus.OK:
        return NOT_TRUSTED
    return WITH_CARE if any(flag in DOUBTS for flag in flags_in(flags)) else ""
