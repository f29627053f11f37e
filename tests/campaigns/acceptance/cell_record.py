"""The load cell's forces from a run's Modbus log, decoded by the profile's register map."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
from pymodbus.framer.rtu import FramerRTU

import drivers.profiles

PROFILE = Path(drivers.profiles.__file__).parent / "four_axis_transmitter.toml"
UNIT = 1
READ_HOLDING = 3
TYPES = {"i16": ("h", 1), "u16": ("H", 1), "i32": ("i", 2), "u32": ("I", 2)}


class CellRecord:
    """Normal force over time. ``bad_frames``: replies whose CRC is wrong."""

    def __init__(self, log: Path) -> None:
        """Read a log of lines `(time) TX|RX bytes`."""
        profile: dict[str, Any] = tomllib.loads(PROFILE.read_text(encoding="utf-8"))
        signals: dict[str, dict[str, Any]] = profile["signals"]
        first = min(signal["address"] for signal in signals.values())
        registers = max(signal["address"] + TYPES[signal["type"]][1] for signal in signals.values()) - first
        self.bad_frames = 0
        request = bytes([UNIT, READ_HOLDING, *first.to_bytes(2, "big"), *registers.to_bytes(2, "big")])
        times: list[float] = []
        words: list[bytes] = []
        asked = False
        at = 3 + 2 * (signals["fz"]["address"] - first)
        size = 2 * TYPES[signals["fz"]["type"]][1]
        for line in log.read_text(encoding="ascii").splitlines():
            stamp, way, text = line.split(" ", 2)
            frame = bytes.fromhex(text)
            if way == "TX":
                asked = frame[:-2] == request
            elif asked and len(frame) == 5 + 2 * registers:
                self.bad_frames += FramerRTU.compute_CRC(frame[:-2]) != int.from_bytes(frame[-2:], "big")
                times.append(float(stamp[1:-1]))
                words.append(frame[at : at + size])
        self.times_s = np.array(times)
        code = {"i32": ">i4", "u32": ">u4", "i16": ">i2", "u16": ">u2"}[signals["fz"]["type"]]
        self.raw_n = np.frombuffer(b"".join(words), code) * float(signals["fz"]["scale"])

    def zero_n(self, before_s: float, span_s: float = 1.0) -> float:
        """Return the mean of the unloaded cell over the second before a time."""
        chosen = (self.times_s < before_s) & (self.times_s >= before_s - span_s)
        return float(np.mean(self.raw_n[chosen]))

    def trailing_mean_n(self, at_s: np.ndarray[Any, Any], span_s: float) -> np.ndarray[Any, Any]:
        """Return the mean raw force over the ``span_s`` before each time."""
        total = np.concatenate(([0.0], np.cumsum(self.raw_n)))
        last = np.searchsorted(self.times_s, at_s, "right")
        first = np.searchsorted(self.times_s, at_s - span_s, "right")
        return (total[last] - total[first]) / np.maximum(last - first, 1)
