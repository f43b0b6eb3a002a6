"""The motion of the block while its corners keep their states: z' = G z, whose power series are entire.

z = (x, x', r, 1) holds the six unknowns, their rates, the references of both corners and a one, so that every function
that is watched or reported is a row over z, and its rate is that row times G. G may have any eigenvalues where a corner
slips or has a dashpot, real and equal ones too: a power series does not care. A step has at most `ANGLE` radians of the
greatest rate that G can give. With x in units of 1/omega, omega^2 the norm of the scaled stiffness, the four blocks of
G have the norms 0, omega, omega and d, that of the scaled dashpots, so that G has at most the norm
d/2 + sqrt(d^2/4 + omega^2).

Floats prove for most steps that nothing switches: the Bernstein forms of the watched functions bound them from below.
"""

from __future__ import annotations

import math
from collections import Counter
from functools import cache, cached_property

import numpy as np
from flint import arb, arb_mat, ctx

from fem_reference.events.block_model import (
    CARRIES_NOTHING,
    OPEN,
    RELEASED,
    RIGHT,
    STICKS,
    BlockModel,
    States,
    row,
    sigma,
)
from fem_reference.events.enclosure import ball, precision, radius_of
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
TABLE_BITS = 128
"""Bits in which the terms of the watched functions are computed before floats take them."""
ROUNDING = 400 * np.finfo(float).eps
"""Part of its terms by which a Bernstein form of `FLOAT_TERMS` terms of 15 products may be wrong after all cuts."""
DERIVATIVES = 10
"""Terms of a function's series after which it counts as zero for ever."""
LEAST_TERMS = 12
"""Terms of a watched function's series, at least."""
FEW = 4
"""Terms that are looked at first: most functions show at once where they go."""
UNIT = np.eye(SIZE)
LEAST_RATE = 1.0
"""Rate that stands for none, as of a rigid block in flight [rad/s]; its series end after the square of the time."""
FREQUENT = 20
"""Times that a time is passed before its exp(G s) is kept, which costs as much as twenty series."""
EXPONENTIAL_ERROR = 1e-13
"""Part of the greatest entry of exp(G s), in the units of the flow, by which floats of it may be wrong."""
EXPONENTIAL_TERMS = 14
"""Terms of its series: what follows is below 0.5^15 / 15!, 2e-17."""


