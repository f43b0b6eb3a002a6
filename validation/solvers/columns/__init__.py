"""Adapters of columns: a scene's layers, joints, base and drive for each package, and the exact layers as a solver.

In come scenes with a column; those with a block are in the rooms above.
"""
