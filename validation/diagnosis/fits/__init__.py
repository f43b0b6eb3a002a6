"""Variants of a scene beside a history: what they compute, what may remain, and the fit of their numbers.

Scenes, histories and the stepping of `dda` come in; causes and words do not.
"""
