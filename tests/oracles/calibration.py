"""A thousand histories of known origin by three generators, what `compare` makes of them, and the counts of the docs.

The generators share nothing with what judges: a plain DDA code (`sliding_block`), the finite elements of
`fem_reference` with a slip in the parameters, and modes: the block's two modes found by hand, each stepped by the
recursion of the scheme or summed in closed form. Causes are single ones of the catalogue, pairs, and ones that are in
no catalogue; digits, noise, steps, schemes and scenes are drawn at random.

``PYTHONPATH=.:tests python tests/oracles/calibration.py [COUNT [PROCESSES]]`` judges so many, a thousand by default,
and writes the counts to docs/compare.md.
"""

from __future__ import annotations

import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from oracles.pages import page_with, summary
from oracles.program_scenes import scene_of
from oracles.sliding_block import Plain, run
from oracles.stepped_vibration import Rule, operators
from scipy.linalg import eigh

from validation import solve
from validation.diagnosis.judgement import compare
from validation.diagnosis.reading import Foreign
from validation.scenes.scene import Scene

PAGE = Path(__file__).parents[2] / "docs" / "compare.md"
BEGIN, END = "<!-- calibration: made by tests/oracles/calibration.py -->\n", "<!-- end of calibration -->\n"
UNKNOWN, SAME = "unexplained", "same"
WORDS = {
    "right": "were named right",
    "silent": "not explained",
    "hidden": "called the same within digits and noise",
    "wrong": "named wrong",
}
SCHEMES = ((0.5, 1.0), (0.5, 1.0), (0.25, 0.5), (0.3025, 0.6))


@dataclass(frozen=True)
class Made:
    """A history, the scene that it is judged against, and the causes that were put in."""

    scene: Scene
    foreign: Foreign
    causes: tuple[str, ...]  # ids; ("unexplained",) where the cause is in no catalogue
    maker: str


@dataclass(frozen=True)
class Judged:
    """What was said of a history."""

    maker: str
    causes: tuple[str, ...]
    named: tuple[str, ...]


def made(seed):
    """Return one history."""
    rng = np.random.default_rng(seed)
    maker = ("plain", "plain", "elements", "modes")[seed % 4]
    base = _scene(rng)
    slips, causes = _cause(rng, base, maker)
    if maker == "elements":
        displacement, pressure = elements(replace(base, **slips))
    elif maker == "modes":
        displacement, pressure = modes(replace(base, **slips))
    else:
        displacement, pressure = run(replace(base, **slips))
    time = base.dt * np.arange(1, base.steps + 1)
    noise = float(rng.choice([0.0, 0.0, 0.0, 1e-4, 1e-3, 1e-2]))
    digits = int(rng.choice([5, 7, 16])) if noise == 0 else 7
    columns = [_printed(rng, values, noise, digits) for values in (displacement, pressure)]
    given = Foreign(time, columns[0], columns[1] if rng.random() < 0.6 else None)
    if "time-shift" in causes:
        given = replace(given, time=time[:-1], displacement=columns[0][1:], pressure=None)
    return Made(meshed(base), given, causes, maker)


def _printed(rng, values, noise, digits):
    noisy = values + noise * np.max(np.abs(values)) * rng.standard_normal(len(values))
    return np.array([float(f"{v:.{digits - 1}e}") for v in noisy])


def _scene(rng):
    alpha, delta = SCHEMES[rng.integers(len(SCHEMES))]
    return Plain(
        dt=float(rng.choice([2e-3, 1e-3, 5e-4])),
        steps=int(rng.choice([60, 100, 150])),
        rho=float(rng.choice([2700.0, 2300.0])),
        E=float(rng.choice([1e9, 2e9])),
        mu=float(rng.choice([0.0, 0.0, 0.25])),
        p=float(rng.choice([1e9, 5e9, 1e10])),
        alpha=alpha,
        delta=delta,
        gg=float(rng.choice([1.0, 1.0, 0.98])),
        consistent=bool(rng.random() < 0.5 and (alpha, delta) != (0.5, 1.0)),
    )


