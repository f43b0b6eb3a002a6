"""Chapters of the paper's block on its locked springs: its scenes, and two finite-element codes on them.

A chapter here reads rows and histories of its study; no solver is called.
"""
