"""Layout of the commissioning screen, beside what all screens have (tester.tui.theme)."""

from __future__ import annotations

from tester.tui import theme

CSS = (
    theme.CSS
    + """
#guide { height: 1fr; }
#guide-steps { width: 30; height: 100%; }
#guide-right { width: 1fr; height: 100%; }
#guide-readings { height: 8; }
#guide-question { height: 8; border: heavy $accent; }
#guide-text { height: 1fr; }
#guide-hint { height: 1; }
#guide-answer { width: 100%; }
#guide-said { height: 1fr; }
Screen.-wide #guide-steps { width: 40; }
Screen.-wide #guide-readings { height: 10; }
Screen.-wide #guide-question { height: 10; }
Screen.-ended #guide-readings { display: none; }
Screen.-ended #guide-question { height: 2fr; }
Screen.-small #guide-steps, Screen.-small #guide-said, Screen.-small #guide-readings { display: none; }
Screen.-small #guide-question { height: 1fr; }
"""
)
