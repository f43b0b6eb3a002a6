"""Columns whose contacts open or slip: known numbers, orders, solves of the open-close iteration, spalls and slips.

In come finished cases; no solver is called.
"""
