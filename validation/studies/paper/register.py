"""The claims C1 to C13 and C17 to C22 of the register, of the paper's sections 2, 4 and 5."""

from __future__ import annotations

import math

import numpy as np

from validation.runs.history import Array
from validation.scenes.scene import Scene
from validation.suite.claims import Evidence, Tests, named, whole

A34, A56, A7, A8, A9 = (
    list(named(name)) for name in ("figures-3-4", "figures-5-6", "figure-7", "figure-8", "figure-9")
)
FIGURE_9 = tuple(named("figure-9").values())
COARSE, MIDDLE, _ = A34  # dt = 0.01, 0.002, 0.001 at p = 1E
SOFT, STIFF, STIFFEST = A56  # p = 1E, 10E, 100E at dt = 0.002
MAP = named("damping-map")
DISCOUNTS = named("discount-map")
TOLERANCES = (1e-4, 0.5)  # the least and the greatest at which a count of steps is looked for
PERIODS = 5  # of Figure 7's vibration, over which it is said to keep its amplitude
CONDITIONAL = named("conditional")


def cell(p: float, step: float) -> str:
    """Name of the case of the damping map at p/E and dt [s]."""
    return next(
        name for name, s in MAP.items() if s.contact.stiffness == p * s.block.young and np.isclose(s.time.step, step)
    )


def steps_of(evidence: Evidence, case: str) -> dict[str, float]:
    """Return the settling steps at 1 %."""
    return {
        "displacement, steps": evidence.settles(case, "displacement"),
        "contact force, steps": evidence.settles(case, "pressure"),
    }


def equilibrium(e: Evidence) -> dict[str, float]:
    """Return the largest distance of the last pressure from q, over q, and the least remaining."""
    distances = [abs(e.scaled(case, "pressure")[-1] - 1) for case in (*A34, *A56)]
    return {"final distance from q, largest of six runs": max(distances)}


def settling_tolerance(e: Evidence, case: str, quantity: str, count: int) -> float:
    """Return the greatest tolerance up to 0.5 at which a quantity takes `count` steps to settle, 0 if there is none.

    It settles in n steps at a tolerance t where the greatest distance from the static value from step n on is at most
    t, and that from step n - 1 on is greater: the tolerances of a count are one interval, of which the part from 1e-4
    to 0.5 counts.
    """
    remaining = np.maximum.accumulate(np.abs(e.scaled(case, quantity) - 1)[::-1])[::-1]
    least = max(remaining[count - 1], TOLERANCES[0])
    greatest = min(remaining[count - 2], TOLERANCES[1])
    return float(greatest) if least < greatest else whole(0.0)


def force_first(e: Evidence) -> dict[str, float]:
    """Return settling steps, the tolerances of the paper's, and the least steps that the force is later."""
    tolerances = np.geomspace(*TOLERANCES, 200)
    late = [e.settles(COARSE, "pressure", t) - e.settles(COARSE, "displacement", t) for t in tolerances]
    return steps_of(e, COARSE) | {
        "greatest tolerance of 5 steps, displacement": settling_tolerance(e, COARSE, "displacement", 5),
        "of 4 steps, force": settling_tolerance(e, COARSE, "pressure", 4),
        "force later by at least, steps (0.01 to 50 %)": whole(min(late)),
    }


def two_answers(e: Evidence) -> dict[str, float]:
    """Return the settling steps of Figures 3 to 6 at dt = 0.002 s, and the tolerances of the paper's."""
    return steps_of(e, MIDDLE) | {
        "greatest tolerance of 34 steps, displacement (0: none)": settling_tolerance(e, MIDDLE, "displacement", 34),
        "of 36 steps, force": settling_tolerance(e, MIDDLE, "pressure", 36),
        "of 44 steps, displacement": settling_tolerance(e, MIDDLE, "displacement", 44),
        "of 44 steps, force": settling_tolerance(e, MIDDLE, "pressure", 44),
    }


