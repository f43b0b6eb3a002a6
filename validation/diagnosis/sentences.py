"""The answer of `compare` in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from validation.diagnosis.causes import CAUSES
from validation.diagnosis.constants import TWICE
from validation.diagnosis.fits.fit import named
from validation.diagnosis.schemes import EXPLICIT, FAMILIES, split_of
from validation.diagnosis.variant import Variant
from validation.runs.numbers import ROUNDING, remainder_text

if TYPE_CHECKING:
    from validation.diagnosis.evidence import Departure, Stage
    from validation.diagnosis.fits.fit import Interval


def scheme_words(alpha: float | None, delta: float | None, gg: float | None) -> str:
    """Return a scheme by name and numbers."""
    if alpha is None or delta is None or gg is None:
        return "exact in time"
    numbers = f"alpha = {alpha:.4g}, delta = {delta:.4g}, gg = {gg:.5g}"
    name = named(alpha, delta)
    return f"{name} ({numbers})" if name else f"an unnamed scheme ({numbers})"


def scheme_of(v: Variant) -> str:
    """Return the scheme of a variant by name and numbers."""
    if v.exact:
        return "exact in time"
    if v.family == "newmark":
        return scheme_words(v.alpha, v.delta, v.gg)
    if v.contact == "impact":
        return f"Moreau and Jean's scheme (theta = {v.spectral:.4g}, gg = {v.gg:.5g})"
    name = FAMILIES[v.family]
    if v.family in EXPLICIT:
        return f"{name} (gg = {v.gg:.5g})"
    numbers = {"hht": f"alpha_f = {v.spectral:.4g}", "theta": f"theta = {v.spectral:.4g}"}
    number = numbers.get(v.family, f"rho_inf = {v.spectral:.4g}")
    if v.family == "composite":
        return f"{name} (split {split_of(v):.4g}, {number}, gg = {v.gg:.5g})"
    return f"{name} ({number}, gg = {v.gg:.5g}, initial acceleration {v.start})"


def span(steps: Sequence[int]) -> str:
    """Return steps as runs, ``1-5, 84-100``."""
    runs: list[list[int]] = []
    for step in steps:
        if runs and step == runs[-1][1] + 1:
            runs[-1][1] = step
        else:
            runs.append([step, step])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


@dataclass(frozen=True)
class Subject:
    """What a sentence is about."""

    scheme: str  # the fitted one, in words
    words: Mapping[str, str]  # of each cause, with its number
    departure: Departure | None  # where the history leaves what is expected
    remainder: str  # what is left, in words
    alike: Sequence[Mapping[str, Any]] = ()  # causes that give the same rows
    model: str = ""  # the solver that gives the history, where it is another one than `dda`

    @property
    def where(self) -> str:
        """Where the history leaves what is expected."""
        return f" from step {self.departure.step} on, mainly in {self.departure.kind}" if self.departure else ""


def remaining(misfit: float) -> str:
    """Return what is left of a history, in words."""
    return f"the remaining difference is {remainder_text(misfit, 2)} %"


def sentence(subject: Subject) -> str:
    """Return the first line of the answer where causes explain the history, or none is needed."""
    faults = [name for name in subject.words if not CAUSES[name].benign]
    benign = [words for name, words in subject.words.items() if CAUSES[name].benign]
    allowed = f", allowing for {listed(benign)}" if benign else ""
    same = f" (the same rows: {_family(subject.alike[0])})" if subject.alike else ""
    of_model = f" as {subject.model}" if subject.model else ""
    if not faults:
        return f"Same model{of_model}, same scheme: {subject.scheme}{allowed}{same}; {subject.remainder}."
    words = listed([subject.words[name] for name in faults])
    if len(faults) == 1 and faults[0] in ("pressure-shift", "pressure-factor"):
        words += ", the displacement is right"
    if any(CAUSES[name].integrator for name in faults):
        return (
            f"Departs{subject.where}: {words}{same}; the history matches {subject.scheme}{of_model}{allowed}; "
            f"{subject.remainder}."
        )
    model = f", same model{of_model}" if of_model or all(CAUSES[name].output for name in faults) else ""
    return (
        f"Same scheme{model}: {subject.scheme}, but departs{subject.where}: {words}{same}{allowed}; "
        f"{subject.remainder}."
    )


def not_explained(
    subject: Subject, nearest: Mapping[str, Any] | None, unexplained: float, stages: Sequence[Stage]
) -> str:
    """Return the first line of the answer where nothing explains the history, or several causes do."""
    start = f"Departs{subject.where}, not explained: "
    if subject.alike:
        words = " or ".join(_family(one) for one in subject.alike[:3])
        further = f"to tell them apart, try {subject.alike[0]['further_scene']}"
        return f"{start}{words} give the same rows within digits and noise; {further}."
    near = "nothing is near"
    if nearest and nearest["causes"] and TWICE * unexplained <= 1:
        near = f"nearest is {_family(nearest)}, {remainder_text(unexplained, 2)} % left"
    right = _names(stages, True)
    wrong = _names(stages, False)
    summary = [f"right so far: {right}" if right else "", f"wrong: {wrong}" if wrong else ""]
    return "; ".join([start + near, *(part for part in summary if part)]) + "."


def diverged(departure: Departure, growth: float) -> str:
    """Return the first line of the answer to a history without bounds."""
    return (
        f"Departs from step {departure.step} on: the run diverged, by a factor of {growth:.4g} a step; "
        "nothing else can be told from it."
    )


def told_lines(determined: Mapping[str, Interval], untold: Sequence[Mapping[str, float]]) -> list[str]:
    """Return the fitted numbers with their intervals, and the directions that the history does not determine."""
    lines = [f"fitted {name} = {_fitted(interval)} (95 %)" for name, interval in determined.items()]
    return lines + [
        "not determined by the data: " + ", ".join(f"{part:+.2f} {name}" for name, part in direction.items())
        for direction in untold
    ]


def cleaned(value: float) -> float:
    """Return a number, zero where it is rounding."""
    return value if abs(value) > ROUNDING else 0.0


def _fitted(interval: Interval) -> str:
    width = f"+- {interval.half_width:.2g}" if interval.half_width > ROUNDING else f"+- less than {ROUNDING:g}"
    return f"{cleaned(interval.value):.7g} {width}"


def listed(parts: Sequence[str]) -> str:
    """Return parts as a list, ``a, b and c``."""
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _names(stages: Sequence[Stage], agrees: bool) -> str:
    return ", ".join(stage.name.replace("_", " ") for stage in stages if stage.agrees is agrees)


def _family(one: Mapping[str, Any]) -> str:
    """Return causes with their numbers, ``density-factor 0.5 and gg 0.98``."""
    return listed([name + (f" {one['values'][name]:.4g}" if name in one["values"] else "") for name in one["causes"]])
