"""Two processes and the doors between them: the same conditions as in one process, and no time-outs of our own."""
