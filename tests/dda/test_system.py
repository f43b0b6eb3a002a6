"""Systems of glued blocks: the two-block model as the smallest, linear elements as the limit of stiff glue."""

from dataclasses import replace

import numpy as np
import pytest
from oracles.plain_newmark import SIDE, glued, stepped, upright

import dda
import fem_reference
from dda.bodies.block_system import BlockSystem
from validation import load_scene, solve
from validation.errors import InputError

COLUMNS = ("displacement", "contact_pressure", "horizontal_displacement", "rotation")
PENTAGON = [[1, 1], [3.1, 1.7], [2.9, 3.3], [1.5, 4], [0.7, 2]]
TRAPEZIUM = ((0.3, 0.1), (2.3, 0.4), (1.9, 1.6), (0.5, 1.4))
RECORD = dda.BaseMotion([0.0, 0.011, 0.02, 0.05], [[1e-4, 0.0], [3e-3, 1e-3], [-1e-3, 2e-3], [0.0, 5e-4]])
LOADS = {"traction": 2e5, "gravity": 9.81, "eccentricity": 0.2, "motion": RECORD}
SCHEME = dda.Scheme(0.5, 1.0, 1.0, 1e-3)


def two_block(vertices=((0, 0), (2, 0), (2, 2), (0, 2)), mu=0.0, p=1e9, q=5e6, **loads):
    return dda.TwoBlockModel(dda.Block(vertices, dda.Material(2700.0, 1e9, mu)), dda.Contact(p, 0.8 * p), q, **loads)


def largest_error(a, b, columns=COLUMNS):
    """Return the greatest error over the columns, each over its maximum."""
    return max(np.abs(a.columns[c] - b.columns[c]).max() / np.abs(b.columns[c]).max() for c in columns)


@pytest.mark.parametrize("scheme", [SCHEME, dda.Scheme(0.25, 0.5, 0.99, 2e-3, "consistent")])
@pytest.mark.parametrize(
    ("p", "moved", "bits"),
    # Two orders of operations: a rounding a step. With stiff springs the moving base itself is rounded, and the
    # ringing contact mode keeps what it is given.
    [(1e9, True, 51), (1e15, False, 48), (1e15, True, 44)],
)
def test_one_sub_block_is_the_two_block_model_to_the_last_bits(scheme, p, moved, bits):
    start = dda.BaseMotion([0.0, 0.02, 0.05], [[0.0, 0.0], [3e-3, 2e-3], [0.0, 5e-4]])
    model = two_block(TRAPEZIUM, 0.3, p, **(LOADS | {"motion": start if moved else None}))
    one = dda.solve_system(dda.subdivided(model, 1, 1, 1e9), scheme, 150, COLUMNS)
    assert largest_error(one, dda.solve(model, scheme, 150, COLUMNS)) < 150 * 2.0**-bits
    static, expected = dda.static(dda.subdivided(model, 1, 1, 1e9)), dda.static(model)
    for name in COLUMNS:
        assert static[name] == pytest.approx(expected[name], rel=1e-12)
    modes = dda.modes(dda.subdivided(model, 1, 1, 1e9), scheme)
    # the dense eigenvalue solver keeps the digits of the largest flexibility
    for mode, same in zip(modes[:2], dda.modes(model, scheme)[:2], strict=True):
        assert mode.frequency == pytest.approx(same.frequency, rel=1e-9)
        assert mode.share == pytest.approx(same.share, rel=1e-8)
        assert mode.contact_share == pytest.approx(same.contact_share, rel=1e-7)


