"""Rigid boxes on a plane, what contact engines simulate: the table `[rigid]`."""
