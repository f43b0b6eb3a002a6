"""The motion of the block while its corners keep their states: x'' = f + R r - B x, whose series are entire.

B need not be symmetric where a corner slips, and may have any eigenvalues: a power series does not care. Over `ANGLE`
radians of the greatest rate that B can give few digits cancel, and what the motion does in so long a step is a matrix
that is computed once for each state of the corners. In floats the same series, with bounds of its rounding, proves for
most steps that nothing switches: Bernstein's form of a polynomial bounds it from below.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from flint import arb, arb_mat, ctx

from fem_reference.events.block_model import OPEN, STICKS, BlockModel, States, sigma
from fem_reference.events.enclosure import ball
from fem_reference.problem.problem import Array

ANGLE = 4.0
"""Length of a step times the greatest rate [rad]; e^4 = 55 is how far the terms of its series may cancel."""
FLOAT_TERMS = 36
"""Terms of a series in floats: 4^36/36! is 1e-20."""
CELLS = (4, 32)
"""Parts of a step whose Bernstein forms are looked at, of all functions and of those that the first cannot prove."""
ROUNDING = 40 * np.finfo(float).eps
"""Part of its terms by which a sum of `FLOAT_TERMS` terms of 18 products may be wrong in floats."""
SEARCHES = 4
"""Times that a first fall is looked for on a finer grid."""
GRID = np.arange(1, 129) / 128
CLOSE = 1e-7
"""Part of a step in which a fall that floats have seen must lie: four searches leave 128^-4 = 4e-9."""
UNIT = [[arb(int(i == j)) for j in range(6)] for i in range(6)]
CORNER_PLACES = [6, 7, 8, 9, 3, 5]
"""Places of (w_M, w_N, s_M, s_N, uy, vy), which determine the block, among the ten functions of `Flow.outputs`."""
REACH = 1 + 1e-6
"""Part of a step for which nothing must switch: the last step to a row is longer than others by rounding."""


@dataclass(frozen=True)
class Row:
    """weights x + constant + (dependence on the references) r, or the same of the rates of x."""

    weights: list[arb]  # over the unknowns
    constant: arb
    references: tuple[arb, arb]  # over the references of both corners
    of_rates: bool = False

    def mixed(self, own: arb, other: Row, share: arb) -> Row:
        """A multiple of this row plus a share of another one."""
        weights = [own * a + share * b for a, b in zip(self.weights, other.weights, strict=True)]
        first, second = (own * a + share * b for a, b in zip(self.references, other.references, strict=True))
        return Row(weights, own * self.constant + share * other.constant, (first, second), self.of_rates)

    @property
    def rate(self) -> Row:
        """The rate of this row, of the rates of the unknowns."""
        return Row(self.weights, arb(0), (arb(0), arb(0)), of_rates=True)


class Corner:
    """One corner in a state: its rows."""

    def __init__(self, model: BlockModel, index: int, state: int) -> None:
        self.model, self.state = model, state
        none, nothing = arb(0), (arb(0), arb(0))
        own = (arb(-1), none) if index == 0 else (none, arb(-1))
        self.gap = Row(model.normal[index], none, nothing)  # w [m]
        self.slide = Row(model.shear[index], none, nothing)  # s [m]
        self.stuck = Row(model.shear[index], none, own)  # s - r [m]
        limit = Row([-model.friction * model.p * x for x in model.normal[index]], model.cohesion, nothing)
        # what a corner that sticks can carry before it slips, limit - sign T, for both signs of T [N]
        self.reserves = {sign: limit.mixed(arb(1), self.stuck, sign * model.ps) for sign in (1, -1)}
        if state == OPEN:
            self.stretch = Row([none] * 6, none, nothing)  # -T / p_s [m]
        elif state == STICKS:
            self.stretch = self.stuck
        else:
            self.stretch = limit.mixed(-sigma(state) / model.ps, limit, none)
        self.reference = self.slide.mixed(arb(1), self.stretch, arb(-1))  # r [m] of one that slips or is open

    def watched(self) -> list[Row]:
        """Functions that are positive, or zero for ever, as long as the corner stays in its state."""
        if self.state == OPEN:
            return [self.gap]
        pressed = self.gap.mixed(arb(-1), self.gap, arb(0))
        if self.model.tan is None:
            return [pressed]
        if self.state == STICKS:
            return [pressed, self.reserves[1], self.reserves[-1]]
        # one that slips moves its reference in the direction of its slip
        return [pressed, self.reference.mixed(arb(-sigma(self.state)), self.reference, arb(0)).rate]


class Flow:
    """The block in one state of its corners."""

    def __init__(self, model: BlockModel, states: States) -> None:
        self.model, self.states = model, states
        self.corners = [Corner(model, c, states[c]) for c in (0, 1)]
        self.watched = [] if model.locked else [row for corner in self.corners for row in corner.watched()]
        self.B, self.f, self.R = model.accelerations(states)
        self.B_floats, self.R_floats = to_floats(self.B), to_floats(self.R)
        self.scale = np.sqrt([float(m) for m in model.mass])
        scaled = self.scale[:, None] * self.B_floats / self.scale
        self.rate = math.sqrt(float(np.linalg.norm(scaled, 2))) * (1 + 1e-9)  # bound of the rates of the motion [rad/s]
        self._steps: dict[int, Step] = {}

    def acceleration(self, x: arb_mat, references: arb_mat) -> arb_mat:
        """The accelerations at displacements."""
        return self.f + self.R * references - self.B * x

    def step(self, span: float) -> Step:
        """The longest step of at most `ANGLE` radians that divides a span [s], from the few that are ever asked for."""
        count = max(1, math.ceil(self.rate * span / ANGLE * (1 - 1e-9)))
        length = span / count
        key = round(math.log(length) * 1e8)  # rows of a record are not evenly spaced in their last digits
        if key not in self._steps:
            self._steps[key] = Step(self, length)
        return self._steps[key]

    def terms(self, x: arb_mat, v: arb_mat, a: arb_mat, length: arb, count: int) -> list[arb_mat]:
        """The first coefficients of the powers of time / length of the unknowns, see `series`."""
        square = self.B * (-length * length)
        terms = [x, v * length, a * (length * length / 2)]
        for k in range(3, count):
            terms.append((square * terms[k - 2]) * _inverse(k * (k - 1), ctx.prec))
        return terms[:count]

    def series(self, x: arb_mat, v: arb_mat, a: arb_mat, length: arb, least: int = 3) -> list[arb_mat]:
        """Coefficients of the powers of time / length of the unknowns, the last one enclosing all further terms.

        Parameters
        ----------
        x, v, a
            Unknowns, their rates and accelerations, of any number of columns.
        length
            Unit of the time [s].
        least
            Terms, at least.
        """
        n = max(least, term_count(self.rate * abs(float(length))) + 1)  # one more for the rates
        terms = self.terms(x, v, a, length, n)
        # In units of the mass B has the norm rate^2: each further term is at most a quarter of the last but one.
        columns = x.ncols()
        angle = self.rate * abs(float(length)) * (1 + 1e-9)
        rest = np.zeros(columns)
        for k in (n, n + 1):
            sizes = np.array([float(c.abs_upper()) for c in terms[k - 2].entries()]).reshape(6, columns)
            rest += (self.scale @ sizes) * angle**2 / (k * (k - 1))
        terms.append(arb_mat([[ball(4 * rest[j] / s) for j in range(columns)] for s in self.scale]))
        return terms

    def floats(self, s: float) -> tuple[Array, Array, Array]:
        """The matrices cos, sin / w and (1 - cos) / w^2 of w^2 = B after a time, in floats."""
        term, k = np.eye(6), 0
        C, S, P = np.zeros((6, 6)), np.zeros((6, 6)), np.zeros((6, 6))
        while k < FLOAT_TERMS:
            C += term
            S += term * (s / (k + 1))
            P += term * (s * s / ((k + 1) * (k + 2)))
            k += 2
            term = -(self.B_floats @ term) * (s * s / (k * (k - 1)))
        return C, S, P

    def jacobian(self, s: float) -> Array:
        """How unknowns, rates and references depend on those before a time, shape (14, 14)."""
        C, S, P = self.floats(s)
        J = np.eye(14)
        J[:6, :6] = J[6:12, 6:12] = C
        J[:6, 6:12], J[6:12, :6] = S, -S @ self.B_floats
        J[:6, 12:], J[6:12, 12:] = P @ self.R_floats, S @ self.R_floats
        return J

    @cached_property
    def outputs(self) -> Array:
        """Rows over (u, v, ux, uy, vx, vy, w_M, w_N, s_M or its stretch, s_N or its) of what is reported.

        They are the six unknowns, the gaps, the stretches less their constant parts and the slides less theirs.
        """
        rows = np.zeros((12, 10))
        rows[:6, :6] = np.eye(6)
        rows[6:8, 6:8] = np.eye(2)
        for c in (0, 1):
            rows[10 + c, 8 + c] = 1.0
            if self.states[c] == STICKS:
                rows[8 + c, 8 + c] = 1.0
            elif self.states[c] != OPEN:
                model = self.model
                rows[8 + c, 6 + c] = sigma(self.states[c]) * float(model.friction * model.p / model.ps)
        return rows

    @cached_property
    def stretched(self) -> Array:
        """Constant parts of the stretches [m], shape (2,)."""
        slips = [abs(state) > 1 for state in self.states]
        part = float(self.model.cohesion / self.model.ps) if any(slips) else 0.0
        return np.array([-sigma(state) * part * slip for state, slip in zip(self.states, slips, strict=True)])

    def powers(self, length: float) -> Array:
        """Coefficients of (time / length)^k of ten functions (see `outputs`), over their values, rates, accelerations.

        Shape (FLOAT_TERMS, 10, 30). The unknowns follow from the unknowns, the functions of the corners from those of
        the corners with uy and vy, so that neither loses digits to the other.
        """
        corners = to_floats(self.to_corners * self.B * self.to_corners.inv())
        square = np.zeros((10, 10))
        square[:6, :6] = self.B_floats
        square[6:, CORNER_PLACES] = corners[:4]
        scaled = -square * length * length
        result = np.zeros((FLOAT_TERMS, 10, 30))
        result[0, :, :10] = np.eye(10)
        result[1, :, 10:20] = np.eye(10) * length
        result[2, :, 20:] = np.eye(10) * length * length / 2
        for k in range(3, FLOAT_TERMS):
            result[k] = scaled @ result[k - 2] / (k * (k - 1))
        return result

    @cached_property
    def to_corners(self) -> arb_mat:
        """From the unknowns to (w_M, w_N, s_M, s_N, uy, vy)."""
        return arb_mat([*self.model.normal, *self.model.shear, UNIT[3], UNIT[5]])

    @cached_property
    def readings(self) -> arb_mat:
        """From the unknowns to the ten functions of `outputs`, the references apart."""
        return arb_mat([*UNIT, *self.model.normal, *self.model.shear])

    @cached_property
    def reading_sizes(self) -> Array:
        """Bounds of the ten functions, their rates and accelerations by those of unknowns, rates and references."""
        sizes = np.abs(to_floats(self.readings))
        table = np.zeros((30, 14))
        table[:10, :6] = table[10:20, 6:12] = sizes
        table[20:, :6] = sizes @ np.abs(self.B_floats)
        table[20:, 12:] = sizes @ np.abs(self.R_floats)
        table[8:10, 12:] = np.eye(2)
        return table * (1 + 1e-12)

    def values(self, x: arb_mat, v: arb_mat, a: arb_mat, references: arb_mat) -> Array:
        """The ten functions of `outputs`, their rates and accelerations, in floats, shape (30,)."""
        both = arb_mat(6, 3, [part[i, 0] for i in range(6) for part in (x, v, a)])
        read = self.readings * both
        for c in (0, 1):
            if self.states[c] == STICKS:
                read[8 + c, 0] = read[8 + c, 0] - references[c, 0]
        return np.array([float(entry) for entry in read.entries()]).reshape(10, 3).T.ravel()


class Step:
    """A step of one length in one state of the corners."""

    def __init__(self, flow: Flow, length: float) -> None:
        self.flow, self.length = flow, length
        unit, nothing = arb_mat(UNIT), arb_mat(6, 6)
        S = _sum(flow.series(nothing, unit, nothing, arb(length)))
        P = _sum(flow.series(nothing, nothing, unit, arb(length)))
        C = unit - flow.B * P
        x_rows = [[*UNIT[i], *S.tolist()[i], *P.tolist()[i]] for i in range(6)]
        v_rows = [[*nothing.tolist()[i], *C.tolist()[i], *S.tolist()[i]] for i in range(6)]
        self.matrix = arb_mat(x_rows + v_rows)  # from (x, v, a) to (x, v)
        self.jacobian = flow.jacobian(length)
        powers = flow.powers(length * REACH)
        tables = []
        for row in flow.watched:
            table = np.einsum("i,kij->kj", _over_readings(flow, row), powers)
            if row.of_rates:
                slopes = table[1:] * np.arange(1, FLOAT_TERMS)[:, None] / (length * REACH)
                table = np.vstack([slopes, np.zeros((1, 30))])
            tables.append(table)
        self.tables = np.array(tables).reshape(len(tables), FLOAT_TERMS, 30)
        self.sizes = np.abs(self.tables).sum(axis=1)
        self.constants = np.array([float(row.constant) for row in flow.watched])

    def clear(self, values: Array, radius: Array, leads: list[int | None]) -> tuple[float, list[int]]:
        """The part of the step throughout which floats prove all watched functions to be positive, at most 1.

        Parameters
        ----------
        values
            The ten functions, their rates and accelerations at the start, shape (30,).
        radius
            How far these may be off, shape (30,).
        leads
            Of each watched function how many of its first terms are zero; None: it rests at zero.

        Returns
        -------
        share, doubtful
            The part, which ends just before a first fall that floats can see, and the functions that end it.
        """
        terms = self.tables @ values
        terms[:, 0] += self.constants
        margin = self.sizes @ (ROUNDING * np.abs(values) + radius) + ROUNDING * np.abs(self.constants)
        for i, place in enumerate(leads):
            if place is None:
                terms[i], margin[i] = 1.0, 0.0
            elif place:
                terms[i] = np.append(terms[i, place:], np.zeros(place))
        doubtful = np.arange(len(terms))
        for cells in CELLS:
            least = (terms[doubtful] @ bernstein(cells)).min(axis=1)
            doubtful = doubtful[~(least > margin[doubtful])]
            if not len(doubtful):
                return 1.0, []
        terms, margin = terms[doubtful], margin[doubtful]
        low, width = 0.0, 1.0
        for _ in range(SEARCHES):
            grid = low + width * GRID
            grid_values = terms @ np.vander(grid, FLOAT_TERMS, increasing=True).T
            below = np.flatnonzero((grid_values <= margin[:, None]).any(axis=0))
            if not len(below) or (below[0] == 0 and low == 0.0):
                return 0.0, doubtful.tolist()
            low, width = low + width * GRID[below[0]] - width / len(GRID), width / len(GRID)
        ahead = terms * low ** np.arange(FLOAT_TERMS)
        proven = bool(np.all((ahead @ bernstein(CELLS[0])).min(axis=1) > margin))
        return (low if proven else 0.0), doubtful.tolist()


def _over_readings(flow: Flow, row: Row) -> Array:
    """Weights of a watched function over the ten functions of `Flow.outputs`; stretches hold their references."""
    weights = np.zeros(10)
    over = arb_mat([row.weights]) * flow.to_corners.inv()
    weights[CORNER_PLACES] = [0.0 if over[0, j].contains(0) else float(over[0, j]) for j in range(6)]
    return weights


def _sum(terms: list[arb_mat]) -> arb_mat:
    total = terms[0]
    for term in terms[1:]:
        total = total + term
    return total


def to_floats(matrix: arb_mat) -> Array:
    """Midpoints of a matrix."""
    return np.array([float(x) for x in matrix.entries()]).reshape(matrix.nrows(), matrix.ncols())


@cache
def _inverse(number: int, bits: int) -> arb:
    return 1 / arb(number)


@cache
def _term_count(angle: float, bits: int) -> int:
    left, n = 0.0, 0
    while left > -bits - 12 or n < 2 * angle:
        n += 1
        left += math.log2(angle / n)
    return n


def term_count(angle: float) -> int:
    """Terms of a series over an angle whose remainder is below the digits of the current context."""
    rounded = 2.0 ** (math.ceil(2 * math.log2(max(angle, 1e-200))) / 2)  # few angles, whose counts are kept
    return _term_count(rounded, ctx.prec)


@cache
def bernstein(cells: int) -> Array:
    """From the coefficients of powers on [0, 1] to those of Bernstein's forms on equal parts of it, (terms, forms)."""
    n = FLOAT_TERMS - 1
    # z = (cell + t) / cells: z^j = sum of C(j, k) cell^(j - k) t^k / cells^j, and t^k has the form C(i, k) / C(n, k)
    form = [[math.comb(i, k) / math.comb(n, k) for i in range(n + 1)] for k in range(n + 1)]
    parts = []
    for cell in range(cells):
        shift = np.zeros((n + 1, n + 1))
        for j in range(n + 1):
            for k in range(j + 1):
                shift[j, k] = math.comb(j, k) * cell ** (j - k) / cells**j
        parts.append(shift @ np.array(form))
    return np.hstack(parts)
