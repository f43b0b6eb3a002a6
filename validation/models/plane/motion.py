"""Outlines and contact forces of blocks at the steps of a history, for drawings and fields."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from validation.models.plane.assembly import Assembly
from validation.models.plane.blocks import PlacedBlock
from validation.models.plane.history import contact_column, place_of
from validation.runs.history import Array, History

Contact = tuple[str, int, str, int]  # a corner of a block on an edge of another one


def outlines_at(assembly: Assembly, history: History, step: int) -> list[Array]:
    """Return the corners of every block at a step [m], with its strains where they are kept, shape (n, 2) each."""
    return [_outline(block, history, step) for block in assembly.blocks]


def _outline(block: PlacedBlock, history: History, step: int) -> Array:
    """X + R(turn) (I + strain) (corner - centroid); a block whose pose is not kept stays where it was."""

    def value(part: str, missing: float = 0.0) -> float:
        column = history.columns.get(f"{block.name}.{part}")
        return missing if column is None else float(column[step])

    if f"{block.name}.x" not in history.columns:
        return block.corners
    turn = value("angle", block.angle) - block.angle
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shear = value("gxy") / 2
    stretch = np.array([[1 + value("ex"), shear], [shear, 1 + value("ey")]])
    arms = block.corners - block.centroid
    return np.asarray([value("x"), value("y")] + arms @ (rotation @ stretch).T)


def contacts_of(history: History) -> list[Contact]:
    """Return the contacts whose normal force a history has."""
    places = [place_of(column) for column in history.columns if column.endswith(".normal")]
    return [place.contact for place in places if place.contact is not None]


def force_on_corner(contact: Contact, outlines: Mapping[str, Array], history: History, step: int) -> Array:
    """Return the force of a contact on the block whose corner it is [N].

    The normal force acts along the edge's outward normal, the shear force against the edge (counter-clockwise).
    """
    block, corner, on, edge = contact
    outline = outlines[on]
    along = outline[(edge + 1) % len(outline)] - outline[edge]
    along = along / np.hypot(*along)
    normal = float(history.columns[contact_column(block, corner, on, edge, "normal")][step])
    sheared = history.columns.get(contact_column(block, corner, on, edge, "shear"))
    force: Array = normal * np.array([along[1], -along[0]])
    return force if sheared is None else force - float(sheared[step]) * along


def forces_at(assembly: Assembly, history: History, step: int) -> Iterator[tuple[Array, Array]]:
    """Yield where each contact that a history has is [m] and the force on the block whose corner it is [N]."""
    names = (block.name for block in assembly.blocks)
    outlines = dict(zip(names, outlines_at(assembly, history, step), strict=True))
    for contact in contacts_of(history):
        yield outlines[contact[0]][contact[1]], force_on_corner(contact, outlines, history, step)
