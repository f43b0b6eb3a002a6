"""Exact motions with contact that opens, closes, sticks and slips, from switch to switch.

The block of one strain with friction and the bar on springs that carry no tension; no mesh and no time step come in.
"""
