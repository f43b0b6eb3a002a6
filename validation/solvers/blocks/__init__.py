"""Adapters of blocks of the package `dda` on contact that opens and slides: in small motion, and turning about.

They take scenes with a block on a unilateral contact; `validation.solvers.dda` chooses among them.
"""
