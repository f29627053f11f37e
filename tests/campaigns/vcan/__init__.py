"""A recipe on a real vcan, in a kernel of its own: user-mode Linux, for hosts whose kernel has no CAN."""
