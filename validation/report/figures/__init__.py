"""Figures of arrays: the only room that imports matplotlib."""
