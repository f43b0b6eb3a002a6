"""References in sixty-digit arithmetic.

They share no step with the solvers that they judge.
"""