def _factor(rng):
    value = float(rng.choice([0.5, 0.8, 0.9, 1.1, 1.25, 2.0, rng.uniform(0.6, 1.6)]))
    return value


def _singles(rng, base):
    """Return every cause of the catalogue that a scene allows, as slips."""
    found = {
        "density-factor": {"rho": base.rho * _factor(rng)},
        "young-factor": {"E": base.E * _factor(rng)},
        "springs-factor": {"p": base.p * float(rng.choice([0.5, 2.0, 0.25, 4.0]))},
        "load-factor": {"q": base.q * _factor(rng)},
        "gg": {"gg": base.gg * float(rng.choice([0.99, 0.97, 0.95]))},
        "scheme": {"alpha": 0.25, "delta": 0.5} if base.alpha != 0.25 else {"alpha": 0.5, "delta": 1.0},
        "reported-point": {"point": float(rng.choice([1.0, -1.0]))},
        "own-weight": {"g": 9.81},
    }
    if base.alpha != 0.5:
        found["start"] = {"consistent": not base.consistent}
    if base.gg < 1:
        found["gg-in-one-formula"] = {"formulas": str(rng.choice(["velocity", "displacement"]))}
    return found


def _of_the_output(rng):
    """Return what only a code of one's own has."""
    return {
        "pressure-shift": {"late": 1} if rng.random() < 0.7 else {"averaged": True},
        "pressure-factor": {"pressure_times": 0.5},
        "time-shift": {},
        "contact-opened": {"opens": True},
        "side-factor": {"side": 2.0 * _factor(rng)},
        "load-row": {"row_sign": -1.0},
        "coupling": {"coupling": 0.0},
    }


def _outside(rng):
    """Return a cause that few programs have, or that is in no catalogue."""
    every = [
        {"viscous": float(rng.choice([3.0, 10.0, 30.0]))},
        {"height": 2.0 * float(rng.choice([0.9, 1.1, 1.3]))},
        {"structural": float(rng.choice([5e-5, 2e-4]))},
        {"hardening": float(rng.choice([5.0, 20.0, 60.0]))},
        {"creep": float(rng.choice([0.3, 1.0, 5.0]))},
        {"ramp": float(rng.choice([0.004, 0.01, 0.03]))},
        {"shaken": float(rng.choice([0.003, 0.01, 0.05])), "seed": int(rng.integers(1000))},
        {"filtered": float(rng.choice([0.2, 0.5]))},
        {"hht": float(rng.choice([-0.05, -0.1]))},
        {"friction": float(rng.choice([5e4, 2e5]))},
        {"hardening": 20.0, "viscous": 10.0},
        {"ramp": 0.01, "height": 2.2},
    ]
    return every[rng.integers(len(every))]


def _named_outside(slips, base):
    """Return the ids of a further slip; more stiffness in a step, without more of it kept, is another scheme.

    With a share e of it under (1/2, 1) from A0 = 0 the step is M a1 + K ((1 + e) x1 - e x) = F, x1 = x + U + dt^2 a1/2,
    which has the rows of Newmark's ((1 + e)/2, 1 + e) from the consistent start, the first one too.
    """
    if set(slips) == {"hht"} and (base.alpha, base.delta, base.consistent) == (0.5, 1.0, False):
        return ("scheme", "start")
    known = {
        "hht": "scheme",
        "structural": "stiffness-damping",
        "viscous": "viscous-damping",
        "ramp": "load-ramp",
        "height": "height-factor",
    }
    (name, *others) = slips
    return (UNKNOWN if others else known.get(name, UNKNOWN),)


