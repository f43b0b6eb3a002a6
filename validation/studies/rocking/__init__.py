"""Blocks that turn by any angle, against rigid ones.

Rocking and toppling: declarations, and what is read from their histories.
"""
