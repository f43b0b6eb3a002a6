"""One block of one strain on contact springs.

Its equations, modes and histories.
"""
