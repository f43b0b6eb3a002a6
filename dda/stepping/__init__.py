"""How a history on contact that opens is made: steps, cut where they must be, and what is kept of them.

Of whatever stands on the contacts: one block, its sub-blocks, a block that turns.
"""
