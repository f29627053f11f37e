"""Any machine: the scan and who calls it, modes and stops, the interlock engine, the walk through a plan.

Nothing here knows one kind of machine. A kind is a folder in ``tester/kinds`` and brings

- its **process image**: readings, demand and setpoints that inherit from those in ``image``;
- its **devices**: drivers on their wires (``drivers``), with ``fill`` (readings from drivers) and ``apply`` (setpoints
  to drivers); the rest of what a scan needs is in ``devices``;
- its **rows**: ``Interlock`` objects (``row``) over inputs that inherit from ``ScanInputs``, made into one
  ``InterlockTable``, with the parameters that belong to no row;
- its **control**: a class that inherits from ``Control`` and implements the commands of each mode and
  the begin and end of a stop (``StandstillControl`` has those of a machine that is safe once it stands); its loops keep
  their state in a class that inherits from ``ControlState``;
- its **context**: what a step may see and do, inherited from ``BaseContext``: specimen, gates, hands at the rig;
- its **procedures**: activities, and a class that inherits from ``Procedures`` and selects the activity for each step
  and for unplanned work; also the proofs before a run may begin (``Arming``), what a repeat is (``MeasureCondition``),
  and its results (``StoredResults``);
- a **build** function that puts these into an ``Engine`` and a ``Connector``, and both into a ``Run``.

A ``Run`` is ticked by one of the ``tickers``. Until the rig is up the connector has the tick: it listens, configures
drives, hears every device, lets ``Arming`` lift, homes position axes and lets ``Arming`` prove; then ``Control.start``
evaluates every row, and the engine has it. In a tick the devices ``receive``, a scan follows if one is due, and they
``transmit``. A scan calls, in this order:

1. ``BaseContext.before_reading``, the devices' ``fill``, ``BaseContext.after_reading``;
2. in RUN ``BaseContext.closed_gates`` and ``Executor.step``: the activity in progress writes the demand;
3. ``Control.step``: ``Control.look`` brings the inputs up to date, the table is evaluated, rows that have held for
   their delay trip, and the mode's outputs are written to the setpoints: ``run_outputs`` in RUN and HOLD,
   ``stop_outputs`` in a stop, ``emergency_outputs``, ``cool_outputs`` or ``rest_outputs``;
4. ``BaseContext.after_control``; events are queued for the record, before the outputs leave;
5. the devices' ``apply``, the choice of the next scan's time, ``Sampler.record``.

Between activities the executor asks the procedures ``before`` and ``activity``, and ``after`` when one has ended.
"""
