"""The verification matrix: which phenomena are verified by which gates, and the run of one with any solver.

How a study states its phenomena is in `validation.suite.tables`; patterns are those of `fnmatch`.
"""

from __future__ import annotations

import difflib
import functools
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from itertools import chain

from validation.engine.case import Case
from validation.engine.judge import evaluate, existing
from validation.engine.run import finish
from validation.errors import InputError
from validation.gates.gate import Gate, Status, Verdict
from validation.metrics.values import NOT_REPORTED
from validation.runs.case_name import scene_of
from validation.runs.progress import Progress
from validation.runs.results import Results
from validation.runs.run import Outcome
from validation.solvers.contract import Solver
from validation.solvers.foreign import SAME_AS
from validation.solvers.registry import get_solver
from validation.suite.folders import StudyFolder, get_study, sources_of, study_folders

JUDGED = "dda"  # whose place another solver takes
SIMILAR = 0.6  # of two words, by difflib's ratio: one may be meant by the other


@dataclass(frozen=True)
class Phenomenon:
    """What is verified."""

    name: str
    study: str
    sources: str  # what problem and truths rest on, with keys of the bibliography
    scenes: tuple[str, ...] = ("*",)  # patterns of those that show it
    problems: tuple[str, ...] = ()  # of the pack that ask any program for it, all cases of each

    @functools.cached_property
    def gates(self) -> tuple[Gate, ...]:
        """The gates of the study on the scenes that show it; computed when asked for, since bands are formulas."""
        return tuple(
            gate
            for gate in get_study(self.study).gates()
            if any(fnmatchcase(scene_of(gate.scene), pattern) for pattern in self.scenes)
        )

    def asked_by(self, problem: str) -> bool:
        """Whether a problem of the pack, or a case of it, asks for it."""
        return any(problem == name or problem.startswith(f"{name}-") for name in self.problems)

    def needs(self, gate: Gate) -> list[tuple[str, str]]:
        """Return scene and solver of the cases that a gate needs, those behind derived rows included."""
        return get_study(self.study).needs(gate)

    def solvers(self, gate: Gate) -> set[str]:
        """Return the solvers that a gate needs."""
        return {solver for _, solver in self.needs(gate)}

    def lines(self) -> list[list[Gate]]:
        """Return the gates by reason and kind of truth, those on `JUDGED` first, exact ones before others."""
        groups: dict[tuple[bool, bool, str], list[Gate]] = {}
        for gate in self.gates:
            others = JUDGED not in self.solvers(gate)
            groups.setdefault((others, gate.reference_kind != "exact", gate.reason), []).append(gate)
        return [groups[key] for key in sorted(groups, key=lambda key: key[:2])]


def phenomena(studies: Iterable[str] | None = None) -> list[Phenomenon]:
    """Return what some studies verify, by default all, in the order of the report; of one in two lengths the long."""
    names = [name for name, folder in study_folders().items() if folder.form == "study"]
    chosen = names if studies is None else set(studies)
    return list(chain.from_iterable(_of_study(name, study_folders()[name]) for name in names if name in chosen))


@functools.cache
def _of_study(study: str, folder: StudyFolder) -> tuple[Phenomenon, ...]:
    stated = folder.fields["phenomenon"]
    patterns_by_name = stated if isinstance(stated, dict) else {stated: ["*"]}
    asked = folder.fields.get("problems", ())
    listed = []
    for name, patterns in patterns_by_name.items():
        problems = asked.get(name, ()) if isinstance(asked, dict) else asked
        listed.append(Phenomenon(name, study, sources_of(study), tuple(patterns), tuple(problems)))
    return tuple(listed)


