"""The slips of the paper's equations in the register: (13), (16), (20), (21), (25), (28), (29) and (32)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from validation.runs.case_name import scene_of
from validation.studies.paper.register import MAP, SOFT
from validation.suite.claims import Evidence, Tests, named

LATERAL = next(iter(named("poisson-statics")))  # mu = 0.3, p = 1E
OBLONG = {"block.width": 1.0, "block.height": 2.0}
HALF = 1.0  # m, of the paper's side: the corners are at (-HALF, -HALF) and (HALF, -HALF) from the centroid
# Displacement of the corners M and N away from and along the base, by the six unknowns: (24) and below (26)
CORNER_M = (0.0, 1.0, -HALF, 0.0, -HALF, -HALF / 2)
CORNER_N = (0.0, 1.0, HALF, 0.0, -HALF, HALF / 2)
SHEAR_M = (1.0, 0.0, HALF, -HALF, 0.0, -HALF / 2)
SHEAR_N = (1.0, 0.0, HALF, HALF, 0.0, -HALF / 2)


def model(case: str, **values: float) -> Any:
    """Return the DDA model of a built-in case, with values set."""
    from validation.solvers.dda import model_of

    return model_of(named(scene_of(case))[case].with_values(dict(values)))


def radius(e: Evidence) -> dict[str, float]:
    """Return |lambda| over sqrt(1 + h) on both sides of w dt = 4."""
    pairs = []
    for name, s in MAP.items():
        for mode in ("mode1", "contact"):
            square = (s.time.step * e.number(name, f"{mode}.frequency")) ** 2
            h = (0.5 - s.time.delta) * square / (1 + s.time.alpha * square)
            pairs.append((math.sqrt(square), e.number(name, f"{mode}.spectral_radius") / math.sqrt(1 + h)))
    omega, ratio = np.array(sorted(pairs)).T
    return {
        "largest |lambda| / sqrt(1 + h) - 1 below w dt = 4": np.abs(ratio[omega < 4] - 1).max(),
        "largest above": np.abs(ratio[omega > 4] - 1).max(),
    }


def inertia(e: Evidence) -> dict[str, float]:
    """Return (3, 6) and (6, 6) of a 1 m x 2 m block's inertia over rho, and (1, 1) over the area."""
    block_model = model(SOFT, **OBLONG)
    mass = block_model.mass / block_model.block.material.density
    return {
        "entry (3, 6)": mass[2, 5],
        "entry (6, 6)": mass[5, 5],
        "entry (1, 1) over the area, kg/m3": block_model.mass[0, 0] / 2.0,
    }


def energy(e: Evidence) -> dict[str, float]:
    """Return the strain energy of ey = 1 over s/2 times the area integral of E."""
    block_model = model(SOFT)
    elastic = block_model.block.elastic()[4, 4]
    area = 4.0
    young = block_model.block.material.young
    return {"strain energy over that of (20)": elastic / 2 / (area / 2 * young * area)}


def modulus(e: Evidence) -> dict[str, float]:
    """Return (4, 4) of the elastic submatrix over the area [Pa], mu = 0.3."""
    return {"entry (4, 4) over area, Pa": model(LATERAL).block.elastic()[3, 3] / 4.0}


def load(e: Evidence) -> dict[str, float]:
    """Return the load on v over a q, and its static displacement."""
    block_model = model(SOFT)
    return {
        "load on v over a q": block_model.force[1] / (2.0 * block_model.load.pressure),
        "static displacement, mm": 1e3 * e.number(SOFT, "displacement.static"),
    }


def lateral(e: Evidence) -> dict[str, float]:
    """Return statics at mu = 0.3, p = 1E: ours, and without the shear springs' stretch, where sigma_x = 0."""
    s = named("poisson-statics")[LATERAL]
    a = s.block.base_length
    E = s.block.young
    q = s.load.pressure
    return {
        "static displacement, mm": 1e3 * e.number(LATERAL, "displacement.static"),
        "with (32) as printed, mm": -1e3 * (a * q / (2 * s.contact.stiffness) + a / 2 * q / E),
    }


def shear_load(e: Evidence) -> dict[str, float]:
    """Return the sideways force of the springs at rest, where they hold no shear, and that of (25) and (28) over a q.

    As printed the load of a shear spring is -(p s0 / l) e_r with the s0 of (23); s0 / l is the normal gap.
    """
    block_model = model(SOFT)
    p = block_model.contact.stiffness
    at_rest = np.linalg.solve(block_model.stiffness, block_model.force)
    gaps = [np.dot(corner, at_rest) for corner in (CORNER_M, CORNER_N)]
    stretches = [np.dot(corner, at_rest) for corner in (SHEAR_M, SHEAR_N)]
    load_force = 2 * HALF * block_model.load.pressure
    return {
        "sideways force at rest over a q": float(-p * sum(stretches) / load_force) + 0.0,
        "by (25) and (28) as printed": -p * sum(gaps) / load_force,
    }


TESTS: Tests = {
    "S13": (MAP, radius),
    "S16": ((SOFT,), inertia),
    "S20": ((SOFT,), energy),
    "S21": ((LATERAL,), modulus),
    "S25": ((SOFT,), shear_load),
    "S29": ((SOFT,), load),
    "S32": ((LATERAL,), lateral),
}
