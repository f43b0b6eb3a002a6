"""Answers to the problems of the pack, as the two files that `dda-validate judge` reads."""

import json
from pathlib import Path
from typing import Any

from validation.problems.data import PACK, SUBMISSION
from validation.problems.pack import table_of
from validation.problems.problem import problem
from validation.problems.submission import FILE
from validation.problems.truth import exact

STATED = {
    "format": SUBMISSION,
    "pack": PACK,
    "problem": "locked",
    "program": "Bob's <code> & co",
    "version": "1.0",
    "settings": "average acceleration, 0.1 ms",
    "who": "somebody",
}


def submitted(place: Path, table: str, **fields: Any) -> Path:
    """Write a submission and return its directory; a field that is ... is left out."""
    place.mkdir(exist_ok=True)
    stated = {key: value for key, value in (STATED | fields).items() if value is not ...}
    (place / FILE).write_text(json.dumps(stated))
    (place / "answer.csv").write_text(table)
    return place


def right_answer(place: Path) -> Path:
    """Write the exact motion of the locked block as a submission, and return its directory."""
    asked = problem("locked")
    return submitted(place, table_of(exact(asked.scene, asked.truth), asked.scene.run.columns))
