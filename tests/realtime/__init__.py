"""`tester sim` and `tester run` as separate processes, measured by the rig's own logs."""
