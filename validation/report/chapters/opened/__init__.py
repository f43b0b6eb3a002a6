"""Chapters of contact that opens: what steps and springs make of it, and the benchmarks of others.

A chapter here reads rows and the data of its study; no solver is called.
"""
