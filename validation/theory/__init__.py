"""Closed forms of the models: statics, spectra, waves, contact, friction, rocking.

They are written apart from all solvers, so that a slip in one cannot hide in its gate. Gates derive their bands from
them, advice and report their numbers.
"""
