"""Adapters of blocks of the package `dda` on contact that opens and slides: in small motion, and turning about.

`validation.solvers.dda` chooses among them.
"""
