"""Any machine: the scan and its callers, modes and stops, the interlock engine, the execution of a plan.

Nothing here depends on the kind of machine. A kind is a folder in ``tester/kinds`` and provides

- its **process image**: readings, demand and setpoints that inherit from those in ``image``;
- its **devices**: drivers on their wires (``drivers``), with ``fill`` (readings from drivers) and ``apply`` (setpoints
  to drivers); the rest of what a scan needs is in ``devices``;
- its **rows**: ``Interlock`` objects (``row``) over inputs that inherit from ``ScanInputs``, made into one
  ``InterlockTable``, with the parameters that belong to no row;
- its **control**: a class that inherits from ``Control`` and implements the commands of each mode and
  the beginning and end of a stop (``StandstillControl`` has those of a machine that is safe at standstill); its loops
  keep their state in a class that inherits from ``ControlState``;
- its **context**: what a step may read and write, inherited from ``BaseContext``: specimen, attendant, gates
  (``gate_bits``, from which the screen's list of gates follows, and ``closed_gates``);
- its **procedures**: activities, and a class that inherits from ``Procedures`` and selects the activity for each step
  and for unplanned work; also the proofs before a run may begin (``Arming``), the activity of a condition
  (``MeasureCondition``), and its results (``StoredResults``);
- a **build** function that puts these into an ``Engine`` and a ``Connector``, and both into a ``Run``, from a
  ``RunSetup`` (``run_parts``).

One of the ``tickers`` ticks a ``Run``. Until the rig is ready, each tick belongs to the connector: it listens,
configures drives, waits for every device, lets ``Arming`` lift, homes position axes and lets ``Arming`` prove. Then
``Control.start`` evaluates every row, and from then on each tick belongs to the engine. In a tick the devices
``receive``, a scan follows if one is due, and they ``transmit``. A scan calls, in this order:

1. ``BaseContext.before_reading``, the devices' ``fill``, ``BaseContext.after_reading``;
2. in RUN ``BaseContext.closed_gates`` and ``Executor.step``: the activity in progress writes the demand;
3. ``Control.step``: ``Control.look`` updates the inputs, the table is evaluated, rows that have held for
   their delay trip, and the mode's outputs are written to the setpoints: ``run_outputs`` in RUN and HOLD,
   ``stop_outputs`` in a stop, ``emergency_outputs``, ``cool_outputs`` or ``rest_outputs``;
4. ``BaseContext.after_control``; events are queued for the record, before the outputs leave;
5. the devices' ``apply``, the choice of the next scan's time, ``Sampler.record``.

Between activities the executor calls the procedures' ``before`` and ``activity``, and ``after`` when an activity has
ended.
"""
