"""Sub-blocks that rub on their base: one of them is the block, and of many every point obeys the law."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from oracles.frictional import KNOWN, rubbing_model
from oracles.unilateral_checks import DT

from dda import Scheme, UnilateralOptions, opening_subdivided, solve_opening_system

ENERGIES = UnilateralOptions(energies=True)
SCHEMES = [(0.5, 1.0, 1.0, "zero"), (0.25, 0.5, 0.99, "consistent")]
FIELDS = ("normal", "shear", "gap", "slide", "slip")


@pytest.mark.parametrize("seed", thinned(range(24), 12))
@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_point_obeys_the_law(seed, scheme):
    alpha, delta, gg, start = scheme
    opening = opening_subdivided(rubbing_model(seed), 3, 2, 1e13)
    law = opening.law
    result = solve_opening_system(opening, Scheme(alpha, delta, gg, DT, start), 60, options=ENERGIES)
    assert result.outcome == "completed"
    limit, size = np.where(result.closed, law.friction * result.normal + law.cohesion, 0.0), np.max(result.normal)
    assert np.all(result.normal >= 0) and np.all(result.gap[~result.closed] >= 0)
    assert np.max(np.abs(result.shear) - limit) <= 2e-12 * size
    slips = np.abs(result.states) == 2
    assert np.max(np.abs(np.abs(result.shear) - limit)[slips], initial=0.0) <= 1e-13 * size
    whole = result.step_cuts == 0
    assert np.all((result.slipped * result.states)[:, whole] >= 0)
    assert np.min(np.diff(result.energies["friction"])) >= 0
    total = sum(result.energies.values())
    assert np.ptp(total) < 1e-11 * np.max(np.abs(list(result.energies.values())))
    stored = sum(result.energies[name] for name in ("kinetic", "strain", "springs", "load"))
    assert delta < 1 or np.max(np.diff(stored)) < 1e-11 * np.max(np.abs(total))


def test_cohesion_is_shared_among_the_points():
    model = KNOWN["incline"].model
    law = replace(model.contact, cohesion=6e3)
    opening = opening_subdivided(replace(model, contact=law), 4, 1, 1e12)
    assert opening.law.cohesion * len(opening.normals) == pytest.approx(2 * law.cohesion)
    assert opening.law.friction == law.friction


def test_what_points_cannot_do_is_refused():
    model, scheme = KNOWN["incline"].model, Scheme(0.5, 1.0, 1.0, 1e-3)
    late = replace(model, contact=replace(model.contact, rules="lagged"))
    with pytest.raises(ValueError, match=r"^rules: sub-blocks take consistent friction alone"):
        solve_opening_system(opening_subdivided(late, 2, 1, 1e12), scheme, 5)
