"""Meshes, matrices and fields by scikit-fem and meshio.

No time comes in.
"""
