"""The study of methods: time schemes and contact methods that are proposed as cures, on the same scenes.

Declarations, printed numbers and what is derived from the runs.
"""
