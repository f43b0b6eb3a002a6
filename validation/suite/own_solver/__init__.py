"""A user's own solver in the place of `dda`: the gates that apply to it, how it is judged, and what is told at the end.

`validation.test_gates` runs one test a gate; `validation.entry.plugin` prints the block after the last one.
"""
