"""STOP from a browser's socket, with 20 pages that stream, one that is frozen, and wrong codes."""
