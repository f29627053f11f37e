"""``python -m bench``: measures the installed software; ``--source``: this checkout's."""

from __future__ import annotations

import sys
from pathlib import Path

if "--source" not in sys.argv:
    # The checkout is searched last: users run an installation, whose scan is compiled.
    root = Path(__file__).resolve().parent.parent
    sys.path[:] = [*(entry for entry in sys.path if Path(entry or ".").resolve() != root), str(root)]

from bench.cli import main

if __name__ == "__main__":
    sys.exit(main())
