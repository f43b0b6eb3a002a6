"""The tables that a scene states, of a block or of a column, and which of them go together."""

from __future__ import annotations

from typing import Any, Self, TypeVar

from pydantic import Field, model_validator

from validation.errors import InputError
from validation.scenes.column import ColumnSection, InputSection
from validation.scenes.keys import Section
from validation.scenes.tables import (
    BlockSection,
    ContactSection,
    DampingSection,
    FemSection,
    LoadSection,
)

Table = TypeVar("Table", bound=Section)
OF_BLOCK, OF_COLUMN = ("block", "contact", "load"), ("column", "input")  # tables that exclude each other
# the solvers that run a column's scene which names none, by the law of its springs
TAKE_COLUMNS = {
    "bonded": ("dda", "fem", "layers"),
    "unilateral": ("dda", "column-events"),
    "frictional": ("dda", "column-events"),
}


class SceneTables(Section):
    """A block on its contact under a load, or a column under an input.

    Whoever asks for a table that the scene does not have is refused (`block`, `contact`, `load`, `input`), so that no
    one takes one kind for the other; `stated_block` and its neighbours are None there.
    """

    name: str = "scene"
    title: str = ""
    extreme: str = ""  # why its values are meant that no rock has; `scenes.plausibility` warns of those of other scenes
    stated_block: BlockSection | None = Field(None, alias="block")
    stated_contact: ContactSection | None = Field(None, alias="contact")
    stated_load: LoadSection | None = Field(None, alias="load")
    column: ColumnSection | None = None
    stated_input: InputSection | None = Field(None, alias="input")
    damping: DampingSection = DampingSection()
    fem: FemSection = FemSection()

    @property
    def block(self) -> BlockSection:
        """The block; refused where the scene has a column."""
        return self._present("block", self.stated_block)

    @property
    def contact(self) -> ContactSection:
        """The block's contact; refused where the scene has a column."""
        return self._present("contact", self.stated_contact)

    @property
    def load(self) -> LoadSection:
        """The block's load; refused where the scene has a column."""
        return self._present("load", self.stated_load)

    @property
    def input(self) -> InputSection:
        """What drives the column; refused where the scene has a block."""
        return self._present("input", self.stated_input)

    def _present(self, field: str, table: Table | None) -> Table:
        if table is None:
            kind = "column" if self.column is not None else "block"
            raise InputError("is needed for what is asked", source=self.name, field=field, value=f"a scene of a {kind}")
        return table

    @model_validator(mode="before")
    @classmethod
    def _choose_solvers(cls, data: Any) -> Any:
        """Let a column's scene that names no solvers be run by those that take it."""
        if isinstance(data, dict) and "column" in data and isinstance(run := data.get("run", {}), dict):
            column = data["column"]
            law = str(column.get("law")) if isinstance(column, dict) else ""
            solvers = TAKE_COLUMNS.get(law, TAKE_COLUMNS["bonded"])
            return {**data, "run": {"solvers": list(solvers), **run}}
        return data

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        stated_tables = {field: getattr(self, f"stated_{field}") for field in (*OF_BLOCK, "input")} | {
            "column": self.column
        }
        required, other = (OF_COLUMN, OF_BLOCK) if self.column is not None else (OF_BLOCK, OF_COLUMN)
        for field in other:
            if stated_tables[field] is not None:
                raise ValueError(
                    f"{field}: does not go {'with' if self.column else 'without'} column, got a table of it"
                )
        for field in required:
            if stated_tables[field] is None and not (field == "input" and self._moves_alone()):
                raise ValueError(f"{field}: is required, got nothing")
        if self.column is not None and (more := sorted(self.fem.model_fields_set - {"elements", "degree"})):
            raise ValueError(f"fem: {more[0]} does not go with column, got {getattr(self.fem, more[0])!r}")
        return self

    def _moves_alone(self) -> bool:
        """Tell whether weight or velocities at t = 0 move a column that nothing drives."""
        column = self.column
        if column is None:
            return False
        return (column.law == "unilateral" and column.gravity > 0) or any(layer.velocity for layer in column.layer)

    def files(self) -> tuple[tuple[str, str | None], ...]:
        """Return the fields that name a file, and what they name."""
        load, drive = self.stated_load, self.stated_input
        return (
            ("fem: mesh", self.fem.mesh),
            ("load: base_motion", None if load is None else load.base_motion),
            ("input: record", None if drive is None else drive.record),
        )
