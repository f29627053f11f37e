"""A sledge that a drive pulls over a plate through a spring: a kind of rig of a laboratory's own."""

from tester.kinds.kind import Kind, found_at

KIND = Kind(
    name="sledge",
    title="sledge on a plate, pulled through a spring",
    rigs={"sledge": "lab_sledge:rig.yaml"},
    rig=found_at("lab_sledge.rig:SledgeRig"),
    interlocks=found_at("lab_sledge.rig:SHEET"),
    page="README.md",
    runs=found_at("lab_sledge.runs:RUNS"),
    served=found_at("lab_sledge.runs:SERVED"),
    recipe=found_at("lab_sledge.recipe:PART"),
)
