"""The tables that a scene states: those of its kind, which exclude those of other kinds, and the common ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self, TypeVar

from pydantic import Field, ValidationError, create_model, model_validator

from validation.errors import InputError
from validation.scenes.keys import Section, stated_value
from validation.scenes.kinds import Kind, kinds
from validation.scenes.tables import BlockSection, ContactSection, DampingSection, FemSection, LoadSection


class SceneHead(Section):
    """What a scene is called."""

    name: str = "scene"
    title: str = ""
    extreme: str = ""  # why its values are meant that no rock has; `scenes.plausibility` warns of those of other scenes


Table = TypeVar("Table", bound=Section)
TYPED = ("block", "contact", "load")  # tables that have a property of their name


def _fields_of_kinds() -> dict[str, Any]:
    """Return a field for each table of each kind: ``column`` of the kind's own table, else ``stated_input``."""
    fields = {}
    for kind in kinds().values():
        for table, section in kind.tables.items():
            is_own = table == kind.name and table not in TYPED
            name = table if is_own else f"stated_{table}"
            fields[name] = (section | None, None if is_own else Field(None, alias=table))
    return fields


if TYPE_CHECKING:
    TablesOfKinds = SceneHead
else:
    TablesOfKinds = create_model("TablesOfKinds", __base__=SceneHead, __module__=__name__, **_fields_of_kinds())


class SceneTables(TablesOfKinds):
    """A scene of one kind with its tables.

    Whoever asks for a table that the scene does not have is refused (`block`, `contact`, `load`, `input`), so that no
    one takes one kind for another; `stated_block` and its neighbours are None there, as is the own table of a kind.
    """

    damping: DampingSection = DampingSection()
    fem: FemSection = FemSection()

    def __getattr__(self, name: str) -> Any:
        """Return a table of a kind by its name; refused where the scene is of another kind."""
        if f"stated_{name}" in type(self).model_fields:
            return self._present(name)
        return super().__getattr__(name)  # type: ignore[misc]  # pydantic defines it where no checker sees it

    @property
    def block(self) -> BlockSection:
        """The block; refused where the scene is of another kind."""
        return self.table(BlockSection)

    @property
    def contact(self) -> ContactSection:
        """The block's contact; refused where the scene is of another kind."""
        return self.table(ContactSection)

    @property
    def load(self) -> LoadSection:
        """The block's load; refused where the scene is of another kind."""
        return self.table(LoadSection)

    def table(self, section: type[Table]) -> Table:
        """Return a table of a kind by its class; refused where the scene is of another kind."""
        for kind in kinds().values():
            for name, table in kind.tables.items():
                if table is section:
                    present: Table = self._present(name)
                    return present
        raise TypeError(f"section: must be a table of a kind of scene, got {section.__name__}")

    def _present(self, field: str) -> Any:
        table = stated_value(self, field)
        if table is None:
            raise InputError("is needed for what is asked", source=self.name, field=field, value=self.kind_in_words)
        return table

    @property
    def kind(self) -> Kind:
        """Kind of the scene."""
        stated_kinds = (kind for kind in reversed([*kinds().values()]) if self._states(kind.name))
        return next(stated_kinds, next(iter(kinds().values())))

    def _states(self, table: str) -> bool:
        return stated_value(self, table) is not None

    @property
    def kind_in_words(self) -> str:
        """Kind of the scene, for messages."""
        return f"a scene of {self.kind.words}"

    @model_validator(mode="before")
    @classmethod
    def _complete_run(cls, data: Any) -> Any:
        """Let a scene that names no solvers or columns have those of its kind."""
        if not isinstance(data, dict) or not isinstance(run := data.get("run", {}), dict):
            return data
        for name, kind in kinds().items():
            if name in data and type(kind).run is not Kind.run:
                try:
                    table = kind.tables[name].model_validate(data[name])
                except ValidationError:  # by the scene, which says where
                    return data
                return {**data, name: table, "run": {**kind.run(table), **run}}
        return data

    @model_validator(mode="after")
    def _check_kind(self) -> Self:
        kind = self.kind
        for other in kinds().values():
            for table in other.tables:
                is_stated = self._states(table)
                if other is not kind and is_stated:
                    without = f"without {other.name}"
                    preposition = without if table != other.name and kind.rank == 0 else f"with {kind.name}"
                    raise ValueError(f"{table}: does not go {preposition}, got a table of it")
                if other is kind and not is_stated and table not in kind.optional(self):
                    raise ValueError(f"{table}: is required, got nothing")
        if kind.fem_keys is not None and (more := sorted(self.fem.model_fields_set - {*kind.fem_keys})):
            raise ValueError(f"fem: {more[0]} does not go with {kind.name}, got {getattr(self.fem, more[0])!r}")
        if apart := {*kind.refuses} & self.model_fields_set:
            raise ValueError(f"{min(apart)}: does not go with {kind.name}, got a table of it")
        return self
