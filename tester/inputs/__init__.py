"""What people write: rig files, recipes, materials."""
