"""The study `stiff-contact`: constant acceleration lets a stiff contact ring, (9/16, 1) does not.

Far above w dt = 4 one root of constant acceleration tends to -1, |lambda| = 1 - 8 / (w dt)^2, so that a stiff contact
changes sign every step and is hardly damped; with alpha = 9/16 = (1/2 + delta)^2 / 4 both roots tend to -1/3.
"""

from __future__ import annotations

from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import Band, about
from validation.theory import spectra


def contact_root(case: Scene) -> Band:
    """Return the spectral radius of the contact mode, to the rounding of a root near -1."""
    return about(spectra.spectral_radius(case, spectra.contact_frequency(case)), 1e-11)


def springs(case: Scene) -> Metrics:
    """Return p/E."""
    return {"p/E": case.contact.stiffness / case.block.young}
