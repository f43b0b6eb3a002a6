"""Corners that hit edges: which one, when, and what comes of it."""
