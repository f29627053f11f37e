"""Acceptance checks: what the software is asked to do, measured from outside through its command line.

`python -m tests.campaigns.acceptance --list` names the topics; docs/testing.md says how they are run.
"""
