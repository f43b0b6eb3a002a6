"""Glued blocks under loads on their outline: hand values at rest, held and free, plain assembly in motion."""

import numpy as np
import pytest
from oracles.staged import System, march

import dda

YOUNG, DENSITY, GLUE, CLAMP = 1e9, 2700.0, 4e9, 7e9  # Pa, kg/m3, N/m, N/m
ROCK = dda.Material(DENSITY, YOUNG, 0.0)
LEFT, RIGHT = ((0.0, 0.0), (0.0, 1.0)), ((2.0, 0.0), (2.0, 1.0))
SIZE = 3e6  # Pa
PULLED = dda.Traction(*RIGHT, (SIZE, 0.0))
SCHEME = dda.Scheme(0.25, 0.5, 0.99, 4e-4)


def cell(x, y, width=1.0):
    return dda.Block([(x, y), (x + width, y), (x + width, y + 1), (x, y + 1)], ROCK)


PAIR = [cell(0.0, 0.0), cell(1.0, 0.0)]
TEE = [cell(0.0, 0.0, 2.0), cell(0.0, 1.0), cell(1.0, 1.0)]
HELD = {"clamps": [LEFT], "clamp_glue": CLAMP, "tractions": [PULLED]}
FREE = {"tractions": [PULLED, dda.Traction(*LEFT, (-SIZE, 0.0))]}


def body(blocks=PAIR, glue=GLUE, **loads):
    return dda.GluedBlocks(dda.glued_blocks(blocks, glue, **loads))


def glued(blocks, springs):
    """Return M and K of blocks on springs at points, (first, second or None, point, normal, shear) on level edges.

    Shear is along x and normal along y; of an upright edge the two are exchanged.
    """
    size = 6 * len(blocks)
    M, K = np.zeros((2, size, size))
    for i, block in enumerate(blocks):
        part = slice(6 * i, 6 * i + 6)
        M[part, part] = block.mass()
        K[part, part] = block.elastic()
    for first, second, point, normal, shear in springs:
        gap = np.zeros((2, size))
        gap[:, 6 * first : 6 * first + 6] = blocks[first].T(*point)
        if second is not None:
            gap[:, 6 * second : 6 * second + 6] = -blocks[second].T(*point)
        K += gap.T @ np.diag([shear, normal]) @ gap
    return M, K


def rigid(blocks):
    """Return translations and the turn about the origin in the blocks' unknowns, (unknowns, 3)."""
    motions = np.zeros((len(blocks), 6, 3))
    motions[:, :3] = np.eye(3)
    motions[:, :2, 2] = [(-block.section.centroid[1], block.section.centroid[0]) for block in blocks]
    return motions.reshape(-1, 3)


@pytest.mark.parametrize("stress", [(SIZE, 0.0, 0.0), (0.0, -SIZE, 0.0), (0.0, 0.0, SIZE), (SIZE, -2 * SIZE, 5e5)])
def test_a_t_junction_passes_every_stress(stress):
    """Stiff glue; the edge below is cut where the two above meet. Nothing moves or turns as a whole."""
    tee = body(TEE, 1e9 * YOUNG, stress=stress)
    ends = {(joint.first, joint.second): {joint.start, joint.end} for joint in tee.system.joints}
    assert {tuple(sorted(pair)): places for pair, places in ends.items()} == {
        (0, 1): {(0.0, 1.0), (1.0, 1.0)}, (0, 2): {(1.0, 1.0), (2.0, 1.0)}, (1, 2): {(1.0, 1.0), (1.0, 2.0)}
    }  # fmt: skip
    e_x, e_y, s_xy = np.array(stress) / YOUNG
    assert tee.strains == pytest.approx(np.tile([e_x, e_y, 2 * s_xy], (3, 1)), abs=2e-8 * max(map(abs, stress)) / YOUNG)
    momentum = [block.mass() @ rest for block, rest in zip(TEE, tee.rest, strict=True)]
    assert np.abs(np.concatenate(momentum) @ rigid(TEE)).max() < 1e-9 * np.abs(momentum).max()


FOUR = [*PAIR, cell(0.0, 1.0), cell(1.0, 1.0)]  # whose inner corners meet in one point
BETWEEN = {2: [(0, 1, (1.0, y)) for y in (0.0, 1.0)]}
BETWEEN[4] = BETWEEN[2] + [(2, 3, (1.0, y)) for y in (1.0, 2.0)] + [(0, 2, (x, 1.0)) for x in (0.0, 1.0)]
BETWEEN[4] += [(1, 3, (x, 1.0)) for x in (1.0, 2.0)]


@pytest.mark.parametrize(("blocks", "loads", "held"), [(PAIR, HELD, True), (PAIR, FREE, False), (FOUR, HELD, True)])
def test_modes_and_steps_are_those_of_the_plain_assembly(blocks, loads, held):
    body_of = body(blocks, **loads)
    springs = [(*joined, GLUE, GLUE) for joined in BETWEEN[len(blocks)]]
    springs += [(0, None, (0.0, y), CLAMP, CLAMP) for y in (0.0, 1.0)] * held
    M, K = glued(blocks, springs)
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)[0 if held else 3 :]
    modes = body_of.modes(SCHEME, len(squares))
    assert [mode.frequency for mode in modes] == pytest.approx(np.sqrt(squares), rel=1e-9)
    assert sum(mode.share for mode in modes) == pytest.approx(1.0, rel=1e-9)
    assert not any(mode.contact_share for mode in modes)
    F = np.zeros((len(blocks), 6))
    F[1] = SIZE * PAIR[1].T(2.0, 0.5)[0]
    F[0] = 0.0 if held else -SIZE * PAIR[0].T(0.0, 0.5)[0]
    rows = body_of.observer(*RIGHT)
    rest = np.zeros(F.size)
    system = System(M, K, lambda t: F.ravel())
    x, _, _ = march(system, "", SCHEME.step, 40, rest, rest, SCHEME.gg, zero=True, weights=(0.25, 0.5))
    expected = x[1:] @ rows.T
    result = body_of.history(SCHEME, 40, rows)
    for number, values in enumerate(expected.T):
        assert result.columns[str(number)] == pytest.approx(values, abs=1e-11 * np.abs(expected).max())
