"""Histories of known origin, what `compare` makes of them, and the counts of its page.

The fifty of `compared.toml` and random ones come from `sliding_block`, with the slips that the file names, those of
other schemes and contact methods from `scheme_histories`; neither shares anything with what judges.
``PYTHONPATH=.:tests python tests/oracles/compared.py KIND FIRST LAST`` judges so many of a kind and writes the counts.
"""

from __future__ import annotations

import math
import sys
import tomllib
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from oracles.pages import page_with, summary
from oracles.program_scenes import scene_of as scene_of_plain
from oracles.scheme_histories import Body, Run, rounded
from oracles.sliding_block import Plain, run

from validation import load_scene
from validation.diagnosis.causes import CAUSES
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene

PAGE = Path(__file__).parents[2] / "docs" / "judge.md"
UNKNOWN, SAME = "unexplained", "same"
TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
TIMES = ("rho", "E", "p", "q", "side", "gg")  # slips that are factors
TOLERANCE = 0.02  # of a number that is named


@dataclass(frozen=True)
class Case:
    """What a program ran, the scene that it is judged against, and what is printed of it."""

    program: Plain | Run
    scene: Scene
    digits: int = 17
    noise: float = 0.0  # standard deviation over the largest value
    with_pressure: bool = True
    every: int = 1  # rows of which one is printed
    seed: int = 0
    causes: tuple[str, ...] = ()  # put in by slips; "unexplained" where it is in no catalogue
    change: Callable[[Foreign], Foreign] = lambda foreign: foreign

    @property
    def foreign(self):
        """What a file would hold."""
        rng = np.random.default_rng(self.seed)
        p = self.program
        rows = slice(self.every - 1, None, self.every)
        columns = []
        for values in run(p) if isinstance(p, Plain) else p.history():
            noisy = values + self.noise * np.max(np.abs(values)) * rng.standard_normal(len(values))
            columns.append(rounded(noisy, self.digits)[rows])
        displacement, pressure = columns
        time = p.dt * np.arange(1, p.steps + 1)[rows]
        return self.change(Foreign(time, displacement, pressure if self.with_pressure else None))

    def judged(self):
        """Return the answer."""
        return compare(self.scene, self.foreign)


# ---- slips ----------------------------------------------------------------------------------------------------------

CHANGES = {  # of the rows
    "milliseconds": lambda f: replace(f, time=f.time * 1e3),
    "late": lambda f: replace(f, displacement=np.concatenate([[0.0], f.displacement[:-1]])),
    "early": lambda f: replace(f, time=f.time[:-1], displacement=f.displacement[1:], pressure=None),
}


def scaled(factor):
    return lambda f: replace(f, displacement=f.displacement * factor)


def fifty():
    """Return the fifty."""
    cases = []
    for seed, (cause, scene, slip, change, noise) in enumerate(TABLES["known"]):
        own = Plain(**({"dt": 0.002, "steps": 30} | scene))
        change = CHANGES.get(change) or scaled(change)
        program = replace(own, **slip)
        cases.append(Case(program, scene_of_plain(own), 7, noise, False, 1, seed, (cause,), change))
    return cases


def slipped(seed):
    """Return a random scene whose program has no slip, one or two."""
    rng = np.random.default_rng(seed)

    def pick(values):
        return values[rng.integers(len(values))]

    own = Plain(**{name: pick(values) for name, values in TABLES["scenes"].items()})
    alpha, delta = pick(TABLES["schemes"])
    own = replace(own, alpha=alpha, delta=delta, consistent=bool(alpha != 0.5 and rng.random() < 0.5))
    slips = {"start": (("consistent", not own.consistent),)} if alpha != 0.5 else {}
    slips["scheme"] = tuple(zip(("alpha", "delta"), (0.25, 0.5) if alpha != 0.25 else (0.5, 1.0), strict=True))
    for cause, name, values in TABLES["slips"]:
        if cause != "gg-in-one-formula" or own.gg < 1:
            slips.setdefault(cause, ((name, pick(values)),))
    (count,) = rng.choice(3, 1, p=[0.08, 0.75, 0.17])
    names = list(slips)
    if count == 2:
        names = [name for name, ((field, _), *_) in slips.items() if field in TIMES]
    causes = tuple(map(str, rng.choice(names, count, replace=False)))
    made = {}
    change = CHANGES["early"] if "time-shift" in causes else Case.change
    for name, value in (slip for cause in causes for slip in slips[cause] if slip[0] != "rows"):
        made[name] = value * getattr(own, name) if name in TIMES else value
    noise = pick(TABLES["noise"])
    digits = 7 if noise else pick((5, 7, 16))
    pressure = bool(rng.random() < 0.6)
    names = tuple(UNKNOWN if cause.startswith(UNKNOWN) else cause for cause in causes) or (SAME,)
    return Case(replace(own, **made), scene_of_plain(own), digits, noise, pressure, 1, seed, names, change)


