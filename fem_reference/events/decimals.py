"""Elementary functions and symmetric eigenvalues in decimal arithmetic of any number of digits.

`decimal` of the standard library has square roots and exponentials but neither cosines nor matrices. All
functions work in the precision of the current decimal context.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from decimal import MAX_EMAX, MIN_EMIN, Context, Decimal, getcontext, localcontext
from functools import lru_cache

ZERO, ONE, TWO = Decimal(0), Decimal(1), Decimal(2)
HALF = Decimal("0.5")

Vector = list[Decimal]
Matrix = list[Vector]

HALVINGS = 5
"""Times an angle is halved before its series is summed."""
SWEEPS = 60
"""Greatest number of Jacobi sweeps; they converge quadratically."""


def working(digits: int) -> AbstractContextManager[Context]:
    """A decimal context of so many digits, whatever the caller's own context is."""
    return localcontext(Context(prec=digits, Emin=MIN_EMIN, Emax=MAX_EMAX))


def dot(a: Iterable[Decimal], b: Iterable[Decimal]) -> Decimal:
    """Scalar product."""
    return sum((x * y for x, y in zip(a, b, strict=True)), ZERO)


def small(guard: int) -> Decimal:
    """10^(guard - digits): what is left of one when all but `guard` of the digits cancel."""
    return Decimal(10) ** (guard - getcontext().prec)


def split(value: Decimal) -> tuple[float, float]:
    """A decimal number as the sum of two floats."""
    high = float(value)
    return high, float(value - Decimal(high))


@lru_cache(maxsize=32)
def _pi(digits: int) -> Decimal:
    """Pi by the Gauss-Legendre iteration of arithmetic and geometric means."""
    with localcontext() as context:
        context.prec = digits + 10
        a, b, t, p = ONE, 1 / TWO.sqrt(), ONE / 4, ONE
        while abs(a - b) > Decimal(10) ** (-digits - 5):
            a, b, t, p = (a + b) / 2, (a * b).sqrt(), t - p * ((a - b) / 2) ** 2, 2 * p
        return (a + b) ** 2 / (4 * t)


def cos_sin(angle: Decimal) -> tuple[Decimal, Decimal]:
    """Cosine and sine of an angle.

    The angle is reduced by multiples of pi / 2 and halved; the series of 1 - cos and the formula
    1 - cos 2x = 2 (1 - cos x) (1 + cos x) keep the digits of small angles.
    """
    digits = getcontext().prec
    with localcontext() as context:
        context.prec = digits + max(0, angle.adjusted()) + 5
        quarter = _pi(context.prec) / 2
        turns = (angle / quarter).to_integral_value()
        rest = angle - turns * quarter
        context.prec = digits + 5
        versine, sine = _series(rest / 2**HALVINGS, digits + 5)
        for _ in range(HALVINGS):
            versine, sine = 2 * versine * (2 - versine), 2 * sine * (1 - versine)
        cosine = 1 - versine
        quadrant = int(turns) % 4
    return ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))[quadrant]


def _series(x: Decimal, digits: int) -> tuple[Decimal, Decimal]:
    """1 - cos x and sin x of a small x by their series."""
    square, term, k = x * x, x, 1
    sine, versine = x, ZERO
    end = x.adjusted() - digits
    while term and term.adjusted() > end:
        term = term * x / (k + 1)
        versine += term
        term = -term * x / (k + 2)
        sine += term
        k += 2
    return (versine, sine) if square else (ZERO, x)


def eigen(matrix: Sequence[Sequence[Decimal]]) -> tuple[Vector, Matrix]:
    """Eigenvalues and orthonormal eigenvectors, one a row, of a symmetric matrix by Jacobi's rotations."""
    n = len(matrix)
    A = [list(row) for row in matrix]
    V = [[ONE if i == j else ZERO for j in range(n)] for i in range(n)]
    for _ in range(SWEEPS):
        if not _sweep(A, V):
            break
    return [A[i][i] for i in range(n)], V


def _sweep(A: Matrix, V: Matrix) -> bool:
    """Rotate every off-diagonal entry away once; whether there was any."""
    floor = small(0) * max(abs(x) for row in A for x in row)
    rotated = False
    for i in range(len(A)):
        for j in range(i + 1, len(A)):
            if abs(A[i][j]) > floor:
                _rotate(A, V, i, j)
                rotated = True
    return rotated


def _rotate(A: Matrix, V: Matrix, i: int, j: int) -> None:
    """Make A[i][j] zero by a rotation in the plane of i and j."""
    ratio = (A[j][j] - A[i][i]) / (2 * A[i][j])
    t = (ONE if ratio >= 0 else -ONE) / (abs(ratio) + (ratio * ratio + 1).sqrt())
    c = 1 / (t * t + 1).sqrt()
    s = t * c
    for k in range(len(A)):
        A[k][i], A[k][j] = c * A[k][i] - s * A[k][j], s * A[k][i] + c * A[k][j]
    for k in range(len(A)):
        A[i][k], A[j][k] = c * A[i][k] - s * A[j][k], s * A[i][k] + c * A[j][k]
    V[i], V[j] = (
        [c * x - s * y for x, y in zip(V[i], V[j], strict=True)],
        [s * x + c * y for x, y in zip(V[i], V[j], strict=True)],
    )


def root(function: Callable[[Decimal], tuple[Decimal, Decimal]], low: Decimal, high: Decimal) -> Decimal:
    """The root of a function that falls through zero between `low` and `high`.

    Newton's method, kept inside the bracket by bisection, until its step is below the digits.

    Parameters
    ----------
    function
        Value and derivative.
    low, high
        Ends of the bracket; the function is positive (or zero) at `low` and negative at `high`.
    """
    floor = small(4) * max(abs(low), abs(high))
    x = (low + high) / 2
    for _ in range(8 * getcontext().prec):
        value, slope = function(x)
        low, high = (x, high) if value >= 0 else (low, x)
        step = -value / slope if slope else ZERO
        following = x + step
        if not (slope and low <= following <= high):
            following = (low + high) / 2
        if abs(following - x) <= floor or high - low <= floor:
            return following
        x = following
    return x
