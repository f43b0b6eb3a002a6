"""Columns of a history on a base that carries no tension; each costs only where it is asked for."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fem_reference.contact.points import ContactModel
from fem_reference.contact.stepper import ContactState
from fem_reference.problem.problem import Array

LOSSES = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
COUNTS = ("solves", "cuts")
UNILATERAL_COLUMNS = (
    "displacement",
    "contact_pressure",
    "horizontal_displacement",
    "rotation",
    "velocity",
    "base_shear",
    "open_share",
    "largest_gap",
    "largest_penetration",
    "largest_slide",
    "kinetic_energy",
    "strain_energy",
    "spring_energy",
    "load_energy",
    *LOSSES,
    *COUNTS,
)
"""Columns of a history, one row a step: v at the centroid [m]; sum of N over the base's length [Pa]; u and rotation at
the centroid [m, 1]; velocity of the centre of mass upwards [m/s]; sum of T over the base's length [Pa]; share of the
base with a positive gap [-]; largest gap and penetration, and largest way that a point has slid while closed, there
less back [m]; energies [J], of the loads -F'D less the work of a moving base; energies lost from t = 0 on [J], negative
where gained, by friction never; solutions of the open-close iteration and cuts of the step [-]."""

Observer = Callable[[ContactState], float]


def observers(model: ContactModel, columns: tuple[str, ...]) -> list[Observer]:
    """Functions of a state, one for each column but `LOSSES` and `COUNTS`.

    Parameters
    ----------
    model
        The block on its points.
    columns
        Names among `UNILATERAL_COLUMNS`.

    Raises
    ------
    ValueError
        If a name is unknown.
    """
    for name in columns:
        if name not in UNILATERAL_COLUMNS:
            raise ValueError(f"columns: must be among {UNILATERAL_COLUMNS}, got {name!r}")
    known = _known(model)
    return [known[name] for name in columns if name in known]


def _known(model: ContactModel) -> dict[str, Observer]:
    seen, share, up, length = model.observers, model.share, model.upwards, model.length
    momentum = model.M @ up
    mass = float(up @ momentum)
    return {
        "displacement": lambda s: float(seen["displacement"] @ s.motion.D),
        "contact_pressure": lambda s: float(s.normal.sum() / length),
        "horizontal_displacement": lambda s: float(seen["horizontal_displacement"] @ s.motion.D),
        "rotation": lambda s: float(seen["rotation"] @ s.motion.D),
        "velocity": lambda s: float(momentum @ s.motion.V) / mass,
        "base_shear": lambda s: float(s.shear.sum() / length),
        "open_share": lambda s: float(share @ (s.gap > 0)),
        "largest_gap": lambda s: float(np.max(s.gap, initial=0.0)),
        "largest_penetration": lambda s: float(np.max(-s.gap, initial=0.0)),
        "largest_slide": lambda s: float(np.max(np.abs(s.slid), initial=0.0)),
        "kinetic_energy": lambda s: kinetic(model, s),
        "strain_energy": lambda s: float(s.motion.D @ (model.K @ s.motion.D) / 2),
        "spring_energy": lambda s: float(springs(model, s).sum()),
        "load_energy": lambda s: float(-model.F @ s.motion.D) - s.given,
    }


def kinetic(model: ContactModel, state: ContactState) -> float:
    """Energy of motion V' M V / 2 [J]."""
    V = state.motion.V
    return float(V @ (model.M @ V) / 2)


def springs(model: ContactModel, state: ContactState) -> Array:
    """Energy N^2 / (2 k) + T^2 / (2 k_t) of each point's springs [J], shape (points,)."""
    k_t = model.shear_stiffness
    sheared = np.divide(state.shear**2, k_t, out=np.zeros_like(k_t), where=k_t > 0)
    energy: Array = (state.normal**2 / model.stiffness + sheared) / 2
    return energy
