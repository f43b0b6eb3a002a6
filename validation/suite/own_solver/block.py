"""The block after the last gate of a user's solver: what passed, what failed and what it tells."""

from __future__ import annotations

import re
import textwrap
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence

from validation.diagnosis import compare
from validation.diagnosis.causes import UNEXPLAINED
from validation.diagnosis.reading import Foreign
from validation.gates.gate import Status
from validation.runs.history import PRESSURE
from validation.runs.numbers import share_text
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.scenes.scene import Scene
from validation.suite.matrix import JUDGED
from validation.suite.own_solver import block_data, gates
from validation.suite.own_solver.block_data import Misreading
from validation.suite.own_solver.gates import BLOCK_DATA, BLOCK_DATA_WORDS, GROUPS
from validation.suite.own_solver.history import AT_REST
from validation.suite.own_solver.session import LARGEST, GateReport

SHOWN = 3  # gates of a group, and scenes of an ending, that are listed; the rest are counted
FOLLOWS = ("statics", "frequency", "damping", "start", "digits")  # a fault in one shows in those after it
FIRST_WIDTH = 11  # characters of the first column
WIDTH = 110  # characters of a line
LONGEST = 2000  # steps of a scene that is compared: every explanation that is tried steps through all of them
MAY_FOLLOW = "may follow from it, look again when it is right"


def block(results: Sequence[GateReport], every: bool = False) -> list[str]:
    """Return the lines of the block; if `every`, all failing gates of a group are listed, not the first few."""
    judged = [t for t in results if t.status != Status.NOT_RUN and t.outcome == Outcome.COMPLETED]
    failed = [t for t in judged if t.status == Status.FAIL]
    # what a solver misreads of the block, with the scenes that show it; nothing where its statics are wrong
    resting = [t for t in judged if t.group == BLOCK_DATA and t.metric == AT_REST]
    rests = {t.scene: (t.value, (t.high - t.low) / 2) for t in resting if isinstance(t.value, float)}
    misreadings = block_data.misreadings(rests)
    statics = [t for t in failed if t.group == "statics"]
    misread = {} if any(not _follows(t, misreadings) for t in statics) else misreadings
    plain = [t for t in failed if t.group != BLOCK_DATA and not _follows(t, misread)]
    lines = [
        *_table(results),
        *_warnings(results),
        *_headline(judged, failed, plain),
        *_block_data(judged, failed, plain, misread),
        *_failures(failed, every),
        *_endings(results),
        *_not_run(results),
    ]
    return [*lines, *diagnosis(plain or _moving(failed), first(judged, plain)), *_unseen(judged)]


def wrapped(lines: Sequence[str]) -> Iterator[str]:
    """Yield lines no longer than a block is wide, what goes on indented below its beginning."""
    for line in lines:
        for part in line.split("\n"):
            indent = " " * (len(part) - len(part.lstrip()) + 4)
            yield from textwrap.wrap(part, WIDTH, subsequent_indent=indent, drop_whitespace=True) or [""]


def _table(results: Sequence[GateReport]) -> Iterator[str]:
    """Yield a line a group: how many of its gates passed, failed, had nothing to judge and were not run."""
    yield f"{'':<{FIRST_WIDTH}}{'PASS':>8}{'FAIL':>8}{'no result':>11}{'NOT RUN':>9}"
    for group, says in (GROUPS | {BLOCK_DATA: BLOCK_DATA_WORDS}).items():
        of_group = [t for t in results if t.group == group]
        sound = [t.status for t in of_group if t.outcome == Outcome.COMPLETED]
        absent = sum(t.status == Status.NOT_RUN for t in of_group)
        passed, failed = sound.count(Status.PASS), sound.count(Status.FAIL)
        if of_group:
            counts = f"{passed:>8}{failed:>8}{len(of_group) - passed - failed - absent:>11}{absent:>9}"
            yield f"{group:<{FIRST_WIDTH}}{counts}   {says}"


def _warnings(results: Sequence[GateReport]) -> Iterator[str]:
    """Yield what makes the verdicts worth less: a solver of the suite answered, or two runs differ."""
    scenes = {t.scene for t in results if t.outcome == Outcome.COMPLETED}
    for solver in dict.fromkeys(name for t in results for name in t.same_as.split()):
        same = {t.scene for t in results if solver in t.same_as.split()}
        yield (
            f"\nidentical: bit for bit the histories of the suite's own {solver} in {len(same)} of {len(scenes)} "
            "scenes; another program differs in its last digits: these gates judged the suite's solver"
        )
    apart = {t.scene: t for t in results if t.apart_in}
    for t in apart.values():
        yield (
            f"\nnot repeatable: two runs of {t.scene} differ by {difference(t.apart)} in {t.apart_in} (relative L2); "
            "verdicts may change from run to run, fix the seed or the race first"
        )


