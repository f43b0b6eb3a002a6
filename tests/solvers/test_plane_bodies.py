"""Bodies of elements and blocks: two codes, one model, the same steps; through scenes too."""

import numpy as np
import pytest
from skfem import MeshTri

import dda
import fem_reference
from dda import Block, GluedBlocks, Traction, glued_blocks
from fem_reference import PatchContact, PlaneBody, PlaneModel
from validation.errors import InputError
from validation.scenes.scene import parse_scene
from validation.solvers.registry import solve

GLUE, WEIGHT, RIGHT = 1e11, (0.0, -9.81), ((2.0, 0.0), (2.0, 1.0))
CORNERS = ((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0))
MIDDLE = (1.1, 0.45)
TRIANGLES = [(CORNERS[i], CORNERS[(i + 1) % 4], MIDDLE) for i in range(4)]
PUSH = (1e6, -2e5)


def elements():
    """A triangle each, glued at both ends of the sides that they share, the left one to the base."""
    bodies = []
    contacts = []
    for number, triangle in enumerate(TRIANGLES):
        mesh = MeshTri(np.array(triangle).T, np.array([[0, 1, 2]]).T)
        loads = ((RIGHT, PUSH),) if number == 1 else ()
        bodies.append(PlaneBody((), 2700.0, 1e9, 0.25, gravity=WEIGHT, tractions=loads, degree=1, mesh=mesh))
        corner = np.array(triangle[1])
        along = (np.array(MIDDLE) - corner) / np.hypot(*(np.array(MIDDLE) - corner))
        for place in triangle[1:]:
            normal = (-along[1], along[0])
            contacts.append(PatchContact(number, (number + 1) % 4, place, place, normal, GLUE, GLUE, bonded=True))
    for place in TRIANGLES[3][:2]:
        contacts.append(PatchContact(3, None, place, place, (1.0, 0.0), GLUE, GLUE, bonded=True))
    return PlaneModel(bodies, contacts)


@pytest.mark.parametrize(("alpha", "delta", "gg"), [(0.25, 0.5, 0.99)])
def test_linear_triangles_on_points_are_glued_blocks(alpha, delta, gg):
    material = dda.Material(density=2700.0, young=1e9, poisson=0.25)
    blocks = [Block(np.array(triangle), material) for triangle in TRIANGLES]
    loads = [Traction(*RIGHT, PUSH)]
    glued = GluedBlocks(glued_blocks(blocks, GLUE, [(CORNERS[0], CORNERS[3])], tractions=loads, gravity=WEIGHT))
    model = elements()
    strains = np.vstack([model.means(body)[3:] for body in range(4)]) @ model.rest
    assert strains == pytest.approx(glued.strains.ravel(), rel=1e-11)
    numbers = (alpha, delta, gg, 1e-4)
    steps = glued.history(dda.Scheme(*numbers), 30, glued.observer(*RIGHT)).columns
    found = model.history(fem_reference.Scheme(*numbers), 30, model.observer(*RIGHT, 1)).columns
    for name, values in steps.items():
        assert np.abs(found[name] - values).max() < 1e-13 * np.abs(values).max()
    theirs = [mode.frequency for mode in glued.modes(dda.Scheme(*numbers), 4)]
    assert [mode.frequency for mode in model.modes(fem_reference.Scheme(*numbers), 4)] == pytest.approx(
        theirs, rel=1e-11
    )


