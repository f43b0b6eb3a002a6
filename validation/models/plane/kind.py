"""The kind of blocks in the plane: its table, and what runs it."""

from __future__ import annotations

from typing import Any, ClassVar

from validation.models.plane.tables import PlaneSection
from validation.scenes.kinds import Kind


class BlocksInThePlane(Kind):
    """Blocks in the plane, glued along the edges they share."""

    name = "plane"
    words = "blocks in the plane"
    feature = "blocks in the plane"
    rank = 3.0
    tables: ClassVar = {"plane": PlaneSection}
    fem_keys = ("elements", "degree")

    def run(self, table: object) -> dict[str, Any]:
        """Return both packages as solvers, and the displacement that the scene observes."""
        return {"solvers": ["dda", "fem"], "columns": ["displacement"]}


KIND = BlocksInThePlane
