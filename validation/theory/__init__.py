"""Closed forms of the models: statics, spectra, waves, contact, friction, rocking; written apart from all solvers.

Gates derive their bands from them, advice and report their numbers. Nothing that runs, measures or judges comes in.
"""
