"""`tester page`: the page in a browser. A process of its own, a client of the service.

It serves the files of ``static`` and one WebSocket, pairs browsers, refuses what a page may not do, and answers
questions about stored runs (docs/decisions/0023).
"""
