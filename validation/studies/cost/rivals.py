"""What a user writes instead: a plain loop over the steps of one strain, and modes with a compiled filter.

Both are solvers of this study alone, of a block whose motion is that of a column.
"""

from __future__ import annotations

import math
from time import perf_counter
from typing import Any

import numpy as np
from scipy.optimize import brentq

from validation.runs.history import Array, History
from validation.runs.run import Outcome, Run
from validation.scenes import features
from validation.scenes.scene import Scene
from validation.solvers.contract import Solver

MOST_SOLVES = 6  # of a step: the contact is closed or open


def run_of(scene: Scene, displacement: Array, pressure: Array, work: dict[str, int], began: float, built: float) -> Run:
    """Return the run of two columns; its set-up began and ended at two instants [s]."""
    columns = {"displacement": displacement, "contact_pressure": pressure}
    time = np.arange(1, scene.time.steps + 1, dtype=np.float64) * scene.time.step
    history = History(time, columns)
    seconds = {"setup": built - began, "stepping": perf_counter() - built}
    return Run(Outcome.COMPLETED, history, work, seconds)


class ColumnSolver(Solver):
    """A solver of a rectangular block whose motion depends on the height alone."""

    name = "rival"
    sections = ("damping", "fem", "time", "run")
    sources = (__name__,)
    own_columns = ("displacement", "contact_pressure")

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the motion does not depend on the height alone."""
        if scene.block.poisson != 0 or scene.block.rectangle is None:
            return "it takes an upright rectangle with Poisson's ratio 0"
        return None


class PlainLoop(ColumnSolver):
    """Newmark's scheme for one strain in a loop, the contact closed or open by trial."""

    name = "validation.studies.cost.rivals:PlainLoop"
    handles = frozenset({features.UNILATERAL, features.WEIGHT})

    def solve(self, scene: Scene, full: bool = False, fields: object = None) -> Run:
        """Run the scene."""
        began = perf_counter()
        width, height = scene.block.rectangle or (0.0, 0.0)
        b = scene.block
        t = scene.time
        dt = t.step
        M = b.mass * np.diag([1.0, height**2 / 12])
        elastic = np.diag([0.0, b.young * width * height])
        base = np.array([1.0, -height / 2])
        k = 2 * scene.contact.stiffness
        f: Array = -scene.load.pressure * width * np.array([1.0, height / 2])
        f[0] -= b.mass * scene.load.gravity
        can_open = scene.contact.law == "unilateral"
        D: Array = np.zeros(2)
        V: Array = np.array([b.velocity, 0.0])
        is_closed = not can_open or scene.contact.gap == 0
        A: Array = np.zeros(2)
        if t.start == "consistent":
            A = f / np.diag(M)
        inverses: dict[bool, Any] = {}
        for closed in (False, True):
            inverses[closed] = np.linalg.inv(M + t.alpha * dt**2 * (elastic + closed * k * np.outer(base, base)))
        built = perf_counter()
        displacement = np.zeros(t.steps)
        pressure = np.zeros(t.steps)
        solves = 0
        for n in range(t.steps):
            V = t.discount * V
            ahead = D + dt * V + (0.5 - t.alpha) * dt**2 * A
            for _ in range(MOST_SOLVES):
                spring = k * (base @ ahead + scene.contact.gap) * base if is_closed else 0.0
                A_next = inverses[is_closed] @ (f - elastic @ ahead - spring)
                D_next = ahead + t.alpha * dt**2 * A_next
                gap = float(base @ D_next) + scene.contact.gap
                solves += 1
                if not can_open or is_closed == (gap < 0):
                    break
                is_closed = gap < 0
            V = V + (1 - t.delta) * dt * A + t.delta * dt * A_next
            D = D_next
            A = A_next
            displacement[n] = D[0]
            pressure[n] = -k * gap / width if is_closed else 0.0
        work = {"unknowns": 2, "factorisations": 2, "solves": solves, "steps": t.steps}
        return run_of(scene, displacement, pressure, work, began, built)


class ModalFilter(ColumnSolver):
    """The lowest modes of the bar on locked springs about its static answer, each a recursion by `lfilter`.

    With k = 2 p / W and lam tan(lam H) = k / E the modes are cos(lam (H - y)); from rest the distance of each from its
    static amplitude obeys y_{n+1} = 2 cos(w dt) y_n - y_{n-1}, exactly. There are ``fem.elements`` of them.
    """

    name = "validation.studies.cost.rivals:ModalFilter"
    handles = frozenset({features.WEIGHT})

    def applicable(self, scene: Scene) -> str | None:
        """Return None, or why the modes are not those of the scene."""
        if scene.time.discount != 1:
            return "its modes are undamped"
        return super().applicable(scene)

    def solve(self, scene: Scene, full: bool = False, fields: object = None) -> Run:
        """Run the scene."""
        from scipy.signal import lfilter  # takes half a second, which nobody else needs

        began = perf_counter()
        width, height = scene.block.rectangle or (0.0, 0.0)
        young = scene.block.young
        density = scene.block.density
        q = scene.load.pressure
        weight = density * scene.load.gravity
        k = 2 * scene.contact.stiffness / width
        roots = []
        for mode in range(scene.fem.per_side):
            low = mode * math.pi
            angle = brentq(lambda x: x * math.sin(x) - k * height / young * math.cos(x), low, low + math.pi / 2)
            roots.append(angle)
        angles = np.array(roots)
        frequencies = angles / height * math.sqrt(young / density)
        norms = density * height / 2 * (1 + np.sin(2 * angles) / (2 * angles))
        forces = -q - weight * height * np.sin(angles) / angles
        amplitudes = forces / (norms * frequencies**2)
        # the static answer: the springs carry all, the middle gives way to the pressure and to the weight above it
        settled = -(q + weight * height) / k
        middle = settled - q * height / (2 * young) - weight * height**2 * 3 / (8 * young)
        built = perf_counter()
        impulse = np.zeros(scene.time.steps + 1)
        impulse[0] = 1.0
        at_middle = np.full(scene.time.steps, middle)
        at_base = np.full(scene.time.steps, settled)
        for amplitude, w, angle in zip(amplitudes, frequencies, angles, strict=True):
            c = math.cos(w * scene.time.step)
            swing = amplitude * lfilter([1.0, -c], [1.0, -2 * c, 1.0], impulse)[1:]
            at_middle -= math.cos(angle / 2) * swing
            at_base -= math.cos(angle) * swing
        count = len(angles)
        work = {"unknowns": count, "factorisations": 0, "solves": count, "steps": scene.time.steps}
        return run_of(scene, at_middle, -k * at_base, work, began, built)
