"""Where a run gets its rig from: by name or file, or from what a run has stored."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tester import kinds
from tester.inputs.rig import Rig
from tester.run.kinds import to_be_run


def load_rig(source: str | Path = kinds.SIMULATED, overrides: Sequence[str] = (), accept_risk: str = "") -> Rig:
    """Return the rig of a file, or the packaged one of that name (tester.inputs.rig.load.load).

    Raises InvalidSource, for a rig of a kind that no recipe can be run on too.
    """
    return to_be_run(kinds.load_rig(source, overrides, accept_risk))


def load_rig_text(text: str | Path) -> Rig:
    """Return the rig of a text or a file that a run has stored; raises InvalidSource as ``load_rig``.

    Its risks were accepted when the run began, or are asked for where it goes on (tester.run.session).
    """
    return to_be_run(kinds.load_rig_text(text))
