"""Blocks, materials, outlines and loads.

No contact and no time come in.
"""
