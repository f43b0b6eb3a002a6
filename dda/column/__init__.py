"""Columns of blocks, bonded or on contacts that open or slip: displacement along one axis, one strain a block.

In come layers, joints, base and drive as numbers; scenes and pulses do not.
"""
