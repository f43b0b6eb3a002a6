"""Defects of submitted files: all that are wrong with them at once, each with file, line and column."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from validation.errors import InputError


@dataclass(frozen=True)
class Place:
    """A place in a text file, counted from 1; line and column are absent where the whole file is meant."""

    path: Path
    line: int | None = None
    column: int | None = None

    def at(self, line: int, column: int) -> Place:
        """Return a place in the same file."""
        return Place(self.path, line, column)

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.path, self.line, self.column) if part is not None)


class DefectsError(InputError):
    """Submitted files that cannot be judged; as one line it is the first defect and the number of the others."""

    def __init__(self, defects: Iterable[InputError]) -> None:
        self.defects = tuple(defects)
        first = self.defects[0]
        more = len(self.defects) - 1
        super().__init__(
            first.rule,
            source=first.source,
            field=first.field,
            value=first.value,
            advice=f"{first.advice or ''} (and {more} more)".strip() if more else first.advice,
        )

    @classmethod
    def of(cls, error: InputError) -> Self:
        """Return the defects that an error stands for."""
        return cls(error.defects if isinstance(error, DefectsError) else [error])


class Defects:
    """The defects that were met so far; what repeats itself in a file is one, with the number of its places."""

    def __init__(self) -> None:
        self._errors: dict[tuple[Path, str | None, str], InputError] = {}
        self._repeated: dict[tuple[Path, str | None, str], int] = {}

    def __len__(self) -> int:
        return len(self._errors)

    def has(self, path: Path, field: str) -> bool:
        """Whether a field of a file has a defect."""
        return any(key[:2] == (path, field) for key in self._errors)

    def add(
        self, place: Place, rule: str, *, field: str | None = None, value: object = None, advice: str | None = None
    ) -> None:
        """Add a defect at a place of a file."""
        key = (place.path, field, rule)
        if key in self._errors:
            self._repeated[key] = self._repeated.get(key, 0) + 1
        else:
            self._errors[key] = InputError(rule, source=place, field=field, value=value, advice=advice)

    def take(self, error: InputError) -> None:
        """Add what another check has refused."""
        for defect in DefectsError.of(error).defects:
            path = defect.source.path if isinstance(defect.source, Place) else Path(str(defect.source))
            self._errors.setdefault((path, defect.field, str(defect)), defect)

    def check(self) -> None:
        """Raise DefectsError where there is a defect."""
        errors = []
        for key, error in self._errors.items():
            repeated = self._repeated.get(key)
            if repeated is None:
                errors.append(error)
                continue
            also = f"and in {repeated} more place{'s' if repeated > 1 else ''}"
            advice = f"{error.advice}; {also}" if error.advice else also
            errors.append(
                InputError(error.rule, source=error.source, field=error.field, value=error.value, advice=advice)
            )
        if errors:
            raise DefectsError(errors)
