"""The kind of a column: its tables, and the solvers that run it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, ClassVar

from validation.models.column.tables import ColumnSection, InputSection
from validation.scenes.kinds import Kind

TAKE = {  # the solvers that run a scene which names none, by the law of its springs
    "bonded": ("dda", "fem", "layers"),
    "unilateral": ("dda", "column-events"),
    "frictional": ("dda", "column-events"),
}


class Column(Kind):
    """Layers on each other under an input."""

    name = "column"
    words = "a column"
    feature = "column"
    rank = 1.0
    tables: ClassVar = {"column": ColumnSection, "input": InputSection}
    fem_keys = ("elements", "degree")

    def run(self, table: ColumnSection) -> dict[str, Any]:
        """Return the solvers that take the law of its springs."""
        return {"solvers": list(TAKE[table.law])}

    def optional(self, scene: Any) -> Collection[str]:
        """Return the input of a column that weight or velocities at t = 0 move."""
        column: ColumnSection = scene.column
        has_weight = column.law == "unilateral" and column.gravity > 0
        return ("input",) if has_weight or any(layer.velocity for layer in column.layer) else ()


KIND = Column
