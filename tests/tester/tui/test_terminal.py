"""The screen in a real terminal (tmux), in front of a real service: as an operator would use it.

    pytest -m campaign tests/tester/tui/test_terminal.py

About three minutes. Every step's capture is written to $TESTER_CAPTURES, if that names a folder.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester import clock

pytestmark = [
    pytest.mark.campaign,
    pytest.mark.skipif(shutil.which("tmux") is None, reason="needs tmux (Debian: tmux)"),
]
TESTER = f"{sys.executable} -c 'from tester.cli.main import main; main()'"
ROOT = Path(__file__).parents[3]
RECIPE = """\
recipe: short
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 5 rev, temperature_band: 2 degC}
grids:
  - {name: one, slip_velocity: 200 mm/s, load: 100, temperature: 25 degC}
"""


class Terminal:
    """A tmux server of its own; ``at`` is its socket."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.at, self.number = folder, str(folder / "tmux"), 0
        self.environment = dict(os.environ, TESTER_RUNTIME_DIR=str(folder / "rt"), PYTHONPATH=str(ROOT))
        self.environment["EDITOR"] = "sed -i s/100,/100\\ N,/"
        (folder / "rt").mkdir(mode=0o700)

    def tmux(self, *words: str) -> str:
        done = subprocess.run(
            ["tmux", "-S", self.at, *words], capture_output=True, text=True, check=True, cwd=self.folder,
            env=self.environment,
        )  # fmt: skip
        return done.stdout

    def open(self, command: str) -> None:
        self.tmux("new-session", "-d", "-x", "120", "-y", "40", command)

    def press(self, *keys: str) -> None:
        for key in keys:
            self.tmux("send-keys", key)
            clock.sleep_until(clock.monotonic() + 0.3)  # a person's pace

    def see(self, text: str, within_s: float = 30.0) -> str:
        """Wait until a text stands on the screen, and return the screen."""
        end_s = clock.monotonic() + within_s
        while clock.monotonic() < end_s:
            seen = self.tmux("capture-pane", "-p")
            if text in seen:
                self.number += 1
                captures = os.environ.get("TESTER_CAPTURES")
                if captures:
                    name = "".join(c if c.isalnum() else "-" for c in text)[:30]
                    (Path(captures) / f"{self.number:02d}-{name}.txt").write_text(seen, encoding="utf-8")
                return seen
            clock.sleep_until(clock.monotonic() + 0.1)
        raise AssertionError(f"{text!r} is not seen:\n{self.tmux('capture-pane', '-p')}")

    def command(self, words: str) -> str:
        done = subprocess.run(f"{TESTER} {words}", shell=True, capture_output=True, text=True, check=False,
                              cwd=self.folder, env=self.environment)  # fmt: skip
        return done.stdout + done.stderr


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Terminal]:
    (tmp_path / "recipes").mkdir()
    (tmp_path / "recipes" / "mine.yaml").write_text(RECIPE, encoding="utf-8")
    made = Terminal(tmp_path)
    yield made
    subprocess.run(["tmux", "-S", made.at, "kill-server"], check=False, capture_output=True)
    for line in subprocess.run(
        ["ps", "-ewwo", "pid,args"], capture_output=True, text=True, check=True
    ).stdout.splitlines():
        if " serve " in line and str(tmp_path) in line:
            os.kill(int(line.split()[0]), signal.SIGTERM)


def test_an_operator_finds_a_mistake_runs_holds_stops_and_exports(terminal: Terminal) -> None:
    on = terminal
    on.open(f"{TESTER} tui --speed 20 --out {on.folder / 'runs'}")
    on.see("OFFLINE")
    on.see("✘ 1 mine")
    on.press("End", "Enter")
    on.see("5:48 load: 100 has no unit")
    on.press("e")
    on.see("✔   mine")
    on.press("Enter")
    on.see("1 condition,")
    on.press("Enter")
    on.see("waits since", 60.0)
    on.press("y")
    on.see("rep 1/3", 120.0)
    on.press("Space")
    on.see(" HOLD ")
    on.press("r")
    on.see("HOLD ends")
    on.press("Enter")
    on.see(" RUN ")
    on.press("F12")
    on.see("STOP taken")
    on.see("OFFLINE", 60.0)
    on.press("F5")
    on.see("stopped")
    on.press("Enter")
    on.see("short, stopped")
    on.press("e", "Enter")
    on.see("exported to")
    on.press("q")
    assert list(on.folder.glob("*-appendix.csv"))


def test_a_screen_that_is_killed_leaves_the_run_alone_and_another_one_shows_it(terminal: Terminal) -> None:
    on = terminal
    on.open(f"{TESTER} tui --speed 20 --out {on.folder / 'runs'}")
    on.see("✔   quickstart")
    on.press("Enter")
    on.see("Start a run")
    on.press("Enter")
    on.see("waits since", 60.0)
    on.press("y")
    on.see("pre-grind")
    os.kill(int(on.tmux("display-message", "-p", "#{pane_pid}")), signal.SIGKILL)
    clock.sleep_until(clock.monotonic() + 1.0)
    assert "RUN" in on.command("status")
    on.open(f"{TESTER} tui --out {on.folder / 'runs'}")
    on.see(" RUN ")
    on.press("C-x")
    on.see("STOP taken")
