"""Items of papers, each with a verdict computed on request.

A kind supplies the papers behind its machine or its laws (``Kind.papers``).
"""