def stiff_steps(e: Evidence) -> dict[str, float]:
    """Return the settling steps at p = 10E, and the tolerances of the paper's."""
    return steps_of(e, STIFF) | {
        "greatest tolerance of 20 steps, displacement (0: none)": settling_tolerance(e, STIFF, "displacement", 20),
        "of 21 steps, force (0: none)": settling_tolerance(e, STIFF, "pressure", 21),
    }


def stiff_alike(e: Evidence) -> dict[str, float]:
    """Return the difference of settling steps between p = 10E and 100E, at 1 % and at 1e-4."""
    differences = {}
    for tolerance, name in ((0.01, "1 %"), (1e-4, "0.01 %")):
        for quantity, word in (("displacement", "displacement"), ("pressure", "contact force")):
            steps = [e.settles(case, quantity, tolerance) for case in (STIFF, STIFFEST)]
            differences[f"{word} to {name}, steps apart"] = whole(abs(steps[1] - steps[0]))
    return differences | {"contact root at 100E": e.number(STIFFEST, "contact.least_root")}


def over_steps(e: Evidence) -> dict[str, float]:
    """Return how xi of the first mode rises with dt at p = 1E below and above Omega = 3.27."""
    pairs = []
    for name, s in MAP.items():
        if s.contact.stiffness == s.block.young:
            pairs.append((s.time.step * e.number(name, "mode1.frequency"), e.number(name, "mode1.damping")))
    omega, xi = np.array(sorted(pairs)).T
    rise = np.diff(xi)
    below = omega[1:] < 3.28
    return {
        "least rise of xi below w dt = 3.27": rise[below].min(),
        "least rise of xi above": rise[~below].min(),
        "greatest xi": xi.max(),
        "at w dt": omega[np.argmax(xi)],
    }


def over_stiffness(e: Evidence) -> dict[str, float]:
    """Return how damping changes with p: first mode below and above dt = 6.2 ms, and contact mode."""
    ladder = (1.0, 10.0, 100.0)
    rises = []
    for dt in {s.time.step for s in MAP.values() if s.time.step <= 0.0062}:
        xi = [e.number(cell(p, dt), "mode1.damping") for p in ladder]
        rises += np.diff(xi).tolist()
    first = [e.number(cell(p, 0.01), "mode1.spectral_radius") for p in ladder]
    return {
        "least rise of xi with p, dt to 6.2 ms": min(rises),
        **{f"|lambda| at dt = 0.01, p = {p:g}E": value for p, value in zip(ladder, first, strict=True)},
        "fall of |lambda| at dt = 0.01": -np.diff(first).max(),
        "contact |lambda| at dt = 0.01, p = 100E": e.number(cell(100.0, 0.01), "contact.spectral_radius"),
    }


def peaks(displacement: Array) -> Array:
    """Return the heights of maxima above the static value."""
    middle = displacement[1:-1]
    is_peak = (middle > displacement[:-2]) & (middle >= displacement[2:]) & (middle > 1)
    return middle[is_peak]


def small_step(e: Evidence) -> dict[str, float]:
    """Return first and last peak over static, xi, and the loss of a few periods, for the p of Figure 7."""
    values: dict[str, float] = {}
    falls = []
    lost = []
    for case, p in zip(A7, ("1E", "10E", "100E"), strict=True):
        heights = peaks(e.scaled(case, "displacement"))
        xi = e.number(case, "mode1.damping")
        values |= {f"first peak at {p}": heights[0], f"last peak at {p}": heights[-1], f"xi at {p}": xi}
        falls.append(float(heights[0] - heights[-1]))
        lost.append(1 - math.exp(-2 * math.pi * PERIODS * xi / math.sqrt(1 - xi * xi)))
    return values | {
        "xi at 1E, dt = 1e-3 s": e.number(cell(1.0, 1e-3), "mode1.damping"),
        "greatest fall of the peaks": max(falls),
        f"greatest loss of amplitude in {PERIODS} periods": max(lost),
    }


def stiffness_of_small_steps(e: Evidence) -> dict[str, float]:
    """Return xi of the first mode for the p of Figure 7."""
    xi = [e.number(case, "mode1.damping") for case in A7]
    return {"xi at 10E over 1E": xi[1] / xi[0], "xi at 100E over 1E": xi[2] / xi[0]}


