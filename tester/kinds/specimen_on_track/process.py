"""The process image of a specimen on a track. One instance of each exists per rig, overwritten in place."""

from __future__ import annotations

from dataclasses import dataclass

from tester.machine.image import NAN, NEVER, BaseDemand, BaseReadings, BaseSetpoints


@dataclass(slots=True)
class TrackReadings(BaseReadings):
    """Newest value of every signal, with the time stamp of its source (seconds of the scan's clock).

    A device that the rig does not have leaves its values NaN and its times at the present scan's.
    """

    track_m_s: float = NAN
    """Speed of the track under the specimen, above 0 forward; from its position, over half a second."""
    track_now_m_s: float = NAN
    """The same speed, from one reading to the next."""
    track_mm: float = NAN
    """Place of a linear track in its travel."""
    way_m: float = 0.0
    """Way of the track since the connection; motion backward reduces it."""
    track_at_s: float = NEVER
    lift_mm: float = NAN
    """Place of the arm, 0 lowered. Without a drive, the place requested of a person; NaN before that."""
    lift_at_s: float = NEVER
    lowered: bool = False
    raised: bool = False
    force_n: float = NAN
    """Tangential force on the specimen, tare applied, above 0 where the track moves forward."""
    friction_n: float = NAN
    """The force against the motion of the track; below 0 only without sliding."""
    sliding_m_s: float = NAN
    """Speed of the track in the demanded direction."""
    load_n: float = 0.0
    """Load of the weights: 0 while the arm is not lowered."""
    cell_valid: bool = False
    cell_silent: bool = False
    """The load cell has not answered several requests in a row, and is not set up again yet."""
    cell_at_s: float = NEVER
    cell_changed_s: float = NEVER
    """When a reading of the cell last differed from its predecessor."""
    air_c: float = NAN
    """Air temperature at the specimen: the chamber's reading, else the thermometer's."""
    air_valid: bool = False
    air_silent: bool = False
    air_at_s: float = NEVER
    chamber_percent: float = NAN
    """Output of the chamber, below 0 cooling."""
    chamber_alarm: bool = False
    """The chamber has gone to standby by itself: beyond its own limits, or its lease ran out."""
    height_mm: float = NAN
    """Height of the arm by its sensor, 0 with a new specimen on the track; NaN where the sensor denies its reading."""
    height_silent: bool = False
    height_at_s: float = NEVER
    height_changed_s: float = NEVER
    """When a reading of the height last differed from its predecessor."""
    exit_c: float = NAN
    """Surface of the track behind the contact, by the pyrometer."""
    exit_silent: bool = False
    exit_at_s: float = NEVER
    contact_c: float = NAN
    """Temperature recorded with friction: the pyrometer's, else the air's."""
    stretch: float = 0.0
    """Way in stretches of the condition."""

    def later(self, seconds: float) -> None:
        BaseReadings.later(self, seconds)
        self.track_at_s += seconds
        self.lift_at_s += seconds
        self.cell_at_s += seconds
        self.cell_changed_s += seconds
        self.air_at_s += seconds
        self.exit_at_s += seconds
        self.height_at_s += seconds
        self.height_changed_s += seconds

    def drive_stamps_s(self) -> tuple[float, ...]:
        return (self.track_at_s, self.lift_at_s)


@dataclass(slots=True)
class TrackDemand(BaseDemand):
    """The demand of the running step; control bounds it and may refuse it."""

    track_m_s: float = 0.0
    lowered: bool = False
    """The arm is to be down."""
    tared: bool = False
    """The cell has been tared with this specimen: only then may the track move with the arm down."""
    sliding_m: float = 0.0
    """Way since the track began to move in this direction with the arm down."""
    least_mu: float = 0.0
    """Least coefficient that the recipe expects of this contact; 0: it states none."""
    chamber_c: float = NAN
    """Temperature of the air to hold; NaN = chamber off."""


@dataclass(slots=True)
class TrackSetpoints(BaseSetpoints):
    """Setpoints for the devices at the end of a scan, within every limit."""

    track_m_s: float = 0.0
    lift_mm: float = 0.0
    chamber_c: float = 20.0
    chamber: bool = False
    """Chamber in run (True) or standby."""
    chamber_silent: bool = False
    """The chamber's setpoint is no longer renewed: the lease ends an output that standby did not end."""
