"""The answer of `run`: what failed in full, then at most `SCREEN` lines: a line a study, alarms, what to type next."""

from __future__ import annotations

import itertools
import shlex
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from validation.cli.app import RESULTS
from validation.engine.measured import JudgedStudy, unjudged
from validation.gates.changes import Change
from validation.gates.gate import Status, Verdict
from validation.report.blocks import TableColumn, table
from validation.report.render.terminal import StyledLine, table_lines, wrapped
from validation.runs.numbers import measured_text
from validation.runs.records import AlarmRecord
from validation.runs.results import Results
from validation.runs.row import Row
from validation.runs.run import Outcome
from validation.runs.text import printable

SCREEN = 25  # lines below what failed
LEAST_STUDIES = 4  # that have a line each; of more than fit, those with nothing to tell are added up
FAILURES_SHOWN = 40  # in full; of more, the rest is counted, and --verbose shows it
KINDS_EXPLAINED = 5  # kinds of alarm of a user's own scene, with a sentence each
WORDS = tuple(str(status) for status in (Status.PASS, Status.FAIL, Status.NOT_RUN))


@dataclass(frozen=True)
class RunAnswer:
    """Studies as one command ran them, and what is to be said of them."""

    runs: Sequence[JudgedStudy]
    seconds: Sequence[float]  # that each took now
    results: Results  # with finished cases, verdicts and alarms
    messages: Sequence[str]  # sentences on what was not measured
    changes: Sequence[Change] | None  # since the baseline; None without one
    user_scenes: frozenset[str]  # names of the runs that are scenes, a user's or built-in, not studies of the suite
    status: int  # exit status

    @property
    def names(self) -> list[str]:
        """Names of the studies."""
        return [run.study.name for run in self.runs]

    @property
    def verdicts(self) -> list[Verdict]:
        """The verdicts of all studies, in their order."""
        return list(itertools.chain.from_iterable(run.verdicts for run in self.runs))

    def alarms(self, names: Iterable[str] | None = None) -> list[AlarmRecord]:
        """Return the alarms of the named studies, by default of all."""
        studies = self.names if names is None else names
        alarms = (self.results.manifest(name).get("alarms", []) for name in studies)
        return list(itertools.chain.from_iterable(alarms))


def lines(answer: RunAnswer, width: int) -> Iterator[StyledLine]:
    """Yield the answer: failures first, so that the summary is what a terminal shows last."""
    yield from failures(answer, width)
    yield from summary(answer, width)


def failures(answer: RunAnswer, width: int) -> Iterator[StyledLine]:
    """Yield every failing gate with value, band and reason, every case that ended badly, and what was not measured."""
    failed = [verdict for verdict in answer.verdicts if verdict.status is Status.FAIL]
    for verdict in failed[:FAILURES_SHOWN]:
        yield from wrapped(_measured(verdict), width, "FAIL")
        for text in dict.fromkeys(filter(None, (verdict.why, verdict.gate.reason))):
            yield from wrapped(f"  {text}", width, "")
    omitted = Counter(verdict.gate.metric for verdict in failed[FAILURES_SHOWN:])
    if omitted:
        counted = ", ".join(f"{metric} {count}" for metric, count in omitted.most_common())
        text = f"FAIL and {omitted.total()} more gates: {counted}; --verbose shows every one"
        yield from wrapped(text, width, "FAIL")
    ended = list(badly_ended(answer))
    for text in ended[:FAILURES_SHOWN]:
        yield from wrapped(text, width, "")
    if len(ended) > FAILURES_SHOWN:
        yield f"and {len(ended) - FAILURES_SHOWN} more runs ended badly; --verbose names every one", ""
    for sentence in answer.messages:
        yield from wrapped(sentence, width, "FAIL")


def _measured(verdict: Verdict) -> str:
    gate = verdict.gate
    value = "no value" if verdict.value is None else verdict.value
    band = f"[{gate.low:.4g}, {gate.high:.4g}]"
    if isinstance(value, str):
        return f"FAIL {printable(gate.id)}: {value}, allowed {band}"
    return f"FAIL {printable(gate.id)}: {measured_text(value)} is outside {band}"


