"""Stored runs as the page's process sends them, without a store: for the page alone, at any size.

The numbers follow a formula, so that a test knows the expected page. Samples are answered as least and greatest
value of buckets, as the page's process does.
"""

from __future__ import annotations

from base64 import b64encode
from typing import Any

import numpy as np

from tester.base.arrays import Array

SLIPS = (50.0, 100.0, 150.0, 200.0, 250.0, 300.0, 350.0, 400.0, 450.0, 500.0, 550.0)
LOADS = (100.0, 150.0, 200.0, 250.0, 300.0)
COMPOUNDS = ("1#", "2#", "3#")
RUN = "2026-11-27T14-18-35-table-2"
COLUMNS = (
    ("friction", "Friction mu", ""), ("load_n", "Load", "N"), ("load_setpoint_n", "Load setpoint", "N"),
    ("slip_mm_s", "Slip speed", "mm/s"), ("slip_setpoint_mm_s", "Slip setpoint", "mm/s"),
    ("surface_c", "Surface temp", "°C"), ("surface_setpoint_c", "Surface setpoint", "°C"),
)  # fmt: skip
REPEAT_S = 40.0


def coefficient(compound: str, slip: float, load: float) -> float:
    """Return a coefficient that differs in every cell."""
    return 0.9 - 0.06 * COMPOUNDS.index(compound) - 4e-4 * load + 2e-4 * slip


def run(name: str = RUN, *, states: dict[int, str] | None = None, shift: float = 0.0, text: str = "") -> dict[str, Any]:
    """Return a run of 165 conditions. ``states``: of some, by number; ``text``: put into every field of words."""
    conditions: list[dict[str, Any]] = []
    for compound in COMPOUNDS:
        for load in LOADS:
            for slip in SLIPS:
                n = len(conditions) + 1
                state = (states or {}).get(n, "done")
                valued = state in ("done", "doubtful", "excluded")
                conditions.append({
                    "n": n, "text": text or f"{compound}, {slip:g} mm/s, {load:g} N, 40 degC",
                    "axes": {"compound": text + compound, "slip_velocity": slip, "load": load, "temperature": 40.0},
                    "mu": coefficient(compound, slip, load) + shift if valued else None, "u": 0.014 if valued else None,
                    "repeats": 3 if valued else 0, "asked": 3, "state": state,
                    "doubt": text or ("swings at 11 Hz" if state == "doubtful" else ""),
                    "reason": text or ("overload" if state == "refused" else ""),
                })  # fmt: skip
    length = REPEAT_S * 3 * len(conditions)
    return {
        "run": name, "recipe": text or "Table 2", "status": "done", "simulated": True, "operator": text or "A. Person",
        "started_utc": "2026-11-27T14:18:35.661Z", "rig_s": length, "t0_s": 0.0, "t1_s": length,
        "plan": [{"n": 1, "text": text or "install wheel 1 (1#)", "kind": "install"}]
        + [{"n": one["n"] + 1, "text": one["text"], "kind": "condition"} for one in conditions],
        "axes": [
            {"key": "compound", "title": text or "Compound", "unit": ""},
            {"key": "slip_velocity", "title": "Slip", "unit": "mm/s"}, {"key": "load", "title": "Load", "unit": "N"},
            {"key": "temperature", "title": "Temperature", "unit": "°C"},
        ],
        "conditions": conditions,
        "marks": [
            {"t_s": 30.0, "kind": "wheel", "text": text or "wheel 1 (1#)", "severity": "info"},
            {"t_s": 300.0, "kind": "alarm", "text": text or "jacket slow", "severity": "alarm"},
            {"t_s": 500.0, "kind": "hold", "text": text or "hold by A. Person", "severity": "warning"},
        ],
        "regions": [
            {
                "from_s": REPEAT_S * at + 8.0, "to_s": REPEAT_S * at + 36.0, "kind": "repeat",
                "text": text or f"repeat {at % 3 + 1}",
            }
            for at in range(3 * len(conditions))
        ] + [{"from_s": 500.0, "to_s": 540.0, "kind": "hold", "text": text or "hold by A. Person"}],
        "columns": [{"key": key, "title": text or title, "unit": unit} for key, title, unit in COLUMNS],
        "notes": [{"utc": "2026-11-27T15:00:00Z", "by": text or "A. Person", "text": text or "belt was new"}],
        "tags": [text or "belt 7"],
    }  # fmt: skip


