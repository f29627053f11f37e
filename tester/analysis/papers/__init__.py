"""Items of papers, each with a verdict computed on request.

A kind brings the papers behind its machine or its laws (``Kind.papers``).
"""
