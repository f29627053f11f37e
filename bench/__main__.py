"""``python -m bench``: measures the software that is installed, where it is; ``--source``: this checkout's."""

from __future__ import annotations

import sys
from pathlib import Path

if "--source" not in sys.argv:
    # The checkout is searched last: an installation's scan is compiled, and what users run.
    root = Path(__file__).resolve().parent.parent
    sys.path[:] = [*(entry for entry in sys.path if Path(entry or ".").resolve() != root), str(root)]

from bench.cli import main

if __name__ == "__main__":
    sys.exit(main())
