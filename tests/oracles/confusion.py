"""Fifty histories of known origin, what `compare` makes of them, and the counts of the documentation.

The histories come from the program in `sliding_block`, which shares nothing with what judges them: seven digits each,
some with noise, some on a base that yields. ``PYTHONPATH=.:tests python
tests/oracles/confusion.py`` writes the counts to docs/compare.md.
"""

from __future__ import annotations

import tomllib
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


@dataclass(frozen=True)
class Known:
    """A history, the scene that it is judged against, and what was done to it."""

    cause: str  # an id, or "same"
    program: Plain  # that ran
    scene: Plain  # what the scene says
    change: Callable[[Foreign], Foreign]
    noise: float  # standard deviation over the largest displacement

    def judged(self, seed):
        """Return the answer and the history it was given."""
        made = history(self.program)
        rng = np.random.default_rng(seed)
        size = float(np.max(np.abs(made.displacement)))
        noisy = made.displacement + self.noise * size * rng.standard_normal(len(made.time))
        given = self.change(Foreign(made.time, np.array([float(f"{u:.6e}") for u in noisy])))
        return compare(scene_of(self.scene), given), made


CHANGES = {  # of the rows
    "milliseconds": lambda f: replace(f, time=f.time * 1e3),
    "late": lambda f: replace(f, displacement=np.concatenate([[0.0], f.displacement[:-1]])),
    "early": lambda f: replace(f, time=f.time[:-1], displacement=f.displacement[1:]),
}


def scaled(factor):
    return lambda f: replace(f, displacement=f.displacement * factor)


def known():
    """Yield the fifty."""
    rows = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["known"]
    for cause, scene, slip, change, noise in rows:
        own = replace(PLAIN, **scene)
        yield Known(cause, replace(own, **slip), own, CHANGES.get(change) or scaled(change), noise)


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
