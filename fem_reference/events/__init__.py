"""Exact motions with contact that opens and closes, from switch to switch.

The block of one strain and the bar on springs that carry no tension; no mesh and no time step come in.
"""
