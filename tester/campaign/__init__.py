"""A run as parts that do not depend on each other: split, carried out one by one or side by side, put together."""
