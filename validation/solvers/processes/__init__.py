"""Processes in which other code runs: a worker that is asked, the one of users' solvers.

No scene is read here but by the worker of users' solvers.
"""