def difference(share: float) -> str:
    """Return a relative difference in per cent, in words where it has no number."""
    return share_text(share, 2) if share < LARGEST else "more than can be told"


# ---- what it tells ----


def first(judged: Sequence[GateReport], failed: Sequence[GateReport]) -> list[str]:
    """Return the groups that a fault lies in: the first that fails, and the pressure where it fails by itself.

    That is where the displacement of the same scene is right to rounding.
    """
    groups = {t.group for t in failed} - {BLOCK_DATA}
    groups_at_fault = [group for group in FOLLOWS if group in groups][:1]
    exact = {t.scene for t in judged if t.metric == "displacement.max" and t.group == "digits"}
    exact -= {t.scene for t in failed if t.group != "pressure"}
    alone = any(t.metric == "pressure.max" and t.scene in exact for t in failed)
    return [*groups_at_fault, "pressure"] if alone or (groups and not groups_at_fault) else groups_at_fault


def _headline(judged: Sequence[GateReport], failed: Sequence[GateReport], plain: Sequence[GateReport]) -> Iterator[str]:
    """Yield what is right, and where to look for the fault that the plain scenes tell of."""
    right = [g for g in GROUPS if any(t.group == g for t in judged) and not any(t.group == g for t in failed)]
    if judged:
        yield f"\nright:  {', '.join(right) or 'nothing yet'}"
    groups_at_fault = first(judged, plain)
    for group in groups_at_fault:
        yield f"wrong:  {group} - {GROUPS[group]}"
    rest = [group for group in GROUPS if group not in groups_at_fault and any(t.group == group for t in plain)]
    if rest:
        yield f"        {', '.join(rest)}: {MAY_FOLLOW}"


def _follows(result: GateReport, misread: Collection[Misreading]) -> bool:
    """Whether a gate is on a scene that a solver misreads."""
    return any(block_data.is_misread(_scene(result), one) for one in misread)


def _scene(result: GateReport) -> Scene:
    return gates.cases(result.study)[result.scene, JUDGED].scene


def _block_data(
    judged: Sequence[GateReport],
    failed: Sequence[GateReport],
    plain: Sequence[GateReport],
    misread: Mapping[Misreading, list[str]],
) -> Iterator[str]:
    """Yield with which data of the block a solver is right, and which of them it misreads."""
    data = block_data.datum_of()
    scenes_of_data = {t.scene for t in judged if t.group == BLOCK_DATA}
    wrong = [t for t in failed if t.group == BLOCK_DATA]
    right = [datum.words for scene, datum in data.items() if scene in scenes_of_data - {t.scene for t in wrong}]
    if right:
        yield f"{BLOCK_DATA}: right with {', '.join(right)}"
    if wrong and any(t.group == "statics" for t in plain):
        yield f"        {BLOCK_DATA}: {MAY_FOLLOW}"
        return
    for misreading, scenes in misread.items():
        where = ", ".join(data[scene].words for scene in scenes)
        yield f"wrong:  {BLOCK_DATA} - {misreading.words} (seen with {where})"
    following = {t.group for t in failed} - {t.group for t in plain} - {BLOCK_DATA}
    if following:
        yield f"        {', '.join(group for group in GROUPS if group in following)}: {MAY_FOLLOW}"
    for t in wrong:
        if t.metric == AT_REST and not any(t.scene in scenes for scenes in misread.values()):
            middle = (t.low + t.high) / 2
            yield (
                f"wrong:  {BLOCK_DATA} - {data[t.scene].words}: rests at {t.value:.6g} m, not at {middle:.6g} m; "
                "which datum is misread is not known, print those that your solver takes from this scene"
            )
    if not any(t.group in ("digits", "pressure") for t in plain):
        suspects = "the moment of inertia, or where width and height enter"
        if not any(_scene(t).time.discount < 1 for t in judged if t.group == "digits"):
            suspects = f"gg, which is below 1 in no other scene that was judged, {suspects}"
        for t in _moving(wrong):
            words = f"{data[t.scene].words}: {t.metric.partition('.')[0]} before it rests"
            yield f"wrong:  {BLOCK_DATA} - {words}: {suspects}"


def _moving(failed: Sequence[GateReport]) -> list[GateReport]:
    """Return the failing gates on the motion of a scene of `BLOCK_DATA` that comes to rest at the right place."""
    misplaced = {t.scene for t in failed if t.metric == AT_REST}
    return [t for t in failed if t.group == BLOCK_DATA and t.scene not in misplaced]


