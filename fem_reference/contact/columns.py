"""Columns of the history of a block on points of its base, from what is kept of its steps."""

from __future__ import annotations

import numpy as np

from fem_reference.contact.march import ALGORITHMIC, DISCOUNT, FRICTION, GROUND, SWITCHING, Record
from fem_reference.contact.points import ContactModel
from fem_reference.contact.system import ContactRows
from fem_reference.problem.problem import Array

ENERGY_COLUMNS = ("kinetic_energy", "strain_energy", "spring_energy", "load_energy")
LOSS_COLUMNS = ("algorithmic_loss", "kinetic_damping_loss", "switching_loss", "friction_loss")
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
    *ENERGY_COLUMNS,
    *LOSS_COLUMNS,
    "solves",
    "cuts",
)
"""Columns of a history, one row a step: v at the centroid [m]; sum of N over the base's length [Pa]; u and rotation at
the centroid [m, 1]; velocity of the centre of mass upwards [m/s]; sum of T over the base's length [Pa]; share of the
base with a positive gap [-]; largest gap and penetration, and largest way that a point has slid while closed, there
less back [m]; energies [J], of the loads -F'D less the work of a moving base; energies lost from t = 0 on [J], negative
where gained, by friction never; solutions of the open-close iteration and cuts of the step [-]."""


def columns_of(record: Record, model: ContactModel, rows: ContactRows) -> dict[str, Array]:
    """All columns of some steps; energies are zero where they are not kept."""
    points = len(model.share)
    gap = record.place[:, :points]
    displacement, horizontal, rotation = record.displacements.T
    force = record.force
    return {
        "displacement": displacement,
        "contact_pressure": force[:, :points].sum(axis=1) / model.problem.base_length,
        "horizontal_displacement": horizontal,
        "rotation": rotation,
        "velocity": record.velocities[:, 0],
        "base_shear": force[:, points:].sum(axis=1) / model.problem.base_length,
        "open_share": (gap > 0) @ model.share,
        "largest_gap": np.maximum(gap, 0.0).max(axis=1),
        "largest_penetration": np.maximum(-gap, 0.0).max(axis=1),
        "largest_slide": np.abs(record.slid).max(axis=1),
        **energies_of(record, rows),
        "solves": record.solves,
        "cuts": record.cuts,
    }


def energies_of(record: Record, rows: ContactRows) -> dict[str, Array]:
    """`ENERGY_COLUMNS` and `LOSS_COLUMNS` of some steps; zero where they are not kept."""
    return {
        "kinetic_energy": record.stored[:, 0],
        "strain_energy": record.stored[:, 1],
        "spring_energy": record.force**2 @ rows.compliance / 2,
        "load_energy": -record.stored[:, 2] - record.sums[:, GROUND],
        "algorithmic_loss": record.sums[:, ALGORITHMIC],
        "kinetic_damping_loss": record.sums[:, DISCOUNT],
        "switching_loss": record.sums[:, SWITCHING],
        "friction_loss": record.sums[:, FRICTION],
    }
