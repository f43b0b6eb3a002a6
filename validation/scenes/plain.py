"""A scene as plain data, for programs in any language: what its motion depends on, the units in the names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from validation.errors import InputError
from validation.runs.units import named
from validation.scenes.keys import Section, keys_of, stated, stated_value
from validation.scenes.kinds import Hooks, kinds
from validation.scenes.scene import Scene


class PlainHooks(Hooks):
    """What a kind of scene states of a problem, as plain data."""

    module = "plain"
    tables: ClassVar[Mapping[str, type[Section]]] = {}  # place in the data to the table whose keys stand there
    # Keys of these that the motion does not depend on: how a solver of this suite steps or cuts, and what another says.
    unstated: ClassVar[Mapping[type[Section], frozenset[str]]] = {}
    also: tuple[str, ...] = ()  # tables whose unstated keys a program is told of where they are not at their defaults
    implied: tuple[str, ...] = ()  # of these keys, what the data say in other words

    def data(self, scene: Scene) -> dict[str, Any]:
        """Return what a scene of this kind states; raises InputError where plain data do not hold it."""
        kinds_in_words = "must be a block, a column or blocks in the plane"
        raise InputError(kinds_in_words, source=scene.name, value=scene.kind_in_words)

    def table(self, section: Section, *without: str) -> dict[str, Any]:
        """Return the keys of a table with their units in the names; a key that is absent is null."""
        unstated = self.unstated.get(type(section), frozenset()) | {*without}
        data = {}
        for name, _, key in keys_of(type(section)):
            if name not in unstated:
                data[named(name, key.unit)] = plain(stated_value(section, name))
        return data


def scene_data(scene: Scene) -> dict[str, Any]:
    """Return what a scene states of a problem, table by table: what the motion depends on, and not how it is solved.

    Raises
    ------
    InputError
        A record drives it, which plain data do not hold.
    """
    return PlainHooks.of(scene).data(scene)


def words() -> Iterator[tuple[str, str]]:
    """Yield the names of the data of problems and what they mean, as the keys of scenes say it."""
    for kind in kinds():
        hooks = PlainHooks.of_kind(kind)
        for place, table in hooks.tables.items():
            for name, _, key in keys_of(table):
                if name not in hooks.unstated.get(table, ()):
                    yield f"{place}.{named(name, key.unit)}", key.text


def plain(value: Any) -> Any:
    """Return a value as JSON has it, which knows no infinity."""
    if isinstance(value, tuple):
        return [plain(part) for part in value]
    return "inf" if value == math.inf else value


def lines(scene: Scene) -> Iterator[str]:
    """Yield a scene for a program that reads words: a key and its values in a line, ``contact.stiffness_N_per_m 1e9``.

    What is null is left out. A key that problems never state follows the word ``also`` where it is not at its default:
    a program that does not know it refuses the scene.
    """
    time = scene.time
    data = scene_data(scene)
    data["time"] = {
        "step_s": time.step,
        "steps": time.steps,
        "scheme": time.scheme,
        "alpha": time.alpha,
        "delta": time.delta,
        "gg": time.discount,
        "start": time.start,
    }
    data["columns"] = list(scene.run.columns)
    yield from _flat("", data)
    hooks = PlainHooks.of(scene)
    tables = scene.tables()
    for place in ("damping", *hooks.also):
        if (section := tables.get(place)) is None:
            continue
        for name, value, key in stated(section):
            if name in hooks.unstated.get(type(section), (name,)) and name not in hooks.implied:
                yield from _flat(f"also {place}.{named(name, key.unit)}", plain(value))


def _flat(place: str, value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for name, part in value.items():
            yield from _flat(f"{place}.{name}" if place else name, part)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for number, part in enumerate(value, start=1):
            yield from _flat(f"{place}.{number}", part)
    elif value is not None:
        words = value if isinstance(value, list) else [value]
        yield f"{place} {' '.join(str(word).replace(' ', '-') for word in words)}"
