"""What is left when the terminal is too small for a screen."""

from __future__ import annotations

from tester.tui.formatting import clean, fit
from tester.tui.gone import gone_line
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import Panel, Parts, rows

SMALLEST = (60, 15)
"""Columns and lines from which on the screens are shown."""


class SmallPanel(Panel):
    """That the run goes on, the question that waits, why the rig is in its mode."""

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return some lines."""
        needed = f"needed: {SMALLEST[0]} x {SMALLEST[1]}"
        texts = ["terminal too small,", gone_line(scene) or "the run continues", needed]
        if scene.state is not None:
            if scene.state.prompt is not None:
                texts.append(f"asks: {clean(scene.state.prompt.text)}")
            texts.append(clean(scene.state.mode_text))
        lines: list[Parts] = [[fit(text, width)] for text in texts[:height]]
        return rows(lines)
