"""The answer of `run`: what failed in full, then at most `SCREEN` lines: a line a study, alarms, what to type next."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from validation.cli.app import RESULTS
from validation.engine.measured import Judged, unjudged
from validation.gates.changes import Change
from validation.gates.gate import Status, Verdict, value_text
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
STYLES = {"PASS": "green", "FAIL": "bold red", "NOT RUN": "yellow"}
Line = tuple[str, str]  # text and the style of its first word


@dataclass(frozen=True)
class Ran:
    """Studies as one command ran them, and what is to be said of them.

    Attributes
    ----------
    runs, seconds
        The studies with verdicts and outcomes, and the seconds that each took now.
    results
        Where finished cases, verdicts and alarms are kept.
    messages
        Sentences on what was not measured.
    changes
        What differs from the baseline; None without one.
    own
        Names of the runs that are a user's scenes or built-in ones, not studies of the suite.
    status
        Exit status.
    """

    runs: Sequence[Judged]
    seconds: Sequence[float]
    results: Results
    messages: Sequence[str]
    changes: Sequence[Change] | None
    own: frozenset[str]
    status: int

    @property
    def names(self) -> list[str]:
        """Names of the studies."""
        return [run.study.name for run in self.runs]

    @property
    def verdicts(self) -> list[Verdict]:
        """The verdicts of all studies, in their order."""
        return [verdict for run in self.runs for verdict in run.verdicts]

    def alarms(self, names: Iterable[str] | None = None) -> list[AlarmRecord]:
        """Return the alarms of the named studies, by default of all."""
        asked = self.names if names is None else names
        return [alarm for name in asked for alarm in self.results.manifest(name).get("alarms", [])]


def lines(ran: Ran, width: int) -> Iterator[Line]:
    """Yield the answer: failures first, so that the summary is what a terminal shows last."""
    yield from failures(ran, width)
    yield from summary(ran, width)


def failures(ran: Ran, width: int) -> Iterator[Line]:
    """Yield every failing gate with value, band and reason, every case that ended badly, and what was not measured."""
    failed = [verdict for verdict in ran.verdicts if verdict.status is Status.FAIL]
    for verdict in failed[:FAILURES_SHOWN]:
        yield from _wrapped(_measured(verdict), width, "FAIL")
        for text in dict.fromkeys(filter(None, (verdict.why, verdict.gate.reason))):
            yield from _wrapped(f"  {text}", width, "")
    rest = Counter(verdict.gate.metric for verdict in failed[FAILURES_SHOWN:])
    if rest:
        counted = ", ".join(f"{metric} {count}" for metric, count in rest.most_common())
        yield from _wrapped(f"FAIL and {rest.total()} more gates: {counted}; --verbose shows every one", width, "FAIL")
    ended = list(badly_ended(ran))
    for text in ended[:FAILURES_SHOWN]:
        yield from _wrapped(text, width, "")
    if len(ended) > FAILURES_SHOWN:
        yield f"and {len(ended) - FAILURES_SHOWN} more runs ended badly; --verbose names every one", ""
    for sentence in ran.messages:
        yield from _wrapped(sentence, width, "FAIL")


def _measured(verdict: Verdict) -> str:
    gate, value = verdict.gate, verdict.value
    band = f"[{gate.low:.4g}, {gate.high:.4g}]"
    if value is None or isinstance(value, str):
        return f"FAIL {printable(gate.id)}: {'no value' if value is None else value}, allowed {band}"
    return f"FAIL {printable(gate.id)}: {value_text(value)} is outside {band}"


def badly_ended(ran: Ran) -> Iterator[str]:
    """Yield how the cases ended that ended in a way their study does not expect."""
    rows = ran.results.rows()
    for run in ran.runs:
        bad = {*run.failed, *(_refused(run) if run.refused else ())}
        for case in ran.results.manifest(run.study.name).get("cases", []):
            if (case["scene"], case["solver"]) in bad:
                yield how_it_ended(case["scene"], case["solver"], rows[case["key"]])


def _refused(run: Judged) -> list[tuple[str, str]]:
    return [case for case, outcome in run.outcomes.items() if outcome is Outcome.REFUSED]


def how_it_ended(scene: str, solver: str, row: Row) -> str:
    """Return the line of a case that did not complete."""
    return printable(f"{scene} {solver}: {row.outcome}: {row.outcome.sentence} {'; '.join(row.notes)}")


# ---- the summary --------------------------------------------------------------------------------------------------


def summary(ran: Ran, width: int) -> Iterator[Line]:
    """Yield the lines that stand last, at most `SCREEN` for the studies of the suite."""
    tail = list(_tail(ran, width))
    yield from _studies(ran, max(SCREEN - 2 - len(tail), LEAST_STUDIES))
    yield from tail


def _tail(ran: Ran, width: int) -> Iterator[Line]:
    yield from _not_run(ran, width)
    yield from _ended(ran, width)
    yield from _alarms(ran, width)
    for sentence in unjudged(ran.runs):
        yield sentence, ""
    yield from _wrapped(f"results: {ran.results.directory}", width, "")
    if any(run.verdicts for run in ran.runs):
        yield from _wrapped(f"next: {'; '.join(next_commands(ran))}", width, "")


def counts(run: Judged) -> Counter[str]:
    """Return the numbers of gates of a study by verdict."""
    return Counter(str(verdict.status) for verdict in run.verdicts)


def _studies(ran: Ran, room: int) -> Iterator[Line]:
    rows = [(run.study.name, counts(run), s) for run, s in zip(ran.runs, ran.seconds, strict=True)]
    shown = _folded(rows, room)
    wide = max(len("study"), *(len(printable(name)) for name, _, _ in shown))
    yield f"{'study':<{wide}}  passed  failed  not run  seconds", ""
    for name, found, seconds in shown:
        numbers = "  ".join(f"{found[word]:>{n}}" for word, n in zip(WORDS, (6, 6, 7), strict=True))
        yield f"{printable(name):<{wide}}  {numbers}  {seconds:>7.1f}", _style(found)
    total = sum((found for _, found, _ in rows), Counter[str]())
    counted = ", ".join(f"{total[word]} {word}" for word in WORDS)
    yield f"{counted} in {sum(ran.seconds):.1f} s", _style(total)


def _style(found: Mapping[str, int]) -> str:
    return next((word for word in ("FAIL", "NOT RUN", "PASS") if found[word]), "")


def _folded(rows: Sequence[tuple[str, Counter[str], float]], room: int) -> list[tuple[str, Counter[str], float]]:
    """Return the rows that fit; those without a gate that failed or was not run are added up first."""
    if len(rows) <= room:
        return list(rows)
    telling = [row for row in rows if row[1]["FAIL"] or row[1]["NOT RUN"]]
    quiet = [row for row in rows if row not in telling]
    kept = (telling + quiet)[: room - 1]
    rest = [row for row in rows if row not in kept]
    folded = sum((row[1] for row in rest), Counter[str]())
    return [*(row for row in rows if row in kept), (f"{len(rest)} more", folded, sum(row[2] for row in rest))]


def _not_run(ran: Ran, width: int) -> Iterator[Line]:
    reasons = Counter(verdict.why for verdict in ran.verdicts if verdict.status is Status.NOT_RUN)
    for why, count in reasons.most_common(2):
        yield from _wrapped(f"NOT RUN {count}: {printable(why)}", width, "NOT RUN")
    if len(reasons) > 2:
        yield f"NOT RUN for {len(reasons) - 2} more reasons; --verbose shows every one", "NOT RUN"


def ends(ran: Ran) -> Counter[str]:
    """Return how many cases ended otherwise than completed as their study expects, by outcome."""
    found: Counter[str] = Counter()
    for run in ran.runs:
        bad = {*run.failed, *(_refused(run) if run.refused else ())}
        found.update(
            str(outcome)
            for case, outcome in run.outcomes.items()
            if outcome is not Outcome.COMPLETED and case not in bad
        )
    return found


def _ended(ran: Ran, width: int) -> Iterator[Line]:
    found = ends(ran)
    if found:
        cases = sum(len(run.outcomes) for run in ran.runs)
        words = ", ".join(f"{count} {word}" for word, count in found.most_common())
        yield from _wrapped(
            f"{found.total()} of {cases} runs did not complete, as their studies allow: {words}", width, ""
        )


def alarm_kinds(ran: Ran) -> dict[str, int]:
    """Return the number of cases of each kind of alarm."""
    cases: dict[str, set[str]] = {}
    for alarm in ran.alarms():
        cases.setdefault(alarm["kind"], set()).add(alarm["scene"])
    return {kind: len(some) for kind, some in cases.items()}


def _alarms(ran: Ran, width: int) -> Iterator[Line]:
    """Yield the kinds of alarm with the number of cases, and for own scenes the first sentence of each kind."""
    kinds = alarm_kinds(ran)
    if kinds:
        words = ", ".join(f"{kind} in {n} case{'s' * (n > 1)}" for kind, n in kinds.items())
        yield from _wrapped(f"alarms: {words}", width, "")
    own = {alarm["kind"]: alarm for alarm in reversed(ran.alarms(name for name in ran.names if name in ran.own))}
    for kind in [kind for kind in kinds if kind in own][:KINDS_EXPLAINED]:
        yield from _wrapped(f"  {kind}: {own[kind]['scene']}: {own[kind]['sentence']}", width, "")


def next_commands(ran: Ran) -> list[str]:
    """Return what to type next."""
    place = "" if ran.results.directory == RESULTS else f" --results {ran.results.directory}"
    report = f"dda-validate report{place} writes the PDF"
    failing = next((run.study.name for run in ran.runs if counts(run)["FAIL"]), None)
    if failing is not None:
        return [f"dda-validate figures {failing}{place} draws the histories", report]
    return [report] if ran.own else [report, "the same command with --verbose lists every gate"]


def _wrapped(text: str, width: int, style: str) -> Iterator[Line]:
    """Yield a text in lines of a width, what follows the first one indented."""
    indent = " " * (len(text) - len(text.lstrip()) + 2)
    wrapped = textwrap.wrap(
        text, max(width, 20), subsequent_indent=indent, break_on_hyphens=False, break_long_words=False
    )
    yield from ((line, style if i == 0 else "") for i, line in enumerate(wrapped))


# ---- for machines --------------------------------------------------------------------------------------------------


def as_data(ran: Ran) -> dict[str, Any]:
    """Return the answer as plain data; verdicts as they stand in ``verdicts.json``."""
    return {
        "status": ran.status,
        "results": str(ran.results.directory),
        "studies": [
            {
                "study": run.study.name,
                "passed": counts(run)["PASS"],
                "failed": counts(run)["FAIL"],
                "not_run": counts(run)["NOT RUN"],
                "seconds": round(seconds, 3),
                "outcomes": dict(Counter(map(str, run.outcomes.values()))),
            }
            for run, seconds in zip(ran.runs, ran.seconds, strict=True)
        ],
        "verdicts": [verdict for name in ran.names for verdict in ran.results.verdicts(name)],
        "ended_badly": list(badly_ended(ran)),
        "alarms": alarm_kinds(ran),
        "changes": None if ran.changes is None else [_change(change) for change in ran.changes],
        "messages": [*unjudged(ran.runs), *ran.messages],
    }


def _change(change: Change) -> dict[str, Any]:
    values = {"before": change.before, "after": change.after}
    return {"change": change.kind, "study": change.study, "gate": change.id, **values}