def told(answer):
    """Return the one cause that the answer names: the faults if there are any, else what is benign."""
    faults = [name for name in answer.causes if not CAUSES[name].benign]
    return "+".join(faults or answer.causes) or SAME


def verdict_of_fifty(case, answer):
    """Return whether what was done is what was named."""
    named = told(answer)
    if (named,) == case.causes:
        return "right"
    return "silent" if named == UNKNOWN else "wrong"


def verdict_of_slips(case, answer):
    """Return whether the answer is right, has the true causes among those alike, is silent or wrong.

    A cause that noise or rounding hides leaves the history the scene's own: "same" is then no wrong cause.
    """
    named, true = set(answer.causes or [SAME]), set(case.causes)
    if named == true or (named, true) == ({"base-compliance"}, {"springs-factor"}):
        return "right"
    if any(set(one["causes"]) == true for one in answer.alike):  # two of a product stand for two others
        return "alike"
    if UNKNOWN in named:
        return "silent"
    return "same" if named == {SAME} else "wrong"


# ---- schemes --------------------------------------------------------------------------------------------------------

SCHEMES = ((0.5, 1.0), (0.25, 0.5), (0.3025, 0.6))
SCENES = (
    {},
    {"time.alpha": 0.25, "time.delta": 0.5, "time.start": "consistent"},
    {"time.start": "consistent"},
)


def scene_of(program, **more):
    """Return the scene of a run, stepped by DDA's scheme."""
    body = program.body
    values = {"time.step": program.dt, "time.steps": program.steps, "time.gg": program.gg}
    values |= {"contact.stiffness": body.p, "contact.law": "unilateral" if program.opens else "locked"}
    values |= {"block.density": body.rho, "block.young": body.E, "load.pressure": body.q, "load.gravity": body.g}
    return load_scene("figures-3-4").with_values(values | more)


def dashpot_of(body, ratio):
    """Return c of a damping ratio [N s/m]."""
    return 2 * ratio * math.sqrt(body.k * body.rho * body.a**2)


def other_scheme(seed):
    """Return a random history of another scheme or contact method; one in seven is in no catalogue."""
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
    program = Run(method, numbers, body, dt, steps, gg, opens)
    noise = pick(0, 0, 0, 0, 1e-4, 1e-3)
    digits = 7 if noise else int(pick(4, 5, 6, 7, 9, 17))
    scene_gg = gg if rng.random() < 0.8 else 1.0
    scene = scene_of(replace(program, gg=scene_gg), **SCENES[rng.integers(len(SCENES))])
    return Case(program, scene, digits, noise, bool(rng.random() < 0.6), int(pick(1, 1, 1, 2)), seed)


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


def names_of(program):
    """Return what a run may be called: a cause with its number, or ("", None, (alpha, delta)) of Newmark's."""
    n = program.numbers
    average = ("", None, (0.25, 0.5))
    pair = n.get("alpha"), n.get("delta")
    r = n.get("r", 0.0)
    rigid = [] if n.get("tolerance") else [("rigid-contact", None, pair)]
    conserving = [("energy-conserving-contact", None, (0.25, 0.5)), *([] if program.opens else [average])]
    chung = [("generalised-alpha", r, None)]
    chung += [("hht", 1 / 3, None)] * (r == 0.5) + [("wbz", 0.0, None)] * (r == 0) + [average] * (r == 1)
    wbz = [("wbz", r, None), *[("generalised-alpha", 0.0, None)] * (r == 0), *[average] * (r == 1)]
    names = {
        "chung-hulbert": chung,
        "hht": [("hht", n.get("e"), None)],
        "wbz": wbz,
        "composite": [("composite", r, None)],
        "tr-bdf2": [("composite", 0.0, None)],
        "implicit-euler": [("theta", 1.0, None), ("", None, (1.0, 1.5))],
        "theta": [("theta", n.get("share"), None)],
        "midpoint": [average],
        "newmark": [("", None, pair)],
        "contact-split": [("implicit-contact", None, (0.25, 0.5))] if n.get("law") == "kane" else conserving,
        "dashpot": [("contact-dashpot", n.get("c", 0.0) / dashpot_of(program.body, 1.0), pair)],
        "moreau": [("impact-law", n.get("e"), None)],
        "lagrange": rigid,
        "leapfrog": [("leapfrog", None, None)],
        "symplectic-euler": [("symplectic-euler", None, None)],
        "runge-kutta": [("exact-in-time", None, None)],  # of order four: within digits or noise at short steps
    }
    return names.get(program.method, [])


