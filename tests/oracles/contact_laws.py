"""The pressed block on a dashpot or on a rigid contact, in the numbers of mpmath: phases and events, without balls.

Both corners do the same. The unknowns are (v, ex, ey) of the centroid and what is linear in them,

    gap w = v - (h/2) ey + g0,    T = m (v'^2 + a^2 ex'^2/12 + h^2 ey'^2/12)/2,    U = a h (ex, ey) C (ex, ey)/2

and the phases are stepped by matrix exponentials on a grid in time, on which events are looked for by their signs.
"""

from dataclasses import dataclass, field

import mpmath as mp
import numpy as np
from numpy.typing import NDArray
from oracles.block_oracle import Integrated

from fem_reference.events.block_model import BlockProblem

FINEST = mp.mpf("1e-22")


@dataclass
class Answer:
    """What happened until the end."""

    events: list[tuple[float, str]] = field(default_factory=list)
    impulses: list[float] = field(default_factory=list)
    displacement: float = 0.0  # v at the end [m]
    velocity: float = 0.0


class PhasedBlock:
    """Phases "open", "pressed", "released" and, on a rigid contact, "open" and "resting"."""

    def __init__(self, problem: BlockProblem, grid: int = 60) -> None:
        self.problem = q = problem
        a, h, E, mu = (mp.mpf(x) for x in (q.width, q.height, q.young, q.poisson))
        m = mp.mpf(q.density) * a * h
        if q.hypothesis == "plane strain":
            E, mu = E / (1 - mu**2), mu / (1 - mu)
        direct = E / (1 - mu**2)
        self.mass = mp.diag([m, m * a**2 / 12, m * h**2 / 12])
        self.K = a * h * direct * mp.matrix([[0, 0, 0], [0, 1, mu], [0, mu, 1]])
        self.n = mp.matrix([[1, 0, -h / 2]])
        load = mp.mpf(q.pressure) * a
        self.F = mp.matrix([-load - m * mp.mpf(q.gravity), 0, -load * h / 2])
        self.compliance = (self.n * self.mass**-1 * self.n.T)[0]
        self.grid = mp.mpf(1) / mp.mpf(grid) * mp.sqrt(h**2 * q.density / E)
        self.steps: dict[str, mp.matrix] = {}
        self.generators = {phase: self.generator(phase) for phase in ("open", "pressed", "released", "resting")}

    @property
    def rigid(self) -> bool:
        return self.problem.restitution is not None

    def generator(self, phase: str) -> mp.matrix:
        W = self.mass**-1
        force = mp.zeros(3, 7)
        force[:, 0:3] = -self.K
        force[:, 6] = self.F
        if phase == "pressed" and not self.rigid:
            p, c = 2 * mp.mpf(self.problem.stiffness), 2 * mp.mpf(self.problem.damping)
            force[:, 0:3] -= p * self.n.T * self.n
            force[:, 3:6] -= c * self.n.T * self.n
            force[:, 6] -= p * self.n.T * mp.mpf(self.problem.gap)
        if phase == "resting":
            force -= self.n.T * (self.n * W * force) / self.compliance
        G = mp.zeros(7, 7)
        G[0:3, 3:6] = mp.eye(3)
        G[3:6, :] = W * force
        return G

    def gap(self, y: mp.matrix) -> mp.mpf:
        return (self.n * y[0:3, 0])[0] + mp.mpf(self.problem.gap)

    def gap_rate(self, y: mp.matrix) -> mp.mpf:
        return (self.n * y[3:6, 0])[0]

    def gap_acceleration(self, y: mp.matrix) -> mp.mpf:
        return (self.n * (self.generators["open"] * y)[3:6, 0])[0]

    def force(self, y: mp.matrix) -> mp.mpf:
        """The force that spring and dashpot, or the rigid stop, would need."""
        if self.rigid:
            return -self.gap_acceleration(y) / self.compliance
        q = self.problem
        return -2 * (mp.mpf(q.stiffness) * self.gap(y) + mp.mpf(q.damping) * self.gap_rate(y))

    def ends(self, phase: str, y: mp.matrix) -> tuple[mp.mpf, ...]:
        """What is positive as long as the phase lasts."""
        if phase == "open":
            return (self.gap(y),)
        if phase == "released":
            return (-self.gap(y), -self.force(y))
        return (self.force(y),)

    def moved(self, phase: str, y: mp.matrix, time: mp.mpf) -> mp.matrix:
        if time == self.grid:
            if phase not in self.steps:
                self.steps[phase] = mp.expm(self.generators[phase] * time)
            return self.steps[phase] * y
        # a power series, since times shorter than the grid are few radians
        term = y
        total = y.copy()
        for k in range(1, 60):
            term = self.generators[phase] * term * (time / k)
            total += term
            if mp.norm(term, 1) < mp.mpf(10) ** (-mp.mp.dps - 3) * mp.norm(total, 1):
                break
        return total

    def crossing(self, phase: str, y: mp.matrix, high: mp.mpf, which: int) -> mp.mpf:
        """Where one of the functions falls through zero within a time, by the Illinois rule."""

        def value(s: mp.mpf) -> mp.mpf:
            return self.ends(phase, self.moved(phase, y, s))[which]

        low = high
        below = value(high)
        while below <= 0:  # the function may be zero at the start
            high, last = low, below
            low /= 2
            below = value(low)
        above = last
        for _ in range(100):
            middle = (low * above - high * below) / (above - below)
            here = value(middle)
            if here == 0 or high - low < mp.mpf(10) ** (4 - mp.mp.dps) * high:
                break
            if here > 0:
                low, below = middle, here
                above /= 2
            else:
                high, above = middle, here
                below /= 2
        return middle

    def run(self, end: float, most: int = 10_000) -> Answer:
        q = self.problem
        y = mp.matrix([0, 0, 0, q.velocity, 0, 0, 1])
        time = mp.mpf(0)
        answer = Answer()
        phase = self.next_phase("open", y) if self.gap(y) == 0 else "open"
        while time < end and len(answer.events) < most:
            step = min(self.grid, mp.mpf(end) - time)
            # the first bit of a flight is short: it may end within the grid
            flight = -2 * self.gap_rate(y) / self.gap_acceleration(y) if self.gap_acceleration(y) < 0 else self.grid
            if phase == "open" and abs(self.gap(y)) < FINEST and 0 < flight < self.grid:
                step = min(step, flight * mp.mpf("0.7"))
            later = self.moved(phase, y, step)
            falls = [i for i, value in enumerate(self.ends(phase, later)) if value < 0]
            if not falls:
                time, y = time + step, later
                continue
            first = min((self.crossing(phase, y, step, i), i) for i in falls)[0]
            time, y = time + first, self.moved(phase, y, first)
            if self.rigid and phase == "open":
                approach = -self.gap_rate(y)
                impulse = (1 + mp.mpf(q.restitution)) * approach / self.compliance
                y[3:6, 0] += self.mass**-1 * self.n.T * impulse
                answer.impulses.append(float(impulse))
                answer.events.append((float(time), "impact"))
                phase = self.next_phase("landed", y)
            else:
                following = self.next_phase(phase, y)
                if {phase, following} != {"open", "released"}:
                    answer.events.append((float(time), "opens" if following in ("open", "released") else "closes"))
                phase = following
        answer.displacement, answer.velocity = float(y[0]), float(y[3])
        return answer

    def next_phase(self, phase: str, y: mp.matrix) -> str:
        if phase == "landed":
            if self.problem.restitution > 0:
                return "open"
            return "resting" if self.force(y) > 0 else "open"
        if self.rigid:
            return "resting" if phase == "open" and self.force(y) > 0 else "open"
        if phase == "pressed":
            return "released" if self.problem.damping else "open"
        if phase == "released":
            return "open" if self.gap_rate(y) > 0 and abs(self.gap(y)) < FINEST else "pressed"
        # a block that touches at rest goes the way of its acceleration
        return "pressed" if self.gap_rate(y) < 0 or self.gap_acceleration(y) < 0 else "open"


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
