"""The quantity of each heading, in any output.

An unlisted heading is its own quantity, in lower case: a new column is compared wherever it has the same heading.
"""

from __future__ import annotations

import re
from typing import Final

from tests.campaigns.agreement.record import plain_heading

MU: Final = "mu"
"""The coefficient at the requested temperature."""
MU_MEASURED: Final = "mu as measured"
"""The coefficient at the measured mean temperature."""
U_THIS, U_COMPOUND = "U this piece", "U compound"
FLAGS, DOUBTS, MARK, STATUS, REASON = "flags", "doubts", "mark", "status", "reason"
ASKED, MADE, VALID, LEFT_OUT, MAKE_UPS = "asked", "made", "valid", "left out", "make-ups"
INTERRUPTED: Final = "interrupted"
CONDITIONS, VALUES, MISSING, WITH_CARE = "conditions", "values", "missing", "with care"
RIG_SECONDS: Final = "rig seconds"
COUNTS: Final = frozenset(
    {ASKED, MADE, VALID, LEFT_OUT, MAKE_UPS, INTERRUPTED, CONDITIONS, VALUES, MISSING, WITH_CARE, "pairs", "checks"}
)
WORDS: Final = frozenset({FLAGS, DOUBTS})
"""Quantities that are sets of words."""
TEXTS: Final = frozenset({STATUS, REASON, "exclusion"})
"""Quantities that are sentences."""

_NAMES: Final = {
    "mu": MU,
    "friction coefficient": MU,
    "mu corrected": MU,
    "coefficient": MU,
    "mu at the temperature asked for": MU,
    "mu as measured": MU_MEASURED,
    "mu measured": MU_MEASURED,
    "mu raw": MU_MEASURED,
    "mu resultant": MU_MEASURED,
    "raw": MU_MEASURED,
    "u": U_THIS,
    "u (95 %)": U_THIS,
    "u expanded": U_THIS,
    "u this": U_THIS,
    "u expanded this": U_THIS,
    "u compound": U_COMPOUND,
    "u expanded compound": U_COMPOUND,
    "u compound %": "U compound %",
    "u this %": "U this piece %",
    "s %": "s %",
    "n valid": VALID,
    "n": ASKED,
    "make ups": MAKE_UPS,
    "asked for": ASKED,
    "k": "k this piece",
    "drift %": "drift %",
    "change at once %": "change %",
    "change percent": "change %",
    "swing percent": "swing %",
    "swing at (hz)": "swing hz",
    "u expanded percent": "U this piece %",
    "u expanded compound percent": "U compound %",
    "flagged": FLAGS,
    "rig time": RIG_SECONDS,
    "coverage factor": "k this piece",
    "coverage factor compound": "k compound",
    "drift percent": "drift %",
    "drift bound percent": "drift bound %",
    "trend percent": "trend %",
}


def quantity_of(heading: str, worn: str) -> str:
    """Return the quantity of a heading; ``worn``: what the kind calls the piece that wears."""
    plain = plain_heading(heading).replace("μ", "mu").replace("±", "").replace("(%)", "%")
    plain = plain.removesuffix(f" this {worn}") + " this" if plain.endswith(f" this {worn}") else plain
    plain = re.sub(rf"\bthis {re.escape(worn)}\b", "this", plain).strip()
    return _NAMES.get(plain, plain)
