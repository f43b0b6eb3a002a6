"""The study of waves: columns as wave guides, joints, a transmitting base, and a site under a record."""

from __future__ import annotations

import functools
import math

import numpy as np

from validation.engine.finished import Derived, DerivedRows
from validation.gates.gate import Gate
from validation.runs.history import History
from validation.runs.row import Metrics, Value
from validation.scenes.scene import Scene, load_scene
from validation.solvers.columns.names import column_of
from validation.studies.waves import rows
from validation.studies.waves.oblique import energies as energies
from validation.studies.waves.oblique import reflections as reflections
from validation.studies.waves.rows import curves as curves

SITE = "waves-site"
USUAL = {"time.alpha": 0.5, "time.delta": 1.0, "time.step": 0.01, "time.steps": 900}


def usual_site() -> Scene:
    """Return the site under the usual scheme of DDA at a usual step."""
    return load_scene(SITE).with_values(USUAL).model_copy(update={"name": f"{SITE}-usual"})


def scenes() -> tuple[str | Scene, ...]:
    """Return the scenes: of the library, joints for every resolution, the site twice."""
    joints = {wave.scene.name: wave.scene for wave in rows.jointed()}
    return "waves-blocks", *rows.OTHERS, *joints.values(), "waves-base", SITE, usual_site()


@functools.cache
def derived() -> DerivedRows:
    """Return the rows measured on histories."""
    needs = tuple((wave.scene.name, wave.solver) for wave in rows.averaged())
    return (
        *(wave.row(rows.travelled) for wave in rows.travelling()),
        *(wave.row(rows.parted) for wave in rows.jointed()),
        *(wave.row(rows.sent_back) for wave in rows.returned()),
        Derived(needs[-1][0], "order", needs, rows.joint_order),
    )


def gates() -> tuple[Gate, ...]:
    """Return the gates on measured waves."""
    return (*rows.travelling_gates(), *rows.joint_gates(), rows.order_gate(), *rows.base_gates())


def fem_too() -> tuple[tuple[str, str], ...]:
    """Return the cases that line elements run beside the blocks."""
    return tuple(
        dict.fromkeys((w.scene.name, w.solver) for w in (*rows.travelling(), *rows.jointed()) if w.solver == "fem")
    )


def closed(case: Scene) -> Metrics:
    """Return c dt/h of the lowest layer, its glue over its own blocks', and the weights of the scheme."""
    column = column_of(case)
    layer = column.layer[0]
    height = layer.thickness / layer.blocks
    speed = math.sqrt(column.modulus(layer) / layer.density)
    time = case.time
    values: dict[str, Value] = {
        "courant": round(speed * time.step / height, 6),
        "scheme": f"{time.alpha:g}, {time.delta:g}, {time.discount:g}",
    }
    return values | {"glue": column.glue * height / column.modulus(layer)} if column.glue else values


def largest(case: Scene, history: History) -> Metrics:
    """Return the largest displacement of the surface [m] and the largest stress on the base [Pa]."""
    return {
        "displacement": np.abs(history.displacement).max(),
        "pressure": np.abs(history.contact_pressure).max(),
    }
