"""Error against run time and work.

Points, fronts and orders.
"""
