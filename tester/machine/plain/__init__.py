"""A plain machine: drives with speeds, sensors with profiles, one step for each condition.

These modules are defaults for plain machines, built on the common parts in ``tester.machine``; a kind overrides what
differs:

- ``image``: readings, demand, setpoints; a kind's readings inherit from ``PlainReadings`` and derive its channels from
  drives and sensors in ``update``;
- ``rows``: the interlock rows of every such machine, over ``PlainInputs``; a kind puts its own before them;
- ``control``, ``devices``: commands in each mode, drivers on their wires;
- ``context``, ``procedures``: mounting a specimen, measuring a condition in repeats; a kind defines the speeds;
- ``runs``, ``served``: the kind's answers to a run and to a service, and the proof of the drives before a start.

Its rig file is a ``tester.inputs.rig.plain_rig.PlainRig``, its recipe a
``tester.inputs.recipe.plain_recipe.PlainPart``, and its simulated twin on the same wires a
``sim.plain_twin.PlainTwin``. A machine that heats, presses or positions needs more: see
``tester.kinds.specimen_on_track``.
"""
