"""Blocks with friction under two corners: histories that are known by their events."""

from dataclasses import dataclass, replace

import numpy as np
from oracles.unilateral_checks import random_model

from dda import BaseMotion, Block, Material, Unilateral, UnilateralModel

YOUNG = 1e9


@dataclass(frozen=True)
class Known:
    """A block and where its centroid is (u, v, r), found from events to 13 digits, at given times."""

    model: UnilateralModel
    at: dict[float, tuple[float, float, float]]


def square(poisson=0.0):
    """Return the block of 2 m by 2 m."""
    return Block.rectangle(2.0, 2.0, Material(2700.0, YOUNG, poisson))


KNOWN = {
    "rubbing": Known(
        UnilateralModel(square(), Unilateral(YOUNG, YOUNG, friction=0.5), 5e6, eccentricity=0.3),
        {
            0.01: (1.432096486408e-3, -1.344857861701e-2, -1.327505388538e-3),
            0.03: (-3.680080923643e-4, -1.251962754476e-2, -1.923369471946e-3),
        },
    ),
}


def rubbing_model(seed):
    """Return a random block whose corners rub: outline, loads, slope, friction and cohesion; some are symmetric."""
    rng, model = np.random.default_rng(1000 + seed), random_model(seed, glued=True)
    law = replace(model.contact, friction=rng.uniform(0.05, 1.0), cohesion=(seed % 5 == 2) * rng.uniform(0.0, 1e5))
    if seed % 3 == 1:
        return replace(model, contact=law)
    sideways = model.block.material.young * rng.uniform(-1e-3, 1e-3)
    return replace(model, contact=law, traction=sideways, slope=rng.uniform(-40, 40))


def shaken(rng, size=1e-3):
    """Return a base that moves to and fro in both directions."""
    moved = np.concatenate([[[0.0, 0.0]], np.cumsum(rng.uniform(-size, size, (20, 2)), axis=0)])
    return BaseMotion(np.linspace(0.0, 0.05, 21), moved)
