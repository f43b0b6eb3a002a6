"""The answer to whose history it is: what `compare`, `judge`, `field` and the plug-in's block show."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from validation.diagnosis import sentences
from validation.diagnosis.causes import CAUSES, UNEXPLAINED, all_benign
from validation.diagnosis.constants import TWICE
from validation.diagnosis.evidence import Departure, Stage, surrounded
from validation.diagnosis.fits.fit import Interval
from validation.diagnosis.readings import Reading, Slip, words_of_slips
from validation.runs.history import Array, History
from validation.runs.numbers import remainder_text
from validation.solvers.contract import Role
from validation.solvers.registry import by_role


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """The answer to `compare`; `as_dict` is what ``--json`` prints."""

    sentence: str = ""
    causes: list[str]
    scheme: dict[str, Any]  # alpha, delta, gg; of another scheme than Newmark's its name and numbers
    departure: Departure | None
    notes: tuple[str, ...] = ()
    opened: tuple[int, int] | None = None  # first step and last
    told: dict[str, Interval] = field(default_factory=dict)  # alpha, delta, gg and what was free with them
    untold: list[dict[str, float]] = field(default_factory=list)
    misfit: float = 0.0  # of the best explanation, relative L2 [-]
    curves: dict[str, History] = field(default_factory=dict)  # of the file, the scene's own run and the explanation
    values: dict[str, float] = field(default_factory=dict)  # id to number
    unexplained: float = 0.0  # share of the difference that is left [-]
    nearest: dict[str, Any] | None = None  # where nothing explains it
    alike: list[dict[str, Any]] = field(default_factory=list)  # causes that give the same rows
    evidence: tuple[Stage, ...] = ()
    slips: tuple[Slip, ...] = ()  # of sign and unit, column by column
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)  # of `values`, 95 %
    remedy: str = ""  # the options by which it is read without `slips`, or with its columns in their places
    model: str = ""  # the solver that explains it, where it is not the scene's

    @property
    def departs(self) -> bool:
        """Whether the history is another one than the scene itself gives, for whatever reason."""
        return bool(self.causes or self.model)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data, all but the curves."""
        written = asdict(replace(self, curves={}))
        del written["curves"]
        return written


def finished(
    answer: Answer, reading: Reading, explained: bool, words: Mapping[str, str], scheme: str, model: str = ""
) -> Answer:
    """Return what was found as an answer: with slips of the reading, what is nearest, and the first line.

    `words` are those of its causes, `scheme` and `model` of what explains the history. The evidence of a cause that is
    no fault is none against the scene.
    """
    causes = [*reading.slips, *answer.causes]
    if explained:
        answer = replace(answer, causes=causes, slips=reading.corrected)
        if causes and all_benign(causes):
            answer = replace(answer, evidence=tuple(surrounded(stage) for stage in answer.evidence))
    else:
        nearest = {"causes": causes, "values": answer.values}
        is_near = causes and not answer.alike
        answer = replace(answer, causes=[UNEXPLAINED], values={}, nearest=nearest if is_near else None)
    words = {**words, **words_of_slips(reading.corrected)}
    return replace(answer, sentence=sentence(answer, words, scheme, model))


def sentence(answer: Answer, words: Mapping[str, str], scheme: str, model: str = "") -> str:
    """Return the first line of an answer, by the words of its causes, of the scheme and of another solver's model."""
    departure = answer.departure
    where = f" from step {departure.step} on, mainly in {departure.kind}" if departure else ""
    if UNEXPLAINED in answer.causes:
        return f"Departs{where}, not explained: {_not_explained(answer)}."
    faults = [name for name in answer.causes if not CAUSES[name].benign]
    benign = [words[name] for name in answer.causes if CAUSES[name].benign]
    allowed = f", allowing for {sentences.listed(benign)}" if benign else ""
    same = f" (the same rows: {sentences.family(answer.alike[0])})" if answer.alike else ""
    of_model = f" as {model}" if model else ""
    remainder = f"the remaining difference is {remainder_text(answer.misfit, 2)} %"
    if not faults:
        return f"Same model{of_model}, same scheme: {scheme}{allowed}{same}; {remainder}."
    wrong = sentences.listed([words[name] for name in faults])
    if len(faults) == 1 and faults[0] in ("pressure-shift", "pressure-factor"):
        wrong += ", the displacement is right"
    if any(CAUSES[name].integrator for name in faults):
        return f"Departs{where}: {wrong}{same}; the history matches {scheme}{of_model}{allowed}; {remainder}."
    of_same = f", same model{of_model}" if of_model or all(CAUSES[name].output for name in faults) else ""
    return f"Same scheme{of_same}: {scheme}, but departs{where}: {wrong}{same}{allowed}; {remainder}."


def _not_explained(answer: Answer) -> str:
    """Return which causes give the same rows, or what is nearest, and what is right without a cause."""
    if answer.alike:
        words = " or ".join(sentences.family(one) for one in answer.alike[:3])
        further = f"to tell them apart, try {answer.alike[0]['further_scene']}"
        return f"{words} give the same rows within digits and noise; {further}"
    near = "nothing is near"
    if answer.nearest and TWICE * answer.unexplained <= 1:
        near = f"nearest is {sentences.family(answer.nearest)}, {remainder_text(answer.unexplained, 2)} % left"
    parts = [near]
    for verdict, agrees in (("right so far", True), ("wrong", False)):
        names = [stage.name.replace("_", " ") for stage in answer.evidence if stage.agrees is agrees]
        parts += [f"{verdict}: {', '.join(names)}"] if names else []
    return "; ".join(parts)


def curves(time: Array, names: Sequence[str], *runs: Iterable[Array]) -> dict[str, History]:
    """Return columns of the file, of the scene's own run and, where there is one, of the best explanation, by name."""
    shown = ("the file", by_role(Role.JUDGED)[0], "best")
    return {name: History(time, dict(zip(names, run, strict=False))) for name, run in zip(shown, runs, strict=False)}
