"""Histories of blocks with friction: the same as the suite's own run of the scene, or judged by their forces.

Motions are compared only to say that they are the same: within some hundred steps stick and slip fall apart in two
programs that agree to the third digit. In come `fits`, `reading`, `causes` and `gates`, and the suite's solver.
"""