class Flow:
    """The block in one state of its corners."""

    def __init__(self, model: BlockModel, states: States) -> None:
        self.model = model
        self.states = states
        self.G = model.generator(states)
        self.G_floats = to_floats(self.G)
        B = -self.G_floats[6:12, :6]
        scale = np.sqrt([float(m) for m in model.mass])
        omega = math.sqrt(float(np.linalg.norm(scale[:, None] * B / scale, 2))) or LEAST_RATE
        dashpots = float(np.linalg.norm(scale[:, None] * self.G_floats[6:12, 6:12] / scale, 2)) / 2
        # bound of the rates of the motion [rad/s]
        self.rate = (dashpots + math.hypot(dashpots, omega)) * (1 + 1e-9)
        # unknowns and rates of norm one, in which G has the norm `rate`; references and the one change them as slowly
        omega *= 1 + 1e-9
        self.units = np.array([*(1 / (scale * omega)), *(1 / scale), *[1 / (scale[0] * omega)] * 2, 1.0])
        load = np.abs(self.G_floats[6:12, 14] * scale).max() / self.rate
        self.units[14] = 1 / load if load else 1.0
        self.stretches: list[arb_mat] = []  # s - r of each corner, which is -T / p_s [m]
        self.references: list[arb_mat] = []  # r of each corner that does not stick [m]
        self.forces: list[arb_mat] = []  # N of each corner [N]
        self.watched: list[arb_mat] = []  # positive, or zero for ever, as long as both corners stay in their states
        for corner in (0, 1):
            self._add_corner(corner)
        self._lines: list[list[arb]] = []
        self._derivatives: dict[tuple[int, int | None], arb_mat] = {}
        self._exponentials: dict[int, tuple[arb, arb_mat, Array]] = {}
        self._uses: Counter[int] = Counter()

    def _add_corner(self, c: int) -> None:
        """Add the rows of one corner."""
        model = self.model
        state = self.states[c]
        gap = model.gaps[c]
        slide = model.slides[c]
        stuck = model.stuck[c]
        limit = gap * (-model.friction * model.p) + row(one=model.cohesion)  # tan(phi) N + C
        force = gap * -model.p - model.gap_rates[c] * model.damping  # N of a corner that presses
        if state in CARRIES_NOTHING:
            stretch = row()
            watched = [gap]
            if state == RELEASED:
                watched = [gap * -1, force * -1]
            force = row()
        elif state == STICKS:
            stretch = stuck
            # without a dashpot the gap falls with the force
            watched = [force if model.damping != 0 else gap * -1]
            if model.tan is not None:
                watched += [model.reserves[c, sign] for sign in (1, -1)]
        else:
            stretch = limit * (-sigma(state) / model.ps)
            watched = [gap * -1]
            # one that slips moves its reference in the direction of its slip
            watched.append((slide - stretch) * self.G * -sigma(state))
        if model.contact is not None:  # both corners of a rigid contact are one
            watched = [model.contact.gap if state == OPEN else model.contact.force] if c == 0 else []
            force = row() if state == OPEN else model.contact.force * (arb(1) / 2)
        self.stretches.append(stretch)
        self.references.append(slide - stretch)
        self.forces.append(force)
        if not model.locked:
            self.watched += watched

    @cached_property
    def unit_balls(self) -> list[arb]:
        """Units of the unknowns and their rates as balls."""
        return [arb(unit) for unit in self.units[:12].tolist()]

    @cached_property
    def dissipates(self) -> bool:
        """Whether a corner slips against friction, or has a dashpot and is not open."""
        if self.model.damping != 0:
            return any(state != OPEN for state in self.states)
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
                gap = model.gaps[c]
                stretch = self.stretches[c]
                total = total + gap.transpose() * gap * model.p + stretch.transpose() * stretch * model.ps
        return total

    def energy(self, z: arb_mat) -> arb:
        """Kinetic energy, that of the strain and of the springs, and the loads' as seen from the base [J].

        A released spring has what its stretch says: it gives it to its dashpot, and nothing to the block.
        """
        return (z.transpose() * (self._hessian * z))[0, 0] / 2

    @cached_property
    def outputs(self) -> arb_mat:
        """Rows over z of what is reported, shape (28, 15).

        (u, v, r, ex, ey, gxy), gaps, stretches and slides, the rates of these, the references, and the normal forces.
        """
        half = arb(1) / 2
        zero = arb(0)
        one = arb(1)
        rows = [
            row([one, zero, zero, zero, zero, zero]),
            row([zero, one, zero, zero, zero, zero]),
            row([zero, zero, zero, -half, half, zero]),
            row([zero, zero, one, zero, zero, zero]),
            row([zero, zero, zero, zero, zero, one]),
            row([zero, zero, zero, one, one, zero]),
        ]
        rows += [*self.model.gaps, *self.stretches, *self.model.slides]
        rows += [part * self.G for part in rows]
        return arb_mat([part.entries() for part in (*rows, *self.references, *self.forces)])

    def step_length(self, span: float) -> float:
        """The longest step of at most `ANGLE` radians that divides a span [s]."""
        return span / max(1, math.ceil(self.rate * span / ANGLE * (1 - 1e-9)))

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
            lines = self._lines
            size = len(self.watched)
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

    def coefficients(
        self, which: int, z: arb_mat, radius: arb_mat, angle: float, least: int = LEAST_TERMS
    ) -> list[arb]:
        """As many of one watched function as an angle needs, the last one enclosing all further terms.

        A z and what it may be off are taken apart, so that neither blurs the other.
        """
        n = max(least, term_count(angle))
        columns = self.derivatives(n, which) * arb_mat([*zip(z.entries(), radius.entries(), strict=True)])
        weights = self.watched[which].entries()[:12]
        size = sum(float(w.abs_upper()) * unit for w, unit in zip(weights, self.units, strict=False))
        rest = ball(size * self._bound(self.G * (z + radius), n))
        return [*(middle + off for middle, off in columns.tolist()), rest]

    def _bound(self, change: arb_mat, n: int) -> arb:
        """What all terms from n on come to, in the power n of the time times the rate, where z' is `change`.

        In its units G has the norm `rate`, so that the terms fall at least like halves where n > 2 angle + 2; their
        derivatives, the first and the second, are then below those of the bound.
        """
        size = sum(float(c.abs_upper()) / unit for c, unit in zip(change.entries()[:12], self.units, strict=False))
        return arb(2 * (1 + 1e-9) * size / self.rate) / arb(n).fac()

    def series(self, z: arb_mat, length: arb) -> arb_mat:
        """Z after a time [s], the power series summed."""
        change = self.G * z
        angle = self.rate * abs(float(length)) * (1 + 1e-12)
        n = term_count(angle)
        term = change * length
        moved = z + term
        for k in range(2, n):
            term = self.G * term * (length / k)
            moved = moved + term
        rest = self._bound(change, n) * arb(angle) ** n
        return moved + arb_mat(SIZE, 1, [ball(rest * unit) for unit in self.units[:12].tolist()] + [arb(0)] * 3)

    def advance(self, z: arb_mat, length: arb) -> arb_mat:
        """Z after a time [s]."""
        known = self.exponential(length)
        if known is not None:
            length = length - known[0]
            z = known[1] * z
        return z if length == 0 else self.series(z, length)

    def exponential(self, length: arb) -> tuple[arb, arb_mat, Array] | None:
        """A length nearly the same, exp(G s) for it, and this in floats; None where it is not `FREQUENT` yet."""
        key = key_of(length)
        self._uses[key] += 1
        if key not in self._exponentials:
            if self._uses[key] <= FREQUENT:
                return None
            matrix = self._exp(length)
            self._exponentials[key] = length, matrix, to_floats(matrix)
        return self._exponentials[key]

    def _exp(self, length: arb) -> arb_mat:
        """exp(G s), by way of the units of the flow, in which G is balanced."""
        units = arb_mat(SIZE, SIZE, [arb(x) for x in np.diag(self.units).ravel().tolist()])
        inverse = units.inv()  # in balls: floats of it would not be its inverse
        exponential = units * (inverse * self.G * units * length).exp() * inverse
        return arb_mat(exponential.tolist()[:12] + UNIT[12:].tolist())

    def sensitivity(self, length: arb) -> Array:
        """exp(G s) in floats, see `EXPONENTIAL_ERROR`."""
        known = self._exponentials.get(key_of(length))
        if known is not None:
            return known[2] + float(length - known[0]) * self.G_floats @ known[2]
        seconds = float(length)
        J = matrix_exponential(self.G_floats * self.units / self.units[:, None] * seconds, self.rate * seconds)
        return np.vstack([(J / self.units * self.units[:, None])[:12], UNIT[12:]])

    def exponential_error(self, J: Array, hull: Array) -> Array:
        """How far the floats of exp(G s) may move a set that reaches so far from zero; references and the one rest."""
        largest = np.abs(J * self.units / self.units[:, None]).max()
        moving = np.array([*self.units[:12], 0.0, 0.0, 0.0])
        return np.asarray(EXPONENTIAL_ERROR * largest * (hull / self.units)[:14].sum() * moving)

    def growth(self, radius: Array, angle: float) -> Array:
        """How far the displacements may be off after an angle, where z is off by a radius; more than they are."""
        apart = radius / self.units
        pull = (self._pull @ radius[12:14]).sum()
        return np.asarray(math.exp(angle) * (apart[:12].sum() + angle * pull) * self._largest)

    @cached_property
    def _pull(self) -> Array:
        """What references do to the rates, in units."""
        return np.asarray(np.abs(self.G_floats[6:12, 12:14]) / self.units[6:12, None] / self.rate)

    @cached_property
    def _largest(self) -> Array:
        """(u, v, r, ex, ey, gxy) of unknowns of norm one."""
        return np.asarray(np.abs(to_floats(self.outputs)[:6, :6]) @ self.units[:6])

    @cached_property
    def _table(self) -> tuple[Array, Array, Array]:
        """Terms of the watched functions over the readings, shape (terms * functions, 15); their sizes and errors."""
        model = self.model
        with precision(min(ctx.prec, TABLE_BITS)):
            G = model.readings * self.G * model.readings_inverse * (1 / arb(self.rate))
            rows = arb_mat([watched.entries() for watched in self.watched]) * model.readings_inverse
            terms = [rows]
            for k in range(1, FLOAT_TERMS):
                rows = rows * G * (1 / arb(k))
                terms.append(rows)
        table = np.vstack([to_floats(rows) for rows in terms])
        errors = np.array([radius_of(entry) for rows in terms for entry in rows.entries()]).reshape(table.shape)
        return table, np.abs(table), errors

    def clear(
        self, z: arb_mat, radius: Array, leads: list[int | None], length: float
    ) -> tuple[float, float, list[int]]:
        """Where floats prove all watched functions to be positive, in parts of a length.

        Parameters
        ----------
        z
            The state at the start.
        radius
            How far it may be off.
        leads
            Of each watched function how many of its first terms are zero; None: it rests at zero.
        length
            How far to look [s].

        Returns
        -------
        share, width, doubtful
            The part throughout which they are positive; the length of the next part, in which that cannot be proven, 0
            where there is none; and the functions that may fall in or after it.
        """
        if not self.watched:
            return 1.0, 0.0, []
        readings = np.array([float(entry) for entry in (self.model.readings * z).entries()])
        blur = ROUNDING * np.abs(readings) + self.model.reading_sizes @ radius
        powers = (self.rate * length * (1 + 1e-12)) ** np.arange(FLOAT_TERMS)
        table, sizes, errors = self._table
        terms = (table @ readings).reshape(FLOAT_TERMS, -1).T * powers
        margin = powers @ (sizes @ blur + errors @ np.abs(readings)).reshape(FLOAT_TERMS, -1)
        for i, place in enumerate(leads):
            if place is None:
                terms[i] = 0.0
                margin[i] = -1.0
            elif place:
                terms[i] = np.append(terms[i, place:], np.zeros(place))
        return first_doubt(terms, margin)


