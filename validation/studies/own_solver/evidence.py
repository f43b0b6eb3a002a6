"""What `compare` finds in the history of the one scene that tells most of a user's solver."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from validation.diagnosis import compare
from validation.diagnosis.reading import Foreign
from validation.runs.history import PRESSURE, History
from validation.runs.results import Results
from validation.studies.own_solver import gates
from validation.studies.own_solver.session import Told

LONGEST = 2000  # steps of a scene that is compared: every explanation that is tried steps through all of them
UNEXPLAINED = "unexplained"


def telling(failed: Sequence[Told], groups: Sequence[str]) -> Told | None:
    """Return a failing gate of the scene that tells most.

    It is the scene with the most failing gates of the groups that the fault lies in, then the most failing gates,
    then the fewest steps; the first of equal ones.
    """
    short = [t for t in failed if t.steps <= LONGEST]
    in_groups, every = Counter(t.scene for t in short if t.group in groups), Counter(t.scene for t in short)
    return max(short, key=lambda t: (in_groups[t.scene], every[t.scene], -t.steps), default=None)


def diagnosis(failed: Sequence[Told], groups: Sequence[str]) -> Iterator[str]:
    """Yield what `compare` says of the scene that tells most; nothing where no history failed a gate."""
    chosen = telling(failed, groups)
    history = None if chosen is None else Results(chosen.results).history(chosen.key)
    if chosen is None or history is None:
        return
    yield f"\ncompare, {chosen.scene} ({chosen.steps} steps)"
    yield from (f"  {line}" for line in _said(chosen, history))


def _said(chosen: Told, history: History) -> Iterator[str]:
    """Yield the sentence of `compare`, and whether it explains the history."""
    scene = gates.cases(chosen.study)[chosen.scene, gates.JUDGED].scene
    try:
        answer = compare(scene, Foreign(history.time, history.displacement, history.columns.get(PRESSURE)))
    except Exception as error:  # numbers of anybody's code: the rest of the block stands without it
        yield f"nothing can be said: {error}"
        return
    yield answer.sentence
    if answer.causes == [UNEXPLAINED]:
        yield "not explained: what is listed above stands, its cause is none that compare knows"
    elif answer.causes:
        yield f"causes: {', '.join(answer.causes)}"
