"""Blocks in the plane that touch, slide and turn."""
