"""Exact solutions: the bar under the Newmark scheme and in continuous time.

No mesh comes in.
"""
