"""The step of a rule of impulses, apart from the solvers."""

import numpy as np

from validation.theory.rebound import Motion


def impact_steps(e, theta_method=0.5, gg=1.0):
    """Return the step of impulses with the restitution e (Moreau and Jean): v1 = -e u where x + u/2 <= 0 falls."""

    def advance(start):
        u = gg * start.v
        P = np.where(start.x + u / 2 <= 0, np.maximum(-(1 + e) * u, 0.0), 0.0)
        v = u + P
        return Motion(start.x + theta_method * v + (1 - theta_method) * u, v, 0 * u, P, P)

    return advance
