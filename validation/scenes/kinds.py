"""The tables that a scene states, of a block, a column, rigid boxes or blocks in the plane, and which go together."""

from __future__ import annotations

from typing import Any, Self, TypeVar

from pydantic import Field, model_validator

from validation.errors import InputError
from validation.scenes.column import ColumnSection, InputSection
from validation.scenes.keys import Section
from validation.scenes.plane import PlaneSection
from validation.scenes.rigid import POSE, RigidSection
from validation.scenes.tables import (
    BlockSection,
    ContactSection,
    DampingSection,
    FemSection,
    LoadSection,
)

Table = TypeVar("Table", bound=Section)
# The tables of each kind of scene, which exclude each other; the first one says which kind it is.
OF_KIND = {
    "block": ("block", "contact", "load"),
    "column": ("column", "input"),
    "rigid": ("rigid",),
    "plane": ("plane",),
}
# the solvers that run a column's scene which names none, by the law of its springs
TAKE_COLUMNS = {
    "bonded": ("dda", "fem", "layers"),
    "unilateral": ("dda", "column-events"),
    "frictional": ("dda", "column-events"),
}
# what runs a scene of blocks in the plane that does not say, and what is kept
TAKE_PLANE = {"solvers": ["dda", "fem"], "columns": ["displacement"]}
TAKE_RIGID = ("rigid-exact",)  # the solvers that run a scene of rigid boxes which names none


class SceneTables(Section):
    """A block on its contact under a load, a column under an input, or rigid boxes on a plane.

    Whoever asks for a table that the scene does not have is refused (`block`, `contact`, `load`, `input`), so that no
    one takes one kind for another; `stated_block` and its neighbours are None there.
    """

    name: str = "scene"
    title: str = ""
    extreme: str = ""  # why its values are meant that no rock has; `scenes.plausibility` warns of those of other scenes
    stated_block: BlockSection | None = Field(None, alias="block")
    stated_contact: ContactSection | None = Field(None, alias="contact")
    stated_load: LoadSection | None = Field(None, alias="load")
    column: ColumnSection | None = None
    stated_input: InputSection | None = Field(None, alias="input")
    rigid: RigidSection | None = None
    plane: PlaneSection | None = None
    damping: DampingSection = DampingSection()
    fem: FemSection = FemSection()

    @property
    def block(self) -> BlockSection:
        """The block; refused where the scene is of another kind."""
        return self._present("block", self.stated_block)

    @property
    def contact(self) -> ContactSection:
        """The block's contact; refused where the scene is of another kind."""
        return self._present("contact", self.stated_contact)

    @property
    def load(self) -> LoadSection:
        """The block's load; refused where the scene is of another kind."""
        return self._present("load", self.stated_load)

    @property
    def input(self) -> InputSection:
        """What drives the column; refused where the scene is of another kind."""
        return self._present("input", self.stated_input)

    def _present(self, field: str, table: Table | None) -> Table:
        if table is None:
            raise InputError("is needed for what is asked", source=self.name, field=field, value=self.kind_in_words)
        return table

    @property
    def kind(self) -> str:
        """Kind of the scene: ``"block"``, ``"column"``, ``"rigid"`` or ``"plane"``."""
        for kind, table in (("rigid", self.rigid), ("plane", self.plane)):
            if table is not None:
                return kind
        return "block" if self.column is None else "column"

    @property
    def kind_in_words(self) -> str:
        """Kind of the scene, for messages."""
        words = {"rigid": "rigid boxes", "plane": "blocks in the plane"}
        return f"a scene of {words.get(self.kind, f'a {self.kind}')}"

    @model_validator(mode="before")
    @classmethod
    def _choose_solvers(cls, data: Any) -> Any:
        """Let a scene of a column or of rigid boxes that names no solvers or columns have those of its kind."""
        if not isinstance(data, dict) or not isinstance(run := data.get("run", {}), dict):
            return data
        if "column" in data:
            column = data["column"]
            law = str(column.get("law")) if isinstance(column, dict) else ""
            solvers = TAKE_COLUMNS.get(law, TAKE_COLUMNS["bonded"])
            return {**data, "run": {"solvers": list(solvers), **run}}
        if "plane" in data:
            return {**data, "run": {**TAKE_PLANE, **run}}
        if "rigid" in data:
            rigid = data["rigid"]
            boxes = rigid.get("box") if isinstance(rigid, dict) else None
            boxes = boxes if isinstance(boxes, list | tuple) else ()  # anything else is refused by the table itself
            poses = [f"{part}_{number}" for number in range(1, len(boxes) + 1) for part in POSE]
            return {**data, "run": {"solvers": list(TAKE_RIGID), "columns": poses or list(POSE), **run}}
        return data

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        tables: dict[str, Section | None] = {
            "block": self.stated_block,
            "contact": self.stated_contact,
            "load": self.stated_load,
            "column": self.column,
            "input": self.stated_input,
            "rigid": self.rigid,
            "plane": self.plane,
        }
        required = OF_KIND[self.kind]
        for field, table in tables.items():
            if table is not None and field not in required:
                preposition = "without column" if field in OF_KIND["column"] else f"with {self.kind}"
                raise ValueError(f"{field}: does not go {preposition}, got a table of it")
        for field in required:
            if tables[field] is None and not (field == "input" and self._moves_alone()):
                raise ValueError(f"{field}: is required, got nothing")
        if self.column is not None and (more := sorted(self.fem.model_fields_set - {"elements", "degree"})):
            raise ValueError(f"fem: {more[0]} does not go with column, got {getattr(self.fem, more[0])!r}")
        if self.rigid is not None and (apart := {"damping", "fem"} & self.model_fields_set):
            raise ValueError(f"{min(apart)}: does not go with rigid, got a table of it")
        if self.plane is not None and (more := sorted(self.fem.model_fields_set - {"elements", "degree"})):
            raise ValueError(f"fem: {more[0]} does not go with plane, got {getattr(self.fem, more[0])!r}")
        return self

    def _moves_alone(self) -> bool:
        """Tell whether weight or velocities at t = 0 move a column that nothing drives."""
        column = self.column
        if column is None:
            return False
        return (column.law == "unilateral" and column.gravity > 0) or any(layer.velocity for layer in column.layer)