def unstated() -> Iterator[tuple[str, Gate]]:
    """Yield the gates that nobody could look up, with what they lack: one phenomenon, or sources of their study."""
    by_gate: dict[tuple[str, str], list[Phenomenon]] = {}
    for shown in phenomena():
        for gate in shown.gates:
            by_gate.setdefault((shown.study, gate.id), []).append(shown)
    for study, folder in study_folders().items():
        for gate in get_study(study).gates() if folder.form == "study" else ():
            named = by_gate.get((study, gate.id), [])
            if len(named) != 1:
                yield "phenomenon", gate
            elif not named[0].sources:
                yield "sources", gate


def phenomenon(text: str) -> Phenomenon:
    """Return the phenomenon that goes by a name, by a part of it that no other has, or by its study.

    Raises
    ------
    InputError
        There is none, or several have this part.
    """
    word = text.strip().casefold()
    listed = phenomena()
    exact = [one for one in listed if word == one.name.casefold()]
    found = exact or [one for one in listed if word == one.study]
    found = found or [one for one in listed if word and word in one.name.casefold()]
    if len(found) == 1:
        return found[0]
    if found:
        names = "; ".join(one.name for one in found)
        rule = "must be a part of one name"
        raise InputError(rule, field="PHENOMENON", value=repr(text), advice=f"several have it: {names}")
    words = {part: None for one in listed for part in (one.study, *one.name.replace(",", "").replace(":", "").split())}
    near = difflib.get_close_matches(word, list(words), cutoff=SIMILAR)
    meant = f"did you mean {', '.join(near)}? " if near else ""
    advice = f"{meant}dda-validate verify lists them"
    rule = "must be a phenomenon, a part of its name or its study"
    raise InputError(rule, field="PHENOMENON", value=repr(text), advice=advice)


# ---- a run ----


@dataclass(frozen=True)
class CaseInPlace(Case):
    """A case that another solver answers in the place of `JUDGED`, under whose name gates and derived rows find it."""

    answered_by: str = JUDGED

    def make_solver(self) -> Solver:
        """Return the solver that answers."""
        return get_solver(self.answered_by)


def in_place(case: Case, solver: str) -> Case:
    """Return a case with who answers it: a solver in the place of `JUDGED`, else its own."""
    return CaseInPlace(**vars(case), answered_by=solver) if case.solver == JUDGED else case


def reported(verdict: Verdict) -> Verdict:
    """Return a verdict; what the solver has no way to report is no failure."""
    if verdict.value != NOT_REPORTED:
        return verdict
    return replace(verdict, status=Status.NOT_RUN, why=f"the solver does not report {verdict.gate.metric}")


def verify(
    shown: Phenomenon, results: Results, solver: str = JUDGED, jobs: int = 1, progress: Progress | None = None
) -> tuple[list[Verdict], list[str]]:
    """Run what the gates of a phenomenon need and judge them.

    Return the verdicts in the order of the gates, and what is to be said of who answered: `solver`, in the place of
    `JUDGED`. Where that is another solver, the gates that do not need `JUDGED` are left out.
    """
    study = get_study(shown.study)
    gates = [gate for gate in shown.gates if solver == JUDGED or JUDGED in shown.solvers(gate)]
    needed = {need for gate in gates for need in shown.needs(gate)}
    cases = [case for case in study.cases() if (case.scene.name, case.solver) in needed]
    if solver != JUDGED:
        cases = [in_place(case, solver) for case in cases]
    finished = finish(cases, study, results, jobs=jobs, progress=progress)
    scenes = list({case.scene.name: case.scene for case in cases}.values())
    notes: Counter[str] = Counter()
    for case in cases:
        row = finished.rows[case.scene.name, case.solver]
        if row.outcome is not Outcome.COMPLETED:
            notes[f"{case.make_solver().name}: {row.outcome}: {'; '.join(row.notes)}"] += 1
        notes.update(f"{note}: it was judged itself" for note in row.notes if note.startswith(SAME_AS))
    remarks = [f"{count} of {len(cases)} runs: {note}" for note, count in notes.items()]
    verdicts = [evaluate(gate, finished) for gate in existing(gates, scenes, finished)]
    return list(map(reported, verdicts)), remarks
