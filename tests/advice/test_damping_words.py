"""What `advise damping` says as plain data, with every number computed apart."""

from dataclasses import replace

import numpy as np

from validation.advice.spectra import ModeDamping, runs


def frequencies():
    """Both axial frequencies of the 2 m block at p = E = 1e9, from (v, ey)."""
    stiffness = np.array([[2e9, -2e9], [-2e9, 4e9 + 2e9]])
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(np.diag([10800.0, 3600.0]), stiffness)).real))


def test_what_has_no_damping_ratio_of_its_own_is_not_split():
    """At gg < 1 a mode may oscillate that without the discount has a root that is not positive."""
    mode = ModeDamping("contact", 1e3, 0.4, 0.6, 2.0, None, None, 0.1, -0.2)
    assert runs(mode) == "is damped at 40 % of critical, kinetic and algorithmic"
    assert runs(replace(mode, algorithmic=0.1, kinetic=0.3)).endswith("10 % algorithmic and 30 % kinetic")
    assert runs(replace(mode, algorithmic=0.4, kinetic=0.0)).endswith("all of it algorithmic")
