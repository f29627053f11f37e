"""STOP from a browser's socket, with 20 streaming pages, a frozen one, and wrong codes."""
