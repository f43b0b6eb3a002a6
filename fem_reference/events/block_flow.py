"""The motion of the block while its corners keep their states: z' = G z, whose power series are entire.

z = (x, x', r, 1) holds the six unknowns, their rates, the references of both corners and a one, so that every function
that is watched or reported is a row over z, and its rate is that row times G. G may have any eigenvalues where a corner
slips: a power series does not care. A long time is a step of at most `ANGLE` radians of the greatest rate that G can
give, or a sum of halvings of one, whose exp(G s) are kept; what is left of it needs a few terms of the series.

Floats prove for most steps that nothing switches: the Bernstein forms of the watched functions bound them from below.
"""

from __future__ import annotations

import math
from functools import cache, cached_property

import numpy as np
from flint import arb, arb_mat, ctx

from fem_reference.events.block_model import OPEN, RIGHT, STICKS, BlockModel, States, row, sigma
from fem_reference.events.enclosure import ball
from fem_reference.problem.problem import Array

SIZE = 15
"""Entries of z: 6 unknowns, their rates, 2 references and a one."""
ANGLE = 12.0
"""Length of a step times the greatest rate [rad]: e^12 is how far the terms of its series may cancel, 18 bits."""
FLOAT_TERMS = 64
"""Terms of a series in floats: 12^64/64! is 1e-20."""
FIRST_CELLS = 4
"""Parts of a step whose Bernstein forms are looked at first."""
CELLS = 8
"""Parts into which the first part that cannot be proven is cut, time and again."""
CUTS = 5
"""Times that it is cut: a fall is left in 1/32768 of a step."""
ROUNDING = 400 * np.finfo(float).eps
"""Part of its terms by which a Bernstein form of `FLOAT_TERMS` terms of 15 products may be wrong after all cuts."""
DERIVATIVES = 10
"""Terms of a function's series after which it counts as zero for ever."""
FEW = 4
"""Terms that are looked at first: most functions show at once where they go."""
REACH = 1 + 1e-6
"""Part of a step for which nothing must switch: the last step to a row is longer than others by rounding."""
UNIT = np.eye(SIZE)
LEVELS = 16
"""Halvings of a step whose exp(G s) are kept."""
NEGLIGIBLE = 1e-13
"""Angle over which floats of exp(G s) are those of a one [rad]."""


