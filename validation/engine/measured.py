"""What a run has left unmeasured: cases that ended badly, gates of which none was judged, required solvers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from validation.engine.study import Study
from validation.gates.gate import Status, Verdict
from validation.runs.run import Outcome
from validation.solvers.registry import FULL, is_solver

MEASURED = (Outcome.COMPLETED, Outcome.UNSTABLE)  # an unstable run that grew as predicted says what was asked of it
NEUTRAL = (Outcome.NOT_RUN, Outcome.NOT_APPLICABLE)  # said by name; a gate that needs them is NOT RUN


@dataclass(frozen=True)
class JudgedStudy:
    """A study as it was run: its verdicts, and how its cases ended by (scene, solver)."""

    study: Study
    verdicts: Sequence[Verdict]
    outcomes: Mapping[tuple[str, str], Outcome]

    @property
    def failed(self) -> list[tuple[str, str]]:
        """Cases that ended in a way that the study does not expect; a refusal is bad input and told as such."""
        fine = {*MEASURED, *NEUTRAL, Outcome.REFUSED, *self.study.expects}
        return [case for case, outcome in self.outcomes.items() if outcome not in fine]

    @property
    def refused(self) -> bool:
        """Whether a case was refused that the study does not expect to be."""
        return Outcome.REFUSED in self.outcomes.values() and Outcome.REFUSED not in self.study.expects

    def concerns(self, verdict: Verdict, name: str) -> bool:
        """Whether a gate needs a solver of this name, with or without option, behind derived rows as well."""
        used = {*verdict.gate.pair, *(solver for _, solver in self.study.needs(verdict.gate))}
        return any(covers(name, solver) for solver in used)


def covers(name: str, solver: str) -> bool:
    """Whether a solver is the named one, perhaps with an option or without savings."""
    return name in (solver, solver.removesuffix(FULL)) or (is_solver(name) and solver.startswith(f"{name}:"))


def complaints(runs: Sequence[JudgedStudy]) -> Iterator[str]:
    """Yield a sentence for each study of which a case ended badly, nothing was measured or no gate was judged."""
    for run in runs:
        name = run.study.name
        statuses = [verdict.status for verdict in run.verdicts]
        if run.failed:
            first = " ".join(run.failed[0])
            more = f" and {len(run.failed) - 1} more" if len(run.failed) > 1 else ""
            yield f"{name}: ended without a measurement: {first}{more}"
        if not any(outcome in MEASURED for outcome in run.outcomes.values()):
            yield f"{name}: no case was measured"
        if statuses and all(status is Status.NOT_RUN for status in statuses):
            yield f"{name}: none of its {len(statuses)} gates was judged, all are NOT RUN"


def missing_gates(runs: Sequence[JudgedStudy], required: Sequence[str]) -> Iterator[str]:
    """Yield a sentence for each required solver that gates were not run for, or that no gate has judged."""
    for name in required:
        statuses = []
        for run in runs:
            statuses += [verdict.status for verdict in run.verdicts if run.concerns(verdict, name)]
        if missing := statuses.count(Status.NOT_RUN):
            yield f"--require {name}: {missing} of {len(statuses)} gates on it are NOT RUN"
        elif not statuses:
            yield f"--require {name}: no gate on it was judged"


def unjudged(runs: Sequence[JudgedStudy]) -> Iterator[str]:
    """Yield a remark for each study without gates."""
    for run in runs:
        if not run.verdicts:
            yield f"{run.study.name}: has no gates: nothing was judged"
