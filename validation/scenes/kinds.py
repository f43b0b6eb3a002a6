"""The kinds of scenes, a folder of `validation/models` each, and how a room asks the kind of a scene.

A room that needs something of a kind declares it as a class of hooks, `class MemoryHooks(Hooks)`, whose methods are the
answers of a kind that says nothing, and asks `MemoryHooks.of(scene).model(scene, solver)`. A kind answers by a class
``HOOKS`` in the module of its folder that the hooks name. So no room asks for the kind, none imports it, and adding or
deleting a folder changes nothing else.
"""

from __future__ import annotations

import functools
import importlib
import importlib.util
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, Protocol, Self

from validation.runs.columns import NO_OWN, OwnColumns
from validation.scenes.keys import Section

MODELS = "validation.models"


class OfAKind(Protocol):
    """A scene, of which the kind is asked."""

    @property
    def kind(self) -> Kind:
        """Its kind."""


class Hooks:
    """What a room asks of the kind of a scene; the methods of a subclass give the answers of a kind without its own."""

    module: ClassVar[str] = ""  # of a kind's folder, which holds the class `HOOKS` with the answers

    @classmethod
    def of(cls, scene: OfAKind) -> Self:
        """Return the answers of the kind of a scene."""
        return cls.of_kind(scene.kind.name)

    @classmethod
    def of_kind(cls, name: str) -> Self:
        """Return the answers of a kind."""
        hooks = _hooks(cls.module, name) or cls
        return hooks()


@functools.cache
def _hooks(module: str, kind: str) -> Any:
    """Return the class that a module of a kind's folder brings; None where there is no such module."""
    place = f"{MODELS}.{kind}.{module}"
    return importlib.import_module(place).HOOKS if importlib.util.find_spec(place) else None


class Kind:
    """What a kind of scenes is: its tables, and what of the common ones goes with it.

    A folder's `kind.py` holds a subclass ``KIND``; it imports no scene, since scenes are made of it.
    """

    name: str = ""  # of the folder, and of the table that says that a scene is of this kind
    words: str = ""  # after "a scene of"
    feature: str = ""  # that its scenes have, by which solvers say that they take them; none of a block
    linear: bool = True  # whether their motion is, unless another feature says no
    locks_contact: bool = False  # whether a contact pressure may be that of a contact that is locked, and pull
    point: str = "top"  # whose displacement a history of it holds
    rank: float = 9.0  # place among the kinds; a scene without a table of any kind is of the first
    tables: ClassVar[Mapping[str, type[Section]]] = {}  # by name, that of the kind first
    columns: OwnColumns = NO_OWN  # numbered columns of histories that only this kind has, without their numbers
    solvers: ClassVar[Mapping[str, str]] = {}  # that the folder brings, each as ``module:class``
    files: ClassVar[Mapping[str, str]] = {}  # keys of its tables that name files, and what these are
    refuses: Collection[str] = ()  # common tables that do not go with it
    fem_keys: Collection[str] | None = None  # keys of `fem` that go with it; None: all

    def run(self, table: Any) -> dict[str, Any]:
        """Return keys of `run`, such as solvers and columns, for a scene that does not state them, by its own table."""
        return {}

    def optional(self, scene: Any) -> Collection[str]:
        """Return the tables of this kind that a scene may leave out."""
        return ()

    def has_column(self, scene: Any, column: str) -> bool:
        """Whether a history of a scene may hold a column, beside those that solvers have of every scene."""
        return False

    def check(self, scene: Any) -> None:
        """Check tables against each other; raise ValueError with ``table: key rule, got value``."""


@functools.cache
def kinds() -> Mapping[str, Kind]:
    """Return the kinds of scenes by name, in the order of their ranks."""
    found = [importlib.import_module(f"{MODELS}.{name}.kind").KIND() for name in _folders()]
    return {kind.name: kind for kind in sorted(found, key=lambda kind: kind.rank)}


def _folders() -> Iterator[str]:
    for directory in importlib.import_module(MODELS).__path__:
        for path in sorted(Path(directory).glob("*/kind.py")):
            yield path.parent.name
