"""Adapters of glued blocks in the plane."""