def verdict(case, answer):
    """Return right, alike, silent, same (within digits and noise) or wrong."""
    if not answer.causes:
        return "same"
    names = names_of(case.program)
    if UNKNOWN in answer.causes:
        possible = {name for name, _, _ in names}
        listed = {cause for one in answer.alike for cause in one["causes"]}
        return "alike" if possible & (listed | ({""} if listed & {"scheme", "start"} else set())) else "silent"
    own = set(answer.causes) - {"scheme", "start", "gg"}
    is_right = any(_is(name, own, answer) for name in names) and _has_split(case.program, answer)
    gg = 1.0 if case.program.method == "runge-kutta" else case.program.gg
    is_right = is_right and math.isclose(answer.scheme["gg"], gg, abs_tol=TOLERANCE / 10)
    return "right" if is_right else "wrong"


def _has_split(program, answer):
    """Whether the split of a composite scheme is the run's, or the one that is the same in locked contact."""
    if "split" not in program.numbers:
        return True
    g, r = program.numbers["split"], program.numbers["r"]
    other = 1 - 2 * g * (r + 1) / (2 * g * (r - 1) + 4)
    return min(abs(answer.scheme["split"] - g), abs(answer.scheme["split"] - other)) < TOLERANCE


def _is(name, own, answer):
    cause, number, pair = name
    if own != ({cause} if cause else set()):
        return False
    if number is not None and abs(answer.values[cause] - number) > TOLERANCE * max(1.0, number):
        return False
    named = answer.scheme["alpha"], answer.scheme["delta"]
    return pair is None or max(abs(a - b) for a, b in zip(named, pair, strict=True)) < TOLERANCE


# ---- counts ---------------------------------------------------------------------------------------------------------

WORDS = {
    "right": "were named right",
    "alike": "were among those alike",
    "silent": "not explained",
    "same": "called the same within digits and noise",
    "wrong": "named wrong",
}
FEWER = {name: WORDS[name] for name in ("right", "silent", "wrong")}
KINDS = {  # cases, verdict and its words
    "fifty": (lambda seed: fifty()[seed], verdict_of_fifty, FEWER),
    "slips": (slipped, verdict_of_slips, WORDS),
    "schemes": (other_scheme, verdict, WORDS),
}


def marks(kind):
    """Return between which marks of the page the counts are."""
    return f"<!-- {kind}: made by tests/oracles/compared.py -->\n", f"<!-- end of {kind} -->\n"


def name_of(case):
    """Return a case as the table calls it."""
    if case.causes:
        return case.causes[0] if len(case.causes) == 1 else "two causes"
    method, numbers = case.program.method, case.program.numbers
    if method in ("houbolt", "wilson", "weights", "runge-kutta") or numbers.get("tolerance"):
        return "in no catalogue"
    law = numbers.get("law")
    return f"{law} contact" if law else method


def page_of(kind, judged):
    """Return the page with the counts of (case, verdict)."""
    table = summary(Counter((name_of(case), outcome) for case, outcome in judged), KINDS[kind][2])
    return page_with(table, PAGE.read_text(), *marks(kind))


def judge(kind, seeds):
    """Return the cases of some seeds, their answers and verdicts."""
    make, verdict_of, _ = KINDS[kind]
    with np.errstate(all="ignore"):
        cases = list(map(make, seeds))
        answers = [case.judged() for case in cases]
    return [(case, answer, verdict_of(case, answer)) for case, answer in zip(cases, answers, strict=True)]


if __name__ == "__main__":
    kind, first, last = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    judged = []
    for seed in range(first, last):
        ((case, answer, outcome),) = judge(kind, [seed])
        judged.append((case, outcome))
        print(seed, outcome, name_of(case), answer.causes, flush=True)
    PAGE.write_text(page_of(kind, judged))
