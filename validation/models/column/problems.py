"""What is judged and shown of a column's motion."""

from __future__ import annotations

import math
from collections.abc import Iterator

from validation.diagnosis.numbers import Values, layers
from validation.metrics.values import largest
from validation.models.column.tables import ColumnSection
from validation.problems.bands import contact_values
from validation.problems.numbered import UNKNOWN
from validation.problems.problem import Number, ProblemHooks
from validation.problems.quantities import arrival, last
from validation.runs.columns import split, unit_of
from validation.runs.history import DISPLACEMENT
from validation.scenes.scene import Scene


class HOOKS(ProblemHooks):
    """Waves, or contacts that open or slip."""

    def changes(self, scene: Scene) -> dict[str, Values] | None:
        """Return the data of contacts and layers, each one per cent larger; None of a bonded column."""
        column = scene.table(ColumnSection)
        return None if column.law == "bonded" else _changes_of_contacts(scene, column, 1 + UNKNOWN)

    def shown_numbers(self, scene: Scene) -> Iterator[Number]:
        """Yield arrivals and largest values, or what contacts come to."""
        if scene.table(ColumnSection).law != "bonded":
            yield from _numbers_of_contacts(scene)
            return
        for name in scene.run.columns:
            yield Number(f"arrival of {name}", "s", name, arrival)
            yield Number(f"largest {name}", "m", name, lambda t, x: largest(x))


def _changes_of_contacts(scene: Scene, column: ColumnSection, factor: float) -> dict[str, Values]:
    """Return the data of a column whose contacts open or slip, each larger by a factor; none that is infinite.

    Gaps and velocities are not among them: they are the question, as a block's are.
    """
    changed: dict[str, Values] = {}
    if any(math.isfinite(contact.stiffness) for contact in column.contacts):
        changed["the contacts' stiffness"] = contact_values(column, stiffness=factor)
    if any(math.isfinite(contact.strength) for contact in column.contacts):
        changed["the contacts' strength"] = contact_values(column, strength=factor)
    if any(math.isfinite(layer.young) for layer in column.layer):
        changed["Young's modulus"] = layers(scene, "young", factor)
    changed["the density"] = layers(scene, "density", factor)
    return changed


def _numbers_of_contacts(scene: Scene) -> Iterator[Number]:
    """Yield what the contacts of a column come to: slip and gap in the end, the largest force, the motion."""
    for part in ("slip", "gap", "force", "velocity", DISPLACEMENT):
        for name in reversed(scene.run.columns):  # the uppermost first, which moves most
            if split(name)[0] != part:
                continue
            if part == "force":
                yield Number(f"largest {name}", unit_of(name), name, lambda t, x: largest(x))
            else:
                yield Number(f"{name} in the end", unit_of(name), name, last)
