"""What papers print and state, each with a verdict that is worked out when it is asked for.

A kind brings the papers that its machine or its laws come from (``Kind.papers``).
"""
