"""How a history on contact that opens is made: one step of any body, the loop over steps, and the balance of energy.

Of whatever stands on the contacts: one block, its sub-blocks, a block that turns, a column.
"""
