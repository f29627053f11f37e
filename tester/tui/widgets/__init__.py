"""What the screens are made of: each shows a part of the scene, and is told when the scene has changed."""
