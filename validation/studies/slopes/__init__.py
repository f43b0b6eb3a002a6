"""Blocks with friction: sliding, thresholds, drag, shaking."""
