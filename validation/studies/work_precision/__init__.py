"""Error against run time and work.

Points, fronts, orders and the committed record.
"""
