"""Contact between a block and its base.

Springs and their directions.
"""
