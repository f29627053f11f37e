"""What the main job gives over many seeds, not over one that suits: complete tables, an honest estimate."""
