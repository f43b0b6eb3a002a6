"""Damping of DDA, finite elements and bar in every scene of the core study: compared, and judged by gates.

A derived row `damping` of each case holds, for every solver, the distance of its one-step operator from the scheme's
closed form at the operator's own frequency, and that of the ratio measured on its history from the operator's.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from validation.engine.finished import Derived, Finished
from validation.gates.gate import Gate
from validation.runs.case_name import scene_of
from validation.runs.row import Row, Value
from validation.scenes.scene import Scene
from validation.studies.bands import OWN, about, cases, gate
from validation.theory import spectra

NAME = "damping"
READS = tuple(f"mode1.{part}" for part in ("frequency", "spectral_radius", "damping", "measured_damping"))
SOLVERS = ("dda", "fem", "bar")
UNDAMPED = 1e-12
# Damping ratio of DDA over that of the elements, minus one, where no closed form holds: case -> (value, half band).
RATIOS = {
    "poisson": (0.0467, 1e-4),
    "poisson-statics[contact.stiffness=1e+09]": (0.0475, 2e-4),
    "poisson-statics[contact.stiffness=1e+10]": (0.0973, 2e-4),
    "poisson-statics[contact.stiffness=1e+11]": (0.1078, 2e-4),
    "corner-springs[fem.elements=4]": (0.5084, 5e-4),
    "corner-springs[fem.elements=8]": (0.6810, 5e-4),
    "corner-springs[fem.elements=16]": (0.8308, 5e-4),
    "corner-springs[fem.elements=32]": (0.9660, 5e-4),
    "corner-springs[fem.elements=64]": (1.0908, 5e-4),
}


def solvers(scene: Scene) -> list[str]:
    """Return the solvers of a scene whose damping is compared."""
    bar = scene.block.poisson == 0 and scene.fem.foundation == "distributed"
    return [name for name in SOLVERS if name in scene.run.solvers and (bar or name != "bar")]


def derived(scenes: tuple[str, ...]) -> tuple[Derived, ...]:
    """Return the derived row of every case."""
    rows = []
    for scene in cases(*scenes):
        needs = tuple((scene.name, solver) for solver in solvers(scene))
        rows.append(Derived(scene.name, NAME, needs, functools.partial(compare, scene=scene), READS))
    return tuple(rows)


def compare(finished: Finished, scene: Scene) -> Mapping[str, Value]:
    """Return the distances of every solver, and the largest of each kind."""
    rows = {solver: finished.rows[scene.name, solver] for solver in solvers(scene)}
    operator = {f"{solver}.operator": operator_distance(scene, row) for solver, row in rows.items()}
    history = {f"{solver}.history": history_distance(row) for solver, row in rows.items()}
    return operator | history | {"operator": _worst(operator), "history": _worst(history)}


def _worst(values: Mapping[str, Value]) -> Value:
    """Return the largest value, or the first that is none."""
    missing = [value for value in values.values() if not isinstance(value, float)]
    return missing[0] if missing else max(v for v in values.values() if isinstance(v, float))


def operator_distance(scene: Scene, row: Row) -> Value:
    """Distance of spectral radius and damping ratio of the first axial mode from the closed form at its frequency."""
    w, radius, xi = (row.metrics.get(f"mode1.{part}") for part in ("frequency", "spectral_radius", "damping"))
    if not (isinstance(w, float) and isinstance(radius, float)):
        return "not reported"
    exact = spectra.roots(scene, w)
    distance = abs(radius - max(map(abs, exact)))
    if abs(exact[0].imag) < 1e-6:
        return distance
    return max(distance, abs(xi - spectra.damping_ratio(scene, w))) if isinstance(xi, float) else "undefined"


def history_distance(row: Row) -> Value:
    """Distance of the damping ratio measured on the history from the operator's."""
    measured = row.metrics.get("mode1.measured_damping")
    xi = row.metrics.get("mode1.damping")
    return abs(measured - xi) if isinstance(measured, float) and isinstance(xi, float) else "undefined"


def gates(scenes: tuple[str, ...]) -> Iterator[Gate]:
    """Yield three gates a case: operator, history, and DDA against the elements."""
    operator = (
        "|lambda| and xi of each solver's own step against trace and determinant at its frequency; band: rounding"
    )
    history = "matrix pencil on each solver's displacement against its operator: the histories hold the mode to 1e-6"
    for scene in cases(*scenes):
        yield gate(scene, NAME, "operator", (0, 1e-12), operator)
        yield gate(scene, NAME, "history", (0, 1e-6), history)
        yield from ratio(scene)


def ratio(scene: Scene) -> Iterator[Gate]:
    """Yield the gate on the damping ratio of DDA over that of the elements, where they are damped."""
    pair = ("dda", "fem")
    metric = "mode1.damping"
    name = scene.name if scene.name in RATIOS else scene_of(scene.name)
    if name in RATIOS:
        value, half = RATIOS[name]
        why = "the mesh has no limit on point springs" if name.startswith("corner") else "the mesh error is below"
        reason = (
            "model form, physics: under (1/2, 1), w dt below 3.27, a stiffer block is damped more at the same dt; own "
            f"value, {why}"
        )
        yield gate(scene, pair, metric, about(value, half), reason, OWN, half)
        return
    frequency = spectra.bar_frequency(scene)
    error = spectra.mesh_frequency_error(scene)
    dda = spectra.damping_ratio(scene, spectra.dda_frequency(scene))
    fem = spectra.damping_ratio(scene, frequency * (1 + error))
    if min(abs(dda), abs(fem)) < UNDAMPED:
        return
    why = "model form, physics: closed form at the two first frequencies; band: the mesh's frequency error"
    yield gate(scene, pair, metric, about(dda / fem - 1, 1e-9 + error), why)
