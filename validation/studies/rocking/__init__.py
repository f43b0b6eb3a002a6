"""Blocks that turn by any angle, against rigid ones."""
