"""A plain machine: drives that are given a speed, sensors that are profiles, one step for each condition.

Defaults for such machines, on what ``tester.machine`` has for all; a kind overrides what differs:

- ``image``: readings, demand, setpoints; a kind's readings inherit from ``PlainReadings`` and say in ``update`` what
  drives and sensors mean;
- ``rows``: the interlock rows that every such machine has, over ``PlainInputs``; a kind puts its own before them;
- ``control``, ``devices``, ``arming``: commands in each mode, drivers on their wires, what is shown before a start;
- ``context``, ``procedures``: a specimen is put on, a condition is measured in repeats; a kind says what it demands;
- ``runs``, ``served``: what a run and a service ask of the kind.

Its rig file is a ``tester.inputs.rig.plain_rig.PlainRig``, its recipe a
``tester.inputs.recipe.plain_recipe.PlainPart``, its twin on the same wires a ``sim.plain_twin.PlainTwin``. A machine
that heats, presses or goes to places is more than plain: see ``tester.kinds.specimen_on_track``.
"""
