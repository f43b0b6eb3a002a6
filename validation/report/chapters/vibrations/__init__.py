"""Chapters of steady vibrations, which no step is run for.

A chapter here reads rows and the data of its study; no solver is called.
"""
