"""Versions of the pack: which answers to an earlier one are answers to this one.

- The *digest* of a problem is taken of its question: its data, its instants and its columns. Titles, words, bands and
  the exact motion are not among them, so that a band or an exact motion that is corrected judges old answers anew.
- A *minor* version (4.0, 4.1) adds problems; the digests of the others stay, and every earlier answer with them.
- A *major* version (4.1, 5.0) changes the question of a problem or drops one. Answers to these problems are *stale*,
  which is said, and not judged; answers to all others stay valid, since their digests do.

`packs.json` holds the digests of every version; what it says of an earlier version never changes.
"""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Mapping
from importlib import resources
from typing import Any

from validation.problems.data import PACK
from validation.problems.problem import Problem
from validation.scenes.plain import scene_data

DIGITS = 12  # of a number in a digest: the last ones of a computed one may differ from processor to processor
DIGEST_LENGTH = 16  # hexadecimal digits


def digest(problem: Problem) -> str:
    """Return the digest of a problem's question, in hexadecimal digits."""
    scene = problem.scene
    stated = {
        "scene": scene_data(scene),
        "sampling": {"step_s": scene.time.step, "count": scene.time.steps},
        "columns": list(problem.columns),
    }
    canonical = json.loads(json.dumps(stated), parse_float=_rounded, object_hook=_stated)
    text = json.dumps(canonical, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:DIGEST_LENGTH]


def _rounded(number: str) -> str:
    return format(float(number), f".{DIGITS}g")


def _stated(table: dict[str, Any]) -> dict[str, Any]:
    """Return a table without what is null, so that a new field that a problem does not use changes no digest."""
    return {name: part for name, part in table.items() if part is not None}


@functools.cache
def packs() -> Mapping[str, Mapping[str, str]]:
    """Return the digests of every version of the pack: version to problem to digest."""
    text = resources.files("validation.problems").joinpath("packs.json").read_text("utf-8")
    digests: dict[str, dict[str, str]] = json.loads(text)
    return digests


def stale(pack: str, problem: str) -> str | None:
    """Return why an answer to a problem of a version is none to this version's; None where it is one.

    Raises
    ------
    KeyError
        There is no such version, or it had no such problem.
    """
    before = packs()[pack][problem]
    now = packs()[PACK].get(problem)
    if now == before:
        return None
    if now is None:
        return f"it answers pack {pack}; pack {PACK} has no such problem any more"
    return f"it answers pack {pack}; its data, instants or columns are others in pack {PACK}"
