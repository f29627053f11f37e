"""A rubber specimen on a moving track: a block on a slow linear track in a chamber, or a pin on a disc."""

from __future__ import annotations

from typing import Final

from tester.kinds.kind import Kind, found_at

KIND: Final = Kind(
    name="specimen_on_track",
    title="rubber specimen on a moving track",
    measurand="the friction coefficient of a rubber specimen that is pressed on a moving track: force along the track "
    "over the load, mean of the repeats of each condition",
    rigs={
        "grosch": "tester.kinds.specimen_on_track:grosch.yaml",
        "pin-on-disc": "tester.kinds.specimen_on_track:pin-on-disc.yaml",
    },
    rig=found_at("tester.kinds.specimen_on_track.rig:TrackConfig"),
    interlocks=found_at("tester.kinds.specimen_on_track.interlocks.table:SHEET"),
    page="docs/kinds/specimen-on-track.md",
    recipe=found_at("tester.kinds.specimen_on_track.recipe.part:PART"),
    runs=found_at("tester.kinds.specimen_on_track.runs:RUNS"),
    papers=found_at("tester.kinds.specimen_on_track.papers:PAPERS"),
    masters=found_at("tester.kinds.specimen_on_track.fit.master_conditions:MASTERS"),
    served=found_at("tester.kinds.specimen_on_track.served:SERVED"),
    commissions=found_at("tester.kinds.specimen_on_track.commission.commission_steps:COMMISSIONS"),
    fits=found_at("tester.kinds.specimen_on_track.fit.fits:FITS"),
)
