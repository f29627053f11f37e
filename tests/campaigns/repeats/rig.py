"""Runs of the simulated rig for the figures, in this process."""

from __future__ import annotations

from pathlib import Path

from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.sweep.case import Unseen


def run(text: str, seed: int, folder: Path) -> Path:
    """Run a recipe with a seed on the packaged rig; return the run's folder."""
    recipe = folder / "recipe.yaml"
    recipe.write_text(text, encoding="utf-8")
    screen = Unseen()
    session = screen.session = Session(SessionOptions(str(recipe), "sim", out=folder / "runs", seed=seed), screen)
    session.run()
    if session.folder is None:
        raise RuntimeError(f"the run did not begin: {' '.join(screen.messages)}")
    return session.folder
