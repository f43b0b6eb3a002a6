"""Time schemes and contact methods that are proposed as cures, on the same scenes."""
