"""`tester sim` and `tester run` as processes of their own, and what the rig's own logs say of them."""
