"""Studies of contact that opens: what steps and springs make of a landing, published impacts, and their pack.

Declarations and what they derive come in; the exact motions against an independent program are `studies.opening`.
"""
