r"""A sparse matrix of small square blocks, one row of them three modes, and its factors in an order of least degree.

The three are the rigid motions of a body, or its strains. The matrix A of bodies that share contacts is positive
definite, or nearly so (friction makes it unsymmetric): no rows need be exchanged, and its pattern is symmetric. Row by
row of blocks is eliminated, of those that are left the one with the fewest neighbours first,

    A_ij <- A_ij - A_ik A_kk^-1 A_kj        of all neighbours i, j of k that are left,

and A_kk^-1 is kept in the place of A_kk, A_ik and A_kj as they are when k is eliminated.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dda.contact.dense import Matrix, Vector

MISSING = -1  # of a block that is zero, and of an order for which there is no room
THREE = 3  # rows and columns of a block; loops whose length is known take half as long


class BlockMatrix(NamedTuple):
    """The blocks that are not zero, and in which order bodies are eliminated."""

    number: Any  # (n, n) of each block among `blocks`, MISSING where it is zero
    blocks: Any  # (most, 3, 3)
    order: Any  # (n,) rows of blocks as they are eliminated
    later: Any  # (n, n) neighbours of each that are eliminated after it
    count: Any  # (n,) how many these are
    degree: Any  # (n,) work: neighbours that are left
    part: Vector  # (3,) work
    panel: Matrix  # (4, 3 n) work: a row of blocks, and a row that is taken off


def block_matrix(n: int, most: int) -> BlockMatrix:
    """Return a matrix of n rows of blocks without any, with room for so many."""
    return BlockMatrix(
        number=np.full((n, n), MISSING),
        blocks=np.zeros((most, THREE, THREE)),
        order=np.zeros(n, np.int64),
        later=np.zeros((n, n), np.int64),
        count=np.zeros(n, np.int64),
        degree=np.zeros(n, np.int64),
        part=np.zeros(THREE),
        panel=np.zeros((THREE + 1, THREE * n)),
    )


def clear_pattern(matrix: BlockMatrix) -> None:
    """Take all blocks away. Those of neighbours are then named by a number that is not MISSING, both ways."""
    for row in matrix.number:
        for j in range(len(row)):
            row[j] = MISSING


def order_blocks(matrix: BlockMatrix) -> int:
    """Order the rows and number all blocks of the factors; return how many, MISSING where there is no room.

    Blocks that elimination fills are among them, and those on the diagonal. They lie as they are needed: A_kk, then
    A_kj and A_jk of each of the later neighbours j of k.
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
    for k in order:
        number[k][k] = total
        total += 1
        for a in range(matrix.count[k]):
            number[k][matrix.later[k][a]] = total
            number[matrix.later[k][a]][k] = total + 1
            total += 2
    return total if total <= len(matrix.blocks) else MISSING


def clear_blocks(matrix: BlockMatrix, total: int) -> None:
    """Set so many blocks to zero, to be summed up anew."""
    for number in range(total):
        block = matrix.blocks[number]
        for r in range(THREE):
            for c in range(THREE):
                block[r][c] = 0.0


def factor_blocks(matrix: BlockMatrix) -> bool:
    """Factor a matrix in place; tell whether it is regular."""
    number = matrix.number
    blocks = matrix.blocks
    panel = matrix.panel
    taken = panel[THREE]
    for k in matrix.order:
        own = number[k][k]
        pivot = blocks[own]
        if not invert(pivot):
            return False
        later = matrix.later[k]
        count = matrix.count[k]
        for b in range(count):
            upper = blocks[own + 1 + 2 * b]
            for r in range(THREE):
                for c in range(THREE):
                    panel[r][THREE * b + c] = (
                        pivot[r][0] * upper[0][c] + pivot[r][1] * upper[1][c] + pivot[r][2] * upper[2][c]
                    )
        for a in range(count):
            row = number[later[a]]
            lower = blocks[own + 2 + 2 * a]
            for r in range(THREE):
                first = lower[r][0]
                second = lower[r][1]
                third = lower[r][2]
                for place in range(THREE * count):  # long loops over what lies side by side
                    taken[place] = first * panel[0][place] + second * panel[1][place] + third * panel[2][place]
                for b in range(count):
                    rest = blocks[row[later[b]]][r]
                    for c in range(THREE):
                        rest[c] -= taken[THREE * b + c]
    return True


def solve_blocks(matrix: BlockMatrix, x: Vector) -> None:
    """Solve with the factors, the right-hand side (3 n,) in place."""
    blocks = matrix.blocks
    part = matrix.part
    for k in matrix.order:
        own = matrix.number[k][k]
        later = matrix.later[k]
        write_product(blocks[own], x, THREE * k, part)
        for a in range(matrix.count[k]):
            take_product(blocks[own + 2 + 2 * a], part, 0, x, THREE * later[a])
    for place in range(len(matrix.order) - 1, -1, -1):
        k = matrix.order[place]
        own = matrix.number[k][k]
        later = matrix.later[k]
        for a in range(matrix.count[k]):
            take_product(blocks[own + 1 + 2 * a], x, THREE * later[a], x, THREE * k)
        write_product(blocks[own], x, THREE * k, part)
        for r in range(THREE):
            x[THREE * k + r] = part[r]


def write_product(block: Matrix, x: Vector, start: int, out: Vector) -> None:
    """Write a block times three of x."""
    for r in range(THREE):
        out[r] = block[r][0] * x[start] + block[r][1] * x[start + 1] + block[r][2] * x[start + 2]


def take_product(block: Matrix, x: Vector, start: int, out: Vector, to: int) -> None:
    """Take a block times three of x off three of another vector."""
    for r in range(THREE):
        out[to + r] -= block[r][0] * x[start] + block[r][1] * x[start + 1] + block[r][2] * x[start + 2]


def invert(A: Matrix) -> bool:
    """Invert a small matrix in place without exchanges; tell whether no pivot is zero."""
    for k in range(THREE):
        pivot = A[k][k]
        if not abs(pivot) > 0:
            return False
        A[k][k] = 1.0
        for c in range(THREE):
            A[k][c] /= pivot
        for r in range(THREE):
            factor = A[r][k]
            if r == k or factor == 0:
                continue
            A[r][k] = 0.0
            for c in range(THREE):
                A[r][c] -= factor * A[k][c]
    return True
