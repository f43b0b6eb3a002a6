"""What problems ask for and are judged by, as numbers kept in `numbers.toml` beside this file.

Answers are stand-ins, waves that a name decides: what is measured on them means nothing, but a formula that has changed
shows. `KEEP_PAGES=1` writes the file anew.
"""

import os
from pathlib import Path

import numpy as np
from oracles.stand_ins import differing, history, keep, kept, summed

from validation.problems.problem import ProblemHooks, names, problem

KEPT = Path(__file__).with_name("numbers.toml")


def numbers(name, factor=1.0):
    """Return the number of all that a problem says in numbers, and of what it measures on a stand-in."""
    posed = problem(name)
    answer = history(posed.scene, factor=factor)
    stated = [len(posed.instants), float(posed.instants[-1]), *posed.columns, *map(posed.unit, posed.columns)]
    for number in posed.numbers:
        stated += [number.exact, number.low, number.high, number.scale, number.optional]
    measured = [number.measure(answer) for number in posed.numbers]
    for number in ProblemHooks.of(posed.scene).shown_numbers(posed.scene) or ():
        measured.append(number.of(answer.time, answer.columns[number.column]))
    return {f"{name} stated": summed(stated), f"{name} measured": summed(measured)}


@np.errstate(all="ignore")
def test_problems_ask_and_measure_as_before():
    found = {}
    changed = {}
    for name in names():
        found |= numbers(name)
        if os.environ.get("KEEP_PAGES"):
            changed |= numbers(name, 1 + 1e-11)
    if os.environ.get("KEEP_PAGES"):
        keep(KEPT, "problems", found, changed)
    assert differing(found, kept(KEPT)["problems"]) == {}
