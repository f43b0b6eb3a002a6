"""Blocks that push each other down a slope."""
