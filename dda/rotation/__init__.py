"""One block that turns by any angle over a plane base.

Outline, contact points and directions are taken anew at every step.
"""
