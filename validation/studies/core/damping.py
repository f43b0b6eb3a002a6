"""Damping of DDA, finite elements and bar in every scene of the core study.

A derived row `damping` of each case holds, for every solver, the distance of its one-step operator from the scheme's
closed form at the operator's own frequency, and that of the ratio measured on its history from the operator's.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator

from validation.engine.finished import Derived, DerivedRows, Finished
from validation.runs.beside import table_beside
from validation.runs.row import Metrics, Row, Value
from validation.scenes.scene import Scene
from validation.suite.bands import Band, about, cases
from validation.theory import spectra

NAME = "damping"
READS = tuple(f"mode1.{part}" for part in ("frequency", "spectral_radius", "damping", "measured_damping"))
SOLVERS = ("dda", "fem", "bar")
UNDAMPED = 1e-12


def compared_cases() -> Iterator[Scene]:
    """Return the cases of the study."""
    return cases(*table_beside(__file__, "study.toml")["study"]["scenes"])


def solvers(scene: Scene) -> list[str]:
    """Return the solvers whose damping is compared."""
    bar = scene.block.poisson == 0 and scene.fem.foundation == "distributed"
    return [name for name in SOLVERS if name in scene.run.solvers and (bar or name != "bar")]


def derived() -> DerivedRows:
    """Return the derived row of every case."""
    rows = []
    for scene in compared_cases():
        needs = tuple((scene.name, solver) for solver in solvers(scene))
        rows.append(Derived(scene.name, NAME, needs, functools.partial(compare, scene=scene), READS))
    return tuple(rows)


def compare(finished: Finished, scene: Scene) -> Metrics:
    """Return the distances of all solvers, and the largest of each kind."""
    rows = {solver: finished.rows[scene.name, solver] for solver in solvers(scene)}
    operator = {f"{solver}.operator": operator_distance(scene, row) for solver, row in rows.items()}
    history = {f"{solver}.history": history_distance(row) for solver, row in rows.items()}
    return operator | history | {"operator": _worst(operator), "history": _worst(history)}


def _worst(values: Metrics) -> Value:
    """Return the largest value, or the first that is none."""
    missing = [value for value in values.values() if not isinstance(value, float)]
    return missing[0] if missing else max(v for v in values.values() if isinstance(v, float))


def operator_distance(scene: Scene, row: Row) -> Value:
    """Distance of the first mode's spectral radius and damping ratio from the closed form at its frequency."""
    w, radius, xi = (row.metrics.get(f"mode1.{part}") for part in ("frequency", "spectral_radius", "damping"))
    if not (isinstance(w, float) and isinstance(radius, float)):
        return "not reported"
    exact = spectra.roots(scene, w)
    distance = abs(radius - max(map(abs, exact)))
    if abs(exact[0].imag) < 1e-6:
        return distance
    return max(distance, abs(xi - spectra.damping_ratio(scene, w))) if isinstance(xi, float) else "undefined"


def history_distance(row: Row) -> Value:
    """Distance of the history's damping ratio from the operator's."""
    measured = row.metrics.get("mode1.measured_damping")
    xi = row.metrics.get("mode1.damping")
    return abs(measured - xi) if isinstance(measured, float) and isinstance(xi, float) else "undefined"


def ratio(case: Scene) -> Band | None:
    """Damping ratio of DDA over that of the elements less one, where both are damped."""
    frequency = spectra.bar_frequency(case)
    error = spectra.mesh_frequency_error(case)
    dda = spectra.damping_ratio(case, spectra.dda_frequency(case))
    fem = spectra.damping_ratio(case, frequency * (1 + error))
    if min(abs(dda), abs(fem)) < UNDAMPED:
        return None
    return about(dda / fem - 1, 1e-9 + error)