def landing(size=1.0, fem=None, columns=("b.x",), contact=None, **plane):
    """A body that lands and slides on another one, which stands on a fixed block; all that drives it times a size."""
    blocks = [
        {"name": "base", "rectangle": [6.0, 1.0], "at": [0.0, -0.5], "fixed": True},
        {"name": "a", "rectangle": [2.0, 1.0], "at": [0.0, 0.5]},
        {"name": "b", "rectangle": [1.0, 1.0], "at": [0.3, 1.5 + 1e-3 * size], "velocity": [0.5 * size, -0.5 * size]},
    ]
    touch = [{"block": up, "corner": i, "on": on, "edge": 2} for up, on in (("a", "base"), ("b", "a")) for i in (0, 1)]
    law = {"stiffness": 1e8, "friction": 30.0} | (contact or {})
    made = {"young": 1e13, "density": 2500.0, "gravity": [0.0, -9.81 * size], "contact": law}
    data = {
        "plane": made | {"block": blocks, "touch": touch} | plane,
        "fem": fem or {"foundation": "corner", "elements": 1, "degree": 1},
        "time": {"step": 1e-3, "steps": 30, "alpha": 0.5, "delta": 1.0, "start": "consistent"},
        "run": {"columns": list(columns), "solvers": ["dda", "fem"]},
    }
    return parse_scene(data, "landing")


PARTS = [f"{block}.{part}" for block in "ab" for part in ("x", "y", "angle", "vx", "vy", "spin")]
PARTS += [
    f"{pair}.{part}" for pair in ("a.0-base.2", "b.0-a.2", "b.1-a.2") for part in ("normal", "shear", "gap", "slip")
]
PARTS += [f"energy.{part}" for part in ("kinetic", "springs", "load", "friction", "algorithmic", "switching")]
PARTS += ["momentum.x", "momentum.y"]


def test_stiff_elements_on_corners_are_dda_but_for_its_finite_rotations():
    """Driven a tenth as hard they differ by a tenth: of first order in the rotation, in every column."""
    apart = []
    for size in (0.1, 0.01):
        scene = landing(size, columns=[*PARTS, "base.x", "energy.balance", "a.gxy"])
        blocks, bodies = (solve(scene, name).history.columns for name in ("dda", "fem"))
        scales = {name: np.abs(blocks[name] - blocks[name][0]).max() for name in PARTS}
        apart.append([np.abs(bodies[name] - blocks[name]).max() / scales[name] for name in PARTS])
        assert np.abs(bodies["energy.balance"]).max() < 1e-9 * np.abs(bodies["energy.kinetic"]).max()
        assert np.all(bodies["base.x"] == 0.0)
    # 0.1 but for the second order, and for slips that begin a step earlier
    assert np.max(apart[1]) < 0.2 * np.max(apart[0]) < 0.01


def test_blocks_that_are_glued_move_as_one():
    """A bond on patches, of two blocks that fall on a fixed one by their weight."""
    names = ("left.y", "right.y", "left.angle")
    blocks = [
        {"name": "base", "rectangle": [6.0, 1.0], "at": [0.0, -0.5], "fixed": True},
        {"name": "left", "rectangle": [1.0, 1.0], "at": [-0.5, 0.5]},
        {"name": "right", "rectangle": [1.0, 1.0], "at": [0.5, 0.5]},
    ]
    touch = [
        {"block": "left", "corner": 0, "on": "base", "edge": 2},
        {"block": "right", "corner": 1, "on": "base", "edge": 2},
    ]
    fem = {"foundation": "patch", "patch_width": 0.05, "elements": 2, "degree": 1}
    bond = [{"blocks": ["left", "right"], "stiffness": 1e11}]
    scene = landing(fem=fem, columns=names, block=blocks, touch=touch, bond=bond)
    columns = solve(scene, "fem").history.columns
    sunk = columns["left.y"] - 0.5
    assert columns["right.y"] - 0.5 == pytest.approx(sunk, rel=1e-6) and sunk.min() < -1e-4
    assert np.abs(columns["left.angle"]).max() < 0.05 * np.abs(sunk).max()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"fem": {"elements": 2}}, "patch_width"),
        ({"ramp": 0.1}, "at once"),
        ({"young": "inf"}, "young"),
        ({"contact": {"tension": 1.0}}, "tension"),
    ],
)
def test_what_elements_do_not_express_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        solve(landing(**changes), "fem")
