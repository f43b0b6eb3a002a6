r"""One block in coordinates in which the corner gaps stand alone, without contact springs.

In the frame of the base edge the six unknowns are x = (ex, e2, gxy, U, w_M, w_N): the strains of
`dda.one_block.gap_form`, the mean tangential displacement U of the base and the gaps of its two ends, with
w = (w_M + w_N)/2 and rotation s = (w_N - w_M)/a there. The block's own stiffness is diagonal and acts on the
strains alone,

    K0 = A diag(E', lambda + 2 G, G, 0, 0, 0),

and the corners move along the base by U -+ (a/2) ex: the mean U and the difference a ex.

What neither loads nor contact forces reach is dropped. In a symmetric motion nothing reaches U and s: both
corners are then one contact of twice the stiffness, with the unknowns (ex, e2, w), ex only if it is reached.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dda.contact.springs import Contact, base_directions
from dda.contact.unilateral import Unilateral
from dda.model.block import Block
from dda.model.loaded import LoadedBlock
from dda.one_block.gap_form import GapForm, gap_form

Array = NDArray[np.float64]

UNKNOWNS = ("ex", "e2", "gxy", "U", "w_M", "w_N")
ONE = ("ex", "e2", "w")  # of a symmetric motion
U_INDEX = UNKNOWNS.index("U")
_SYMMETRIC = [3, 4, 1]  # ex, e2, w in gap_form.UNKNOWNS


@dataclass(frozen=True, eq=False)
class UnilateralForm:
    """M x'' + K0 x = F + multiplicity B' lambda in n unknowns, with c contacts: corners M, N or one for both."""

    unknowns: tuple[str, ...]  # names of x: strains, then lengths [m]; the last c are the gaps
    M: Array  # (n, n) inertia
    K: Array  # (n,) diagonal of the elastic stiffness
    F: Array  # (n,) constant load
    translation: Array  # (n, 2) R, x of a rigid translation by 1 m along the base and away from it
    axes: Array  # (2, 2) unit tangent of the base from M to N, and its normal into the block
    B: Array  # (c, n), or (2c, n) with shear: gaps, then slides in the coordinates of dda.contact.kernel.Free [m]
    contacts: int  # c, 1 or 2
    multiplicity: float  # corners that a contact stands for
    start: Array  # (n,) x at t = 0
    observers: dict[str, Array]  # displacement column -> (n,) row over x - start
    slide: Array  # (2, n) displacement of M and N along the base by x


def unilateral_form(model: LoadedBlock, law: Unilateral, velocity: float, full: bool) -> UnilateralForm:
    """Assemble one block over no-tension corners; `velocity` only tells what moves, `full` keeps all unknowns."""
    block, load = model.block, model.load
    tangent, normal, a = base_directions(block, model.base)
    axes = np.array([tangent, normal])
    form = gap_form(block, Contact(1.0), model.base, model.top, load)  # of its springs nothing is used below
    pushed = form.F + velocity * (form.M[:, :2] @ axes[:, 1])
    if load.motion is not None:
        pushed = np.abs(pushed) + np.sum(np.abs(form.M @ form.R), axis=1)
    reached = _reached(form, pushed)
    if not full and not reached[0] and not reached[2] and not reached[5]:
        unknowns = [i for i in _SYMMETRIC if reached[i] or i != 3]
        return _symmetric(block, law, form, a, axes, unknowns)
    return _two_corners(block, law, form, a, axes)


def _reached(form: GapForm, pushed: Array) -> NDArray[np.bool_]:
    """Return which unknowns move: pushed ones and those that M couples to them, (6,)."""
    reached: NDArray[np.bool_] = pushed != 0
    coupled = form.M != 0
    while np.any((grown := reached | coupled @ reached) != reached):
        reached = grown
    return reached


def _elastic(block: Block) -> Array:
    """Return the block's own stiffness of ex, e2 and gxy [N m]."""
    material = block.material
    moduli = (material.free_modulus, material.constrained_modulus, material.shear_modulus)
    return block.section.area * np.array(moduli)


def _symmetric(
    block: Block, law: Unilateral, form: GapForm, a: float, axes: Array, unknowns: Sequence[int]
) -> UnilateralForm:
    """Both corners as one contact; its tangential displacement is that of N, and M has the opposite one."""
    names = {3: "ex", 4: "e2", 1: "w"}
    elastic = dict(zip((3, 4, 1), (*_elastic(block)[:2], 0.0), strict=True))
    rows = [[1.0 if i == 1 else 0.0 for i in unknowns]]
    if law.shear and 3 in unknowns:  # else the corners do not slide
        rows.append([a / 2 if i == 3 else 0.0 for i in unknowns])
    index = np.array(unknowns)
    return UnilateralForm(
        unknowns=tuple(names[i] for i in unknowns),
        M=form.M[np.ix_(index, index)],
        K=np.array([elastic[i] for i in unknowns]),
        F=form.F[index],
        translation=np.eye(6, 2)[index],
        axes=axes,
        B=np.array(rows),
        contacts=1,
        multiplicity=2.0,
        start=np.array([law.gap if i == 1 else 0.0 for i in unknowns]),
        observers=_observers(form, np.eye(6)[:, index]),
        slide=np.array([[side * a / 2 if i == 3 else 0.0 for i in unknowns] for side in (-1, 1)]),
    )


def _two_corners(block: Block, law: Unilateral, form: GapForm, a: float, axes: Array) -> UnilateralForm:
    T = np.zeros((6, 6))  # gap_form's unknowns (U, w, s, ex, e2, gxy) from (ex, e2, gxy, U, w_M, w_N)
    T[0, 3] = T[3, 0] = T[4, 1] = T[5, 2] = 1.0
    T[1, 4:] = 0.5
    T[2, 4:] = -1 / a, 1 / a
    B = np.zeros((4, 6))
    B[0, 4] = B[1, 5] = 1.0
    B[2, 3], B[3, 0] = 1.0, a
    translation = np.zeros((6, 2))
    translation[3, 0] = 1.0
    translation[4:, 1] = 1.0
    M = T.T @ form.M @ T
    return UnilateralForm(
        unknowns=UNKNOWNS,
        M=(M + M.T) / 2,
        K=np.array([*_elastic(block), 0.0, 0.0, 0.0]),
        F=T.T @ form.F,
        translation=translation,
        axes=axes,
        B=B if law.shear else B[:2],
        contacts=2,
        multiplicity=1.0,
        start=np.array([0.0, 0.0, 0.0, 0.0, law.gap, law.gap]),
        observers=_observers(form, T),
        slide=np.array([[-a / 2, 0.0, 0.0, 1.0, 0.0, 0.0], [a / 2, 0.0, 0.0, 1.0, 0.0, 0.0]]),
    )


def _observers(form: GapForm, T: Array) -> dict[str, Array]:
    """Return the rows of the displacement columns in the unknowns."""
    return {name: row @ T for name, row in form.observers.items() if name != "contact_pressure"}