def listed(name: str, text: str = "") -> dict[str, Any]:
    """Return a row of the stored runs."""
    return {
        "run": name, "recipe": text or "Table 2", "status": "done", "operator": text or "A. Person",
        "compounds": list(COMPOUNDS), "started_utc": "2026-11-27T14:18:35.661Z", "simulated": 1, "conditions": 165,
        "values": 160, "tags": [text or "belt 7"],
    }  # fmt: skip


def condition(n: int, mu: float, text: str = "") -> dict[str, Any]:
    """Return the repeats of a condition."""
    at = REPEAT_S * 3 * (n - 1)
    return {
        "repeats": [
            {
                "n": i + 1, "mu": mu + 0.004 * (i - 1), "u": 0.01, "state": "valid", "reason": text,
                "from_s": at + REPEAT_S * i + 8.0, "to_s": at + REPEAT_S * i + 36.0,
            }
            for i in range(3)
        ],
    }  # fmt: skip


class Samples:
    """A million samples, or any number, and their answer for a window."""

    def __init__(self, count: int, length_s: float) -> None:
        """Make ``count`` samples over ``length_s`` rig seconds."""
        self.t: Array = np.linspace(0.0, length_s, count)
        wave = np.sin(self.t / 7.0)
        self.columns: dict[str, Array] = {
            "friction": 0.7 + 0.05 * wave, "load_n": 200.0 + 3.0 * wave, "load_setpoint_n": np.full(count, 200.0),
            "slip_mm_s": 300.0 + 2.0 * wave, "slip_setpoint_mm_s": np.full(count, 300.0),
            "surface_c": 40.0 + wave, "surface_setpoint_c": np.full(count, 40.0),
        }  # fmt: skip
        self.columns["friction"][count // 2] = 1.9  # one sample that every window must show

    def window(self, columns: list[str], from_s: float, to_s: float, points: int) -> dict[str, Any]:
        """Answer the query `samples`."""
        first, last = np.searchsorted(self.t, [from_s, to_s])
        edges = np.unique(np.linspace(first, max(last, first + 1), points + 1).astype(int))[:-1]
        found = {
            key: {"min": _packed(np.minimum.reduceat(self.columns[key][:last], edges)),
                  "max": _packed(np.maximum.reduceat(self.columns[key][:last], edges))}
            for key in columns
        }  # fmt: skip
        return {"t": b64encode((self.t[edges] - from_s).astype("<f8").tobytes()).decode(), "columns": found}


def _packed(values: Array) -> str:
    return b64encode(values.astype("<f4").tobytes()).decode()


def overlay(runs: list[str], against: str, text: str = "") -> dict[str, Any]:
    """Return runs laid over each other; each later one lies 0.02 above the one before."""
    made = [run(name, shift=0.02 * at) for at, name in enumerate(runs)]
    points = [
        [
            {"x": one["axes"].get(against, one["n"]), "mu": one["mu"], "u": one["u"], "label": text or one["text"]}
            for one in each["conditions"]
        ]
        for each in made
    ]
    first = points[0]

    def beside(at: int, *, ratio: bool) -> list[dict[str, Any]]:
        pairs = zip(points[at], first, strict=True)
        return [
            {"x": a["x"], "y": a["mu"] / b["mu"] if ratio else a["mu"] - b["mu"], "u": 0.02, "label": a["label"]}
            for a, b in pairs
        ]

    rest = range(1, len(runs))
    return {
        "against": {"key": against, "title": against, "unit": ""},
        "runs": [{"run": name, "points": points[at]} for at, name in enumerate(runs)],
        "difference": [{"run": runs[at], "points": beside(at, ratio=False)} for at in rest],
        "ratio": [{"run": runs[at], "points": beside(at, ratio=True)} for at in rest],
    }
