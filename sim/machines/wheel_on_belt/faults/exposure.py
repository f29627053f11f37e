"""When a fault of this machine can be noticed at all."""

from __future__ import annotations

from enum import Enum


class Exposure(Enum):
    """When a fault can be noticed at all: its budget counts from then on."""

    ALWAYS = "at once, once the run has begun"
    RUNNING = "at once, where it begins in a run and no wheel was just changed"
    DRIVES = "at once, once every drive is configured"
    CONNECTING = "at the next connection"
    ENABLED = "while the drives are on"
    TURNING = "while the wheel turns"
    LOADED = "in contact"
    PRESSING = "while a load is held"
    SLIDING = "in contact, with slip"
    RUBBING = "while a load is held, with slip"
    ASTRAY = "while a drive shows another speed than it was told"
    HEATING = "while the jacket heats"
    MISWEIGHED = "while the press is further than the load shown can need"
    MISREAD = "while the thermometer is off by more than the model allows, turning"
    STARVED = "while full heat is asked for and the hub stays cold"
    UNASKED = "while heat flows that the controller does not give"
    HIDDEN = "while full heat is given and the hub is far hotter than shown"
    OVERHEATED = "while the hub is hotter than it was ever told to be"
    HOT = "while the hub is far hotter than any recipe needs"
    WELDED = "while the contactor is closed without request"
