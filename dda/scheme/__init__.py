"""The Newmark scheme: one step, its closed spectral forms, many steps at once.

No block comes in.
"""
