"""Adapters of columns: a scene's layers, joints, base and drive for each package, and the exact layers as a solver."""
