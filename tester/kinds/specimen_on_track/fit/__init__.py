"""What was measured of a specimen on a track, as laws and master curves take it."""
