"""The sparse matrix of bodies: order, fill and solutions, against dense ones."""

import numpy as np
import pytest

from dda.plane.elimination import (
    MISSING,
    block_matrix,
    clear_blocks,
    clear_pattern,
    factor_blocks,
    order_blocks,
    solve_blocks,
)


def neighbours(kind, n):
    """Return the pairs of bodies that touch."""
    if kind == "chain":
        return [(i, i + 1) for i in range(n - 1)]
    if kind == "star":
        return [(0, i) for i in range(1, n)]
    if kind == "apart":
        return []
    random = np.random.default_rng(n)
    return sorted({tuple(sorted(random.choice(n, 2, replace=False).tolist())) for _ in range(2 * n)})


def filled(kind, n, symmetric=True):
    """Return a matrix of blocks and the same as a dense one."""
    m = 3
    random = np.random.default_rng(3)
    matrix = block_matrix(n, 10_000)
    clear_pattern(matrix)
    for i, j in neighbours(kind, n):
        matrix.number[i, j] = matrix.number[j, i] = 0
    total = order_blocks(matrix)
    matrix.blocks[:] = 7.0  # of a step before
    clear_blocks(matrix, total)
    dense = np.zeros((n, m, n, m))
    dense[np.arange(n), :, np.arange(n)] = 40.0 * np.eye(m)
    for i, j in neighbours(kind, n):
        block = random.normal(size=(m, m))
        dense[i, :, j] = block
        dense[j, :, i] = block.T if symmetric else random.normal(size=(m, m))
    for i, j in np.argwhere(np.any(dense != 0, axis=(1, 3))):
        matrix.blocks[matrix.number[i, j]] = dense[i, :, j]
    return matrix, dense.reshape(n * m, n * m), total


@pytest.mark.parametrize(("kind", "n", "symmetric"), [("chain", 12, True), ("star", 9, False), ("random", 30, False)])
def test_solutions_are_those_of_the_dense_matrix(kind, n, symmetric):
    matrix, dense, _ = filled(kind, n, symmetric)
    right = np.random.default_rng(5).normal(size=3 * n)
    x = right.copy()
    assert factor_blocks(matrix)
    solve_blocks(matrix, x)
    assert x == pytest.approx(np.linalg.solve(dense, right), rel=1e-11, abs=1e-13)


@pytest.mark.parametrize(("kind", "blocks"), [("chain", 12 + 2 * 11), ("star", 12 + 2 * 11), ("apart", 12)])
def test_trees_fill_nothing(kind, blocks):
    matrix, _, total = filled(kind, 12)
    assert total == blocks
    assert sorted(matrix.order) == list(range(12))
    clear_pattern(matrix)
    assert order_blocks(matrix) == 12
    matrix, _, _ = filled(kind, 12)
    small = block_matrix(12, blocks - 1)
    small.number[:] = np.where(matrix.number == MISSING, MISSING, 0)
    assert order_blocks(small) == MISSING


def test_a_zero_pivot_is_told():
    matrix, _, _ = filled("chain", 4)
    matrix.blocks[matrix.number[2, 2]] = 0.0
    matrix.blocks[matrix.number[1, 2]] = 0.0
    matrix.blocks[matrix.number[3, 2]] = 0.0
    assert not factor_blocks(matrix)
