"""Layered columns under plane waves: line elements with interface springs, a dashpot below, and their own stepping.

In come layers, joints, base and drive as numbers; blocks and scenes do not. The exact solution is in `exact.layers`.
"""
