r"""Whether blocks can rest: admissible contact forces by a linear program, and limits in closed form.

Blocks rest only if there are forces N >= 0, |T| <= mu N at the ends of their contacts that balance the weights. That
these exist is necessary; it is sufficient too where nothing can slide or all forces are determined. With friction a
prestress may be admissible that no history of the blocks brings about (a key stone that is wider below).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, linprog

from validation.models.plane.blocks import Vertices as Outline
from validation.models.plane.blocks import centroid
from validation.models.plane.generators import ArchSection, ColumnsSection, GeneratorSection
from validation.models.plane.geometry import near_pairs
from validation.runs.history import Array
from validation.scenes.outline import area

NEAR = 1e-6  # m, by which a corner that touches an edge may be beside it
LEAST_PUSH = 1e-7  # m2 of rock: what a toe begins to need; a recursion is zero below its limit
PARALLEL = 1e-6  # sine of the angle between faces that lie on each other


class ContactPoint(NamedTuple):
    """A place where two blocks touch; points and vectors are complex numbers x + i y."""

    block: int  # whose corner it is
    on: int  # whose edge
    place: complex  # [m]
    normal: complex  # outwards from the edge


def contact_points(outlines: Sequence[Outline]) -> Iterator[ContactPoint]:
    """Yield every corner on an edge: inside of it, or at its end where two faces lie on each other."""
    near = {*near_pairs(outlines, np.full(len(outlines), NEAR))}
    rings = [np.array(outline) @ (1, 1j) for outline in outlines]
    for block, ring in enumerate(rings):
        faces = np.roll(ring, -1) - ring
        faces = faces / np.abs(faces)
        for on, others in enumerate(rings):
            if (min(block, on), max(block, on)) not in near:
                continue
            starts = others[:, None]  # edges of the other block along the first axis, corners of this along the second
            edges = np.roll(starts, -1, axis=0) - starts
            lengths = np.abs(edges)
            along = edges / lengths
            apart = (ring - starts) * along.conjugate()
            opposite = faces * along.conjugate()
            lies_on = (np.abs(opposite.imag) < PARALLEL) & (opposite.real < 0)
            lies_on |= np.roll(lies_on, 1, axis=1)  # of the faces that meet in a corner either
            inside = (apart.real > NEAR) & (apart.real < lengths - NEAR)
            over = (apart.real >= -NEAR) & (apart.real <= lengths + NEAR)
            for edge, number in np.argwhere((np.abs(apart.imag) <= NEAR) & over & (inside | lies_on)):
                yield ContactPoint(block, on, complex(ring[number]), complex(-1j * along[edge, 0]))


class Balance(NamedTuple):
    """The equations of blocks at rest: forces at contact points, along normal and edge."""

    forces: Array  # of every unit force on the blocks that move, rows x, y and moment of each
    weights: Array  # what they bear, over the greatest of these

    def is_possible(self, mu: float | None) -> bool:
        """Return whether forces at contacts of friction mu bear the weights; where mu is None nothing can slide."""
        count = self.forces.shape[1]
        slides = None if mu is None else np.kron(np.eye(count // 2), [[-mu, 1.0], [-mu, -1.0]])
        solution = linprog(
            np.zeros(count),
            A_ub=slides,
            b_ub=None if slides is None else np.zeros(len(slides)),
            A_eq=self.forces,
            b_eq=self.weights,
            bounds=[(0.0, None), (None, None)] * (count // 2),
            method="highs",
        )
        return bool(solution.status == 0)


def balance_of(
    outlines: Sequence[Outline], held: Sequence[bool], gravity: tuple[float, float] = (0.0, -1.0)
) -> Balance:
    """Return the balance of blocks of one density; the parameters are those of `can_rest`."""
    points = list(contact_points(outlines))
    balance = np.zeros((len(outlines), 3, 2 * len(points)))
    weights = np.zeros((len(outlines), 3))
    for number, outline in enumerate(outlines):
        x, y = centroid(outline)
        borne = -area(outline) * np.array(gravity) / math.hypot(*gravity)
        weights[number] = [*borne, x * borne[1] - y * borne[0]]
    for column, point in enumerate(points):
        for place, direction in enumerate((point.normal, 1j * point.normal)):
            force = [direction.real, direction.imag, (point.place.conjugate() * direction).imag]
            balance[point.block, :, 2 * column + place] += force
            balance[point.on, :, 2 * column + place] -= force
    moving = ~np.array(held)
    borne = weights[moving].ravel()
    return Balance(balance[moving].reshape(-1, 2 * len(points)), borne / np.max(np.abs(borne)))


def can_rest(
    outlines: Sequence[Outline], held: Sequence[bool], mu: float | None, gravity: tuple[float, float] = (0.0, -1.0)
) -> bool:
    """Return whether forces at contacts of friction mu balance the weights of blocks of one density.

    Blocks are stated by their corners [m] and by which are held; mu is tan(phi) of all contacts, None where nothing can
    slide, gravity a direction.
    """
    return balance_of(outlines, held, gravity).is_possible(mu)


def drawn(section: GeneratorSection) -> tuple[list[Outline], list[bool]]:
    """Return the outlines that a table draws, and which of them are fixed."""
    parts = list(section.outlines())
    return [outline for _, outline, _ in parts], [fixed for *_, fixed in parts]


def last_that_rests(rests: Callable[[float], bool], stands: float, falls: float) -> float:
    """Return the last value from one that rests on towards one that does not, to 1e-7 of their distance."""
    least = 1e-7 * abs(falls - stands)
    while abs(falls - stands) > least:
        middle = (stands + falls) / 2
        stands, falls = (middle, falls) if rests(middle) else (stands, middle)
    return stands


@functools.cache
def least_thickness(radius: float, voussoirs: int, chords: int = 1) -> float:
    """Return the least thickness at which a semicircle of equal voussoirs stands, nothing slides [m]."""

    def rests(thickness: float) -> bool:
        arch = ArchSection(name="arch", radius=radius, thickness=thickness, voussoirs=voussoirs, chords=chords)
        return can_rest(*drawn(arch), None)

    return last_that_rests(rests, 0.2 * radius, 0.05 * radius)


@functools.cache
def flat_height(count: int, width: float, dip: float, mu: float) -> tuple[float, float]:
    """Return the height H of columns y_n = H n/N on a flat base: by the recursion, and the greatest [m].

    Above the greatest no contact forces balance the weights; between them the history decides.
    """

    def heights(H: float) -> tuple[float, ...]:
        return tuple(H * n / count for n in range(1, count + 1))

    def rests(H: float) -> bool:
        columns = ColumnsSection(name="column", width=width, heights=heights(H), dip=math.degrees(dip))
        return can_rest(*drawn(columns), mu)

    low = 1.001 * width / math.tan(dip)  # a single column of that height stands
    push = brentq(lambda H: recursion(heights(H), width, 0.0, dip, mu) - LEAST_PUSH, low, 100 * low, xtol=1e-12)
    return float(push), last_that_rests(rests, low, 100 * low)


@functools.cache
def stepped_friction(heights: tuple[float, ...], width: float, rise: float, dip: float) -> tuple[float, float]:
    """Return tan(phi) that columns on a stepped base need: by the recursion, and the least.

    Between them the history decides, as of `flat_height`.
    """
    columns = ColumnsSection(name="column", width=width, heights=heights, dip=math.degrees(dip), rise=rise)
    balance = balance_of(*drawn(columns))
    least = math.tan(dip) / 2  # in which nothing stands; above 1 the recursion has no sliding
    push = brentq(lambda mu: recursion(heights, width, rise, dip, mu) - LEAST_PUSH, math.tan(dip), 0.99, xtol=1e-12)
    return float(push), last_that_rests(balance.is_possible, 1.0, least)


def keyed_dip(height: float, count: int, width: float) -> float:
    """Return the dip at which columns topple that are keyed to a base and smooth between them [rad].

    Heights are y_n = H n/N. Smooth sides pass moments on, the columns turn together, and stand while the sum of
    W_n (y_n sin a - dx cos a) is negative: tan a = 3 N dx/((2 N + 1) H).
    """
    return math.atan(3 * count * width / ((2 * count + 1) * height))


def harmonic(count: int, length: float) -> float:
    """Return how far so many equal blocks overhang at most [m]: l/2 (1 + 1/2 + ... + 1/n)."""
    return length / 2 * sum(1 / k for k in range(1, count + 1))


def seat_forces(count: int, length: float, share: float) -> list[tuple[float, float]]:
    """Return the forces at the edge and at the inner corner of each seat from above, over the weight of a block.

    The k blocks above a seat, each offset by a share of its limit l/2k, press at e = (1 - share) l/2 from the edge of
    a seat of c = l - share l/2k.
    """
    forces = []
    for k in range(1, count + 1):
        seat = length - share * length / (2 * k)
        inward = (1 - share) * length / 2
        forces.append((k * (1 - inward / seat), k * inward / seat))
    return forces


def leaning_friction(inclination: float, slenderness: float) -> float:
    """Return tan(phi) that a block on a floor needs to lean on a smooth wall: (cot psi - d/L)/2, L/d: slenderness."""
    return (1 / math.tan(inclination) - 1 / slenderness) / 2


def recursion(heights: Sequence[float], width: float, rise: float, dip: float, mu: float) -> float:
    """Return the force that the toe of columns on a stepped base needs, over the weight of a unit of area [m2].

    Goodman and Bray (1976): from the highest column down, P of the next one is what toppling or sliding leaves,
    with the forces between columns at the tops of the contacts and their friction at its limit. Zero: it stands.
    Heights [m] count from the toe on, the width [m] is along the dip of the treads [rad], the rise [m] is that of the
    base from a column to the next, mu is tan(phi).
    """
    push = 0.0
    sine = math.sin(dip)
    cosine = math.cos(dip)
    for n in reversed(range(len(heights))):
        height = heights[n]
        weight = height * width
        upper = min(height, heights[n + 1] + rise) if n + 1 < len(heights) else height  # where the one above pushes
        lower = min(height, heights[n - 1] - rise) if n else height  # where it pushes the one below
        over = weight * (height * sine - width * cosine) / 2
        topples = (push * (upper - mu * width) + over) / lower
        slides = push - weight * (mu * cosine - sine) / (1 - mu**2)
        push = max(0.0, topples, slides)
    return push


def stepped_dip(heights: Sequence[float], width: float, rise: float, mu: float) -> float:
    """Return the dip at which columns on a stepped base begin to topple [rad]."""
    return float(brentq(lambda dip: recursion(heights, width, rise, dip, mu) - LEAST_PUSH, 0.0, 1.0, xtol=1e-12))
