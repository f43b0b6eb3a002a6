"""Operations on small matrices as plain loops, which take arrays as well as lists and can be compiled."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Matrix = Any  # (n, m) array, or a list of lists of floats
Vector = Any  # (n,) array, or a list of floats


def zeros(*shapes: int | tuple[int, ...], dtype: type = float) -> list[Any]:
    """Return arrays of zeros."""
    return [np.zeros(shape, dtype=dtype) for shape in shapes]


def dot(a: Vector, b: Vector, n: int) -> float:
    """Return the sum of the first n products."""
    total = 0.0
    for i in range(n):
        total += a[i] * b[i]
    return total


def copy(source: Vector, target: Vector) -> None:
    """Write a vector."""
    for i in range(len(source)):
        target[i] = source[i]


def copy_matrix(source: Matrix, target: Matrix) -> None:
    """Write a matrix."""
    for i in range(len(source)):
        copy(source[i], target[i])


def eliminate(A: Matrix, right: Matrix, scale: Vector, size: int, columns: int) -> None:
    """Solve A X = right in place of `right`, by elimination with pivots; `scale` brings the rows to one size."""
    for i in range(size):
        best = i
        largest = abs(A[i][i]) * scale[i]
        for k in range(i + 1, size):
            entry = abs(A[k][i]) * scale[k]
            if entry > largest:
                best = k
                largest = entry
        if best != i:
            scale[i], scale[best] = scale[best], scale[i]
            for j in range(i, size):
                A[i][j], A[best][j] = A[best][j], A[i][j]
            for j in range(columns):
                right[i][j], right[best][j] = right[best][j], right[i][j]
        row = A[i]
        pivot = row[i] if row[i] != 0 else math.nan
        for k in range(i + 1, size):
            lower = A[k]
            factor = lower[i] / pivot
            if factor != 0:
                for j in range(i + 1, size):
                    lower[j] -= factor * row[j]
                for j in range(columns):
                    right[k][j] -= factor * right[i][j]
    for i in range(size - 1, -1, -1):
        row = A[i]
        pivot = row[i] if row[i] != 0 else math.nan
        for j in range(columns):
            total = right[i][j]
            for k in range(i + 1, size):
                total -= row[k] * right[k][j]
            right[i][j] = total / pivot
