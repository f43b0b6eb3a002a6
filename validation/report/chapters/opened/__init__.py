"""Chapters of contact that opens: what steps and springs make of it, the benchmarks of others, blocks that turn.

A chapter here reads rows and the data of its study; no solver is called.
"""
