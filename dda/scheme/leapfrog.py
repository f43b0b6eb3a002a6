r"""The leapfrog, which explicit DDA steps with: velocities half a step behind the displacements.

    v_(n+1/2) = gg v_(n-1/2) + dt a_n,        x_(n+1) = x_n + dt v_(n+1/2),

the first half step from the velocity at t = 0 with a_0 / 2. No equation is solved; it is stable to
(w dt)^2 = 2 (1 + gg), and of second order at gg = 1.
"""

from __future__ import annotations

from dda.scheme.stage import Stage, Table


def leapfrog() -> Table:
    """Return its only stage."""
    return Table((Stage(0.0, 0.0, e_0=1.0, g_0=1.0),), lag=0.5)
