"""Contact between a block and its base: springs, laws, and the states that a step ends with.

Nothing here knows a block: gaps, ways along the base and the flexibility of a step come in from outside.
Locked springs (`springs`, of a block's edge) aside, what may come in is a law, its iteration, or a rule of others.
"""
