"""Histories of blocks with friction, judged by the forces that their motion shows.

No motion is computed and compared: within some hundred steps stick and slip fall apart in two programs that agree to
the third digit. In come `fits`, `reading`, `causes` and `gates`.
"""
