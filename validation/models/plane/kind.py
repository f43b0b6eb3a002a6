"""The kind of blocks in the plane: its table, what runs it and what a history of it may hold."""

from __future__ import annotations

import difflib
from typing import Any, ClassVar

from validation.models.plane.assembly import Assembly
from validation.models.plane.history import PlaneColumns, numbers_of, place_of
from validation.models.plane.tables import PlaneSection
from validation.scenes.kinds import Kind


class BlocksInThePlane(Kind):
    """Blocks in the plane, glued along the edges they share, or moving and touching each other."""

    name = "plane"
    words = "blocks in the plane"
    feature = "blocks in the plane"
    rank = 3.0
    tables: ClassVar = {"plane": PlaneSection}
    solvers: ClassVar = {"rigid-exact": "validation.models.plane.exact:RigidExact"}
    columns = PlaneColumns()
    files: ClassVar = {"plane.block.motion": "record of a block's motion"}
    fem_keys = ("elements", "degree", "foundation", "patch_width")

    def run(self, table: PlaneSection) -> dict[str, Any]:
        """Return both packages for glued blocks and what they observe; of moving ones the poses, by `dda`."""
        if table.is_glued:
            return {"solvers": ["dda", "fem"], "columns": ["displacement"]}
        return {"solvers": ["dda"], "columns": list(table.assembly.pose_columns)}

    def has_column(self, scene: Any, column: str) -> bool:
        """Whether a column is of moving blocks, corners and edges that there are."""
        plane: PlaneSection = scene.plane
        return plane.moves and _is_column(column, plane.assembly)

    def check(self, scene: Any) -> None:
        """Check the columns of moving blocks, and that only these have contacts on patches."""
        plane: PlaneSection = scene.plane
        if plane.is_glued and scene.fem.foundation != "distributed":
            raise ValueError(f"fem: foundation goes with blocks that move, got {scene.fem.foundation!r} of glued ones")
        for column in scene.run.columns if plane.moves else ():
            if not self.has_column(scene, column):
                near = difflib.get_close_matches(column, plane.assembly.pose_columns, n=1)
                meant = f"; did you mean {near[0]}?" if near else ""
                of_contacts = "BLOCK.0-BLOCK.0.normal, BLOCK-BLOCK.normal"
                rule = f"columns must be BLOCK.x, {of_contacts}, energy.kinetic, momentum.x or their like"
                if plane.touch and "-" in column:
                    rule = "columns of contacts must be of those that [[plane.touch]] states"
                raise ValueError(f"run: {rule}, got {column!r}{meant}")


def _is_column(column: str, assembly: Assembly) -> bool:
    """Whether a column is of blocks, corners and edges that there are; of contacts, where these are stated."""
    try:
        place = place_of(column)
    except KeyError:
        return False
    corners = {block.name: len(block.vertices) for block in assembly.blocks}
    if place.contact is not None:
        block, corner, on, edge = place.contact
        if not (corner < corners.get(block, 0) and edge < corners.get(on, 0) and block != on):
            return False
        stated = [one[:4] for one in assembly.contacts]
        return not stated or numbers_of(place.contact, [*corners]) in stated
    if place.pair is not None:
        return {*place.pair} <= {*corners} and len({*place.pair}) == len(place.pair)
    return bool(place.whole) or place.block in corners


KIND = BlocksInThePlane
