"""Blocks in the plane, glued along the edges they share: the table `[plane]`."""
