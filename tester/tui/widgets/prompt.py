"""A question that waits for a person; the answer is recorded."""

from __future__ import annotations

from tester.tui.formatting import clean, clock_text, fit
from tester.tui.scene import ScreenScene
from tester.tui.widgets.panel import WARNING, Panel, Parts


class PromptPanel(Panel):
    """Shown while a question waits."""

    def show(self, scene: ScreenScene) -> None:
        """Appear with the question, and vanish with it."""
        self.display = scene.state is not None and scene.state.prompt is not None
        super().show(scene)

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return question and keys."""
        if scene.state is None or scene.state.prompt is None:
            return []
        prompt = scene.state.prompt
        since = clock_text(prompt.utc)
        return [
            (" ? ", WARNING),
            fit(f" {clean(prompt.text)}  (waits since {since})", width - 4),
            "\n",
            fit("    Enter: answer it", width),
        ]