def sensitivity(e: Evidence) -> dict[str, float]:
    """Return the exponents of dt and p in xi of the first mode at small steps, from neighbours in the map."""
    xi = {(p, step): e.number(cell(p, step), "mode1.damping") for p in (1.0, 10.0, 100.0) for step in (1e-4, 5e-4)}
    exponents = {f"of p, {p:g}E to {10 * p:g}E": math.log10(xi[10 * p, 1e-4] / xi[p, 1e-4]) for p in (1.0, 10.0)}
    exponents |= {f"of dt, {p:g}E": math.log(xi[p, 5e-4] / xi[p, 1e-4]) / math.log(5) for p in (1.0, 10.0, 100.0)}
    least = min(value for name, value in exponents.items() if name.startswith("of dt"))
    greatest = max(value for name, value in exponents.items() if name.startswith("of p"))
    return exponents | {"least of dt over greatest of p": least / greatest}


def quasi_static(e: Evidence) -> dict[str, float]:
    """Return the settling steps of Figure 8's schemes, and whether average acceleration settles."""
    undamped, damped = A8
    distance = np.abs(e.scaled(undamped, "displacement") - 1)
    return {
        "constant acceleration, steps to 1 %": e.settles(damped, "displacement"),
        "its last distance from static": abs(e.scaled(damped, "displacement")[-1] - 1),
        "average acceleration, greatest distance over the last 50 steps": distance[-50:].max(),
    }


def discounted_amplitudes(e: Evidence) -> dict[str, float]:
    """Return what a step leaves of the first mode of Figure 9, by discount."""
    radii = [e.number(case, "mode1.spectral_radius") for case in A9]
    left = {f"|lambda| at gg = {s.time.discount:g}": radius for s, radius in zip(FIGURE_9, radii, strict=True)}
    squares = [radius**2 / s.time.discount for s, radius in zip(FIGURE_9, radii, strict=True)]
    return left | {
        "least fall from one discount to the next": -np.diff(radii).max(),
        "|lambda|^2 / gg - 1, largest": max(abs(square - 1) for square in squares),
    }


def dominance(e: Evidence) -> dict[str, float]:
    """Return the diagonal dominance of (31), the same block in metres and in centimetres, and of a longer block.

    The least over the rows of (diagonal - sum of the others) / diagonal; a row mixes displacements, in the unit of
    length, with strains, which have none.
    """
    block = MAP[cell(1.0, 0.01)]
    values = {}
    for side, step in ((2.0, 0.01), (2.0, 1.0), (3.0, 0.01)):
        values[f"a = {side:g} m, dt = {step:g} s"] = dominance_margin(block, side, step, 1.0)
    centimetres = dominance_margin(block, 2.0, 0.01, 100.0)
    metres = values["a = 2 m, dt = 0.01 s"]
    return values | {
        "a = 200 cm, dt = 0.01 s": centimetres,
        "changes of sign by the unit of length": whole(float((metres > 0) != (centimetres > 0))),
    }


def dominance_margin(scene: Scene, side: float, step: float, units_in_a_metre: float) -> float:
    """Return that least (`dominance`) over the rows of (31), lengths in another unit."""
    a = side * units_in_a_metre
    p = scene.contact.stiffness
    E = scene.block.young
    inertia = scene.block.density * side**2 / (scene.time.alpha * step**2)
    # p, E and inertia are forces per area and scale all rows alike; the length that goes with a strain does not. The
    # rows of displacement and strain across the base share -p a; that of the strain along it has its diagonal alone.
    diagonal = np.array([inertia + 2 * p, a**2 * (inertia / 12 + E + p / 2)])
    return float(((diagonal - p * a) / diagonal).min())


def conditionally_stable(e: Evidence) -> dict[str, float]:
    """Return |lambda| of the contact mode 1 % below and above its limit, under linear acceleration and differences."""
    values = {}
    for name, scene in CONDITIONAL.items():
        scheme = "central differences" if scene.time.alpha == 0 else "linear acceleration"
        omega = e.number(name, "contact.frequency") * scene.time.step
        values[f"|lambda| - 1 at w dt = {omega:.3g}, {scheme}"] = e.number(name, "contact.spectral_radius") - 1
    return values