class Flow:
    """The block in one state of its corners."""

    def __init__(self, model: BlockModel, states: States) -> None:
        self.model, self.states = model, states
        self.G = model.generator(states)
        self.G_floats = to_floats(self.G)
        B = -self.G_floats[6:12, :6]
        scale = np.sqrt([float(m) for m in model.mass])
        scaled = scale[:, None] * B / scale
        self.rate = math.sqrt(float(np.linalg.norm(scaled, 2))) * (1 + 1e-9)  # bound of the rates of the motion [rad/s]
        self.norm = [*(1 / (scale * self.rate)).tolist(), *(1 / scale).tolist()]  # of unknowns and rates of norm one
        self.stretches: list[arb_mat] = []  # s - r of each corner, which is -T / p_s [m]
        self.references: list[arb_mat] = []  # r of each corner that does not stick [m]
        self.watched: list[arb_mat] = []  # positive, or zero for ever, as long as both corners stay in their states
        for corner in (0, 1):
            self._add_corner(corner)
        self._lines: list[list[arb]] = []
        self._derivatives: dict[tuple[int, int | None], arb_mat] = {}
        self._steps: dict[int, Step] = {}
        self.units = [2.0 ** (math.ceil(math.log2(ANGLE / self.rate)) - level) for level in range(1, LEVELS + 1)]

    def _add_corner(self, c: int) -> None:
        """Add the rows of one corner."""
        model, state = self.model, self.states[c]
        gap, slide, stuck = model.gaps[c], model.slides[c], model.stuck[c]
        limit = gap * (-model.friction * model.p) + row(one=model.cohesion)  # tan(phi) N + C
        if state == OPEN:
            stretch, watched = row(), [gap]
        elif state == STICKS:
            stretch, watched = stuck, [gap * -1]
            if model.tan is not None:
                watched += [model.reserves[c, sign] for sign in (1, -1)]
        else:
            stretch, watched = limit * (-sigma(state) / model.ps), [gap * -1]
            # one that slips moves its reference in the direction of its slip
            watched.append((slide - stretch) * self.G * -sigma(state))
        self.stretches.append(stretch)
        self.references.append(slide - stretch)
        if not model.locked:
            self.watched += watched

    @cached_property
    def dissipates(self) -> bool:
        """Whether a corner slips against friction."""
        rough = self.model.friction != 0 or self.model.cohesion != 0
        return bool(rough) and any(abs(state) == RIGHT for state in self.states)

    @cached_property
    def _hessian(self) -> arb_mat:
        model = self.model
        H = [[arb(0)] * SIZE for _ in range(SIZE)]
        for i, m in enumerate(model.mass):
            H[i][:6] = model.elastic[i]
            H[6 + i][6 + i] = m
            H[i][14] = H[14][i] = -model.load[i]
        total = arb_mat(H)
        for c, state in enumerate(self.states):
            if state != OPEN:
                gap, stretch = model.gaps[c], self.stretches[c]
                total = total + gap.transpose() * gap * model.p + stretch.transpose() * stretch * model.ps
        return total

    def energy(self, z: arb_mat) -> arb:
        """Kinetic energy, that of the strain and of the springs, and the loads' as seen from the base [J]."""
        return (z.transpose() * (self._hessian * z))[0, 0] / 2

    @cached_property
    def outputs(self) -> arb_mat:
        """Rows of what is reported: unknowns, gaps, stretches and slides, then the rates of these, shape (24, 15)."""
        rows = [row([arb(int(i == j)) for j in range(6)]) for i in range(6)]
        rows += [*self.model.gaps, *self.stretches, *self.model.slides]
        return arb_mat([part.entries() for part in rows + [one * self.G for one in rows]])

    def step(self, span: float) -> Step:
        """The longest step of at most `ANGLE` radians that divides a span [s], from the few that are ever asked for."""
        count = max(1, math.ceil(self.rate * span / ANGLE * (1 - 1e-9)))
        length = span / count
        key = round(math.log(length) * 1e8)  # rows of a record are not evenly spaced in their last digits
        if key not in self._steps:
            self._steps[key] = Step(self, length)
        return self._steps[key]

    def derivatives(self, count: int, which: int | None = None) -> arb_mat:
        """Rows of the first coefficients of the watched functions in powers of the time times the rate, term by term.

        Parameters
        ----------
        count
            Terms of each function.
        which
            One of the functions; None: all.
        """
        if (count, which) not in self._derivatives:
            lines, size = self._lines, len(self.watched)
            rows = arb_mat(lines[-size:]) if lines else None
            for k in range(len(lines) // size, count):
                if rows is None:
                    rows = arb_mat([watched.entries() for watched in self.watched])
                else:
                    rows = rows * self.G * (1 / (arb(self.rate) * k))
                lines += rows.tolist()
            chosen = lines[: count * size] if which is None else lines[which : count * size : size]
            self._derivatives[count, which] = arb_mat(chosen)
        return self._derivatives[count, which]

    def leading(self, z: arb_mat, count: int) -> list[list[arb]]:
        """The first coefficients of the watched functions in powers of the time times the rate."""
        sums = (self.derivatives(count) * z).entries()
        return [sums[i :: len(self.watched)] for i in range(len(self.watched))]

    def coefficients(self, which: int, z: arb_mat, radius: arb_mat, angle: float) -> list[arb]:
        """As many of one watched function as an angle needs, the last one enclosing all further terms.

        A z and what it may be off are taken apart, so that neither blurs the other.
        """
        n = max(12, term_count(angle))
        columns = self.derivatives(n, which) * arb_mat([*zip(z.entries(), radius.entries(), strict=True)])
        rate = (self.G * (z + radius)).entries()[:12]
        norm = sum(float(c.abs_upper()) / unit for c, unit in zip(rate, self.norm, strict=True)) / self.rate
        weights = self.watched[which].entries()[:12]
        size = sum(float(w.abs_upper()) * unit for w, unit in zip(weights, self.norm, strict=True))
        rest = ball(2 * (1 + 1e-9) * size * norm / arb(n).fac())
        return [*(middle + off for middle, off in columns.tolist()), rest]

    def terms(self, z: arb_mat, length: arb, count: int) -> list[arb_mat]:
        """The first coefficients of the powers of time / length of z, of any number of columns."""
        terms = [z]
        for k in range(1, count):
            terms.append(self.G * terms[-1] * (length / k))
        return terms

    def series(self, z: arb_mat, length: arb, least: int = 2) -> list[arb_mat]:
        """Coefficients of the powers of time / length of z, the last one enclosing all further terms.

        In units of the mass and of the rate G has the norm `rate`, so that what follows a term is at most twice as
        large as the next term's bound where the terms are more than twice the angle.
        """
        angle = self.rate * float(abs(length).upper()) * (1 + 1e-9)
        n = max(least, term_count(angle))
        terms = self.terms(z, length, n)
        columns, last = z.ncols(), terms[-1].entries()
        bounds = [ball(0.0)] * (SIZE * columns)
        for j in range(columns):
            sizes = [float(c.abs_upper()) for c in last[j : 12 * columns : columns]]
            rest = 2 * (1 + 1e-9) * angle / n * sum(size / unit for size, unit in zip(sizes, self.norm, strict=True))
            bounds[j : 12 * columns : columns] = [ball(rest * unit) for unit in self.norm]
        terms.append(arb_mat(SIZE, columns, bounds))
        return terms

    @cached_property
    def _powers(self) -> list[tuple[arb_mat, Array]]:
        """exp(G s) for the units, in balls and in floats."""
        powers = [total(self.series(identity(), arb(self.units[-1])))]
        while len(powers) < LEVELS:
            powers.append(powers[-1] * powers[-1])
        return [(power, to_floats(power)) for power in powers[::-1]]

    def advance(self, z: arb_mat, length: arb, step: Step | None = None) -> tuple[arb_mat, Array]:
        """Z after a time, and exp(G s) in floats, exact to 1e-12 of its entries.

        Parameters
        ----------
        z
            A column, or more.
        length
            The time [s].
        step
            A step of about this time, if there is one.
        """
        rest, J = length, UNIT
        if step is not None:
            z, J, rest = step.matrix * z, step.floats, length - step.length
        short = float(rest)
        for unit, (power, floats) in zip(self.units, self._powers, strict=True):
            while short >= unit:
                z, J, rest = power * z, floats @ J, rest - unit
                short = float(rest)
        if short:
            z = total(self.series(z, rest))
        if abs(short) * self.rate > NEGLIGIBLE:
            gs = self.G_floats * short
            J = J + gs @ (J + gs @ (J + gs @ J / 3) / 2)
        return z, J


class Step:
    """A step of one length in one state of the corners."""

    def __init__(self, flow: Flow, length: float) -> None:
        self.length = length
        self.matrix, self.floats = flow.advance(identity(), arb(length))
        self.readings, inverse = flow.model.readings, flow.model.readings_inverse
        self.reading_sizes = np.abs(to_floats(self.readings)) * (1 + 1e-9)
        self.count = len(flow.watched)
        if flow.watched:
            powers = np.repeat((flow.rate * length * REACH) ** np.arange(FLOAT_TERMS), self.count)
            self.table = to_floats(flow.derivatives(FLOAT_TERMS) * inverse) * powers[:, None]
            self.sizes = np.abs(self.table).reshape(FLOAT_TERMS, self.count, SIZE).sum(axis=0)

    def clear(self, z: arb_mat, radius: Array, leads: list[int | None]) -> tuple[float, float, list[int]]:
        """Where floats prove all watched functions to be positive, in parts of the step.

        Parameters
        ----------
        z
            The state at the start.
        radius
            How far it may be off.
        leads
            Of each watched function how many of its first terms are zero; None: it rests at zero.

        Returns
        -------
        share, width, doubtful
            The part throughout which they are positive; the length of the next part, in which that cannot be proven, 0
            where there is none; and the functions that may fall in or after it.
        """
        values = np.array([float(entry) for entry in (self.readings * z).entries()])
        terms = (self.table @ values).reshape(FLOAT_TERMS, self.count).T
        margin = self.sizes @ (ROUNDING * np.abs(values) + self.reading_sizes @ radius)
        for i, place in enumerate(leads):
            if place is None:
                terms[i], margin[i] = 0.0, -1.0
            elif place:
                terms[i] = np.append(terms[i, place:], np.zeros(place))
        doubtful = np.arange(len(terms))
        forms = (terms @ bernstein(FIRST_CELLS)).min(axis=1)
        doubtful = doubtful[~(forms > margin)]
        if not len(doubtful):
            return 1.0, 0.0, []
        terms, margin = terms[doubtful], margin[doubtful, None]
        low, width = 0.0, 1.0
        for _ in range(CUTS):
            forms = (terms @ bernstein(CELLS)).reshape(len(terms), CELLS, FLOAT_TERMS).min(axis=2)
            failing = np.flatnonzero(~(forms > margin).all(axis=0))
            if not len(failing):
                return low + width, 0.0, []
            width /= CELLS
            low += failing[0] * width
            terms = terms @ cell_shift(CELLS, int(failing[0]))
        return low, width, doubtful.tolist()


def total(terms: list[arb_mat]) -> arb_mat:
    """Sum of the terms of a series, the small ones first."""
    result = terms[-1]
    for term in reversed(terms[:-1]):
        result = term + result
    return result


def identity() -> arb_mat:
    """The matrix one of the size of z."""
    return arb_mat(SIZE, SIZE, [arb(int(i == j)) for i in range(SIZE) for j in range(SIZE)])


def to_floats(matrix: arb_mat) -> Array:
    """Midpoints of a matrix."""
    return np.array([*map(float, matrix.entries())]).reshape(matrix.nrows(), matrix.ncols())


@cache
def _term_count(angle: float, bits: int) -> int:
    logarithm, n = 0.0, 0
    while logarithm > -bits - 12 or n < 2 * angle:
        n += 1
        logarithm += math.log2(angle / n)
    return n


def term_count(angle: float) -> int:
    """Terms of a series over an angle whose remainder is below the digits of the current context."""
    rounded = 2.0 ** (math.ceil(2 * math.log2(max(angle, 1e-200))) / 2)  # few angles, whose counts are kept
    return _term_count(rounded, ctx.prec)


@cache
def cell_shift(cells: int, cell: int) -> Array:
    """From coefficients of powers on [0, 1] to those on one of its equal parts, shape (terms, terms)."""
    # z = (cell + t) / cells: z^j = sum of C(j, k) cell^(j - k) t^k / cells^j
    shift = np.zeros((FLOAT_TERMS, FLOAT_TERMS))
    for j in range(FLOAT_TERMS):
        for k in range(j + 1):
            shift[j, k] = math.comb(j, k) * cell ** (j - k) / cells**j
    return shift


@cache
def bernstein(cells: int) -> Array:
    """From the coefficients of powers on [0, 1] to those of Bernstein's forms on equal parts of it, (terms, forms)."""
    n = FLOAT_TERMS - 1
    # t^k has the form C(i, k) / C(n, k)
    form = np.array([[math.comb(i, k) / math.comb(n, k) for i in range(n + 1)] for k in range(n + 1)])
    return np.hstack([cell_shift(cells, cell) @ form for cell in range(cells)])