def first_doubt(terms: Array, margin: Array) -> tuple[float, float, list[int]]:
    """Where Bernstein's forms prove polynomials on [0, 1] to be positive.

    Parameters
    ----------
    terms
        Coefficients of their powers, shape (functions, `FLOAT_TERMS`).
    margin
        What each may be wrong by, shape (functions,).

    Returns
    -------
    share, width, doubtful
        The end of the part throughout which all are positive; the length of the next part, in which that cannot be
        proven, 0 where there is none; and the numbers of the functions that may fall in or after it.
    """
    forms = (terms @ bernstein(FIRST_CELLS)).min(axis=1)
    doubtful = np.flatnonzero(~(forms > margin))
    if not len(doubtful):
        return 1.0, 0.0, []
    terms = terms[doubtful]
    margins = margin[doubtful, None]
    low = 0.0
    width = 1.0
    for _ in range(CUTS):
        forms = (terms @ bernstein(CELLS)).reshape(len(terms), CELLS, FLOAT_TERMS).min(axis=2)
        failing = np.flatnonzero(~(forms > margins).all(axis=0))
        if not len(failing):
            return low + width, 0.0, []
        width /= CELLS
        low += failing[0] * width
        terms = terms @ cell_shift(CELLS, int(failing[0]))
    return low, width, doubtful.tolist()


def to_floats(matrix: arb_mat) -> Array:
    """Midpoints of a matrix."""
    return np.array([*map(float, matrix.entries())]).reshape(matrix.nrows(), matrix.ncols())


def matrix_exponential(matrix: Array, angle: float) -> Array:
    """exp(A) in floats, ||A|| <= angle: the series of a part of at most half a radian, squared; numpy has no such."""
    squarings = max(0, math.ceil(math.log2(2 * angle))) if angle > 0 else 0
    part = matrix / 2.0**squarings
    one = np.eye(len(matrix))
    power = one
    for k in range(EXPONENTIAL_TERMS, 0, -1):
        power = one + part @ power / k
    for _ in range(squarings):
        power = power @ power
    return power


def key_of(length: arb) -> int:
    """The same for lengths that differ by rounding only, as those of the rows of a record do."""
    return round(math.log(float(length)) * 1e8) if length > 0 else 0


@cache
def _term_count(angle: float, bits: int) -> int:
    logarithm = 0.0
    n = 0
    while logarithm > -bits - 12 or n < 2 * angle + 3:
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
