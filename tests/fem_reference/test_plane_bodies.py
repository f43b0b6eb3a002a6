"""Bodies in the plane on contacts: the block's own solver, a column, closed forms, balances."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import thinned
from skfem import MeshQuad

from fem_reference import Friction, Motion, PatchContact, PlaneBody, PlaneModel, Problem, Scheme, Unilateral
from fem_reference.column.contact_model import ColumnContact, ContactColumn
from fem_reference.column.contacts import solve_contacts
from fem_reference.column.problem import Excitation, Ground, Stratum
from fem_reference.contact import compilation
from fem_reference.history.unilateral import solve_unilateral

YOUNG, DENSITY, GRAVITY, UP = 1e9, 2500.0, 9.81, (0.0, 1.0)
CONSTANT = Scheme(0.5, 1.0, 1.0, 1e-3)


def rectangle(x0, y0, x1, y1, **changes):
    polygon = ((x0, y0), (x1, y0), (x1, y1), (x0, y1))
    return replace(PlaneBody((polygon,), DENSITY, YOUNG, 0.25, rectangle=True, elements=4), **changes)


def patches(first, second, left, right, y, width, **law):
    """Both ends of a horizontal face."""
    ends = (((left, y), (left + width, y)), ((right - width, y), (right, y)))
    return [PatchContact(first, second, *piece, UP, **law) for piece in ends]


def in_modes(monkeypatch):
    """Step what follows in natural modes, not compiled."""
    monkeypatch.setattr(compilation, "LONG", 1)
    monkeypatch.setattr(compilation, "compiled", lambda: (None, ""))


def apart(found, truth, size=0.0):
    return np.abs(found - truth).max() / max(size, np.abs(truth).max())


SHAKEN = Motion((0.0, 0.05, 0.1, 0.15), (0.0, 1e-3, -1e-3, 0.0), (0.0, 0.0, 5e-4, 0.0))


@pytest.mark.parametrize(
    ("shear", "angle", "width", "degree"), thinned([(4e8, 20.0, 1.0, 2), (0.0, None, 0.25, 2), (4e8, None, 0.5, 1)], 3)
)
def test_one_body_on_the_base_is_the_block(shear, angle, width, degree):
    """Dropped with a sideways traction: the same springs, points, friction and steps from two ways to a mesh."""
    side, stiffness, drag, pressure = 2.0, 1e9, 4e5 if shear else 0.0, 2e5
    corners = ((0.0, 0.0), (side, 0.0), (side, side), (0.0, side))
    problem = Problem(
        corners, 0, 2, DENSITY, YOUNG, 0.25, "plane stress", stiffness, shear, pressure, 4, degree,
        foundation="patch", patch_width=width, traction=drag, gravity=GRAVITY, motion=SHAKEN,
    )  # fmt: skip
    friction = None if angle is None else Friction(angle, 1e4)
    start = Unilateral(1e-3, -0.1, "glued" if shear else "frictionless", friction=friction)
    block = solve_unilateral(problem, CONSTANT, 30, start, full=True)
    law = {"friction": None, "cohesion": 0.0}
    if angle is not None:
        law = {"friction": math.tan(math.radians(angle)), "cohesion": 1e4 * side / 2}
    top = ((side, side), (0.0, side))
    body = rectangle(
        0.0, 0.0, side, side, degree=degree, velocity=(0.0, -0.1), gravity=(0.0, -GRAVITY),
        tractions=((top, (drag, -pressure)),),
    )  # fmt: skip
    law |= {"stiffness": stiffness, "shear_stiffness": shear, "gap": 1e-3}
    model = PlaneModel([body], patches(0, None, 0.0, side, 0.0, width, **law), SHAKEN)
    found = model.history(CONSTANT, 30, model.observer((1.0, 1.0), (1.0, 1.0)))
    columns = block.columns
    place = np.abs(columns["displacement"]).max()
    force = np.abs(columns["contact_pressure"]).max()
    assert apart(found.columns["0"], columns["horizontal_displacement"], place) < 1e-11
    assert apart(found.columns["1"], columns["displacement"]) < 1e-11
    assert apart(found.normal.sum(axis=1) / side, columns["contact_pressure"]) < 1e-11
    assert apart(found.shear.sum(axis=1) / side, columns["base_shear"], force) < 1e-11
    if angle is not None:
        assert np.abs(found.slip).max() > 1e-4
    work = np.abs(columns["load_energy"]).max()
    for name, values in found.energy.items():
        assert apart(values, columns[name], work) < 1e-11


@pytest.mark.parametrize(("degree", "modal"), thinned([(2, True), (1, False)], 2))
def test_two_bodies_on_each_other_are_the_column(degree, modal, monkeypatch):
    """Poisson's ratio 0 and springs all along the faces: the same motion on every vertical line, tilts none."""
    width, height, gap, stiffness = 2.0, 1.0, (2e-3, 1e-3), (1e9, 5e8)
    changes = {"poisson": 0.0, "gravity": (0.0, -GRAVITY), "velocity": (0.0, -1.0), "degree": degree}
    bodies = [rectangle(0.0, y, width, y + height, **changes) for y in (0.0, height + gap[1])]
    contacts = patches(0, None, 0.0, width, 0.0, width / 2, stiffness=stiffness[0], gap=gap[0])
    contacts += patches(1, 0, 0.0, width, height + gap[1], width / 2, stiffness=stiffness[1], gap=gap[1])
    model = PlaneModel(bodies, contacts)
    top = 2 * height + gap[1]
    scheme = Scheme(0.5, 1.0, 1.0, 1e-4, "consistent")
    still = np.zeros(61)
    faces = [ColumnContact(y, 2 * k / width, g) for y, k, g in zip((0.0, height), stiffness, gap, strict=True)]
    strata = (Stratum(height, DENSITY, YOUNG, 0.0),) * 2
    column = ContactColumn(Ground(strata, "pressure"), "unilateral", tuple(faces), (-1.0, -1.0), GRAVITY)
    names = ("displacement", "force_1", "force_2")
    truth = solve_contacts(column, (4, 4), degree, scheme, Excitation(*[still] * 4), names, (0.0, height)).columns
    if modal:
        in_modes(monkeypatch)
    rows = np.vstack([model.observer((0.0, top), (width, top), 1)[1], model.means(1)[[0, 2]]])
    found = model.history(scheme, 60, rows)
    assert apart(found.columns["0"], truth["displacement"]) < 1e-12
    for pair, name in (((0, 1), "force_1"), ((2, 3), "force_2")):
        assert apart(found.normal[:, pair].sum(axis=1) / width, truth[name]) < 1e-12
    assert np.abs(np.array([found.columns["1"], found.columns["2"]])).max() < 1e-12 * np.abs(found.columns["0"]).max()


