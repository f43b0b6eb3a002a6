"""Systems of glued blocks.

Joint forces are unknowns of their own.
"""
