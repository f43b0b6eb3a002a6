"""The report is built from a results directory alone, whatever the verdicts are."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

from validation.gates import Gate, Status, Verdict, judge
from validation.history import History, Outcome
from validation.results import Results, Row
from validation.scene import load_scene

CORE = ("figures-3-4", "figure-7", "figure-8", "poisson", "corner-springs")
FREQUENCY = {"dda": 344.561, "dda-textbook": 344.561, "fem": 327.683, "bar": 327.682, "continuum": 327.682}
CODE, MESH = 3.2e-13, 6.1e-9  # invented differences between solvers that agree
MATRIX = 0.0021  # s per halving of the mesh, for the drift


def synthetic(scene, solver):
    """Return a damped oscillation about the static value with the solver's frequency, as history and metrics."""
    time = scene.time.step * np.arange(1, scene.time.steps + 1)
    w = FREQUENCY[solver]
    xi = 0.0 if solver == "continuum" else min(0.3, 0.25 * w * scene.time.step)
    shape = 1 - np.exp(-xi * w * time) * np.cos(w * math.sqrt(1 - xi**2) * time)
    static = -0.010
    if scene.fem.foundation == "corner" and solver == "fem":
        static -= 0.005 * math.log2(scene.fem.per_side)
    scale = {"dda-textbook": 1 + CODE, "fem": 1 + MESH}.get(solver, 1.0)
    history = History(time, {"displacement": static * scale * shape, "contact_pressure": 5e6 * scale * shape})
    peak = {
        "displacement.peak": float(history.displacement.min()),
        "pressure.peak": float(history.contact_pressure.max()),
    }
    metrics = {
        "displacement.static": static,
        "pressure.static": 5e6,
        "pressure.minimum": -0.338e6,
        "displacement.settling_step": 44.0,
        "pressure.settling_step": "undefined",
        "mode1.frequency": w,
        "mode1.damping": xi,
        "mode1.numerical_frequency": w * (1 - xi),
        "mode1.spectral_radius": math.exp(-xi),
        "mode1.measured_damping": "not reported",
        "mode1.measured_frequency": w * (1 - xi),
        **peak,
    }
    return history, metrics


def l2(a, b):
    return float(np.linalg.norm(a - b) / np.linalg.norm(b))


def comparison(case, solver, reference, histories):
    a, b = histories[solver], histories[reference]
    metrics = {
        "displacement.l2": l2(a.displacement, b.displacement),
        "pressure.l2": l2(a.contact_pressure, b.contact_pressure),
    }
    return {"scene": case, "solver": solver, "reference": reference, "window": float(a.time[-1]), "metrics": metrics}


def write_study(results, study, scenes, gates=(), title="The paper's scenes"):
    """Fill a results directory as the engine does, with synthetic data; dda-textbook is absent from figure-8."""
    entries, comparisons = [], []
    for case in [case for scene in scenes for case in scene.expand()]:
        histories = {}
        for solver in case.run.solvers:
            key = f"{study}-{len(entries)}"
            entries.append(
                {"scene": case.name, "title": case.title, "solver": solver, "key": key, "definition": case.definition()}
            )
            if solver == "dda-textbook" and case.name.startswith("figure-8"):
                results.append(
                    Row(key, study, case.name, solver, Outcome.NOT_APPLICABLE, {}, notes=("alpha must be above 0",)),
                    None,
                )
                continue
            histories[solver], metrics = synthetic(case, solver)
            results.append(
                Row(
                    key,
                    study,
                    case.name,
                    solver,
                    Outcome.COMPLETED,
                    metrics,
                    {"unknowns": 6, "steps": case.time.steps},
                    {"setup": 0.001, "stepping": 0.01},
                ),
                histories[solver],
            )
        order = [s for s in ("dda", "dda-textbook", "fem", "bar", "continuum") if s in histories]
        comparisons += [comparison(case.name, a, b, histories) for i, a in enumerate(order) for b in order[i + 1 :]]
    results.write_json(
        f"studies/{study}.json",
        {
            "study": study,
            "title": title,
            "purpose": "Does the code say what the model says?",
            "cases": entries,
            "comparisons": comparisons,
            "seconds": 12.3,
            "provenance": {
                "python": "3.11.0",
                "packages": {"numpy": "2.4.0", "scipy": "1.17.0"},
                "commit": "0123abc",
                "processor": "a processor",
                "cores": 2,
                "seeds": [],
                "date": "2024-01-01",
            },
        },
    )
    results.write_verdicts(study, [verdict.record(study) for verdict in gates])
    return results


def verdict(scene, metric, value, low=0.03, high=0.04, **kwargs):
    gate = Gate(
        scene, ("dda", "bar"), metric, low, high, "the model form at this step, known from both sides", **kwargs
    )
    return judge(gate, value)


PASSES = verdict("figures-3-4[time.step=0.002]", "displacement.l2", 0.0363, until=0.2)
FAILS = verdict("figures-3-4[time.step=0.01]", "pressure.l2", 0.0567)
WAITS = Verdict(
    Gate(
        "figure-8[time.alpha=0.25,time.delta=0.5]",
        ("dda", "fenicsx"),
        "displacement.l2",
        0,
        1e-6,
        "another code",
        "other code",
        1e-9,
    ),
    None,
    Status.NOT_RUN,
    "fenicsx: dolfinx is not installed",
)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    directory = Results(tmp_path_factory.mktemp("results"))
    scenes = [load_scene(name) for name in CORE]
    if os.environ.get("REPORT_PREVIEW"):
        from validation.scene import scene_names

        scenes = [load_scene(name) for name in scene_names()]
    return write_study(directory, "core", scenes, (PASSES, FAILS, WAITS))