@pytest.mark.parametrize("degree", thinned([2, 1], 2))
def test_a_plate_on_rollers_is_stretched_evenly(degree):
    """On a mesh of its own, under tractions that are functions of the place: s x / E and -nu s y / E exactly."""
    points = np.array([[0, 1.3, 3, 0, 1.1, 3, 0, 1.6, 3], [0, 0, 0, 0.8, 1.0, 0.9, 2, 2, 2]])
    cells = np.array([[0, 1, 3, 4], [1, 2, 4, 5], [4, 5, 7, 8], [3, 4, 6, 7]])
    pulled = (((3.0, 0.0), (3.0, 2.0)), lambda x: np.array([1e6 + 0 * x[0], 0 * x[1]]))
    rollers = ((((0.0, 0.0), (3.0, 0.0)), "y"), (((0.0, 2.0), (0.0, 0.0)), "x"))
    mesh = MeshQuad(points, cells)
    model = PlaneModel(
        [PlaneBody((), DENSITY, YOUNG, 0.25, mesh=mesh, rollers=rollers, tractions=(pulled,), degree=degree)]
    )
    for x, y in ((3.0, 2.0), (1.6, 2.0), (3.0, 0.9), (0.0, 0.8)):
        moved = model.observer((x, y), (x, y)) @ model.rest
        assert moved == pytest.approx([1e6 * x / YOUNG, -0.25 * 1e6 * y / YOUNG], abs=1e-14)


def test_bodies_that_begin_at_rest_stay_there():
    """Over gaps: the springs are as long at rest as the weight says, and nothing moves."""
    weight = {"gravity": (0.0, -GRAVITY), "elements": 2}
    bodies = [rectangle(0.0, 0.0, 2.0, 1.0, **weight), rectangle(0.0, 1.01, 2.0, 2.01, **weight)]
    law = {"stiffness": 1e9, "gap": 0.01}
    contacts = patches(0, None, 0.0, 2.0, 0.0, 0.5, **law) + patches(1, 0, 0.0, 2.0, 1.01, 0.5, **law)
    model = PlaneModel(bodies, contacts)
    half = DENSITY * GRAVITY
    assert model.settled.normal == pytest.approx([2 * half, 2 * half, half, half], rel=1e-9)
    rows = np.vstack([model.means(0), model.means(1)])
    assert rows[7] @ model.rest < rows[1] @ model.rest - 0.01 < -0.02
    consistent = replace(CONSTANT, start="consistent")
    found = model.history(consistent, 4, rows, settled=True)
    at_rest = rows @ model.rest
    for number, values in found.columns.items():
        assert np.abs(values - at_rest[int(number)]).max() < 1e-12
