"""Made histories of other schemes and contact methods, what `compare` makes of them, and the counts of its page.

Schemes, numbers, stiffness, time step, rows, digits, noise, the scene's own scheme and what is recorded are drawn at
random; one in seven programs is in no catalogue. The histories come from `scheme_histories`, which shares nothing with
what judges. ``PYTHONPATH=.:tests python tests/oracles/compared_schemes.py 0 300`` judges so many and writes them.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from oracles.pages import page_with, summary
from oracles.scheme_histories import Body, Run, rounded

from validation import load_scene
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene

PAGE = Path(__file__).parents[2] / "docs" / "compare.md"
BEGIN, END = "<!-- schemes: made by tests/oracles/compared_schemes.py -->\n", "<!-- end of schemes -->\n"
SCHEMES = ((0.5, 1.0), (0.25, 0.5), (0.3025, 0.6))
SCENES = (
    {},
    {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"},
    {"time.start": "consistent"},
)
TOLERANCE = 0.02  # of a number that is named


@dataclass(frozen=True)
class Case:
    """A run, the scene that it is judged against, and what is printed of it."""

    run: Run
    scene: Scene
    digits: int = 17
    noise: float = 0.0  # standard deviation over the largest value
    with_pressure: bool = True
    every: int = 1  # rows of which one is printed
    seed: int = 0

    @property
    def foreign(self):
        """What a file would hold."""
        rng = np.random.default_rng(self.seed)
        time = self.run.dt * np.arange(1, self.run.steps + 1)
        columns = []
        for values in self.run.history():
            noisy = values + self.noise * np.max(np.abs(values)) * rng.standard_normal(len(values))
            columns.append(rounded(noisy, self.digits)[self.every - 1 :: self.every])
        displacement, pressure = columns
        return Foreign(time[self.every - 1 :: self.every], displacement, pressure if self.with_pressure else None)

    def judged(self):
        """Return the answer."""
        return compare(self.scene, self.foreign)


def scene_of(run, **more):
    """Return the scene of a run, stepped by DDA's scheme."""
    values = {
        "time.step": run.dt,
        "time.steps": run.steps,
        "time.gg": run.gg,
        "contact.stiffness": run.body.p,
        "contact.law": "unilateral" if run.opens else "locked",
        "block.density": run.body.rho,
        "block.young": run.body.E,
        "load.pressure": run.body.q,
        "load.gravity": run.body.g,
    }
    return load_scene("figures-3-4").with_values(values | more)


def dashpot_of(body, ratio):
    """Return c of a damping ratio [N s/m]."""
    return 2 * ratio * math.sqrt(body.k * body.rho * body.a**2)


def made(seed):
    """Return one case."""
    rng = np.random.default_rng(seed)

    def pick(*values):
        return float(rng.choice(values))

    opens = bool(rng.random() < 0.45)
    body = Body(p=pick(5e8, 1e9, 5e9, 2e10, 1e11), rho=pick(2700, 2300), E=pick(1e9, 3e9), g=pick(0, 0, 9.81))
    contact_frequency = math.sqrt(body.k / (body.rho * body.a**2))
    dt = float(f"{pick(0.05, 0.15, 0.3, 0.6, 1.0, 1.6) / contact_frequency:.2g}")
    steps = int(pick(25, 60, 100, 200))
    gg = pick(1, 1, 1, 0.98, 0.995)
    method, numbers = _method(rng, body, opens)
    if method in ("leapfrog", "symplectic-euler", "runge-kutta"):
        while dt * math.sqrt((4 * body.k / body.a**2 + 3 * body.E) / body.rho) > 1.8:
            dt /= 2
    run = Run(method, numbers, body, dt, steps, gg, opens)
    noise = pick(0, 0, 0, 0, 1e-4, 1e-3)
    digits = 7 if noise else int(pick(4, 5, 6, 7, 9, 17))
    scene_gg = gg if rng.random() < 0.8 else 1.0
    scene = scene_of(replace(run, gg=scene_gg), **SCENES[rng.integers(len(SCENES))])
    return Case(run, scene, digits, noise, bool(rng.random() < 0.6), int(pick(1, 1, 1, 2)), seed)


def _method(rng, body, opens):
    """Return a method with its numbers."""

    def pick(*values):
        return values[rng.integers(len(values))]

    zero = bool(rng.random() < 0.25)
    alpha, delta = pick(*SCHEMES)
    newmark = {"alpha": alpha, "delta": delta, "zero": zero}
    family = {"zero": zero, "form": pick("force", "state") if opens else "force"}
    r = pick(0.0, 0.1, 0.3, 0.5, 0.62, 0.8, 0.9, 1.0)
    c = dashpot_of(body, pick(0.02, 0.08, 0.25, 0.6, 1.2))
    every = [
        ("chung-hulbert", {"r": r, **family}),
        ("hht", {"e": pick(0.02, 0.05, 0.1, 0.2, 0.3), **family}),
        ("wbz", {"r": r, **family}),
        ("leapfrog", {}),
        ("symplectic-euler", {}),
        ("composite", {"split": pick(0.3, 0.4, 0.5, 2 - math.sqrt(2), 0.7), "r": min(r, 0.9)}),
        ("implicit-euler", {}),
        ("theta", {"share": pick(0.55, 0.6, 0.75, 0.9)}),
        ("newmark", newmark),
        ("contact-split", {"law": "kane"}),
        ("contact-split", {"law": "energy-conserving"}),
        ("dashpot", {"c": c, "clipped": pick(True, False), **newmark}),
        ("runge-kutta", {}),
    ]
    if opens:
        every += [
            ("moreau", {"e": pick(0.0, 0.2, 0.5, 0.77, 1.0), "theta": pick(0.5, 0.5, 0.65, 1.0)}),
            ("lagrange", newmark),
            ("lagrange", {**newmark, "tolerance": 1e-6, "r": body.k}),
        ]
    else:
        weights = {"am": pick(0.1, -0.2), "af": pick(0.2, 0.35), "zero": zero, "form": "force"}
        every += [("tr-bdf2", {}), ("midpoint", {}), ("houbolt", {}), ("wilson", {}), ("weights", weights)]
    return every[rng.integers(len(every))]


