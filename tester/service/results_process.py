"""The process that works out a run's results while it is under way, ``python -m tester.service.results_process LINK``.

A request is the name of a run; the settings are the folder of the runs (``tester.service.asked_process``).
"""

from __future__ import annotations

from pathlib import Path

from tester.service.asked_process import NICE, answer_all
from tester.service.child_process import link_to_owner
from tester.service.present_results import PresentResults

if __name__ == "__main__":
    answer_all(link_to_owner(NICE), lambda runs: PresentResults(Path(str(runs))).answer)