def badly_ended(answer: RunAnswer) -> Iterator[str]:
    """Yield how the cases ended that ended in a way their study does not expect."""
    for run in answer.runs:
        bad = _bad_cases(run)
        for scene, solver, row in finished_cases(answer.results, [run.study.name]):
            if (scene, solver) in bad:
                yield how_it_ended(scene, solver, row.outcome, row.notes)


def finished_cases(results: Results, studies: Iterable[str]) -> Iterator[tuple[str, str, Row]]:
    """Yield scene, solver and row of every case of some studies."""
    rows = results.rows()
    for study in studies:
        for case in results.manifest(study).get("cases", []):
            yield case["scene"], case["solver"], rows[case["key"]]


def _bad_cases(run: JudgedStudy) -> set[tuple[str, str]]:
    """Return the cases that ended in a way their study does not expect, refused ones among them."""
    bad = set(run.failed)
    if run.refused:
        bad.update(case for case, outcome in run.outcomes.items() if outcome is Outcome.REFUSED)
    return bad


def how_it_ended(scene: str, solver: str, outcome: Outcome, notes: Sequence[str]) -> str:
    """Return the line of a case that did not complete, or of several ones of a solver."""
    return printable(f"{scene} {solver}: {outcome}: {outcome.sentence} {'; '.join(notes)}")


# ---- the summary ----


def summary(answer: RunAnswer, width: int) -> Iterator[StyledLine]:
    """Yield the lines that stand last, at most `SCREEN` for the studies of the suite."""
    tail = list(_tail(answer, width))
    room = max(SCREEN - 2 - len(tail), LEAST_STUDIES)
    rows = [(run.study.name, counts(run), s) for run, s in zip(answer.runs, answer.seconds, strict=True)]
    lines = [
        (printable(name), *(str(tally[word]) for word in WORDS), f"{seconds:.1f}")
        for name, tally, seconds in _folded(rows, room)
    ]
    numbers = (TableColumn(title, "decimal") for title in ("passed", "failed", "not run", "seconds"))
    yield from table_lines(table([TableColumn("study"), *numbers], lines), None)
    total = sum((tally for _, tally, _ in rows), Counter[str]())
    counted = ", ".join(f"{total[word]} {word}" for word in WORDS)
    style = next((word for word in ("FAIL", "NOT RUN", "PASS") if total[word]), "")
    yield f"{counted} in {sum(answer.seconds):.1f} s", style
    yield from tail


def _tail(answer: RunAnswer, width: int) -> Iterator[StyledLine]:
    reasons = Counter(verdict.why for verdict in answer.verdicts if verdict.status is Status.NOT_RUN)
    for why, count in reasons.most_common(2):
        yield from wrapped(f"NOT RUN {count}: {printable(why)}", width, "NOT RUN")
    if len(reasons) > 2:
        yield f"NOT RUN for {len(reasons) - 2} more reasons; --verbose shows every one", "NOT RUN"
    yield from _ended(answer, width)
    # for own scenes the first sentence of each kind of alarm, too
    kinds = alarm_kinds(answer)
    if kinds:
        words = ", ".join(f"{kind} in {n} case{'s' * (n > 1)}" for kind, n in kinds.items())
        yield from wrapped(f"alarms: {words}", width, "")
    user_alarms = answer.alarms(name for name in answer.names if name in answer.user_scenes)
    first_alarms = {alarm["kind"]: alarm for alarm in reversed(user_alarms)}
    for kind in [kind for kind in kinds if kind in first_alarms][:KINDS_EXPLAINED]:
        yield from wrapped(f"  {kind}: {first_alarms[kind]['scene']}: {first_alarms[kind]['sentence']}", width, "")
    for sentence in unjudged(answer.runs):
        yield sentence, ""
    yield from wrapped(f"results: {answer.results.directory}", width, "")
    if any(run.verdicts for run in answer.runs):
        yield from wrapped(f"next: {'; '.join(next_commands(answer))}", width, "")


