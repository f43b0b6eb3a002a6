"""Exact motions with contact that opens, closes, sticks and slips, from switch to switch.

The block of one strain and the column of blocks, by one engine (`march`), and bars by characteristics (`bars_march`);
no mesh and no time step come in.
"""
