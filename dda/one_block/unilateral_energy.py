r"""Energy of one block over no-tension corners, and what takes it away.

For any Newmark scheme whose accelerations obey M A = F - K0 D + B' lambda at both ends of a step, with
c = alpha - delta/2 and V the velocity after gg,

    E1 - E0 = - (delta - 1/2) dD' K0 dD - c h^2 [ A' M A / 2 ] - (delta - 1/2) c h^2 dA' M dA
              + sum over contacts of U1 - U0 + dw [(1 - delta) N0 + delta N1] + ds [(1 - delta) T0 + delta T1],

[ ] the change over the step and U = N^2/(2 p) + T^2/(2 p_s). A contact that keeps its state is part of the
algorithmic loss, one that opens or closes is a switching loss (negative: a gain). Energy-conserving contact does
the work U0 - U1 itself and loses nothing. Of what a corner loses that slips, friction takes -T1 (r1 - r0), never
negative. Where the base moves by y the loads work on x = D + R y, and its own work -lambda' B R y is counted as theirs.
What the first step's A0 adds where M A0 was not F - K0 D0 is algorithmic, too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dda.contact.unilateral import Unilateral
from dda.model.load import BaseMotion
from dda.one_block.unilateral_form import UnilateralForm
from dda.one_block.unilateral_step import BlockHistory

Array = NDArray[np.float64]

STORED = ("kinetic", "strain", "springs", "load")
LOST = ("algorithmic", "kinetic damping", "switching", "friction")
ENERGIES = STORED + LOST


def energies(
    form: UnilateralForm, law: Unilateral, step: float, motion: BaseMotion | None, history: BlockHistory, losses: Array
) -> dict[str, Array]:
    """Return the energies [J] after every step, the losses summed from t = 0 on.

    Parameters
    ----------
    losses : (steps, 5) array
        Those of `dda.stepping.driver.Counts`.
    """
    D, V = history.D, history.P / step
    shear = history.shear**2 / law.shear if law.shear else 0.0
    load = -(D - form.start) @ form.F - losses[:, 4]
    if motion is not None:
        load -= motion.at(step * np.arange(1.0, len(D) + 1)) @ (form.translation.T @ form.F)
    stored = (
        np.einsum("ki,ij,kj->k", V, np.linalg.inv(form.M), V) / 2,
        (D * D) @ form.K / 2,
        form.multiplicity * np.sum(history.normal**2 * law.compliance + shear, axis=1) / 2,
        load,
    )
    return dict(zip(ENERGIES, (*stored, *losses[:, :4].T), strict=True))