def test_a_pentagon_on_a_fixed_block_is_the_two_block_model():
    material = dda.Material(2400.0, 2e9, 0.2)
    block, ground = dda.Block(PENTAGON, material), dda.Block([[0.0, -3.0], [4.0, -3.0], [3.1, 1.7], [1, 1]], material)
    (joint,) = dda.shared_edges([block, ground], 3e9, 1e9)
    assert (joint.first, joint.second) == (0, 1)
    edge = block.edge(2)
    load = dda.SurfaceLoad(0, tuple(edge[0]), tuple(edge[1]), (0.0, -5e6))
    _, normal, a = dda.contact.springs.base_directions(block, 0)
    system = BlockSystem(
        [block],
        [replace(joint, second=dda.FIXED)],
        block.section.centroid,
        a,
        [load],
        9.81,
        base_normal=tuple(normal),
    )
    model = dda.TwoBlockModel(block, dda.Contact(3e9, 1e9), 5e6, gravity=9.81)
    pair = [dda.solve_system(system, SCHEME, 80, COLUMNS), dda.solve(model, SCHEME, 80, COLUMNS)]
    assert largest_error(*pair) < 80 * 2**-50


def linear_elements(n, p, scheme, steps, q=5e6, g=0.0):
    """Return centroid displacement and base pressure of n linear bar elements on the spring 2p, plain Newmark."""
    M, K = upright(n, p)
    F = -g * M.sum(0)
    F[-1] -= q * SIDE
    D = stepped(M, K, np.tile(F, (steps + 1, 1)), scheme)
    middle = [np.interp(SIDE / 2, np.linspace(0, SIDE, n + 1), row) for row in D]
    return dict(zip(COLUMNS[:2], (np.array(middle), -2 * p * D[:, 0] / SIDE), strict=True))


@pytest.mark.parametrize(("n", "p", "g"), [(3, 1e9, 0.0), (8, 3e10, 9.81)])
@pytest.mark.parametrize("scheme", [SCHEME, dda.Scheme(0.25, 0.5, 0.99, 5e-4)])
def test_a_stiffly_glued_column_is_linear_elements(n, p, g, scheme):
    expected = linear_elements(n, p, scheme, 200, g=g)
    system = dda.subdivided(two_block(p=p, gravity=g), 1, n, 1e21)
    result = dda.solve_system(system, scheme, 200)
    assert result.unknowns == 2 * n  # v and ey of every sub-block
    for name, values in expected.items():
        # 1e-8 is asked; what is left is rounding: glue 1e12 E leaves n / 2e12 of compliance, times the phase
        np.testing.assert_allclose(result.columns[name], values, rtol=0, atol=1e-10 * np.abs(values).max())


STILL = {"traction": 2e5, "gravity": 9.81}


@pytest.mark.parametrize(
    ("n", "mu", "p", "loads", "scheme", "corrections"),
    [
        (3, 0.0, 2e9, {}, SCHEME, None),
        (5, 0.25, 2e9, LOADS, SCHEME, None),
        # without corrections a step of 10 s loses to 1e-5; the elements' own double arithmetic leaves some 1e-11
        (6, 0.3, 1e12, STILL, replace(SCHEME, step=0.1), 1),
        (6, 0.3, 1e12, STILL, dda.Scheme(0.25, 0.5, 1.0, 10.0), 2),
    ],
)
def test_stiffly_glued_triangles_are_linear_finite_elements(n, mu, p, loads, scheme, corrections):
    result = dda.solve_system(
        dda.subdivided(two_block(TRAPEZIUM, mu, p, **loads), n, n, 1e21, "triangles"), scheme, 50, COLUMNS
    )
    moved = fem_reference.Motion(*map(tuple, (RECORD.time, *np.transpose(RECORD.displacement))))
    others = loads | ({"motion": moved} if "motion" in loads else {})
    data = (2700.0, 1e9, mu, "plane stress", p, 0.8 * p, 5e6, n, 1)
    problem = fem_reference.Problem(TRAPEZIUM, 0, 2, *data, foundation="nodes", cells="triangles", **others)
    elements = fem_reference.Scheme(scheme.alpha, scheme.delta, 1.0, scheme.step)
    expected = fem_reference.solve(problem, elements, 50, COLUMNS, full=corrections is not None)
    assert corrections is None or result.solves == 50 * (1 + corrections)
    assert largest_error(result, expected) < 1e-9  # 1e-8 is asked


