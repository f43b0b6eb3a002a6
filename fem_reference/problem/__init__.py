"""What is solved and what comes out: problem, scheme, motion of the base, result.

No mesh comes in.
"""
