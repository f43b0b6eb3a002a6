"""The name of a case as a value: the scene's name and its swept values."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

_CASE = re.compile(r"(?P<scene>.*?)\[(?P<values>\w+(\.\w+)*=.*)\]", re.DOTALL)
_NEXT = re.compile(r",(?=\w+(?:\.\w+)*=)")  # a comma that separates two values


@dataclass(frozen=True)
class CaseName:
    """A scene's name and the swept values as text, written ``scene[section.key=value,...]``."""

    scene: str
    values: Mapping[str, str] = field(default_factory=dict)  # dotted key to value

    def __str__(self) -> str:
        inside = ",".join(f"{key}={value}" for key, value in self.values.items())
        return f"{self.scene}[{inside}]" if inside else self.scene

    @classmethod
    def parse(cls, text: str) -> CaseName:
        """Return the name that a text states; brackets that hold no ``key=value`` belong to the scene's name."""
        match = _CASE.fullmatch(text)
        if match is None:
            return cls(text)
        pairs = (part.partition("=") for part in _NEXT.split(match["values"]))
        return cls(match["scene"], {key: value for key, _, value in pairs})


def scene_of(case: str) -> str:
    """Return the scene's name without its swept values."""
    return CaseName.parse(case).scene
