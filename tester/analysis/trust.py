"""Whether a condition's value is trustworthy, and the mark beside its number in every output."""

from __future__ import annotations

from typing import Final

from tester.analysis.flags import DOUBTS, flags_in
from tester.analysis.results import ConditionStatus

NOT_TRUSTED: Final = "!"
"""Mark of a number without a trustworthy value."""
WITH_CARE: Final = "?"
"""Mark of a value that carries a flag of DOUBTS."""


def mark_of(status: ConditionStatus | str, flags: str) -> str:
    """Return the mark of a condition's number: ``!`` not to be trusted, ``?`` with care, "" trusted.

    ``flags`` as in a condition's result, one text.
    """
    if status != ConditionStatus.OK:
        return NOT_TRUSTED
    return WITH_CARE if any(flag in DOUBTS for flag in flags_in(flags)) else ""
