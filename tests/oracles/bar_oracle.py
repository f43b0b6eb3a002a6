"""Random bars on a no-tension spring, and an independent integration of their delay equation."""

from collections.abc import Callable

import numpy as np

from fem_reference.problem.bar import BarProblem


def random_problem(seed: int) -> BarProblem:
    rng = np.random.default_rng(seed)
    young = 1e9 * 10 ** rng.uniform(-1, 1)
    height, width = rng.uniform(0.5, 3.0, 2)
    speed = float(np.sqrt(young / 2500.0)) * 1e-3
    return BarProblem(
        height=height,
        width=width,
        density=rng.uniform(2000, 3000),
        young=young,
        base_stiffness=young * width / height * 10 ** rng.uniform(-1, 2),
        pressure=young * rng.uniform(-0.001, 0.01),
        gravity=rng.uniform(0, 20),
        gap=height * rng.uniform(0, 5e-3) * int(rng.integers(2)),
        velocity=speed * rng.uniform(-5, 2),
    )


class Delayed:
    """The same bar from its delay equation by DOP853, round trip by round trip, in m/s and travel times."""

    def __init__(self, bar: BarProblem) -> None:
        speed = float(np.sqrt(bar.young / bar.density))
        self.V, self.q = bar.velocity, bar.pressure / (bar.density * speed)
        self.b, self.gap = bar.gravity * bar.height / speed, bar.gap * speed / bar.height
        self.kappa = bar.base_stiffness * bar.height / (bar.young * bar.width)
        self.pieces: list[tuple[float, float, Callable[[float], float]]] = []
        self.switches: list[float] = []

    def down(self, t: float, begin: float) -> float:
        """Wave g' just after `begin` or later in the piece that begins there."""
        if begin < 1:
            return self.V / 2
        if begin < 2:
            return self.V / 2 - self.q
        for low, high, up in self.pieces:
            if low <= begin - 2 + 1e-12 < high:
                return up(t - 2) - self.q
        raise AssertionError((t, begin))

    def run(self, end: float) -> float:
        """Gap at the end."""
        breaks, t, w = [1.0, 2.0], 0.0, self.gap
        closed = not w and 2 * self.V / 2 <= 0
        while t < end - 1e-12:
            high = min([x for x in breaks if x > t + 1e-10] + [end])
            t, w, closed = self.piece(t, high, w, closed)
            breaks.append(self.pieces[-1][1] + 2)
        return w

    def piece(self, low: float, high: float, w: float, closed: bool) -> tuple[float, float, bool]:
        k = self.kappa if closed else 0.0

        from scipy.integrate import solve_ivp

        def rate(t, y):
            return [2 * self.down(t, low) - self.b * t - k * y[0]]

        def event(t, y):
            return y[0]

        event.terminal, event.direction = True, 1 if closed else -1
        done = solve_ivp(
            rate, (low, high), [w], method="DOP853", rtol=1e-12, atol=1e-15, events=event, dense_output=True
        )
        stop = float(done.t[-1])
        self.pieces.append((low, stop, lambda t: self.down(t, low) - k * float(done.sol(t)[0])))
        if len(done.t_events[0]):
            self.switches.append(stop)
            return stop, 0.0, not closed
        return stop, float(done.y[0, -1]), closed
