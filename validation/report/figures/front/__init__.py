"""Figures of the first pages: the model drawn, and charts of a few named curves.

Functions of arrays and words; no results directory comes in.
"""
