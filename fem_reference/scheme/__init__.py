"""The elements' own Newmark scheme, its spectrum, modes and diagnostics.

Nothing of `dda` comes in.
"""
