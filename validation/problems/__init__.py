"""Problems for any program: a scene, its exact motion and the bands in which an answer to it passes.

What judges a history against an exact motion comes in here; what runs programs does not.
"""
