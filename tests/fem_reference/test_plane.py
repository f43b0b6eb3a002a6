"""The plane elastic body: a free body's strains, cells that meet in a T and that halve towards a clamp."""

from dataclasses import replace

import numpy as np
import pytest

from fem_reference.plane.body import PlaneBody, mesh_of
from fem_reference.plane.model import PlaneModel

YOUNG, POISSON = 1e9, 0.25
# one wide cell below two narrow ones, whose common corner lies on its side
TEE = (
    ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)),
    ((0.0, 1.0), (0.8, 1.0), (0.8, 2.0), (0.0, 2.0)),
    ((0.8, 1.0), (2.0, 1.0), (2.0, 2.0), (0.8, 2.0)),
)
STRESSED = PlaneBody(TEE, 2700.0, YOUNG, POISSON, stress=(3e6, -1e6, 2e6), elements=2)


@pytest.mark.parametrize(("hypothesis", "degree"), [("plane stress", 1), ("plane strain", 2)])
def test_a_free_body_has_its_three_strains_and_no_momentum(hypothesis, degree):
    model = PlaneModel([replace(STRESSED, hypothesis=hypothesis, degree=degree)])
    assert model.stress_error() < 1e-10
    momentum = model.motions.T @ (model.M @ model.rest)
    assert np.abs(momentum).max() < 1e-9 * np.abs(model.M @ model.rest).sum()
    E, mu = (YOUNG, POISSON) if hypothesis == "plane stress" else (YOUNG / (1 - POISSON**2), POISSON / (1 - POISSON))
    s_xx, s_yy, s_xy = STRESSED.stress
    sides = [model.observer(*[(x, 1.0)] * 2) @ model.rest for x in (0.0, 2.0)]
    ends = [model.observer(*[(1.0, y)] * 2) @ model.rest for y in (0.0, 2.0)]
    across, up = (sides[1] - sides[0]) / 2, (ends[1] - ends[0]) / 2
    strains = across[0], up[1], across[1] + up[0]
    expected = (s_xx - mu * s_yy) / E, (s_yy - mu * s_xx) / E, 2 * (1 + POISSON) * s_xy / YOUNG
    assert strains == pytest.approx(expected, rel=1e-9)


def test_cells_that_meet_in_a_t_share_their_points():
    """Five triangles below, whose side the corner above cuts, and four in each cell above it."""
    mesh = mesh_of(STRESSED)
    assert mesh.nelements == 4 * 13  # 13 by four a halving
    facets = mesh.p[:, mesh.facets[:, mesh.boundary_facets()]]
    assert np.hypot(*(facets[:, 1] - facets[:, 0])).sum() == pytest.approx(8.0)  # the outline, and no slit
