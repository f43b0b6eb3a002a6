"""The pressed block on a dashpot or on a rigid contact, in the numbers of mpmath: phases and events, without balls.

Both corners do the same. The unknowns are (v, ex, ey) of the centroid and what is linear in them,

    gap w = v - (h/2) ey + g0,    T = m (v'^2 + a^2 ex'^2/12 + h^2 ey'^2/12)/2,    U = a h (ex, ey) C (ex, ey)/2

and the phases are stepped by matrix exponentials on a grid in time, on which events are looked for by their signs.
"""

import numpy as np
from numpy.typing import NDArray
from oracles.block_oracle import Integrated


class IntegratedDashpots(Integrated):
    """Two corners with dashpots that do what they please, by DOP853 with events; forces of its own states."""

    def run_laws(self, states: list[str], end: float) -> tuple[list[tuple[float, str]], NDArray[np.float64]]:
        from scipy.integrate import solve_ivp

        q = self.problem
        y, t = np.zeros(12), 0.0
        y[7] = q.velocity
        events: list[tuple[float, str]] = []

        def law(y: NDArray[np.float64], c: int) -> float:
            rate = float(self.corners[c][1] @ y[6:])
            return -(q.stiffness * self.gap(y[:6], c) + q.damping * rate)

        def rate(_t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
            force = self.F - self.K0 @ y[:6]
            for c in (0, 1):
                if states[c] == "pressed":
                    force = force + law(y, c) * self.corners[c][1]
            return np.concatenate([y[6:], np.linalg.solve(self.M, force)])

        def watch(function, sign: int):
            def event(_t: float, y: NDArray[np.float64]) -> float:
                return sign * function(y)

            event.terminal = True
            event.direction = -1
            return event

        while t < end:
            watched = []
            for c in (0, 1):

                def gap(y, c=c):
                    return self.gap(y[:6], c)

                def force(y, c=c):
                    return law(y, c)

                if states[c] == "open":
                    watched.append((c, "pressed", watch(gap, 1)))
                elif states[c] == "pressed":
                    watched.append((c, "released", watch(force, 1)))
                else:
                    watched.append((c, "open", watch(gap, -1)))
                    watched.append((c, "pressed", watch(force, -1)))
            functions = [event for _, _, event in watched]
            step = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-16, "events": functions}
            done = solve_ivp(rate, (t, end), y, **step)
            t, y = float(done.t[-1]), done.y[:, -1]
            for (c, following, _), times in zip(watched, done.t_events, strict=True):
                if len(times):
                    if {states[c], following} != {"open", "released"}:
                        events.append((t, "MN"[c] + (" opens" if following == "released" else " closes")))
                    states[c] = following
        return events, y
