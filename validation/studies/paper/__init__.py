"""The paper's figures and the register of its statements.

Claims are data with a measure and bands.
"""
