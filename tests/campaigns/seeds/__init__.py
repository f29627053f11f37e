"""Results of the main job over many seeds, not over a single lucky one: complete tables, an honest estimate."""
