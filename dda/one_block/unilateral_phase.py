r"""Many steps at once while every contact stays as it is: closed ones closed, open ones open.

Between two switches the block moves linearly, on the springs of its closed corners. Coordinates y are chosen in
which these springs are diagonal beside the block's own stiffness,

    M y'' + K y = F,    R = K y the force of block and springs,    -p y_w the normal force of a closed corner:

the unknowns of the form, with the stretch of the one glued corner in place of U where only one is closed. An
unknown without stiffness (the gap of an open corner, U where nothing is glued) is a rigid motion zeta = y_z +
M_zz^-1 M_ze y_e; the others have the modes of M_ee - M_ez M_zz^-1 M_ze, found to full relative accuracy.

Displacements, gaps and forces count from the beginning of the phase: a gap after a short flight is then no
difference of large displacements, and a mode, q = 0 at first, tends to phi' (F - R)/w^2, in which a stiff spring
comes with its force and not with the last digit of a displacement. A mode's steps are those of
`dda.scheme.blocked`; a rigid motion's are a parabola, damped by gg.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import SLIDES, Unilateral
from dda.one_block.natural_modes import graded_modes
from dda.one_block.unilateral_form import U_INDEX, UnilateralForm
from dda.scheme.blocked import doubled, mode_maps, why_stepped, with_all_digits
from dda.scheme.newmark import Scheme

Array = NDArray[np.float64]
BLOCK = 1024  # steps of the table that is kept of each watched quantity
_LEVELS = BLOCK.bit_length() - 1
_FEW = 32


@dataclass(frozen=True, eq=False)
class Phase:
    """One contact state: z = (q, p and static q of every mode, zeta and pi of every rigid motion, 1), its steps."""

    read: Array  # (size of z, size): z at the beginning from v
    tended: Array  # (size of z,): what is added to it
    shown: Array  # (size, size of z): change of v since the beginning from z, of P all
    maps: Array  # (levels, size of z, size of z): z after 1, 2, 4, ... steps
    watched: Sequence[
        tuple[int, float]
    ]  # normal force of a closed contact, gap of an open one: place in v, least value
    kept: Array  # (size,) one, zero for P
    held: Sequence[tuple[Array, float]] = ()  # with friction: row over v of what is left to the limit, least value
    tables: dict[bytes, list[Array | None]] = field(default_factory=dict)

    @cached_property
    def watch(self) -> list[Array]:
        """The watched rows after 1, 2, ... steps, (BLOCK, size of z) each."""
        watched = [self.shown[at] for at, _ in self.watched] + [row @ self.shown for row, _ in self.held]
        return [self._row(row) for row in watched]

    def limits(self, constant: Array) -> list[float]:
        """Return the least values of what the watched rows add to the constants of the phase."""
        own = [limit - constant.item(at) for at, limit in self.watched]
        return own + [limit - float(row @ constant) for row, limit in self.held]

    def table(self, rows: Array) -> list[Array | None]:
        """Return rows over v as rows over z after 1, 2, ..., BLOCK steps, (BLOCK, size of z) each; None for zeros."""
        key = rows.tobytes()
        if key not in self.tables:
            self.tables[key] = [self._row(row) if np.any(row) else None for row in rows @ self.shown]
        return self.tables[key]

    def _row(self, row: Array) -> Array:
        return doubled((row @ self.maps[0])[None], self.maps[:_LEVELS])

    def start(self, v: Array) -> tuple[Array, Array]:
        """Return z and the constants of the phase, v but for P, from the state in which it begins."""
        return self.read @ v + self.tended, self.kept * v

    def after(self, z: Array, steps: int) -> Array:
        """Return z some steps later, `BLOCK` at most."""
        many, few = divmod(steps, _FEW)
        z = self.few[few] @ z
        return self.many[many] @ z if many else z

    @cached_property
    def few(self) -> Array:
        """Maps of 0, 1, ..., _FEW - 1 steps."""
        return doubled_maps(self.maps[: _FEW.bit_length() - 1])

    @cached_property
    def many(self) -> Array:
        """Maps of 0, _FEW, 2 _FEW, ..., BLOCK steps."""
        return doubled_maps(self.maps[_FEW.bit_length() - 1 : _LEVELS + 1])


def doubled_maps(maps: Array) -> Array:
    """Return all products of maps that double each other, beginning with one."""
    made = np.eye(maps.shape[1])[None]
    for power in maps:
        made = np.concatenate([made, made @ power])
    return made


def phase_of(
    form: UnilateralForm, law: Unilateral, scheme: Scheme, closed: tuple[bool, ...], levels: int
) -> Phase | str:
    """Return the steps of one contact state, or why it must be stepped, in words.

    A rigid stop has no stiffness by which its force could be read from a displacement; neither is there a
    table of powers for a scheme that grows, or for a stiffness beyond the range of `why_stepped`.
    """
    if any(closed) and law.compliance == 0:
        return "the corners are rigid stops"
    made = _Coordinates(form, law, scheme, closed)
    frequencies, shapes = graded_modes(made.reduced, made.K[made.e])
    reason = why_stepped(scheme, frequencies)
    return reason if reason else made.phase(frequencies, shapes, max(levels, _LEVELS + 1))


class _Coordinates:
    """The coordinates y of one contact state."""

    def __init__(self, form: UnilateralForm, law: Unilateral, scheme: Scheme, closed: tuple[bool, ...]) -> None:
        self.form, self.law, self.scheme, self.closed = form, law, scheme, closed
        n, c = len(form.unknowns), form.contacts
        self.layout = form.layout
        self.gaps = range(n - c, n)
        self.slides = form.B[c:]  # in the coordinates of SLIDES
        self.T = np.eye(n)  # x = T y
        self.K = form.K + self._springs()
        M = self.T.T @ form.M @ self.T
        self.M = (M + M.T) / 2
        self.F = self.T.T @ form.F
        self.z, self.e = np.flatnonzero(self.K == 0), np.flatnonzero(self.K)
        Mzz, self.Mze = self.M[np.ix_(self.z, self.z)], self.M[np.ix_(self.z, self.e)]
        self.Mzz_inverse = np.linalg.inv(Mzz) if len(self.z) else Mzz
        self.Mzz = Mzz
        self.carried = self.Mzz_inverse @ self.Mze  # rigid motion that goes with the others
        reduced = self.M[np.ix_(self.e, self.e)] - self.Mze.T @ self.carried
        self.reduced = (reduced + reduced.T) / 2

    def _springs(self) -> Array:
        """Return the diagonal of the closed corners' springs in y; where one of two is glued, U becomes its stretch."""
        form, p, p_s = self.form, self.law.stiffness, self.law.shear
        K = np.zeros(len(form.unknowns))
        for i, shut in zip(self.gaps, self.closed, strict=True):
            K[i] = form.multiplicity * p if shut else 0.0
        if not len(self.slides) or not any(self.closed):
            return K
        if len(self.closed) == 1 or all(self.closed):
            weights = [form.multiplicity] if len(self.closed) == 1 else [2.0, 0.5]
            for row, weight in zip(self.slides, weights, strict=True):
                K += weight * p_s * row * row
            return K
        line = np.array(SLIDES[2][self.closed.index(True)]) @ self.slides  # s = U -+ (a/2) ex
        self.T[U_INDEX] = -line
        self.T[U_INDEX, U_INDEX] = 1.0
        K[U_INDEX] = p_s
        return K

    def phase(self, frequencies: Array, shapes: Array, levels: int) -> Phase:
        """Assemble maps and rows."""
        exact, modes = with_all_digits(self.scheme), len(frequencies)
        size = 3 * modes + 2 * len(self.z) + 1
        maps = np.zeros((levels, size, size))
        maps[:, -1, -1] = 1.0
        units = np.empty(modes)
        for k, w in enumerate(frequencies.tolist()):
            table, units[k], _ = mode_maps(exact, w, levels)
            first = 3 * k
            maps[:, first : first + 2, first : first + 2] = table[:, :4].reshape(-1, 2, 2)
            maps[:, first : first + 2, first + 2] = table[:, 4:]
            maps[:, first + 2, first + 2] = 1.0
        pulled = self.scheme.step**2 * (self.Mzz_inverse @ self.F[self.z])
        for k, a in enumerate(pulled.tolist()):
            at = slice(3 * modes + 2 * k, 3 * modes + 2 * k + 2)
            maps[:, at, at], maps[:, at, -1] = rigid_maps(self.scheme.gg, a, levels)
        tended = np.zeros(size)
        tended[2 : 3 * modes : 3] = (
            shapes.T @ (self.F[self.e] - self.carried.T @ self.F[self.z]) / (frequencies * frequencies)
        )
        tended[-1] = 1.0
        N, w = self.layout.contact(0).start, self.layout.contact(2).start
        states = enumerate(self.closed)
        watched = [(N + i, -self.law.pull) if shut else (w + i, -self.law.band[0]) for i, shut in states]
        kept = np.ones(self.layout.size)
        kept[self.layout.P] = 0.0
        read, shown = self._read(frequencies, shapes, units, size), self._shown(shapes, units, size)
        return Phase(read, tended, shown, maps, watched, kept, self._held())

    def _held(self) -> list[tuple[Array, float]]:
        """Return tan(phi) N +- T of the closed contacts, and -c."""
        N, T = self.layout.contact(0).start, self.layout.contact(1).start
        found: list[tuple[Array, float]] = []
        if self.law.friction is None or not len(self.slides):
            return found
        for i in np.flatnonzero(self.closed).tolist():
            for side in (-1.0, 1.0):
                row = np.zeros(self.layout.size)
                row[N + i], row[T + i] = self.law.friction, side
                found.append((row, -self.law.cohesion))
        return found

    def _read(self, frequencies: Array, shapes: Array, units: Array, size: int) -> Array:
        """Return z by v."""
        place, form, n, modes = self.layout, self.form, self.layout.unknowns, len(frequencies)
        force = np.zeros((n, place.size))  # R by v, in the form's unknowns
        force[:, place.D] = np.diag(form.K)
        force[:, place.contact(0)] = -form.multiplicity * form.B[: place.contacts].T
        if len(self.slides):
            both = np.array([[1.0]]) if place.contacts == 1 else np.array([[1.0, 1.0], [-0.5, 0.5]])
            force[:, place.contact(1)] = -form.multiplicity * self.slides.T @ both
        force = (self.T.T @ force)[self.e]
        momentum = np.zeros((n, place.size))
        momentum[:, place.P] = self.T.T
        read = np.zeros((size, place.size))
        own = momentum[self.e] - self.carried.T @ momentum[self.z]
        read[1 : 3 * modes : 3] = (shapes.T @ own) / units[:, None]
        read[2 : 3 * modes : 3] = -(shapes.T / (frequencies * frequencies)[:, None]) @ force
        read[3 * modes + 1 : -1 : 2] = self.Mzz_inverse @ momentum[self.z]
        return read

    def _shown(self, shapes: Array, units: Array, size: int) -> Array:
        """Return what z adds to v."""
        place, n, modes = self.layout, self.layout.unknowns, shapes.shape[1]
        y, momentum = np.zeros((n, size)), np.zeros((n, size))
        q, p = slice(0, 3 * modes, 3), slice(1, 3 * modes, 3)
        zeta, pi = slice(3 * modes, size - 1, 2), slice(3 * modes + 1, size - 1, 2)
        y[self.e, q], y[self.z, q] = shapes, -self.carried @ shapes
        y[self.z, zeta] = np.eye(len(self.z))
        momentum[self.e, p], momentum[self.e, pi] = self.reduced @ shapes * units, self.Mze.T
        momentum[self.z, pi] = self.Mzz
        shown = np.zeros((place.size, size))
        shown[place.D], shown[place.P] = self.T @ y, np.linalg.inv(self.T).T @ momentum
        N, T, w = (place.contact(kind).start for kind in range(3))
        stretch = self._stretch(y)
        for i, shut in enumerate(self.closed):
            shown[w + i] = y[self.gaps[i]]
            if shut:
                shown[N + i] = -self.law.stiffness * y[self.gaps[i]]
                shown[T + i] = -self.law.shear * stretch[i]
        return shown

    def _stretch(self, y: Array) -> Array:
        """Return the stretch of every contact by z; of the one of two that is glued it is a coordinate itself."""
        if not len(self.slides):
            return np.zeros((len(self.closed), y.shape[1]))
        if len(self.closed) == 2 and not all(self.closed):
            return np.array([y[U_INDEX]] * 2)
        stretch: Array = np.array(SLIDES[len(self.closed)]) @ (self.slides @ y)
        return stretch


def rigid_maps(gg: float, a: float, levels: int) -> tuple[Array, Array]:
    """Return the maps of 1, 2, 4, ... steps of a rigid motion under the constant acceleration a/dt^2.

    One step is zeta + gg pi + a/2, gg pi + a; only positive numbers are added.
    """
    linear, constant = np.zeros((levels, 2, 2)), np.zeros((levels, 2))
    linear[:, 0, 0] = 1.0
    g, s, moved, gained = gg, gg, 0.5, 1.0  # gg^j, sum of gg^i to j, of the acceleration in zeta and in pi
    for level in range(levels):
        linear[level, 0, 1], linear[level, 1, 1] = s, g
        constant[level] = moved * a, gained * a
        moved, gained = 2 * moved + s * gained, gained * (1 + g)
        s, g = s * (1 + g), g * g
    return linear, constant