def _cause(rng, base, maker):
    """Return the slips of a history and the ids of its causes."""
    kind = rng.random()
    single = _singles(rng, base)
    if maker != "plain":
        for name in ("reported-point", "own-weight", "gg-in-one-formula", *(() if maker == "modes" else ("start",))):
            single.pop(name, None)
    if kind < 0.08:
        return {}, (SAME,)
    if kind < 0.38 and maker == "plain":
        slips = _outside(rng)
        return slips, _named_outside(slips, base)
    if kind < 0.38 and maker == "modes":
        return {"hht": 1.0}, ("exact-in-time",)  # summed in closed form: no scheme at all
    if kind < 0.55:
        names = rng.choice(sorted(set(single) - {"own-weight", "start", "scheme"}), 2, replace=False)
        return single[names[0]] | single[names[1]], tuple(names)
    if maker == "plain":
        single |= _of_the_output(rng)
    name = str(rng.choice(sorted(single)))
    return single[name], (name,)


def meshed(p):
    """Return the scene of a run, with a mesh of its own."""
    return scene_of(p).with_values({"fem.elements": 12, "fem.degree": 1})


def elements(p):
    """Return a history of the finite elements."""
    found = solve(meshed(p), "fem")
    return found.displacement, found.contact_pressure


def modes(p):
    """Return a history from the modes of the block, (v, ey, ex), each stepped alone or summed in closed form."""
    m, h, a = p.rho * p.side**2, p.side, p.side
    c11 = p.E / (1 - p.mu**2)
    M = np.diag([m, m * h**2 / 12, m * a**2 / 12])
    k = 2 * p.p
    K = np.array(
        [
            [k, -k * h / 2, 0.0],
            [-k * h / 2, k * h**2 / 4 + a * h * c11, a * h * p.mu * c11],
            [0.0, a * h * p.mu * c11, a * h * c11 + k * a**2 / 4],
        ]
    )
    F = -p.q * a * np.array([1.0, h / 2, 0.0])
    squares, shapes = eigh(K, M)
    forces = shapes.T @ F
    if p.hht:
        angles = np.outer(np.arange(1, p.steps + 1) * p.dt, np.sqrt(squares))
        rows = forces / squares * (1 - np.cos(angles))
    else:
        T, push = operators(Rule(p.alpha, p.delta, p.gg, p.dt), squares)
        pushed = p.dt**2 * forces
        state = np.zeros((3, 3))
        state[:, 2] = p.consistent * pushed
        rows = np.empty((p.steps, 3))
        for n in range(p.steps):
            state = np.einsum("nij,nj->ni", T, state) + push * pushed[:, None]
            rows[n] = state[:, 0]
    v, ey, _ = shapes @ rows.T
    return v, -k * (v - h / 2 * ey) / a


# ---- what is said of them -------------------------------------------------------------------------------------------


def judged(seed):
    """Return what `compare` says of one history."""
    with np.errstate(all="ignore"):
        one = made(seed)
        answer = compare(one.scene, one.foreign)
    return Judged(one.maker, one.causes, tuple(answer.causes) or (SAME,))


def verdict(one):
    """Return whether the answer is right, silent or wrong.

    A cause that noise or rounding hides leaves the history the scene's own: "same" is then no wrong cause.
    """
    named, true = set(one.named), set(one.causes)
    same_rows = ({"base-compliance"}, {"springs-factor"}), ({"scheme"}, {"stiffness-damping"})
    if named == true or (named, true) in same_rows:
        return "right"
    if UNKNOWN in named:
        return "silent"
    return "hidden" if named == {SAME} else "wrong"


def table(found):
    """Return the paragraph of the page."""
    return summary(Counter((_kind(one.causes), verdict(one)) for one in found), WORDS)


def _kind(causes):
    return causes[0] if len(causes) == 1 else "two causes"


def judge(count, processes=1, first=0):
    """Judge so many histories."""
    if processes == 1:
        return [judged(seed) for seed in range(first, first + count)]
    with ProcessPoolExecutor(processes) as pool:
        return list(pool.map(partial(judged), range(first, first + count), chunksize=5))


if __name__ == "__main__":
    wanted = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    results = judge(wanted, int(sys.argv[2]) if len(sys.argv) > 2 else 2)
    PAGE.write_text(page_with(table(results), PAGE.read_text(), BEGIN, END))