def average(e: Evidence) -> dict[str, float]:
    """Return what average acceleration damps: both modes' |lambda| - 1, and the history's ratio."""
    return {
        f"|lambda| - 1, {mode} mode": e.number(A8[0], f"{key}.spectral_radius") - 1
        for mode, key in (("first", "mode1"), ("contact", "contact"))
    } | {"measured xi": e.number(A8[0], "mode1.measured_damping")}


def high_frequencies(e: Evidence) -> dict[str, float]:
    """Return |lambda| over w dt, of both modes of the map."""
    pairs = []
    for name, s in MAP.items():
        for mode in ("mode1", "contact"):
            omega = s.time.step * e.number(name, f"{mode}.frequency")
            pairs.append((omega, e.number(name, f"{mode}.spectral_radius")))
    omega, radius = np.array(sorted(pairs)).T
    below = omega < 4
    above = omega > 4
    return {
        "greatest rise of |lambda| below w dt = 4": np.diff(radius[below]).max(),
        "least |lambda|": radius.min(),
        "greatest w dt of the map": omega[-1],
        "|lambda| there": radius[-1],
        "least rise of |lambda| above w dt = 4": np.diff(radius[above]).min(),
    }


def boundary(e: Evidence) -> dict[str, float]:
    """Return alpha - (1/2 + delta)^2 / 4 of both schemes, and how far a stiff contact's roots are from real."""
    margins = [s.time.alpha - (0.5 + s.time.delta) ** 2 / 4 for s in named("figure-8").values()]
    root, radius = (e.number(STIFFEST, f"contact.{part}") for part in ("least_root", "spectral_radius"))
    return {
        "margin of (14), average": margins[0],
        "margin of (14), constant": margins[1],
        "1 - |Re|/|lambda| of the stiff contact": 1 - abs(root) / radius,
    }


def discount_alone(e: Evidence) -> dict[str, float]:
    """Return |lambda|^2 / gg and xi at one discount over dt."""
    ratios = {}
    squares = []
    for name, s in DISCOUNTS.items():
        ratios[f"xi at dt = {s.time.step:g}"] = e.number(name, "mode1.damping")
        if s.time.step >= 1e-4:
            squares.append(e.number(name, "mode1.spectral_radius") ** 2 / s.time.discount)
    xi = [value for name, value in ratios.items() if name != "xi at dt = 2e-05"]
    return ratios | {
        "|lambda|^2 / gg - 1, largest of complex roots": max(abs(v - 1) for v in squares),
        "xi, greatest over least": max(xi) / min(xi),
    }


def last_discount(e: Evidence) -> dict[str, float]:
    """Return the velocity share that Figure 9's steps take away, from |lambda|^2 = gg."""
    shares = [1 - e.number(case, "mode1.spectral_radius") ** 2 for case in A9]
    return {f"discount {i + 1}": share for i, share in enumerate(shares)}


TESTS: Tests = {
    "C1": ((*A34, *A56), equilibrium),
    "C2": ((COARSE,), force_first),
    "C3": ((MIDDLE,), two_answers),
    "C4": ((STIFF,), stiff_steps),
    "C5": ((STIFF, STIFFEST), stiff_alike),
    "C6": ([name for name, s in MAP.items() if s.contact.stiffness == s.block.young], over_steps),
    "C7": (MAP, over_stiffness),
    "C8": ((*A7, cell(1.0, 1e-3)), small_step),
    "C9": (A8[:1], average),
    "C10": (MAP, high_frequencies),
    "C11": ((STIFFEST,), boundary),
    "C12": (DISCOUNTS, discount_alone),
    "C13": (A9, last_discount),
    "C17": (A8, quasi_static),
    "C18": (A9, discounted_amplitudes),
    "C19": (A7, stiffness_of_small_steps),
    "C20": ([name for name, s in MAP.items() if s.time.step <= 5e-4], sensitivity),
    "C21": ((), dominance),
    "C22": (CONDITIONAL, conditionally_stable),
}
