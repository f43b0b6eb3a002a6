"""Figures: the only room that imports matplotlib.

Functions of arrays; no results directory comes in.
"""
