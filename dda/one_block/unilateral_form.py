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

from dataclasses import dataclass

import numpy as np

from dda.contact.springs import Contact, base_directions
from dda.contact.unilateral import Unilateral
from dda.model.arrays import Array
from dda.model.block import Block
from dda.model.load import LoadedBlock
from dda.one_block.gap_form import UNKNOWNS as GAP_UNKNOWNS
from dda.one_block.gap_form import gap_form

UNKNOWNS = ("ex", "e2", "gxy", "U", "w_M", "w_N")
ONE = ("ex", "e2", "w")  # of a symmetric motion
U_INDEX = UNKNOWNS.index("U")


@dataclass(frozen=True, eq=False)
class UnilateralForm:
    """M x'' + K0 x = F + multiplicity B' lambda in n unknowns, with c contacts: corners M, N or one for both."""

    unknowns: tuple[str, ...]  # names of x: strains, then lengths [m]; the last c are the gaps
    M: Array  # (n, n) inertia
    K: Array  # (n,) diagonal of the elastic stiffness
    F: Array  # (n,) load
    ramp: float  # time in which it rises from zero [s]
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
    block = model.block
    load = model.load
    tangent, normal, a = base_directions(block, model.base)
    axes = np.array([tangent, normal])
    form = gap_form(block, Contact(1.0), model.base, model.top, load)  # of its springs nothing is used below
    pushed = form.F + velocity * (form.M[:, :2] @ axes[:, 1])
    if load.motion is not None:
        pushed = np.abs(pushed) + np.sum(np.abs(form.M @ form.R), axis=1)
    reached = dict(zip(GAP_UNKNOWNS, form.reached_from(pushed != 0), strict=True))
    names: tuple[str, ...] = UNKNOWNS
    if not full and not (reached["U"] or reached["s"] or reached["gxy"]):
        names = ONE if reached["ex"] else ONE[1:]
    contacts = 1 if names != UNKNOWNS else 2
    T = np.column_stack([_as_gaps(name, a) for name in names])
    gaps = np.array([name.startswith("w") for name in names])
    # Both corners as one: its tangential displacement is that of N, and M has the opposite one.
    slides = [[side * a / 2 if name == "ex" else 1.0 * (name == "U") for name in names] for side in (-1, 1)]
    B = np.eye(len(names))[gaps]
    if law.shear and contacts == 2:
        B = np.vstack([B, np.mean(slides, axis=0), np.subtract(slides[1], slides[0])])
    elif law.shear and "ex" in names:  # else the corners do not slide
        B = np.vstack([B, slides[1]])
    M = T.T @ form.M @ T
    return UnilateralForm(
        unknowns=names,
        M=(M + M.T) / 2,
        K=np.array([_modulus(block, name) for name in names]),
        F=T.T @ form.F,
        ramp=load.ramp,
        translation=np.column_stack([[1.0 * (name == "U") for name in names], 1.0 * gaps]),
        axes=axes,
        B=B,
        contacts=contacts,
        multiplicity=2.0 / contacts,
        start=law.gap * gaps,
        observers={name: row @ T for name, row in form.observers.items() if name != "contact_pressure"},
        slide=np.array(slides),
    )


def _as_gaps(unknown: str, a: float) -> Array:
    """Return the unknowns of `dda.one_block.gap_form` by one of these."""
    column = np.zeros(len(GAP_UNKNOWNS))
    if unknown in GAP_UNKNOWNS:
        column[GAP_UNKNOWNS.index(unknown)] = 1.0
    else:  # a gap at one end, the other one zero
        column[GAP_UNKNOWNS.index("w")] = 0.5
        column[GAP_UNKNOWNS.index("s")] = (-1 if unknown == "w_M" else 1) / a
    return column


def _modulus(block: Block, unknown: str) -> float:
    """Return the block's own stiffness of an unknown [N m], none of a rigid motion."""
    material = block.material
    moduli = {"ex": material.free_modulus, "e2": material.constrained_modulus, "gxy": material.shear_modulus}
    return block.section.area * moduli.get(unknown, 0.0)
