"""The answer of `compare` in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from validation.diagnosis.causes import CAUSES
from validation.diagnosis.fits.fit import named
from validation.diagnosis.variant import Variant
from validation.gates.gate import ROUNDING

if TYPE_CHECKING:
    from validation.diagnosis.departure import Departure
    from validation.diagnosis.evidence import Stage
    from validation.diagnosis.fits.fit import Interval
    from validation.diagnosis.other_solvers import RivalVerdict
    from validation.diagnosis.readings import Slip

INTEGRATOR = (
    *("scheme", "gg", "gg-in-one-formula", "start", "hht", "generalised-alpha", "substeps"),
    *("exact-in-time", "velocity"),
)
OUTPUT = ("sign", "unit", "time-shift", "pressure-shift", "pressure-factor", "reported-point")
HALF = 0.5
NEAR = 0.5  # share of the difference: what leaves more is near to nothing


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
    number = f"alpha_f = {v.spectral:.4g}" if v.family == "hht" else f"spectral radius {v.spectral:.4g}"
    name = "HHT" if v.family == "hht" else "generalised alpha (Chung and Hulbert)"
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
class Said:
    """What a sentence is about."""

    variant: Variant
    scene: Variant
    causes: Sequence[str]
    values: Mapping[str, float]
    gone: Departure | None
    open_steps: Sequence[int]
    misfit: float  # relative L2 [-]
    compliance: float  # share of the static displacement that softer springs add [-]
    slips: Sequence[Slip] = ()  # of sign and unit
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def own(self) -> str:
        """The fitted scheme in words."""
        return scheme_of(self.variant)

    @property
    def where(self) -> str:
        """Where the history leaves what is expected."""
        return f" from step {self.gone.step} on, mainly in {self.gone.kind}" if self.gone else ""


def sentence(subject: Said, alike: Sequence[Mapping[str, Any]] = ()) -> str:
    """Return the first line of the answer where causes explain the history, or none is needed."""
    faults = [name for name in subject.causes if not CAUSES[name].benign]
    benign = [_benign_words(name, subject) for name in subject.causes if CAUSES[name].benign]
    allowed = f", allowing for {_listed(benign)}" if benign else ""
    remainder = f"the remaining difference is {per_cent(subject.misfit, 2)} %"
    if not faults:
        same = f" (the same rows: {_family(alike[0])})" if alike else ""
        return f"Same model, same scheme: {subject.own}{allowed}{same}; {remainder}."
    words = _listed([_fault_words(name, subject) for name in faults])
    if len(faults) == 1 and faults[0] in ("pressure-shift", "pressure-factor"):
        words += ", the displacement is right"
    family = f" (the same rows: {_family(alike[0])})" if alike else ""
    if set(faults) & set(INTEGRATOR):
        return f"Departs{subject.where}: {words}{family}; the history matches {subject.own}{allowed}; {remainder}."
    model = ", same model" if set(faults) <= set(OUTPUT) else ""
    return f"Same scheme{model}: {subject.own}, but departs{subject.where}: {words}{family}{allowed}; {remainder}."


def not_explained(
    subject: Said,
    nearest: Mapping[str, Any] | None,
    alike: Sequence[Mapping[str, Any]],
    unexplained: float,
    stages: Sequence[Stage],
) -> str:
    """Return the first line of the answer where nothing explains the history, or several causes do."""
    start = f"Departs{subject.where}, not explained: "
    if alike:
        words = " or ".join(_family(one) for one in alike[:3])
        further = f"to tell them apart, try {alike[0]['further_scene']}"
        return f"{start}{words} give the same rows within digits and noise; {further}."
    near = "nothing is near"
    if nearest and nearest["causes"] and unexplained <= NEAR:
        near = f"nearest is {_family(nearest)}, {per_cent(unexplained, 2)} % left"
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


def rival_sentence(
    verdict: RivalVerdict, causes: Sequence[str], departure: Departure | None, models: Mapping[str, str]
) -> str:
    """Return the first line where another solver explains the history best."""
    best = verdict.best
    scheme_of_best, model = scheme_words(best.alpha, best.delta, best.gg), models.get(best.model, best.model)
    remainder = f"the remaining difference is {per_cent(best.misfit, 2)} %"
    if not verdict.explained:
        return (
            f"Departs, not explained: nearest is {best.model} ({model}) with {scheme_of_best}, "
            f"{per_cent(verdict.left, 2)} % of the difference left; {remainder}."
        )
    parts = [f"{CAUSES[name].words}{_number(name, verdict.values)}" for name in causes]
    faults = f"; {_listed(parts)}" if parts else ""
    if departure is None:
        return f"Same model as {best.model} ({model}), same scheme: {scheme_of_best}{faults}; {remainder}."
    where = f"departs from step {departure.step} on, mainly in {departure.kind}"
    scheme = "a different scheme" if {"scheme", "exact-in-time"} & set(causes) else "same scheme"
    return f"Closest match: {best.model} ({model}), {scheme}: {scheme_of_best}; {where}{faults}; {remainder}."


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


def per_cent(value: float, digits: int = 3) -> str:
    """Return a fraction in per cent, without its unit; rounding is not written as digits."""
    return f"{100 * value:.{digits}g}" if abs(value) > ROUNDING else f"below {100 * ROUNDING:g}"


def _fitted(interval: Interval) -> str:
    width = f"+- {interval.half_width:.2g}" if interval.half_width > ROUNDING else f"+- less than {ROUNDING:g}"
    return f"{cleaned(interval.value):.7g} {width}"


def _listed(parts: Sequence[str]) -> str:
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


def _names(stages: Sequence[Stage], agrees: bool) -> str:
    return ", ".join(stage.name.replace("_", " ") for stage in stages if stage.agrees is agrees)


def _number(name: str, values: Mapping[str, float]) -> str:
    return f" ({values[name]:.4g})" if name in values else ""


def _family(one: Mapping[str, Any]) -> str:
    """Return causes with their numbers, ``density-factor 0.5 and gg 0.98``."""
    return _listed([name + (f" {one['values'][name]:.4g}" if name in one["values"] else "") for name in one["causes"]])


def _benign_words(name: str, subject: Said) -> str:
    if name == "base-compliance":
        return f"a base that adds {100 * subject.compliance:.2g} % to the static displacement"
    if name == "own-weight":
        return f"the block's own weight ({subject.variant.weight:.3g} x 9.81 m/s2)"
    return CAUSES[name].words


def _fault_words(name: str, subject: Said) -> str:
    """Return a cause with its number."""
    v, scene, value = subject.variant, subject.scene, subject.values.get(name, 0.0)
    steps = span(subject.open_steps)
    formula = {"velocity": "velocity (7)", "displacement": "displacement (6)"}.get(v.discounted, "")
    words = {
        "sign": _slips("sign", subject.slips),
        "unit": _slips("unit", subject.slips),
        "scheme": f"a different scheme from the scene's {scheme_words(scene.alpha, scene.delta, scene.gg)}",
        "gg": f"gg = {v.gg:.5g} where the scene has {scene.gg:.5g}" + _square(v.gg, scene.gg),
        "gg-in-one-formula": f"gg is applied only in the formula for the {formula}",
        "start": f'the initial acceleration is "{v.start}", not "{scene.start}"',
        "time-shift": f"the rows are {_steps(v.shift)}",
        "pressure-shift": _lateness(v.late),
        "pressure-factor": f"the reported pressure is {value:.5g} times the scene's",
        "reported-point": f"the displacement is that of a point {value:+.4g} m above the centroid{_place(v.point)}",
        "density-factor": f"the density is {value:.5g} times the scene's",
        "young-factor": f"Young's modulus is {value:.5g} times the scene's",
        "poisson": f"Poisson's ratio is {value:.4g}",
        "side-factor": f"the side of the block is {value:.5g} times the scene's",
        "springs-factor": f"the contact springs are {value:.4g} times the scene's",
        "load-factor": f"the load, or the displacement, is {value:.5g} times the scene's",
        "viscous-damping": f"viscous damping of the mass is there, {value:.4g} 1/s",
        "stiffness-damping": f"viscous damping of the stiffness is there, {value:.4g} s",
        "hht": f"the scheme is that of Hilber, Hughes and Taylor, alpha_f = {value:.4g}",
        "generalised-alpha": f"the scheme is generalised alpha, of spectral radius {value:.4g}",
        "substeps": f"the program makes {v.parts} steps in one of the scene's",
        "load-ramp": f"the load comes on within {value:.4g} s, not at once",
        "gravity-factor": _gravity(value),
        "inertia": f"the inertia of the strains is {value:.4g} times the rectangle's{_twelfth(value)}",
        "load-row": "the load " + ("is missing" if v.strain_load == 0 else "has the wrong sign") + " in the row of ey",
        "coupling": "the springs' coupling of v and ey " + ("is missing" if v.coupling == 0 else "has the wrong sign"),
        "stress-not-kept": f"only the {'force of the springs' if v.kept == 'springs' else 'stress'} is carried over",
        "contact-opened": f"the contact opened in steps {steps}" if steps else "the contact opened",
        "dead-band": f"an open contact closes only beyond a penetration of about {value:.3g} m"
        + _between(subject, name),
    }
    return words.get(name, CAUSES[name].words)


def _slips(cause: str, slips: Sequence[Slip]) -> str:
    return " and ".join(slip.words for slip in slips if slip.cause == cause) or CAUSES[cause].words


def _between(subject: Said, name: str) -> str:
    """Say between which values of a number the rows do not change."""
    if name not in subject.intervals:
        return ""
    low, high = subject.intervals[name]
    return f" ({low:.3g} to {high:.3g} m give the same rows)"


def _gravity(factor: float) -> str:
    """Say what became of the scene's gravity."""
    words = {0.0: "gravity is missing", -1.0: "gravity acts upwards"}
    return words.get(factor, f"gravity is {factor:.5g} times the scene's")


def _twelfth(factor: float) -> str:
    """Say which slip a factor on the inertia is, where it looks so."""
    words = {3.0: ", of a mass in the corners", 12.0: ", without its twelfth"}
    return words.get(round(factor, 3), "")


def _square(gg: float, scene: float) -> str:
    """Say that gg was applied twice, where it looks so."""
    return ", its square" if scene < 1 and abs(gg - scene**2) < 1e-6 else ""


def _lateness(late: float) -> str:
    if late == HALF:
        return "the pressure is the mean of this step and the one before"
    return f"the pressure is {_steps(late)}"


def _steps(late: float) -> str:
    return f"{abs(late):g} step{'s' * (abs(late) > 1)} {'late' if late > 0 else 'early'}"


def _place(point: float) -> str:
    return {1.0: ", the top edge", -1.0: ", the base"}.get(round(point, 6), "")