# ---- verdicts -------------------------------------------------------------------------------------------------------


def names_of(run):
    """Return what a run may be called: a cause with its number, or ("", None, (alpha, delta)) of Newmark's."""
    n = run.numbers
    average = ("", None, (0.25, 0.5))
    match run.method:
        case "chung-hulbert":
            names = [("generalised-alpha", n["r"], None)]
            names += [("hht", 1 / 3, None)] if n["r"] == 0.5 else []
            names += [("wbz", 0.0, None)] if n["r"] == 0 else []
            return [average, *names] if n["r"] == 1 else names
        case "hht":
            return [("hht", n["e"], None)]
        case "wbz":
            names = [("wbz", n["r"], None)] + ([("generalised-alpha", 0.0, None)] if n["r"] == 0 else [])
            return [average, *names] if n["r"] == 1 else names
        case "composite" | "tr-bdf2":
            return [("composite", n.get("r", 0.0), None)]
        case "implicit-euler":
            return [("theta", 1.0, None), ("", None, (1.0, 1.5))]
        case "theta":
            return [("theta", n["share"], None)]
        case "midpoint":
            return [average]
        case "newmark":
            return [("", None, (n["alpha"], n["delta"]))]
        case "contact-split":
            if n["law"] == "kane":
                return [("implicit-contact", None, (0.25, 0.5))]
            return [("energy-conserving-contact", None, (0.25, 0.5)), *([] if run.opens else [average])]
        case "dashpot":
            ratio = n["c"] / dashpot_of(run.body, 1.0)
            return [("contact-dashpot", ratio, (n["alpha"], n["delta"]))]
        case "moreau":
            return [("impact-law", n["e"], None)]
        case "lagrange":
            return [] if n.get("tolerance") else [("rigid-contact", None, (n["alpha"], n["delta"]))]
        case "leapfrog" | "symplectic-euler":
            return [(run.method, None, None)]
        case "runge-kutta":  # of order four: at short steps within digits or noise of the motion itself
            return [("exact-in-time", None, None)]
    return []


def verdict(case, answer):
    """Return right, alike, silent, same (within digits and noise) or wrong."""
    if not answer.causes:
        return "same"
    names = names_of(case.run)
    if "unexplained" in answer.causes:
        possible = {name for name, _, _ in names}
        listed = {cause for one in answer.alike for cause in one["causes"]}
        return "alike" if possible & (listed | ({""} if listed & {"scheme", "start"} else set())) else "silent"
    own = set(answer.causes) - {"scheme", "start", "gg"}
    is_right = any(_is(name, own, answer) for name in names) and _has_split(case.run, answer)
    gg = 1.0 if case.run.method == "runge-kutta" else case.run.gg
    is_right = is_right and math.isclose(answer.scheme["gg"], gg, abs_tol=TOLERANCE / 10)
    return "right" if is_right else "wrong"


def _has_split(run, answer):
    """Whether the split of a composite scheme is the run's, or the one that is the same in locked contact."""
    if "split" not in run.numbers:
        return True
    g, r = run.numbers["split"], run.numbers["r"]
    other = 1 - 2 * g * (r + 1) / (2 * g * (r - 1) + 4)
    return min(abs(answer.scheme["split"] - g), abs(answer.scheme["split"] - other)) < TOLERANCE


def _is(name, own, answer):
    cause, number, pair = name
    if own != ({cause} if cause else set()):
        return False
    if number is not None and abs(answer.values[cause] - number) > TOLERANCE * max(1.0, number):
        return False
    if pair is None:
        return True
    alpha, delta = answer.scheme["alpha"], answer.scheme["delta"]
    return abs(alpha - pair[0]) < TOLERANCE and abs(delta - pair[1]) < TOLERANCE


WORDS = {
    "right": "were named right",
    "alike": "were among those alike",
    "silent": "not explained",
    "same": "called the same within digits and noise",
    "wrong": "named wrong",
}


def table(judged):
    """Return the paragraph of the page."""
    return summary(Counter((kind_of(case.run), verdict(case, answer)) for case, answer in judged), WORDS)


def kind_of(run):
    """Return a method as the table calls it."""
    if run.method in ("houbolt", "wilson", "weights", "runge-kutta") or run.numbers.get("tolerance"):
        return "in no catalogue"
    law = run.numbers.get("law")
    return f"{law} contact" if law else run.method


def judge(first, last):
    """Judge the cases of some seeds."""
    judged = []
    for seed in range(first, last):
        case = made(seed)
        judged.append((case, case.judged()))
        outcome = verdict(*judged[-1])
        print(seed, outcome, case.run.method, case.run.numbers, judged[-1][1].causes, flush=True)
    return judged


if __name__ == "__main__":
    cases = judge(int(sys.argv[1]), int(sys.argv[2]))
    PAGE.write_text(page_with(table(cases), PAGE.read_text(), BEGIN, END))
