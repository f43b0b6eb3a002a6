"""The contract of a solver, the registry, and one adapter for each solver.

The only room that knows `dda` and `fem_reference` as models.
"""
