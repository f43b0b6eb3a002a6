"""Folders of answers: exact motions, scaled, as tables beside one file of metadata."""

import json

from validation.problems.answers import FILE
from validation.problems.bands import standard
from validation.problems.data import ANSWERS, PACK
from validation.problems.pack import table_of
from validation.problems.problem import problem
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


def stated(place, **fields):
    """Write the metadata of a folder of answers, and return it; a field that is ... is left out."""
    place.mkdir(parents=True, exist_ok=True)
    content = {key: value for key, value in (STATED | fields).items() if value is not ...}
    (place / FILE).write_text(json.dumps(content, indent=1))
    return place


def answered(place, factor=1.01, names=QUICK, **fields):
    """Write a folder of answers, the exact motions times a factor, and return it."""
    stated(place, **fields)
    for name in names:
        one = problem(name)
        exact = standard(one).exact
        scaled = History(exact.time, {column: factor * values for column, values in exact.columns.items()})
        (place / f"{name}.csv").write_text(table_of(one, scaled))
    return place
