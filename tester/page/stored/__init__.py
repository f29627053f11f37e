"""Answers to the page's questions about stored runs, computed in a process of their own.

Every number comes from the tables, records and analyses that `tester show` prints; this package only picks them.
"""
