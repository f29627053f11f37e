"""Files that people write: rig files, recipes, materials."""
