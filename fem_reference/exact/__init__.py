"""Exact solutions: references that no mesh, no time step and no solver tolerance limits.

Closed forms and event-driven motions come in; anything with a mesh or a time step stays out.
"""
