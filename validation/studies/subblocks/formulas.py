"""The study of sub-blocks: what cutting into glued sub-blocks buys, and how rocking differs by model."""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from validation.metrics.values import or_nan
from validation.runs.row import Metrics, Row
from validation.scenes.scene import Scene
from validation.suite.bands import Band, near
from validation.theory import spectra, statics


def linear_elements(case: Scene) -> Band:
    """Return the relative error of the first frequency of linear elements, to a tenth."""
    error = spectra.mesh_frequency_error(case)
    return 0.9 * error, 1.1 * error


def glued_column(case: Scene) -> Band:
    """Return the static v of the centroid of a glued column, mu = 0 [m]: block on springs, and its joints."""
    width, _ = statics.size(case)
    _, n = case.block.cuts
    joint = 1 / (2 * case.block.glue_ratio * case.block.young)
    value = statics.static_displacement(case) - (n - 1) / 2 * joint * case.load.pressure * width
    return near(value, 1e4 * spectra.EPS)


def linear_error(case: Scene) -> float:
    """Return (b/n)^2 / 24 of linear elements at n = 32."""
    wave: float = spectra.bar_frequency(case) / (case.block.young / case.block.density) ** 0.5 * statics.size(case)[1]
    return (wave / 32) ** 2 / 24


def rocking_frequency(case: Scene) -> Band:
    """Return the lowest frequency of a DDA square at mu = 0 that turns and shears [rad/s].

    (17): M = rho diag(a^2, a^4/6, a^4/24); (27): p [[2, a, -a/2], [a, a^2, 0], [-a/2, 0, a^2/4]], and A G for gxy.
    """
    a = statics.size(case)[0]
    M = case.block.density * np.diag([a**2, a**4 / 6, a**4 / 24])
    K = case.contact.stiffness * np.array([[2.0, a, -a / 2], [a, a * a, 0.0], [-a / 2, 0.0, a * a / 4]])
    K[2, 2] += a * a * case.block.young / 2
    return near(float(np.sqrt(eigh(K, M, eigvals_only=True)[0])), 1e-12)


def cut(case: Scene) -> Metrics:
    """Return the number of sub-blocks on each other, and the width of patches that carry elements [m]."""
    _, n = case.block.cuts
    return {"n": n, "patch": case.fem.patch_width or case.block.base_length}


def apart(case: Scene, dda: Row, fem: Row) -> Metrics:
    """Return the first frequency of DDA over that of elements, less one."""
    first, second = (or_nan(row.metrics.get("mode1.frequency")) for row in (dda, fem))
    return {"first frequency": first / second - 1}