def _failures(failed: Sequence[GateReport], every: bool) -> Iterator[str]:
    """Yield the failing gates with their values, by group."""
    for group in (*GROUPS, BLOCK_DATA):
        of_group = [t for t in failed if t.group == group]
        if of_group:
            yield f"\nfailed: {group}"
        for t in of_group if every else of_group[:SHOWN]:
            yield f"  {t.scene}: {outside(t)}"
        if len(of_group) > SHOWN and not every:
            yield f"  and {len(of_group) - SHOWN} more (-v lists them)"


def outside(result: GateReport) -> str:
    """Return value and band with so many digits that one sees the band's width and the value outside."""
    metric, low, high = result.metric, result.low, result.high
    if not isinstance(result.value, float | int):
        return f"{metric} is {result.value}; the band is [{low:.6g}, {high:.6g}]"
    for digits in range(4, 17):
        value, *edges = (f"{number:.{digits}g}" for number in (result.value, low, high))
        if value not in edges and (edges[0] != edges[1] or low == high):
            break
    return f"{metric} = {value} is outside [{', '.join(edges)}]"


# ---- what was not judged ----


def _endings(results: Sequence[GateReport]) -> Iterator[str]:
    """Yield how runs without a history to judge ended, each ending once with its scenes."""
    ended = [t for t in results if t.status == Status.FAIL and t.outcome not in ("", Outcome.COMPLETED)]
    for kind in dict.fromkeys(map(_ending, ended)):
        of_kind = [t for t in ended if _ending(t) == kind]
        why, outcome = of_kind[0].why, of_kind[0].outcome
        yield f"\n{why if why.startswith('wrong ') else f'{outcome}: {why}'}"
        yield f"  {_gates(of_kind)}: {_few([t.scene for t in of_kind])}"


def _ending(result: GateReport) -> tuple[str, str, str]:
    """Return what tells endings apart: the place in the solver's code, but no number of a scene."""
    why, _, place = result.why.rpartition(" (") if result.outcome == Outcome.RAISED else (result.why, "", "")
    return result.outcome, re.sub(r"\d+", "", why), place


def _not_run(results: Sequence[GateReport]) -> Iterator[str]:
    """Yield why gates were not run, each reason once."""
    absent = [t for t in results if t.status == Status.NOT_RUN]
    if absent:
        yield "\nNOT RUN"
    for why in dict.fromkeys(t.why for t in absent):
        of_reason = [t for t in absent if t.why == why]
        yield f"  {_gates(of_reason)}: {why}"


def _unseen(judged: Sequence[GateReport]) -> Iterator[str]:
    """Yield what no gate has seen of the solver: a pass says nothing of it."""
    kinds = gates.unseen({(t.study, t.scene): _scene(t) for t in judged}.values())
    if judged and kinds:
        yield f"\nno gate saw: {', '.join(kinds)}; what passed says nothing of it"


def _gates(results: Sequence[GateReport]) -> str:
    return f"{len(results)} gate{'s' * (len(results) > 1)}"


def _few(names: Sequence[str]) -> str:
    """Return the first names of a list, and the number of the others."""
    every = list(dict.fromkeys(names))
    more = f" and {len(every) - SHOWN} more scenes" if len(every) > SHOWN else ""
    return ", ".join(every[:SHOWN]) + more


# ---- what `compare` finds ----


def telling(failed: Sequence[GateReport], groups: Sequence[str]) -> GateReport | None:
    """Return a failing gate of the scene that tells most.

    It has the most failing gates of the groups that the fault lies in, then the most failing gates, then the fewest
    steps; the first of equal ones.
    """
    short = [t for t in failed if t.steps <= LONGEST]
    in_groups, every = Counter(t.scene for t in short if t.group in groups), Counter(t.scene for t in short)
    return max(short, key=lambda t: (in_groups[t.scene], every[t.scene], -t.steps), default=None)


def diagnosis(failed: Sequence[GateReport], groups: Sequence[str]) -> Iterator[str]:
    """Yield what `compare` says of the scene that tells most; nothing where no history failed a gate."""
    chosen = telling(failed, groups)
    history = None if chosen is None else Results(chosen.results).history(chosen.key)
    if chosen is None or history is None:
        return
    yield f"\ncompare, {chosen.scene} ({chosen.steps} steps)"
    try:
        answer = compare(_scene(chosen), Foreign(history.time, history.displacement, history.columns.get(PRESSURE)))
    except Exception as error:  # numbers of anybody's code: the rest of the block stands without it
        yield f"  nothing can be said: {error}"
        return
    yield f"  {answer.sentence}"
    if answer.causes == [UNEXPLAINED]:
        yield "  not explained: what is listed above stands, its cause is none that compare knows"
    elif answer.causes:
        yield f"  causes: {', '.join(answer.causes)}"