def counts(run: JudgedStudy) -> Counter[str]:
    """Return the numbers of gates of a study by verdict."""
    return Counter(str(verdict.status) for verdict in run.verdicts)


def _folded(rows: Sequence[tuple[str, Counter[str], float]], room: int) -> list[tuple[str, Counter[str], float]]:
    """Return the rows that fit; those without a gate that failed or was not run are added up first."""
    if len(rows) <= room:
        return list(rows)
    # A stable sort: studies with something to tell stand first, otherwise their order is kept.
    ranked = sorted(rows, key=lambda row: not (row[1]["FAIL"] or row[1]["NOT RUN"]))
    separate = ranked[: room - 1]
    remainder = [row for row in rows if row not in separate]
    tally = sum((row[1] for row in remainder), Counter[str]())
    total = (f"{len(remainder)} more", tally, sum(row[2] for row in remainder))
    return [*(row for row in rows if row in separate), total]


def ends(answer: RunAnswer) -> Counter[str]:
    """Return how many cases ended otherwise than completed as their study expects, by outcome."""
    tally: Counter[str] = Counter()
    for run in answer.runs:
        bad = _bad_cases(run)
        for case, outcome in run.outcomes.items():
            if outcome is not Outcome.COMPLETED and case not in bad:
                tally[str(outcome)] += 1
    return tally


def _ended(answer: RunAnswer, width: int) -> Iterator[StyledLine]:
    tally = ends(answer)
    if tally:
        cases = sum(len(run.outcomes) for run in answer.runs)
        words = ", ".join(f"{count} {word}" for word, count in tally.most_common())
        yield from wrapped(
            f"{tally.total()} of {cases} runs did not complete, as their studies allow: {words}", width, ""
        )


def alarm_kinds(answer: RunAnswer) -> dict[str, int]:
    """Return the number of cases of each kind of alarm."""
    cases: dict[str, set[str]] = {}
    for alarm in answer.alarms():
        cases.setdefault(alarm["kind"], set()).add(alarm["scene"])
    return {kind: len(scenes) for kind, scenes in cases.items()}


def next_commands(answer: RunAnswer) -> list[str]:
    """Return what to type next."""
    place = "" if answer.results.directory == RESULTS else f" --results {shlex.quote(str(answer.results.directory))}"
    report = f"dda-validate report{place} writes the PDF"
    failing = next((run.study.name for run in answer.runs if counts(run)["FAIL"]), None)
    if failing is not None:
        return [f"dda-validate report {shlex.quote(failing)} --figures figures{place} draws the histories", report]
    return [report] if answer.user_scenes else [report, "the same command with --verbose lists every gate"]


# ---- for machines ----


def as_data(answer: RunAnswer) -> dict[str, Any]:
    """Return the answer as plain data; verdicts as they stand in ``verdicts.json``."""
    return {
        "status": answer.status,
        "results": str(answer.results.directory),
        "studies": [
            {
                "study": run.study.name,
                "passed": counts(run)["PASS"],
                "failed": counts(run)["FAIL"],
                "not_run": counts(run)["NOT RUN"],
                "seconds": round(seconds, 3),
                "outcomes": dict(Counter(map(str, run.outcomes.values()))),
            }
            for run, seconds in zip(answer.runs, answer.seconds, strict=True)
        ],
        "verdicts": list(itertools.chain.from_iterable(map(answer.results.verdicts, answer.names))),
        "ended_badly": list(badly_ended(answer)),
        "alarms": alarm_kinds(answer),
        "changes": None if answer.changes is None else [_change(change) for change in answer.changes],
        "messages": [*unjudged(answer.runs), *answer.messages],
    }


def _change(change: Change) -> dict[str, Any]:
    return {
        "change": change.kind,
        "study": change.study,
        "gate": change.id,
        "before": change.before,
        "after": change.after,
    }
