r"""A sparse matrix of small square blocks, one row of them a body, and its factors in an order of least degree.

The matrix A of bodies that share contacts is positive definite, or nearly so (friction makes it unsymmetric): no rows
need be exchanged, and its pattern is symmetric. Body by body is eliminated, of those that are left the one with the
fewest neighbours first,

    A_ij <- A_ij - A_ik A_kk^-1 A_kj        of all neighbours i, j of k that are left,

and A_kk^-1 is kept in the place of A_kk, A_ik and A_kj as they are when k is eliminated.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix, Vector, copy, dot

MISSING = -1  # of a block that is zero, and of an order for which there is no room


class BlockMatrix(NamedTuple):
    """The blocks that are not zero, and in which order bodies are eliminated."""

    number: Any  # (n, n) of each block among `blocks`, MISSING where it is zero
    blocks: Any  # (most, m, m)
    order: Any  # (n,) bodies as they are eliminated
    later: Any  # (n, n) neighbours of each body that are eliminated after it
    count: Any  # (n,) how many these are
    degree: Any  # (n,) work: neighbours that are left
    part: Vector  # (m,) work
    panel: Matrix  # (m + 1, n m) work: a row of blocks, and a row that is taken off


def block_matrix(bodies: int, m: int, most: int) -> BlockMatrix:
    """Return a matrix without blocks, with room for so many of size m."""
    n = bodies
    return BlockMatrix(
        number=np.full((n, n), MISSING),
        blocks=np.zeros((most, m, m)),
        order=np.zeros(n, np.int64),
        later=np.zeros((n, n), np.int64),
        count=np.zeros(n, np.int64),
        degree=np.zeros(n, np.int64),
        part=np.zeros(m),
        panel=np.zeros((m + 1, n * m)),
    )


def clear_pattern(matrix: BlockMatrix) -> None:
    """Take all blocks away. Those of neighbours are then named by a number that is not MISSING, both ways."""
    for row in matrix.number:
        for j in range(len(row)):
            row[j] = MISSING


def order_blocks(matrix: BlockMatrix) -> int:
    """Order the bodies and number all blocks of the factors; return how many, MISSING where there is no room.

    Blocks that elimination fills are among them, and those of all bodies themselves.
    """
    number = matrix.number
    order = matrix.order
    degree = matrix.degree
    n = len(order)
    for i in range(n):
        number[i][i] = 0
        order[i] = i
        degree[i] = -1  # itself is none
        for j in range(n):
            if number[i][j] != MISSING:
                degree[i] += 1
    for step in range(n):
        least = step  # of those that are left, which stand from here on
        for place in range(step + 1, n):
            if degree[order[place]] < degree[order[least]]:
                least = place
        k = order[least]
        order[least] = order[step]
        order[step] = k
        later = matrix.later[k]
        count = 0
        for place in range(step + 1, n):
            i = order[place]
            if number[k][i] != MISSING:
                later[count] = i
                count += 1
                degree[i] -= 1
        matrix.count[k] = count
        for a in range(count):
            i = later[a]
            for b in range(a + 1, count):
                j = later[b]
                if number[i][j] == MISSING:
                    number[i][j] = 0
                    number[j][i] = 0
                    degree[i] += 1
                    degree[j] += 1
    total = 0
    for row in number:
        for j in range(n):
            if row[j] != MISSING:
                row[j] = total
                total += 1
    return total if total <= len(matrix.blocks) else MISSING


def clear_blocks(matrix: BlockMatrix, total: int) -> None:
    """Set so many blocks to zero, to be summed up anew."""
    m = len(matrix.part)
    for number in range(total):
        block = matrix.blocks[number]
        for r in range(m):
            for c in range(m):
                block[r][c] = 0.0


def factor_blocks(matrix: BlockMatrix) -> bool:
    """Factor a matrix in place; tell whether it is regular."""
    number = matrix.number
    blocks = matrix.blocks
    panel = matrix.panel
    m = len(matrix.part)
    for k in matrix.order:
        pivot = blocks[number[k][k]]
        if not invert(pivot):
            return False
        later = matrix.later[k]
        count = matrix.count[k]
        for b in range(count):
            upper = blocks[number[k][later[b]]]
            for r in range(m):
                for c in range(m):
                    total = 0.0
                    for e in range(m):
                        total += pivot[r][e] * upper[e][c]
                    panel[r][m * b + c] = total
        taken = panel[m]
        for a in range(count):
            row = number[later[a]]
            lower = blocks[row[k]]
            for r in range(m):
                for place in range(m * count):  # long loops over what lies side by side
                    taken[place] = 0.0
                for e in range(m):
                    factor = lower[r][e]
                    upper = panel[e]
                    for place in range(m * count):
                        taken[place] += factor * upper[place]
                for b in range(count):
                    rest = blocks[row[later[b]]][r]
                    for c in range(m):
                        rest[c] -= taken[m * b + c]
    return True


def solve_blocks(matrix: BlockMatrix, x: Matrix) -> None:
    """Solve with the factors, the right-hand side (n, m) in place."""
    number = matrix.number
    part = matrix.part
    m = len(part)
    for k in matrix.order:
        inverse = matrix.blocks[number[k][k]]
        for r in range(m):
            part[r] = dot(inverse[r], x[k], m)
        for a in range(matrix.count[k]):
            i = matrix.later[k][a]
            take_product(matrix.blocks[number[i][k]], part, x[i])
    for place in range(len(matrix.order) - 1, -1, -1):
        k = matrix.order[place]
        for a in range(matrix.count[k]):
            j = matrix.later[k][a]
            take_product(matrix.blocks[number[k][j]], x[j], x[k])
        inverse = matrix.blocks[number[k][k]]
        for r in range(m):
            part[r] = dot(inverse[r], x[k], m)
        copy(part, x[k])


def take_product(block: Matrix, x: Vector, out: Vector) -> None:
    """Take a block times x off."""
    for r in range(len(x)):
        out[r] -= dot(block[r], x, len(x))


def invert(A: Matrix) -> bool:
    """Invert a small matrix in place without exchanges; tell whether no pivot is zero."""
    m = len(A)
    for k in range(m):
        pivot = A[k][k]
        if not abs(pivot) > 0:
            return False
        A[k][k] = 1.0
        for c in range(m):
            A[k][c] /= pivot
        for r in range(m):
            factor = A[r][k]
            if r == k or factor == 0:
                continue
            A[r][k] = 0.0
            for c in range(m):
                A[r][c] -= factor * A[k][c]
    return True
