"""The paper's block unlocked: exact motions against an independent program's numbers, DDA and elements against them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.runs.history import History
from validation.runs.row import Metrics
from validation.scenes.scene import Scene
from validation.suite.bands import convergence

SCENE = "unlocked"
INSTANTS = (3, 6, 9)  # wave transits a / c


def samples(case: Scene, history: History) -> Metrics:
    """Return displacement and contact pressure at the instants."""
    values = {}
    for n in INSTANTS:
        values[f"displacement.{n}"] = float(history.displacement[n - 1])
        values[f"pressure.{n}"] = float(history.contact_pressure[n - 1])
    return values


def front(case: Scene) -> float:
    """Return the pressure that a front can bring in a few ulps of the last instant [Pa].

    It changes by at most 2 q in a time 1 / kappa, kappa = 2 p / (a rho c) [1/s].
    """
    b = case.block
    kappa = 2 * case.contact.stiffness / (b.base_length * math.sqrt(b.young * b.density))
    return 4 * math.ulp(case.time.duration) * 2 * case.load.pressure * kappa


def order_in_mesh(runs: Sequence[tuple[Scene, History, History]]) -> Metrics:
    """Return the order in h of elements against the exact bar."""
    return convergence(runs, "fem.elements")
