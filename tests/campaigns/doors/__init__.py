"""Two processes and the doors between them: the same results as in one process, and no time-outs caused by our code."""
