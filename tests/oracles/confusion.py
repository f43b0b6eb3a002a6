"""Fifty histories of known origin, what `compare` makes of them, and the counts of the documentation.

The histories come from the program in `sliding_block`, which shares nothing with what judges them: seven digits each,
some with noise, some on a base that yields. ``PYTHONPATH=.:tests python
tests/oracles/confusion.py`` writes the counts to docs/compare.md.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from oracles.pages import page_with, summary
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, history

from validation.diagnosis.causes import CAUSES
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign

PAGE = Path(__file__).parents[2] / "docs" / "compare.md"
BEGIN, END = "<!-- confusion: made by tests/oracles/confusion.py -->\n", "<!-- end -->\n"
SAME = "same"
WORDS = {"right": "were named right", "silent": "not explained", "wrong": "named wrong"}
PLAIN = Plain(dt=0.002, steps=30)
AVERAGE = {"alpha": 0.25, "delta": 0.5}


@dataclass(frozen=True)
class Known:
    """A history, the scene that it is judged against, and what was done to it."""

    cause: str  # an id, or "same"
    program: Plain  # that ran
    scene: Plain  # what the scene says
    change: Callable[[Foreign], Foreign] = lambda foreign: foreign
    noise: float = 0.0  # standard deviation over the largest displacement

    def judged(self, seed):
        """Return the answer and the history it was given."""
        made = history(self.program)
        rng = np.random.default_rng(seed)
        size = float(np.max(np.abs(made.displacement)))
        noisy = made.displacement + self.noise * size * rng.standard_normal(len(made.time))
        given = self.change(Foreign(made.time, np.array([float(f"{u:.6e}") for u in noisy])))
        return compare(scene_of(self.scene), given), made


def scaled(factor):
    return lambda f: replace(f, displacement=f.displacement * factor)


def in_milliseconds(f):
    return replace(f, time=f.time * 1e3)


def one_row_late(f):
    return replace(f, displacement=np.concatenate([[0.0], f.displacement[:-1]]))


def one_row_early(f):
    return replace(f, time=f.time[:-1], displacement=f.displacement[1:])


def known():
    """Yield the fifty."""
    dt1, dt4, stiff = replace(PLAIN, dt=0.001), replace(PLAIN, dt=4e-4), replace(PLAIN, p=1e10)
    damped = replace(PLAIN, gg=0.97, rho=2300.0)
    average = replace(PLAIN, **AVERAGE)
    for program in (PLAIN, dt4, damped):
        yield Known(SAME, program, program)
    for program, noise in ((PLAIN, 1e-3), (stiff, 1e-2), (average, 1e-3), (damped, 1e-2)):
        yield Known(SAME, program, program, noise=noise)
    for program, share in ((PLAIN, 0.01), (dt4, 0.01), (stiff, 0.015), (damped, 0.008)):
        soft = share * (0.5 + 0.5 * program.p / program.E) * 2  # over the springs' own share of the static value
        yield Known("base-compliance", replace(program, p=program.p / (1 + soft)), program)
    yield Known("base-compliance", replace(PLAIN, base=(5.0, 1.05e11)), PLAIN, noise=1e-4)
    for dt, p in ((1e-3, 1e9), (5e-4, 1e9), (5e-4, 1e10), (3e-4, 5e8), (2e-4, 2e9)):
        program = replace(PLAIN, dt=dt, p=p)
        yield Known("contact-opened", replace(program, opens=True), program)
    program = replace(PLAIN, dt=5e-4, gg=0.98)
    yield Known("contact-opened", replace(program, opens=True), program, noise=1e-3)
    for program, noise in ((average, 0.0), (replace(average, dt=0.001), 0.0), (replace(average, gg=0.97), 1e-3)):
        yield Known("start", replace(program, consistent=True), program, noise=noise)
    program = replace(average, dt=0.001, consistent=True)
    yield Known("start", replace(program, consistent=False), program)
    for base, gg, formula in (
        (PLAIN, 0.97, "velocity"),
        (PLAIN, 0.97, "displacement"),
        (average, 0.95, "velocity"),
        (average, 0.95, "displacement"),
        (dt1, 0.9, "velocity"),
    ):
        program = replace(base, gg=gg)
        yield Known("gg-in-one-formula", replace(program, formulas=formula), program)
    for program, factor in ((PLAIN, 0.5), (PLAIN, 2.0), (dt1, 10.0), (stiff, 0.1), (average, 0.25)):
        yield Known("springs-factor", replace(program, p=program.p * factor), program)
    for program in (PLAIN, dt4, stiff, replace(PLAIN, q=2e7)):
        yield Known("geometry-updated", replace(program, updated=True), program)
    for program, change, noise in (
        (PLAIN, one_row_late, 0.0),
        (average, one_row_late, 0.0),
        (PLAIN, one_row_early, 0.0),
        (damped, one_row_early, 1e-3),
    ):
        yield Known("time-shift", program, program, change, noise)
    yield Known("sign", PLAIN, PLAIN, scaled(-1.0))
    yield Known("sign", average, average, scaled(-1.0), 1e-3)
    yield Known("unit", PLAIN, PLAIN, scaled(1e3))
    yield Known("unit", stiff, stiff, scaled(100.0), 1e-3)
    yield Known("unit", average, average, in_milliseconds)
    yield Known("scheme", average, PLAIN)
    yield Known("scheme", replace(PLAIN, alpha=9 / 16), PLAIN, noise=1e-3)
    yield Known("scheme", replace(PLAIN, alpha=0.3025, delta=0.6), PLAIN)
    yield Known("gg", replace(PLAIN, gg=0.98), PLAIN)
    yield Known("gg", replace(average, gg=0.95), average, noise=1e-3)


def told(answer):
    """Return the one cause that the answer names: the faults if there are any, else what is benign."""
    faults = [name for name in answer.causes if not CAUSES[name].benign]
    return "+".join(faults or answer.causes) or SAME


def judge():
    """Judge all fifty."""
    return [(one, *one.judged(seed)) for seed, one in enumerate(known())]


def verdict(one, answer):
    """Return whether what was done is what was named."""
    named = told(answer)
    if named == one.cause:
        return "right"
    return "silent" if named == "unexplained" else "wrong"


def table(judged):
    """Return the paragraph of the page."""
    return summary(Counter((one.cause, verdict(one, answer)) for one, answer, _ in judged), WORDS)


if __name__ == "__main__":
    PAGE.write_text(page_with(table(judge()), PAGE.read_text(), BEGIN, END))
