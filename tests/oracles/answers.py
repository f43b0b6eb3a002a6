"""Folders of answers: exact motions, scaled, as tables beside one file of metadata."""

import json
from pathlib import Path
from typing import Any

from validation.problems.bands import standard
from validation.problems.data import ANSWERS, PACK
from validation.problems.pack import table_of
from validation.problems.problem import problem
from validation.problems.submission import FILE
from validation.runs.history import History

STATED = {
    "format": ANSWERS,
    "pack": PACK,
    "program": "Bob's <code> & co",
    "version": "1.0",
    "settings_name": "default",
    "settings": "no damping",
    "scheme": "average acceleration",
    "step_s": 0.002,
    "contact_model": "springs",
    "processor": "a processor",
    "who": "somebody",
    "licence": "CC0-1.0",
}
QUICK = ("locked", "rocking", "column")  # problems whose exact motions take no time


def answered(place: Path, factor: float = 1.01, names: tuple[str, ...] = QUICK, **fields: Any) -> Path:
    """Write a folder of answers, the exact motions times a factor, and return it; a field that is ... is left out."""
    place.mkdir(parents=True, exist_ok=True)
    stated = {key: value for key, value in (STATED | fields).items() if value is not ...}
    (place / FILE).write_text(json.dumps(stated, indent=1))
    for name in names:
        one = problem(name)
        exact = standard(one).exact
        scaled = History(exact.time, {column: factor * values for column, values in exact.columns.items()})
        (place / f"{name}.csv").write_text(table_of(scaled, one.scene.run.columns))
    return place
