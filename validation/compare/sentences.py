"""The answer of `compare` in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from dda.one_block.variants import Variant
from validation.compare.causes import CAUSES
from validation.compare.fit import named
from validation.gates.gate import ROUNDING

if TYPE_CHECKING:
    from validation.compare.departure import Departure
    from validation.compare.fit import Interval
    from validation.compare.other_solvers import Rival

INTEGRATOR = ("scheme", "gg", "gg-in-one-formula", "start")


def scheme_words(alpha: float | None, delta: float | None, gg: float | None) -> str:
    """Return a scheme by name and numbers."""
    if alpha is None or delta is None or gg is None:
        return "exact in time"
    numbers = f"alpha = {alpha:.4g}, delta = {delta:.4g}, gg = {gg:.5g}"
    name = named(alpha, delta)
    return f"{name} ({numbers})" if name else f"an unnamed scheme ({numbers})"


def span(steps: Sequence[int]) -> str:
    """Return steps as runs, ``1-5, 84-100``."""
    runs: list[list[int]] = []
    for step in steps:
        if runs and step == runs[-1][1] + 1:
            runs[-1][1] = step
        else:
            runs.append([step, step])
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def sentence(
    variant: Variant,
    gg: float,
    scene: Variant,
    causes: Sequence[str],
    gone: Departure | None,
    open_steps: Sequence[int],
    misfit: float,
    compliance: float,
) -> str:
    """Return the first line of the answer."""
    own = scheme_words(variant.alpha, variant.delta, gg)
    faults = [name for name in causes if not CAUSES[name].benign]
    benign = [_benign_words(name, variant, compliance) for name in causes if CAUSES[name].benign]
    allowed = f", allowing for {_listed(benign)}" if benign else ""
    left = f"the remaining difference is {per_cent(misfit, 2)} %"
    if not faults and gone is None:
        return f"Same model, same scheme: {own}{allowed}; {left}."
    where = f" from step {gone.step} on, mainly in {gone.kind}" if gone else ""
    if not faults:
        return f"Departs{where}, for no known reason; the closest match is {own}{allowed}; {left}."
    said = _listed([_fault_words(name, variant, gg, scene, open_steps, compliance) for name in faults])
    if set(faults) & set(INTEGRATOR):
        return f"Departs{where}: {said}; the history matches {own}{allowed}; {left}."
    model = "" if set(faults) & {"contact-opened", "springs-factor", "load-factor"} else ", same model"
    return f"Same scheme{model}: {own}, but departs{where}: {said}{allowed}; {left}."


def rival_sentence(
    best: Rival, same_scheme: bool, causes: Sequence[str], gone: Departure | None, models: Mapping[str, str]
) -> str:
    """Return the first line where another solver explains the history best."""
    own, model = scheme_words(best.alpha, best.delta, best.gg), models.get(best.model, best.model)
    left = f"the remaining difference is {per_cent(best.misfit, 2)} %"
    said = "".join(f"; {CAUSES[name].words}" for name in causes)
    if gone is None:
        return f"Same model as {best.model} ({model}), same scheme: {own}{said}; {left}."
    where = f"departs from step {gone.step} on, mainly in {gone.kind}"
    scheme = "same scheme" if same_scheme else "a different scheme"
    return f"Closest match: {best.model} ({model}), {scheme}: {own}; {where}{said}; {left}."


def told_lines(told: Mapping[str, Interval], untold: Sequence[Mapping[str, float]]) -> list[str]:
    """Return the fitted numbers with their intervals, and the directions that the history does not determine."""
    lines = [f"fitted {name} = {_fitted(found)} (95 %)" for name, found in told.items()]
    return lines + [
        "not determined by the data: " + ", ".join(f"{part:+.2f} {name}" for name, part in direction.items())
        for direction in untold
    ]


def cleaned(value: float) -> float:
    """Return a number, zero where it is rounding."""
    return value if abs(value) > ROUNDING else 0.0


def per_cent(value: float, digits: int = 3) -> str:
    """Return a fraction in per cent, without its unit; rounding is not written as digits."""
    return f"{100 * value:.{digits}g}" if abs(value) > ROUNDING else f"below {100 * ROUNDING:g}"


def _fitted(found: Interval) -> str:
    width = f"+- {found.half_width:.2g}" if found.half_width > ROUNDING else f"+- less than {ROUNDING:g}"
    return f"{cleaned(found.value):.7g} {width}"


def _listed(parts: Sequence[str]) -> str:
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _benign_words(name: str, variant: Variant, compliance: float) -> str:
    if name == "base-compliance":
        return f"a base that adds {100 * compliance:.2g} % to the static displacement"
    if name == "own-weight":
        return f"the block's own weight ({variant.weight:.3g} x 9.81 m/s2)"
    return CAUSES[name].words


def _fault_words(
    name: str, variant: Variant, gg: float, scene: Variant, open_steps: Sequence[int], compliance: float
) -> str:
    """Return a cause with its number."""
    if name == "scheme":
        return f"a different scheme from the scene's {scheme_words(scene.alpha, scene.delta, scene.gg)}"
    if name == "gg":
        return f"gg = {gg:.5g} where the scene has {scene.gg:.5g}"
    if name == "gg-in-one-formula":
        formula = {"velocity": "velocity (7)", "displacement": "displacement (6)"}[variant.discounted]
        return f"gg is applied only in the formula for the {formula}"
    if name == "start":
        return f'the initial acceleration is "{variant.start}", not "{scene.start}"'
    if name == "time-shift":
        return f"the rows are {abs(variant.shift)} step {'late' if variant.shift > 0 else 'early'}"
    if name == "springs-factor":
        return f"the contact springs are {2.718281828459045**-variant.softness:.4g} times the scene's"
    if name == "load-factor":
        return f"the load, or the displacement, is {variant.load:.5g} times the scene's"
    if name == "contact-opened":
        return f"the contact opened in steps {span(open_steps)}" if open_steps else "the contact opened"
    return CAUSES[name].words