@pytest.mark.parametrize("ratio", [0.3, 50.0])
def test_finite_glue_is_the_assembled_system_in_other_coordinates(ratio):
    """Joints written down by hand, in the unknowns of the blocks, by plain Newmark."""
    width, height, nx, ny, p = 1.8, 1.2, 3, 2, 2e9
    vertices = ((0, 0), (width, 0), (width, height), (0, height))
    model = dda.TwoBlockModel(dda.Block(vertices, dda.Material(2700.0, 1e9, 0.2)), dda.Contact(p), 5e6, gravity=9.81)
    system = dda.subdivided(model, nx, ny, ratio * 1e9)
    w, h, blocks, glue = width / nx, height / ny, system.blocks, (ratio * 1e9,) * 2
    springs = []
    for k in range(nx * ny):
        x, y = (k % nx) * w, (k // nx) * h
        if k % nx < nx - 1:
            springs += [(k, k + 1, (x + w, y + end), *glue) for end in (0.0, h)]
        if k < nx:
            springs += [(k, k + nx, (x + end, y + h), *glue) for end in (0.0, w)]
            springs += [(k, None, (x + end, 0.0), p / nx, p / nx) for end in (0.0, w)]
    M, K = glued(blocks, springs)
    F, pressure = np.zeros((2, 6 * nx * ny))
    for k, block in enumerate(blocks):
        rows = slice(6 * k, 6 * k + 6)
        F[rows] = -9.81 * 2700.0 * w * h * np.eye(6)[1]
        if k >= nx:
            F[rows] -= 5e6 * w * block.T((k % nx + 0.5) * w, height)[1]
        else:
            pressure[rows] = -2 * p / nx / width * block.T((k + 0.5) * w, 0.0)[1]
    D = stepped(M, K, np.tile(F, (61, 1)), SCHEME)
    T = [blocks[k].T(width / 2, height / 2)[1] for k in (1, 4)]
    expected = {"displacement": (D[:, 6:12] @ T[0] + D[:, 24:30] @ T[1]) / 2, "contact_pressure": D @ pressure}
    result = dda.solve_system(system, SCHEME, 60)
    for name, values in expected.items():
        np.testing.assert_allclose(result.columns[name], values, rtol=0, atol=1e-11 * np.abs(values).max())


def test_squares_and_triangles_under_mixed_loads_keep_equilibrium():
    a, rho, tau, q, g, e = 2.0, 2700.0, 2e5, 5e6, 9.81, 0.35
    for pattern in ("squares", "triangles"):
        model = two_block(mu=0.25, gravity=g, traction=tau, eccentricity=e)
        static = dda.static(dda.subdivided(model, 5, 3, 1e12, pattern))
        # 0.35 cuts the middle of a sub-block's edge: the pressed part ends inside it
        assert static["contact_pressure"] == pytest.approx(q * (a - 2 * e) / a + rho * g * a, rel=1e-11)


def test_unknowns_out_of_reach_are_dropped_and_nothing_changes():
    column = dda.subdivided(two_block(), 1, 6, 1e13)
    saved, full = (dda.solve_system(column, SCHEME, 60, full=full) for full in (False, True))
    assert (saved.unknowns, full.unknowns) == (12, 36)
    assert saved.notes == ("12 of 36 unknowns kept",)
    assert largest_error(saved, full, COLUMNS[:2]) < 1e-12
    # A second column that stands apart is at rest, whatever it consists of.
    left = two_block(((0, 0), (1, 0), (1, 2), (0, 2)), mu=0.2)
    parts = [dda.subdivided(left, 1, 3, 1e13)]
    right = two_block(((5, 0), (6, 0), (6, 2), (5, 2)), mu=0.2)
    parts.append(dda.subdivided(right, 1, 3, 1e13))
    moved = [dda.Joint(j.first + 3, j.second + 3 if j.second >= 0 else -1, *j_rest(j)) for j in parts[1].joints]
    both = BlockSystem(
        [*parts[0].blocks, *parts[1].blocks], [*parts[0].joints, *moved], parts[0].observed, 1.0, parts[0].loads
    )
    alone, together = dda.solve_system(parts[0], SCHEME, 60), dda.solve_system(both, SCHEME, 60)
    assert together.unknowns == alone.unknowns == 9
    assert largest_error(together, alone, COLUMNS[:2]) < 1e-13


def j_rest(joint):
    return joint.start, joint.end, joint.normal, joint.shear


@pytest.mark.parametrize("pattern", ["squares", "triangles"])
def test_there_are_as_many_gaps_as_independent_relative_motions(pattern):
    gaps = dda.subdivided(two_block(), 2, 2, 1e9, pattern).equations.B.toarray()
    assert np.linalg.matrix_rank(gaps) == len(gaps)


def test_central_differences_and_their_limit():
    system = dda.subdivided(two_block(mu=0.2), 2, 3, 4e9)
    fastest = dda.highest_frequency(system)
    steady = dda.Scheme(0.0, 0.5, 1.0, 1.99 / fastest)
    wild = dda.Scheme(0.0, 0.5, 1.0, 2.01 / fastest)
    bounds = [np.abs(dda.solve_system(system, s, 600).columns["displacement"]).max() for s in (steady, wild)]
    assert bounds[0] < 0.05 < 1e3 < bounds[1]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"columns": 0}, "columns: must be at least 1"),
        ({"rows": -1}, "rows: must be at least 1"),
        ({"glue": 0.0}, "glue: must be finite and positive"),
        ({"pattern": "hexagons"}, "pattern: must be 'squares' or 'triangles'"),
        ({"model": two_block(PENTAGON)}, "only convex quadrilaterals"),
    ],
)
def test_what_cannot_be_cut_is_refused(changes, words):
    data = {"model": two_block(), "columns": 2, "rows": 2, "glue": 1e9, "pattern": "squares"} | changes
    with pytest.raises(ValueError, match=words):
        dda.subdivided(**data)


