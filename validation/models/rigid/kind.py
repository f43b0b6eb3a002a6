"""The kind of rigid boxes: its table, and what runs it."""

from __future__ import annotations

from typing import Any, ClassVar

from validation.models.rigid.tables import MOST_BOXES, POSE, RigidSection
from validation.runs.columns import ColumnKind, OwnColumns
from validation.scenes.kinds import Kind

REST = 1e-9  # m, rad, N: of a box that is at rest
COLUMNS: OwnColumns = {
    "x": ColumnKind(
        "m", "position of the centre of box {n} along the ground, down a slope positive", "x, box {n}", REST
    ),
    "y": ColumnKind("m", "height of the centre of box {n} above the ground, normal to it", "y, box {n}", REST),
    "angle": ColumnKind("rad", "angle of box {n}, counter-clockwise positive, not folded", "Rotation, box {n}", REST),
    "force": ColumnKind("N", "normal force between box {n} and what it stands on", "Normal force, box {n}", REST),
}


class RigidBoxes(Kind):
    """Rigid boxes on a plane."""

    name = "rigid"
    words = "rigid boxes"
    feature = "rigid boxes"
    linear = False
    rank = 2.0
    tables: ClassVar = {"rigid": RigidSection}
    solvers: ClassVar = {"rigid-exact": "validation.models.rigid.exact:RigidExact"}
    columns = COLUMNS
    greatest_number = MOST_BOXES
    refuses = ("damping", "fem")

    def run(self, table: RigidSection) -> dict[str, Any]:
        """Return the exact motion as solver, and the poses of all boxes as columns."""
        poses = [f"{part}_{number}" for number in range(1, len(table.box) + 1) for part in POSE]
        return {"solvers": ["rigid-exact"], "columns": poses}

    def motion_unread(self, scene: Any) -> str:
        """Return that boxes are judged by numbers of their motion."""
        return f"a scene of {self.words}"

    def check(self, scene: Any) -> None:
        """Check that the columns are those of its boxes."""
        rigid: RigidSection = scene.rigid
        for name in scene.run.columns:
            if name not in rigid.columns:
                raise ValueError(f"run: columns must be among {', '.join(rigid.columns)}, got {name!r}")


KIND = RigidBoxes
