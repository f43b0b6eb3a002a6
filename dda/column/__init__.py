"""Columns of blocks as wave guides: displacement along one axis, which strains each block uniformly.

In come layers, joints, base and drive as numbers; scenes and pulses do not.
"""