def test_joints_and_systems_are_checked():
    block = two_block().block
    with pytest.raises(ValueError, match="normal: must be finite and positive"):
        dda.Joint(0, 1, (0, 0), (1, 0), 0.0, 1.0)
    with pytest.raises(ValueError, match="end: must differ from start"):
        dda.Joint(0, 1, (0, 0), (0, 0), 1.0, 1.0)
    with pytest.raises(ValueError, match="must name blocks from 0 to 0"):
        BlockSystem([block], [dda.Joint(0, 1, (0, 0), (1, 0), 1.0, 1.0)], (1.0, 1.0), 2.0)
    with pytest.raises(ValueError, match="observed: must lie in a block"):
        BlockSystem([block], [], (3.0, 1.0), 2.0)


def test_what_leaves_the_range_of_doubles_is_infinite_from_there_on():
    system = dda.subdivided(two_block(mu=0.2), 2, 1, 1e11)
    result = dda.solve_system(system, dda.Scheme(0.0, 0.5, 1.0, 1.0), 200)
    (note,) = [note for note in result.notes if "overflow" in note]
    first = int(note.rpartition(" ")[2]) - 1
    for values in result.columns.values():
        assert np.all(np.isfinite(values[:first]))
        assert np.all(values[first + 1 :] == np.inf)


def test_a_scene_is_cut(scene_file):
    text = scene_file.read_text().replace("young = 1.0e9", "young = 1.0e9\nsubdivide = [1, 4]\nglue_ratio = 1e12")
    scene_file.write_text(
        text.replace("elements = 4", "elements = 4\ndegree = 1") + '[run]\nsolvers = ["dda", "fem"]\n'
    )
    scene = load_scene(scene_file)
    dda_run, fem_run = (solve(scene, name) for name in ("dda", "fem"))
    scale = np.abs(fem_run.displacement).max()
    np.testing.assert_allclose(dda_run.displacement, fem_run.displacement, rtol=0, atol=1e-9 * scale)
    with pytest.raises(InputError, match="does not handle sub-blocks"):
        solve(scene, "dda-textbook")
