"""Histories of a mesh: stepped, or in a small space.

One factorisation serves a whole run.
"""
