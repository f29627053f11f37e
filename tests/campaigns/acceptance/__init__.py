"""Acceptance checks: the software's requirements, measured from outside through its command line.

`python -m tests.campaigns.acceptance --list` lists the topics; docs/testing.md describes how to run them.
"""
