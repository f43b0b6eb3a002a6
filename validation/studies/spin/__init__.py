"""Blocks that spin, fly, slide to rest and tip over a ledge."""
